// [[library]]: sparse library terms, what pinode_discover leaves behind.

#ifndef PINODE_CASE_LIBRARY_SECTION_H_
#define PINODE_CASE_LIBRARY_SECTION_H_

#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/terms_section.h"
#include "pinode/case/toml_table.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Adds the library terms of the case to *dynamics. To be called after
// ReadElements, whose laws come first in StructuralDynamics::laws().
[[nodiscard]] bool ReadLibraries(const TomlTable& root,
                                 const TermsContext& context,
                                 StructuralDynamics* dynamics);

// The unit of the coefficient of `function` where the product is an
// acceleration or a force. Functions that do not scale with their features'
// units, such as the sine of a displacement, count as pure numbers.
// `features` are those of the function; `inputs` those of the dynamics.
std::string LibraryCoefficientUnit(const LibraryFunction& function,
                                   const std::vector<Feature>& features,
                                   const std::vector<InputSpec>& inputs,
                                   ActsAs acts_as, const UnitSystem& units);

}  // namespace pinode

#endif  // PINODE_CASE_LIBRARY_SECTION_H_
