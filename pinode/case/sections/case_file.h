// Case files of users, read as problems to be identified.

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

// A case file, read and checked. All values in `problem` are in the model's
// units.
struct Case {
  std::string path;  // empty: from memory

  // Problem with a complete description: no field is left to its default.
  IdentificationProblem problem;
  IdentificationOptions options;
  // Steps of each record of the problem, chosen or as in the case file.
  std::vector<SubstepChoice> substeps;

  // Frequencies that the user expects of the model (Hz); may be empty.
  std::vector<double> expected_hz;

  // Finite-element model of which the problem's is a reduction
  // (pinode/study/reduction/reduced_structure.h); null if the case has none.
  std::shared_ptr<const ReducedStructure> finite_element;

  // [geometry]: places of its nodes (pinode/study/picture/structure_picture.h);
  // null if the case has none.
  std::shared_ptr<const PlacedGeometry> geometry;

  // [simulate]: noise in per cent of each channel's standard deviation, or of
  // each channel's own sigma.
  double noise_percent = 0.0;
  bool noise_is_sigma = false;
  std::uint64_t noise_seed = 1;

  // [discover]: options of pinode_discover.
  DiscoveryOptions discover;

  // Candidates: [[element]] with optional = true and the free terms of
  // [[library]] with select = true. A fit keeps those that the records support.
  std::vector<ModelCandidate> candidates;

  // [profiles]: the parameters whose likelihood is to be profiled, empty for
  // all free ones; no value without profiles.
  std::optional<std::vector<std::string>> profiles;

  // [damage]: changes besides those of groups that pinode_damage searches for.
  DamageSearch damage;

  // [plan]: possible sensors and their places; set by ReadCaseForPlanning only.
  SensorRequest plan;

  // The text as a tree, from which model.toml is made.
  std::shared_ptr<const TomlValue> source;
  // Arrays that the tree names in place of files; null: there are none.
  std::shared_ptr<const CaseData> data;
};

// Purpose for which a case is read, see below.
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

// Reads as ReadCase, on several ranks that share the tables of its records:
// each calls this, with its own `tables`.
[[nodiscard]] bool ReadCase(const std::string& path, SharedTables* tables,
                            Case* c, std::string* error);

// Reads as ReadCase, ReadCaseForCheck or ReadCaseForSimulation, from a tree
// that names arrays in `data` (null: none) as well as files. `path`, which need
// not exist, is the case's path for messages and relative paths. Empty: paths
// are relative to the working directory.
[[nodiscard]] bool ReadCaseTree(const TomlValue& tree, const std::string& path,
                                std::shared_ptr<const CaseData> data,
                                CasePurpose purpose, Case* c,
                                std::string* error);

// Reads as ReadCase, for a check: a model without records and modes is a case
// as well.
[[nodiscard]] bool ReadCaseForCheck(const std::string& path, Case* c,
                                    std::string* error);

// Reads as ReadCase, for a simulation: measured responses are not read (their
// values are NaN), a record needs no file, and no parameter need be free.
[[nodiscard]] bool ReadCaseForSimulation(const std::string& path, Case* c,
                                         std::string* error);

// Reads as ReadCaseForSimulation, to plan sensors: records need no channel, and
// Case::plan has the possible sensors. Each of `plan.excite` is a separate
// case: with `force_dof` not empty, the first force of each record acts there.
// No other force or ground motion acts then.
[[nodiscard]] bool ReadCaseForPlanning(const std::string& path,
                                       const std::string& force_dof, Case* c,
                                       std::string* error);

// Returns what Identify needs of a case beside its problem and options: the
// candidates, and the structure that its model is a reduction of.
IdentificationExtras ExtrasOf(const Case& c);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_CASE_FILE_H_
