// Case files: what a user writes, as the problem to be identified.

#ifndef PINODE_CASE_CASE_FILE_H_
#define PINODE_CASE_CASE_FILE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/case/damage_section.h"
#include "pinode/case/reference_curve_section.h"
#include "pinode/discover/discovery.h"
#include "pinode/estimate/identification_options.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/study/substeps.h"

namespace pinode {

struct FiniteElementCase;
struct TomlValue;

// What a writer must know about a channel beside
// IdentificationProblem::records[r].channels[c], to give it back as it came.
struct CaseChannel {
  std::string name;
  std::string unit;  // of the file
  // value in the model's units = factor * value in the file; the sensor's sign
  // is included.
  double factor = 1.0;
  // The DOF's name, or the combination, such as "-1 u1 + 1 u2".
  std::string location;
};

// What a writer must know about a record, beside IdentificationProblem.
struct CaseRecord {
  std::string time_unit = "s";  // of the file
  // time in the model's unit = time_factor * time in the file.
  double time_factor = 1.0;
  Interpolation interpolation = Interpolation::kLinear;
  // False for a free vibration.
  bool has_excitation = false;
  std::vector<CaseChannel> channels;  // in the problem's order
  // Chosen, or as the case file says.
  bool substeps_given = false;
  SubstepChoice substeps;
  // What a reader of the report should know about this record, one sentence
  // each: rate and jitter of the time column, samples missing, ...
  std::vector<std::string> remarks;
};

// What a force that is to be found was in truth, to be compared with it and for
// nothing else.
struct ForceTruth {
  std::string name;  // of the unknown force, or the network
  Vector times;
  Vector values;
};

// A case file, read and checked. Everything in `problem` is in the model's
// units.
struct Case {
  std::string path;
  std::string title;
  UnitSystem units;

  IdentificationProblem problem;
  IdentificationOptions options;
  // One per record of the problem, in its order.
  std::vector<CaseRecord> records;

  // Frequencies that the user expects of the model (Hz); may be empty.
  std::vector<double> expected_hz;

  // The finite-element model of which the problem's is a reduction
  // (finite_element_section.h); null where the case has none.
  std::shared_ptr<const FiniteElementCase> finite_element;

  // Of a case whose basis has been renewed (renewed_basis.h), the hash of what
  // was read (checkpoint.h), by which its results are known; else empty.
  std::string renewed_from;

  // As far as the case file names any.
  std::vector<ForceTruth> force_truths;

  // [simulate]: noise in per cent of each channel's standard deviation.
  double noise_percent = 0.0;
  std::uint64_t noise_seed = 1;

  // [discover]: where pinode_discover looks for equations.
  DiscoveryOptions discover;

  // [damage]: what pinode_damage looks for beside changes of groups.
  DamageSearch damage;

  // [[reference_curve]]: what the report draws beside the terms' forces.
  std::vector<ReferenceCurve> reference_curves;

  // Decisions that were taken for the user, one sentence each.
  std::vector<std::string> remarks;

  // The text as a tree, from which model.toml is made.
  std::shared_ptr<const TomlValue> source;

  // Frequencies in Hz are this factor times those in cycles per model time.
  double HzPerModelFrequency() const;
};

// Reads the case file at `path` and all files that it names; see
// pinode/case/README.md for every key. Includes the checks of
// IdentificationProblem::IsValid and IdentificationOptions::IsValid, and the
// choice of the integration step.
//
// Fails with one line in *error, `file:line: what, and what was expected`;
// *c is untouched then.
[[nodiscard]] bool ReadCase(const std::string& path, Case* c,
                            std::string* error);

// As ReadCase, of a case that is a tree already; `path`, which need not exist,
// is where it stands for messages and relative paths.
[[nodiscard]] bool ReadCaseTree(const TomlValue& tree, const std::string& path,
                                Case* c, std::string* error);

// As ReadCase, for a simulation: measured responses are not read (their values
// are NaN), a record may do without a file, and nothing need be free.
[[nodiscard]] bool ReadCaseForSimulation(const std::string& path, Case* c,
                                         std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_CASE_FILE_H_
