// Case files: what a user writes, as the problem to be identified.

#ifndef PINODE_CASE_SECTIONS_CASE_FILE_H_
#define PINODE_CASE_SECTIONS_CASE_FILE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/discovery.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/damage/damage_search.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/problem/substeps.h"
#include "pinode/study/sensors/sensor_plan.h"
#include "pinode/study/terms/model_candidate.h"

namespace pinode {

class SharedTables;
struct CaseData;
struct PlacedGeometry;
struct ReducedStructure;
struct TomlValue;

// A case file, read and checked. Everything in `problem` is in the model's
// units.
struct Case {
  std::string path;  // empty: from memory

  // Its description is complete: nothing in it is left to defaults.
  IdentificationProblem problem;
  IdentificationOptions options;
  // The steps, chosen or as the case file says, of each record of the problem.
  std::vector<SubstepChoice> substeps;

  // Frequencies that the user expects of the model (Hz); may be empty.
  std::vector<double> expected_hz;

  // The finite-element model of which the problem's is a reduction
  // (pinode/study/reduction/reduced_structure.h); null where the case has none.
  std::shared_ptr<const ReducedStructure> finite_element;

  // [geometry]: where its nodes are (pinode/study/picture/structure_picture.h);
  // null where the case does not say.
  std::shared_ptr<const PlacedGeometry> geometry;

  // [simulate]: noise in per cent of each channel's standard deviation, or of
  // each channel's own sigma.
  double noise_percent = 0.0;
  bool noise_is_sigma = false;
  std::uint64_t noise_seed = 1;

  // [discover]: where pinode_discover looks for equations.
  DiscoveryOptions discover;

  // [[element]] with optional = true and the free terms of [[library]] with
  // select = true: those of which a fit keeps what the records support.
  std::vector<ModelCandidate> candidates;

  // [profiles]: the parameters whose likelihood is to be profiled, empty for
  // all that are free; none where nobody asks.
  std::optional<std::vector<std::string>> profiles;

  // [damage]: what pinode_damage looks for beside changes of groups.
  DamageSearch damage;

  // [plan]: which sensors could be where; by ReadCaseForPlanning alone.
  SensorRequest plan;

  // The text as a tree, from which model.toml is made.
  std::shared_ptr<const TomlValue> source;
  // Arrays that the tree names in place of files; null: there are none.
  std::shared_ptr<const CaseData> data;
};

// What a case is read for, see below.
enum class CasePurpose { kFit, kCheck, kSimulation, kPlanning };

// Reads the case file at `path` and all files that it names; see
// pinode/case/README.md for every key. Includes the checks of
// IdentificationProblem::IsValid and IdentificationOptions::IsValid, and the
// choice of the integration step.
//
// Fails with one line in *error, `file:line: what, and what was expected`;
// *c is untouched then.
[[nodiscard]] bool ReadCase(const std::string& path, Case* c,
                            std::string* error);

// As ReadCase, by several ranks that read the tables of its records for each
// other: all of them call this, with `tables` of their own.
[[nodiscard]] bool ReadCase(const std::string& path, SharedTables* tables,
                            Case* c, std::string* error);

// As ReadCase, ReadCaseForCheck or ReadCaseForSimulation, of a case that is a
// tree already, and names arrays in `data` (null: none) as well as files.
// `path`, which need not exist, is where it stands for messages and relative
// paths; empty: nowhere, and paths are those of the working directory.
[[nodiscard]] bool ReadCaseTree(const TomlValue& tree, const std::string& path,
                                std::shared_ptr<const CaseData> data,
                                CasePurpose purpose, Case* c,
                                std::string* error);

// As ReadCase, to be looked at: a model alone, with neither records nor modes,
// is a case as well.
[[nodiscard]] bool ReadCaseForCheck(const std::string& path, Case* c,
                                    std::string* error);

// As ReadCase, for a simulation: measured responses are not read (their values
// are NaN), a record may do without a file, and nothing need be free.
[[nodiscard]] bool ReadCaseForSimulation(const std::string& path, Case* c,
                                         std::string* error);

// As ReadCaseForSimulation, to plan sensors: records need no channel, and
// Case::plan says which sensors there could be. Each of `plan.excite` is a case
// of its own: with `force_dof` not empty the first force of each record acts
// there, and no other force or ground motion does.
[[nodiscard]] bool ReadCaseForPlanning(const std::string& path,
                                       const std::string& force_dof, Case* c,
                                       std::string* error);

// Returns what Identify needs of a case beside its problem and options: the
// candidates, and the structure that its model is a reduction of.
IdentificationExtras ExtrasOf(const Case& c);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_CASE_FILE_H_
