#include "pinode/problem/identification_summary.h"

#include <cmath>
#include <string>

#include "pinode/base/strings.h"

namespace pinode {

const char* TerminationName(Termination termination) {
  switch (termination) {
    case Termination::kFailure:
      return "failure";
    case Termination::kConverged:
      return "converged";
    case Termination::kNoConvergence:
      return "no_convergence";
    case Termination::kInterrupted:
      return "interrupted";
  }
  return "failure";
}

std::string IdentificationSummary::BriefReport() const {
  std::string text = GradeTitle(verdict.grade());
  text += ": " + message +
          (!message.empty() && message.back() == '.' ? " " : ". ") +
          std::to_string(num_iterations) +
          (num_iterations == 1 ? " iteration, " : " iterations, ") +
          FormatNumber(seconds, 3) + " s.";
  for (size_t i = 0; i < records.size(); ++i) {
    const RecordScore& record = records[i];
    text +=
        (i == 0 ? " Error: '" : ", '") + record.name +
        (record.role == IdentificationRecord::Role::kTrain ? "' (train) "
                                                           : "' (holdout) ") +
        (std::isfinite(record.nrmse)
             ? FormatNumber(100.0 * record.nrmse, 3) + " %"
             : "diverges");
  }
  return text + (records.empty() ? "" : ".");
}

}  // namespace pinode
