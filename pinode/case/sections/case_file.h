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

// Case file, read and checked. All values in `problem` are in the model's
// units.
struct Case {
  // Path of the case file; empty for a case from memory.
  std::string path;

  // Problem with a complete description: no field is left to its default.
  IdentificationProblem problem;
  // Options of the fit.
  IdentificationOptions options;
  // Integration steps per sample of each record, chosen by pinode or as in the
  // case file. One entry per record of the problem.
  std::vector<SubstepChoice> substeps;

  // Natural frequencies in Hz that the user expects of the model; may be empty.
  std::vector<double> expected_hz;

  // Finite-element model that was reduced to the problem's model
  // (pinode/study/reduction/reduced_structure.h). Null if nothing was reduced.
  std::shared_ptr<const ReducedStructure> finite_element;

  // [geometry]: nodes and elements of the structure, for pictures
  // (pinode/study/picture/structure_picture.h). Null if the case has none.
  std::shared_ptr<const PlacedGeometry> geometry;

  // [simulate]: noise to be added. It is noise_percent per cent of each
  // channel's standard deviation. If noise_is_sigma is true, it is each
  // channel's own `sigma` instead.
  double noise_percent = 0.0;
  bool noise_is_sigma = false;
  // Seed of the random numbers of the noise.
  std::uint64_t noise_seed = 1;

  // [discover]: options of pinode_discover.
  DiscoveryOptions discover;

  // Candidates: [[element]] with optional = true and the free terms of
  // [[library]] with select = true. A fit keeps those that the records support.
  std::vector<ModelCandidate> candidates;

  // [profiles]: names of the parameters whose likelihood is to be profiled. An
  // empty list stands for all free parameters. No value: no profiles.
  std::optional<std::vector<std::string>> profiles;

  // [damage]: changes that pinode_damage searches for besides changes of
  // groups.
  DamageSearch damage;

  // [plan]: possible sensors and their places. Only ReadCaseForPlanning sets
  // it.
  SensorRequest plan;

  // Text of the case file as a tree of tables. model.toml is made from it.
  std::shared_ptr<const TomlValue> source;
  // Arrays in memory that the tree names in place of files. Null: there are
  // none.
  std::shared_ptr<const CaseData> data;
};

// Purpose for which a case is read. Each value belongs to one function below.
enum class CasePurpose { kFit, kCheck, kSimulation, kPlanning };

// Reads the case file at `path` and all files that it names.
// pinode/case/README.md describes every key. Also runs
// IdentificationProblem::IsValid and IdentificationOptions::IsValid, and
// chooses the integration step.
//
// Returns false on failure, with one line in *error: `file:line: what, and what
// was expected`. *c is then unchanged. The functions below fail alike.
[[nodiscard]] bool ReadCase(const std::string& path, Case* c,
                            std::string* error);

// Reads as ReadCase, on several ranks that share the tables of the records, so
// that each file is read once. Each rank calls this with its own `tables`.
[[nodiscard]] bool ReadCase(const std::string& path, SharedTables* tables,
                            Case* c, std::string* error);

// Reads a case from a tree of tables, which may name arrays in `data` as well
// as files. `data` may be null. `purpose` selects one of ReadCase,
// ReadCaseForCheck, ReadCaseForSimulation and ReadCaseForPlanning. `path` is
// used in messages and resolves relative paths; the file need not exist. With
// an empty `path`, paths are relative to the working directory.
[[nodiscard]] bool ReadCaseTree(const TomlValue& tree, const std::string& path,
                                std::shared_ptr<const CaseData> data,
                                CasePurpose purpose, Case* c,
                                std::string* error);

// Reads as ReadCase, for a check. Also accepts a model without records and
// without measured modes.
[[nodiscard]] bool ReadCaseForCheck(const std::string& path, Case* c,
                                    std::string* error);

// Reads as ReadCase, for a simulation. Measured responses are not read: their
// values are NaN. A record needs no file, and no parameter need be free.
[[nodiscard]] bool ReadCaseForSimulation(const std::string& path, Case* c,
                                         std::string* error);

// Reads as ReadCaseForSimulation, to plan sensors. Records need no channel, and
// Case::plan gets the possible sensors.
//
// `force_dof` names one DOF of `plan.excite`. If it is not empty, the first
// force of each record acts at this DOF, and no other force or ground motion
// acts. Call once for each DOF of `plan.excite`.
[[nodiscard]] bool ReadCaseForPlanning(const std::string& path,
                                       const std::string& force_dof, Case* c,
                                       std::string* error);

// Returns the other inputs of Identify besides problem and options: the
// candidates, and the finite-element model that was reduced.
IdentificationExtras ExtrasOf(const Case& c);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_CASE_FILE_H_
