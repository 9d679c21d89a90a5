// Description of a problem for reports and result files.
//
// The description does not affect the identification. The defaults are right
// for a problem that is made from arrays in SI units. ReadCase fills all
// fields.

#ifndef PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_
#define PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/dynamics/observation.h"

namespace pinode {

// Original unit and scale of a channel, so that reports show its values as they
// were measured.
struct ChannelDescription {
  // Unit of the original values. Empty: the model's own unit of the quantity.
  std::string unit;
  // Factor in: value in the model's units = factor * original value. It
  // includes the sign of the sensor. It must be finite and not zero.
  double factor = 1.0;
  // Name of the DOF, or a combination such as "-1 u1 + 1 u2". Empty:
  // LocationText() of the observation.
  std::string location;
};

// Original unit of a record's times, and remarks on it.
struct RecordDescription {
  // Unit of the original times. Empty: the model's own.
  std::string time_unit;
  // Factor in: time in the model's unit = time_factor * original time. It must
  // be positive.
  double time_factor = 1.0;
  // Remarks for the report, one sentence each: rate and jitter of the time
  // column, samples missing, ...
  std::vector<std::string> remarks;
};

// True values of a force that is to be found, for comparison only. `times` and
// `values` have the same length and are in the model's units.
struct ForceTruth {
  std::string name;  // name of the unknown force or network
  Vector times;
  Vector values;
};

// Curve of force over deformation for one term of the model, from a data sheet
// or a test of the device, for comparison. The term has one output. It is a
// force, or the acceleration of one uncoupled mass.
struct ReferenceCurve {
  std::string term;
  std::string name;  // text of the legend
  // Points of the curve, of equal number, in the model's units. A positive
  // force resists a positive deformation.
  Vector deformation, force;
};

// Description of a problem.
struct ProblemDescription {
  std::string title;
  // Units of all numbers in the problem.
  UnitSystem units;
  std::vector<ForceTruth> force_truths;
  std::vector<ReferenceCurve> reference_curves;
  // Hash of the problem from which this one was made, if both ask the same
  // question, for instance with another basis of the reduction. Saved results
  // are recognised by it (pinode/study/problem/checkpoint.h). Otherwise empty.
  std::string known_as;
  // Decisions that pinode has taken automatically, one sentence each.
  std::vector<std::string> remarks;

  // Factor that converts cycles per unit of the model's time to Hz.
  double HzPerModelFrequency() const;

  // Checks that units exist, and that curves have finite forces, one per point.
  // On failure returns false, with a sentence in *error.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns the physical dimension of a quantity.
Dimension DimensionOf(Quantity quantity);

// Returns the weighted DOFs as text, such as "u2" or "u2 - 0.5 u1". `weights`
// and `dof_names` have one entry per DOF.
std::string LocationText(const Vector& weights,
                         const std::vector<std::string>& dof_names);

}  // namespace pinode

#endif  // PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_
