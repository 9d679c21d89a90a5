#include "pinode/problem/verdict.h"

#include <algorithm>
#include <utility>

namespace pinode {

const char* GradeName(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "good";
    case Grade::kWithCare:
      return "with_care";
    case Grade::kNotUsable:
      return "not_usable";
  }
  return "not_usable";
}

const char* GradeTitle(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "Good";
    case Grade::kWithCare:
      return "Usable with care";
    case Grade::kNotUsable:
      return "Not usable";
  }
  return "Not usable";
}

std::string Finding::Sentence() const {
  return advice.empty() ? what : what + "; " + advice;
}

Verdict::Verdict()
    : Verdict(std::vector<Finding>{
          {"not_judged", "the identification has not been started"}}) {}

Verdict::Verdict(std::vector<Finding> findings)
    : findings_(std::move(findings)), grade_(Grade::kGood) {
  for (const Finding& finding : findings_) {
    grade_ = std::max(grade_, finding.grade);
  }
}

bool Verdict::MissesMotionAlone() const {
  return std::all_of(findings_.begin(), findings_.end(),
                     [](const Finding& finding) {
                       return finding.grade != Grade::kNotUsable ||
                              finding.check == kUnexplainedMotion;
                     });
}

}  // namespace pinode
