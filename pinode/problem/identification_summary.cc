#include "pinode/problem/identification_summary.h"

#include <sstream>

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
  std::ostringstream text;
  text << (usable() ? "usable" : "not usable") << ", " << message << ", "
       << num_iterations << " iterations, " << seconds << " s";
  for (const RecordScore& record : records) {
    text << "; " << record.name
         << (record.role == IdentificationRecord::Role::kTrain ? " (train)"
                                                               : " (holdout)")
         << " nrmse " << record.nrmse;
  }
  return text.str();
}

}  // namespace pinode
