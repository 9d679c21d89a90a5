// Verdict on a result, and the findings that it follows from.

#ifndef PINODE_PROBLEM_VERDICT_H_
#define PINODE_PROBLEM_VERDICT_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {

// From best to worst. `kWithCare`: usable, with the findings in mind.
enum class Grade { kGood, kWithCare, kNotUsable };
// "good", "with_care", "not_usable": as in result.json.
const char* GradeName(Grade grade);
// "Good", "Usable with care", "Not usable": as in reports.
const char* GradeTitle(Grade grade);

// A failed check.
struct Finding {
  // Name of the check for programs, such as "open_gaps". Stable.
  std::string check;
  // Description with its numbers, without a period at the end.
  std::string what;
  // Number that was checked and the limit that it crossed; NaN if the check has
  // none.
  double number = kNaN;
  double limit = kNaN;
  // Advice to the user. Empty: none.
  std::string advice{};
  // Best grade that the finding still allows.
  Grade grade = Grade::kNotUsable;

  // "<what>; <advice>".
  std::string Sentence() const;
};

// Check of motion that a model does not explain.
inline constexpr char kUnexplainedMotion[] = "unexplained_motion";

// Verdict on a result. Its grade is a function of its findings and of nothing
// else: the best grade that all of them allow.
class Verdict {
 public:
  // A result that nothing has judged is not usable; it has one finding that
  // says so.
  Verdict();
  // Only the failed checks are listed. None: good.
  explicit Verdict(std::vector<Finding> findings);

  Grade grade() const { return grade_; }
  bool usable() const { return grade_ != Grade::kNotUsable; }
  const std::vector<Finding>& findings() const { return findings_; }
  // True if nothing speaks against the result but motion that it does not
  // explain: what explains it may still be found.
  bool MissesMotionAlone() const;

 private:
  std::vector<Finding> findings_;
  Grade grade_ = Grade::kNotUsable;
};

// A named parameter of the problem under an explanation.
struct ExplainedValue {
  std::string name;
  double value = kNaN;
  double lower95 = kNaN;
  double upper95 = kNaN;
};

// Something that the model does not have among its unknowns and that would
// describe the records better: another unknown, or several together, refitted
// with all others.
struct Explanation {
  // Description with its values, such as "damping of the whole structure by one
  // factor, +31 (29 to 33) %".
  std::string what;
  // Kind for programs: "damping", "mass", "stiffness", "bound", "nonlinear",
  // "sensor_gain", "sensor_delay", "sensor_offset", "sensors_exchanged",
  // "excitation_delay", "excitation_scale", "clock_rate". Several together are
  // joined by "+".
  std::string kind;
  // Name of the DOF, group or sensor, joined likewise. Empty: the whole
  // structure.
  std::string place;
  // Logarithm of its odds against the model as it is. Number of unknowns,
  // number of candidates and memory of the residuals are allowed for.
  double log_odds = 0.0;
  // Probability among all that were tried and the model as it is, each equally
  // probable before.
  double probability = 0.0;
  // Value of its first unknown, with a 95 % interval: a fraction of what the
  // model has (damping, mass, stiffness, clock rate), a gain, a delay, or the
  // coefficient of a force. NaN if it has no unknown.
  double value = kNaN;
  double lower95 = kNaN;
  double upper95 = kNaN;
  // Share of the squared error of the records that it removes.
  double removes = 0.0;
  // Unexplained motion under it, as a fraction, of the training records the
  // largest.
  double leaves = kNaN;
  // Named parameter that it moves most, and by how many half-widths of the 95 %
  // interval. Empty: the model has no interval.
  std::string moved;
  double shift = 0.0;
  // The model's own named unknowns under it.
  std::vector<ExplainedValue> values{};
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_VERDICT_H_
