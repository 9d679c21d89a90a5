// Description of a problem for reports and result files.
//
// None of it takes part in an identification. The default of each field is
// right for a problem made of arrays in SI units. A case file fills all fields.

#ifndef PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_
#define PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/dynamics/observation.h"

namespace pinode {

// Original unit and scale of a channel, to report its values as they were
// measured.
struct ChannelDescription {
  // Unit of the original values. Empty: the model's own unit of the quantity.
  std::string unit;
  // Factor with: value in the model's units = factor * original value. It
  // includes the sensor's sign. Finite and not zero.
  double factor = 1.0;
  // Name of the DOF, or a combination such as "-1 u1 + 1 u2". Empty: location
  // of the observation.
  std::string location;
};

// Original unit of a record's times, and remarks on it.
struct RecordDescription {
  // Unit of the original times. Empty: the model's own.
  std::string time_unit;
  // Factor with: time in the model's unit = time_factor * original time;
  // positive.
  double time_factor = 1.0;
  // Remarks for the report, one sentence each: rate and jitter of the time
  // column, samples missing, ...
  std::vector<std::string> remarks;
};

// True values of a force that is to be found, used only for comparison. Model
// units.
struct ForceTruth {
  std::string name;  // of the unknown force, or the network
  Vector times;
  Vector values;
};

// Force of one of the model's terms from another source: a data sheet, or a
// test of the device alone. The term has one output and resists, or is an
// acceleration of one uncoupled mass.
struct ReferenceCurve {
  std::string term;
  std::string name;  // for the legend
  // Points of the curve in model units; the force resists positive deformation.
  Vector deformation, force;
};

struct ProblemDescription {
  std::string title;
  // Units of everything in the problem.
  UnitSystem units;
  std::vector<ForceTruth> force_truths;
  std::vector<ReferenceCurve> reference_curves;
  // Hash of the original problem, if this one was made from it without a change
  // of the question, as by another basis of its reduction. Results are
  // recognised by it (study/problem/checkpoint.h). Else empty.
  std::string known_as;
  // Decisions that were taken automatically, one sentence each.
  std::vector<std::string> remarks;

  // Factor from cycles per model time to Hz.
  double HzPerModelFrequency() const;

  // Checks that units exist and that curves have as many finite forces as
  // points.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns the physical dimension of a quantity.
Dimension DimensionOf(Quantity quantity);

// Returns the weighted DOFs as text, "u2" or "u2 - 0.5 u1".
std::string LocationText(const Vector& weights,
                         const std::vector<std::string>& dof_names);

}  // namespace pinode

#endif  // PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_
