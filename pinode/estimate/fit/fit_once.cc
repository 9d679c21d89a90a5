#include "pinode/estimate/fit/fit_once.h"

#include <chrono>
#include <memory>
#include <string>

#include "pinode/base/stopwatch.h"
#include "pinode/estimate/fit/ambient_start.h"
#include "pinode/estimate/fit/multistart.h"
#include "pinode/estimate/fit/outcome.h"
#include "pinode/estimate/start/time_scale.h"

namespace pinode {
namespace {

// Checks that `initial` (may be nullptr) can have come from such a problem.
bool FitsProblem(const IdentificationProblem& problem,
                 const IdentifiedModel* initial, std::string* error) {
  if (initial == nullptr) return true;
  const int size = ParameterLayout(problem).num_parameters();
  if (initial->parameters.size() != size) {
    *error = "the initial model belongs to another problem: it has " +
             std::to_string(initial->parameters.size()) +
             " parameters, the problem has " + std::to_string(size);
    return false;
  }
  if (!initial->parameters.allFinite()) {
    *error = "a parameter of the initial model is not finite";
    return false;
  }
  return true;
}

// Fits the modes of ambient records first, where the fit can begin only there.
bool StartFromAmbientModes(const IdentificationProblem& problem,
                           const IdentificationOptions& options,
                           IdentifiedModel* start) {
  IdentificationProblem modes_alone;
  if (!ModesOfAmbientRecord(problem, options.num_threads, &modes_alone)) {
    return false;
  }
  IdentificationOptions quick = options;
  quick.num_starts = 1;
  quick.callback = nullptr;
  FitSummary summary;
  IdentifiedModel found;
  FitOnce(modes_alone, quick, nullptr, &summary, &found);
  if (summary.termination == Termination::kFailure ||
      summary.termination == Termination::kInterrupted ||
      !found.parameters.allFinite()) {
    return false;
  }
  start->parameters = found.parameters;
  return true;
}

}  // namespace

void FitOnce(const IdentificationProblem& problem,
             const IdentificationOptions& options,
             const IdentifiedModel* initial, FitSummary* summary,
             IdentifiedModel* model) {
  const auto begin = std::chrono::steady_clock::now();
  *summary = FitSummary();
  *model = IdentifiedModel();
  std::string error;
  if (!problem.IsValid(&error) || !options.IsValid(&error) ||
      !IsTimeScalePossible(problem, &error) ||
      !FitsProblem(problem, initial, &error)) {
    summary->message = error;
    return;
  }
  IdentifiedModel start;
  if (initial == nullptr && StartFromAmbientModes(problem, options, &start)) {
    initial = &start;
  }
  const std::unique_ptr<Fit> fit =
      RunStarts(problem, options, initial, summary);
  if (fit != nullptr) {
    ReportOutcome(problem, options, fit.get(), summary, model);
  }
  summary->seconds = SecondsSince(begin);
}

}  // namespace pinode
