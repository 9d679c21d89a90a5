#include "pinode/estimate/multistart.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "pinode/estimate/pulse_scan.h"
#include "pinode/estimate/signs.h"
#include "pinode/estimate/ways.h"
#include "pinode/network/initialize_weights.h"

namespace pinode {
namespace {

// By what predicts, or, without records, by the cost.
bool IsBetter(const IdentificationProblem& problem, const FitState& one,
              const FitState& other) {
  return problem.num_train_records() == 0
             ? one.cost < other.cost
             : one.ExpectedError() < other.ExpectedError();
}

}  // namespace

Vector DrawStart(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const MultistartTuning& tuning,
                 uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random]() {
    return (static_cast<double>(random() >> 11) + 0.5) * 0x1.0p-53;
  };
  Vector values = layout.InitialValues();
  for (int index : layout.free()) {
    const Parameter& parameter = layout.parameter(index);
    if (!layout.IsNamed(index)) continue;
    double low = parameter.lower;
    double high = parameter.upper;
    if (parameter.HasPrior()) {
      low = std::max(low, parameter.prior_mean -
                              tuning.prior_deviations * parameter.prior_sigma);
      high = std::min(high, parameter.prior_mean + tuning.prior_deviations *
                                                       parameter.prior_sigma);
    }
    if (!std::isfinite(low) || !std::isfinite(high)) continue;
    values[index] = low + (high - low) * uniform();
  }
  const StructuralDynamics& dynamics = *problem.dynamics;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const int block = dynamics.network_block(static_cast<int>(j));
    const Vector weights = InitializeWeights(
        dynamics.networks()[j].network->architecture(), random(), true);
    for (int i = 0; i < weights.size(); ++i) {
      const int index = dynamics.block_offset(block) + i;
      if (layout.FreeIndex(index) >= 0) values[index] = weights[i];
    }
  }
  return values;
}

std::unique_ptr<Fit> RunStarts(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const IdentifiedModel* initial,
                               IdentificationSummary* summary) {
  const MultistartTuning& tuning = options.tuning.multistart;
  const ParameterLayout layout(problem);
  std::unique_ptr<Fit> best;
  int num_starts = 0;
  std::vector<double> costs;  // of the starts that came to an end
  for (int start = 0; start < std::max(1, options.num_starts); ++start) {
    ++num_starts;
    Vector parameters = layout.InitialValues();
    if (start > 0) {
      parameters = DrawStart(problem, layout, tuning,
                             options.seed + static_cast<uint64_t>(start));
    } else if (initial != nullptr) {
      parameters = initial->parameters;
    } else {
      FindSigns(problem, &parameters);
      ScanPulses(problem, &parameters);
    }
    IdentificationSummary outcome;
    std::unique_ptr<Fit> fit = RunWays(
        problem, options, parameters, start == 0 ? initial : nullptr, &outcome);
    const bool interrupted = fit != nullptr && fit->interrupted();
    if (fit != nullptr) costs.push_back(fit->best().cost);
    if (fit == nullptr) {
      if (best == nullptr) *summary = outcome;
    } else if (best == nullptr ||
               IsBetter(problem, fit->best(), best->best())) {
      best = std::move(fit);
      *summary = outcome;
    }
    if (interrupted) break;
  }
  if (best == nullptr) return nullptr;
  summary->num_starts = num_starts;
  const double same =
      best->best().cost + tuning.same_cost * std::abs(best->best().cost);
  summary->num_starts_at_best = static_cast<int>(
      std::count_if(costs.begin(), costs.end(),
                    [same](double cost) { return cost <= same; }));
  return best;
}

}  // namespace pinode
