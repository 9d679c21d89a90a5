#include "pinode/study/problem/inner_fit.h"

#include <algorithm>

#include "pinode/estimate/fit/fit_once.h"

namespace pinode {

void InnerFit::Run(const std::string& what,
                   const IdentificationProblem& problem,
                   const IdentificationOptions& options,
                   const IdentifiedModel* begin, FitSummary* summary,
                   IdentifiedModel* model) {
  IdentificationOptions watched = options;
  if (watch_ != nullptr) {
    watched.callback = [&](const IdentificationProgress& progress) {
      const bool go_on = !options.callback || options.callback(progress);
      return watch_->OnIteration(what, problem, progress) && go_on;
    };
  }
  FitOnce(problem, watched, begin, summary, model);
  if (watch_ != nullptr) watch_->OnFitEnd(summary->termination);
}

void BeginNearTheEnd(IdentificationOptions* options) {
  options->shooting = IdentificationOptions::Shooting::kSingle;
}

void DecideQuickly(IdentificationOptions* options) {
  constexpr double kTolerance = 1e-7;
  constexpr int kMaxIterations = 60;
  options->function_tolerance =
      std::max(options->function_tolerance, kTolerance);
  options->max_num_iterations =
      std::min(options->max_num_iterations, kMaxIterations);
}

FitHistory FitHistory::Of(const FitSummary& summary) {
  return {summary.way, summary.linear_error, summary.seconds};
}

void FitHistory::Enter(FitSummary* summary) const {
  summary->way = way;
  summary->linear_error = linear_error;
  summary->seconds += seconds;
}

}  // namespace pinode
