// What a problem says of itself, for reports and result files.
//
// None of it takes part in an identification. Every field has a value that is
// right for a problem made of arrays in SI units, so that only those who know
// better need to fill it; a case file fills all of it.

#ifndef PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_
#define PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/dynamics/observation.h"

namespace pinode {

// How a channel came, to give its values back as they came.
struct ChannelDescription {
  // Of the values as they came; empty: the model's own unit of the quantity.
  std::string unit;
  // value in the model's units = factor * value as it came; the sensor's sign
  // is included. Finite and not zero.
  double factor = 1.0;
  // The DOF's name, or a combination such as "-1 u1 + 1 u2"; empty: that of the
  // observation.
  std::string location;
};

// How a record came.
struct RecordDescription {
  // Of the times as they came; empty: the model's own.
  std::string time_unit;
  // time in the model's unit = time_factor * time as it came; positive.
  double time_factor = 1.0;
  // What a reader of the report should know about this record, one sentence
  // each: rate and jitter of the time column, samples missing, ...
  std::vector<std::string> remarks;
};

// What a force that is to be found was in truth, to be compared with it and for
// nothing else. Model units.
struct ForceTruth {
  std::string name;  // of the unknown force, or the network
  Vector times;
  Vector values;
};

// The force of one of the model's terms as known from elsewhere: a data sheet,
// a test of the device alone. The term has one output and resists, or is an
// acceleration of one uncoupled mass.
struct ReferenceCurve {
  std::string term;
  std::string name;  // for the legend
  // Model units; the force resists positive deformation.
  Vector deformation, force;
};

struct ProblemDescription {
  std::string title;
  // In which everything in the problem is written.
  UnitSystem units;
  std::vector<ForceTruth> force_truths;
  std::vector<ReferenceCurve> reference_curves;
  // Of a problem that was made from another one without a change of what is
  // asked, as by another basis of its reduction: the hash of that one, by which
  // results are known (study/problem/checkpoint.h); else empty.
  std::string known_as;
  // Decisions that were taken for the user, one sentence each.
  std::vector<std::string> remarks;

  // Frequencies in Hz are this factor times those in cycles per model time.
  double HzPerModelFrequency() const;

  // Units that exist; curves with as many finite forces as places.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// What a quantity is measured in.
Dimension DimensionOf(Quantity quantity);

// The weighted DOFs, "u2" or "u2 - 0.5 u1".
std::string LocationText(const Vector& weights,
                         const std::vector<std::string>& dof_names);

}  // namespace pinode

#endif  // PINODE_PROBLEM_PROBLEM_DESCRIPTION_H_
