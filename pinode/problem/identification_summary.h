// Results of an identification.

#ifndef PINODE_PROBLEM_IDENTIFICATION_SUMMARY_H_
#define PINODE_PROBLEM_IDENTIFICATION_SUMMARY_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/model_choice.h"
#include "pinode/problem/parameter_profile.h"
#include "pinode/problem/verdict.h"

namespace pinode {

// Level of motion at one sensor over the training records, for which a result
// holds: the RMS over parts of a record, in `unit`
// (pinode/problem/motion_levels.h).
struct MotionLevel {
  std::string channel;   // name of the sensor
  std::string dof;       // place of the sensor
  std::string quantity;  // as in case files, such as "displacement"
  std::string unit;      // unit of the model
  double lowest = 0.0;
  double mean = 0.0;
  double highest = 0.0;
};

// Result of Identify: its last fit, with a verdict. A new summary has the grade
// "not usable".
struct IdentificationSummary : FitSummary {
  IdentificationSummary() = default;
  explicit IdentificationSummary(FitSummary fit) : FitSummary(std::move(fit)) {}

  // Verdict, and the findings from which it follows.
  Verdict verdict;
  bool usable() const { return verdict.usable(); }

  // Explanations: refits with further unknowns that describe the records
  // better, best first (pinode/study/explanations/explain.h).
  std::vector<Explanation> explanations;

  // Choice among candidate terms (pinode/study/terms/term_choice.h). Empty: the
  // problem had no candidates.
  ModelChoice choice;
  // Profiles of the likelihood, if the case asks for them
  // (pinode/estimate/certainty/profile.h), and their computing time.
  std::vector<ParameterProfile> profiles;
  double profile_seconds = 0.0;

  // Returns a line with the verdict, message, iterations and time, and the
  // error of the simulation of each record.
  std::string BriefReport() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_SUMMARY_H_
