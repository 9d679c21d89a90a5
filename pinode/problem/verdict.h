// Verdict on a result, and the findings from which it follows.

#ifndef PINODE_PROBLEM_VERDICT_H_
#define PINODE_PROBLEM_VERDICT_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {

// Grade of a result, from best to worst. kWithCare: usable if the findings are
// kept in mind.
enum class Grade { kGood, kWithCare, kNotUsable };
// Returns "good", "with_care" or "not_usable", as in result.json.
const char* GradeName(Grade grade);
// Returns "Good", "Usable with care" or "Not usable", as in reports.
const char* GradeTitle(Grade grade);

// Finding: a check that has failed.
struct Finding {
  // Name of the check for programs, such as "open_gaps". It does not change
  // between versions.
  std::string check;
  // Description with its numbers, without a period at the end.
  std::string what;
  // Number that was checked, and the limit that it has crossed. NaN if the
  // check has none.
  double number = kNaN;
  double limit = kNaN;
  // Advice to the user. Empty: none.
  std::string advice{};
  // Best grade that the finding still allows.
  Grade grade = Grade::kNotUsable;

  // Returns "<what>; <advice>".
  std::string Sentence() const;
};

// Name of the check of unexplained motion.
inline constexpr char kUnexplainedMotion[] = "unexplained_motion";

// Verdict on a result. Its grade is the best one that all findings allow. It
// depends on nothing else.
class Verdict {
 public:
  // Creates the verdict of a result that was not checked. Its grade is
  // kNotUsable, and its only finding says so.
  Verdict();
  // Creates the verdict that follows from the checks that failed. If there are
  // none, the grade is kGood.
  explicit Verdict(std::vector<Finding> findings);

  Grade grade() const { return grade_; }
  bool usable() const { return grade_ != Grade::kNotUsable; }
  const std::vector<Finding>& findings() const { return findings_; }
  // True if unexplained motion is the only finding. Its explanation may still
  // be found.
  bool MissesMotionAlone() const;

 private:
  std::vector<Finding> findings_;
  Grade grade_ = Grade::kNotUsable;
};

// Value and 95 % interval of a named parameter under an explanation, in the
// parameter's unit.
struct ExplainedValue {
  std::string name;
  double value = kNaN;
  double lower95 = kNaN;
  double upper95 = kNaN;
};

// Explanation of unexplained motion: one or several further unknowns with which
// the model describes the records better. All unknowns were fitted again with
// them.
struct Explanation {
  // Description with its values, such as "all damping by one factor, +31 (29
  // to 33) %".
  std::string what;
  // Kind for programs, one of "damping", "mass", "stiffness", "bound",
  // "nonlinear", "sensor_gain", "sensor_delay", "sensor_offset",
  // "sensors_exchanged", "excitation_delay", "excitation_scale",
  // "clock_rate", "force_place", "mode" (a measured mode is left out).
  // Kinds of several unknowns are joined by "+".
  std::string kind;
  // Name of the DOF, group or sensor. Several are joined by "+". Empty: the
  // whole structure.
  std::string place;
  // Natural logarithm of the odds of the explanation relative to the present
  // model. It allows for the number of unknowns, the number of candidates, and
  // the correlation of residuals from sample to sample.
  double log_odds = 0.0;
  // Probability among the present model and all explanations that were tried.
  // Their prior probabilities are equal.
  double probability = 0.0;
  // Value of the first further unknown, with its 95 % interval. It is a
  // fraction of the model's value (damping, mass, stiffness, clock rate), a
  // gain, a delay, or the coefficient of a force. NaN: there is no unknown.
  double value = kNaN;
  double lower95 = kNaN;
  double upper95 = kNaN;
  // Fraction of the records' squared error that the explanation removes.
  double removes = 0.0;
  // Remaining unexplained motion, as a fraction of the measured motion; the
  // largest value of the training records.
  double leaves = kNaN;
  // Named parameter that the explanation changes most, and its change in half
  // widths of the 95 % interval. Empty: the model has no intervals.
  std::string moved;
  double shift = 0.0;
  // Values of the model's own named parameters under the explanation.
  std::vector<ExplainedValue> values{};
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_VERDICT_H_
