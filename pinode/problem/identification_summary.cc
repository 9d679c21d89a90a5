#include "pinode/problem/identification_summary.h"

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
  std::string text = usable() ? "usable: " : "not usable: ";
  text += message + " after " + std::to_string(num_iterations) +
          (num_iterations == 1 ? " iteration" : " iterations") + " and " +
          FormatNumber(seconds, 3) + " s.";
  for (size_t i = 0; i < records.size(); ++i) {
    const RecordScore& record = records[i];
    text +=
        (i == 0 ? " Error: '" : ", '") + record.name +
        (record.role == IdentificationRecord::Role::kTrain ? "' (train) "
                                                           : "' (holdout) ") +
        FormatNumber(100.0 * record.nrmse, 3) + " %";
  }
  return text + (records.empty() ? "" : ".");
}

}  // namespace pinode
