// Verdict on a result, and the findings that it follows from.

#ifndef PINODE_PROBLEM_VERDICT_H_
#define PINODE_PROBLEM_VERDICT_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {

enum class Grade { kGood, kNotUsable };
// "good", "not_usable": as in result.json.
const char* GradeName(Grade grade);
// "Good", "Not usable": as in reports.
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

 private:
  std::vector<Finding> findings_;
  Grade grade_ = Grade::kNotUsable;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_VERDICT_H_
