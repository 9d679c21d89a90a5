// [[group]], [[element]] and [[network]]: the unknown parts of the model.

#ifndef PINODE_CASE_SECTIONS_TERMS_SECTION_H_
#define PINODE_CASE_SECTIONS_TERMS_SECTION_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/study/terms/model_candidate.h"

namespace pinode {

// Context of the sections below in the rest of the case.
struct TermsContext {
  const UnitSystem* units = nullptr;
  const ModelSection* model = nullptr;
  std::uint64_t default_seed = 1;
  // Receives decisions taken automatically.
  std::vector<std::string>* remarks = nullptr;
  // Receives the terms that may be left out.
  std::vector<ModelCandidate>* candidates = nullptr;
};

// Add the terms of their sections to *dynamics.
[[nodiscard]] bool ReadGroups(const TomlTable& root,
                              const TermsContext& context,
                              StructuralDynamics* dynamics);
[[nodiscard]] bool ReadElements(const TomlTable& root,
                                const TermsContext& context,
                                StructuralDynamics* dynamics);
// Call it after groups and elements, which the gauge rule uses.
[[nodiscard]] bool ReadNetworks(const TomlTable& root,
                                const TermsContext& context,
                                StructuralDynamics* dynamics);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_TERMS_SECTION_H_
