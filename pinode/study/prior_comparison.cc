#include "pinode/study/prior_comparison.h"

#include <utility>

#include "pinode/estimate/free_run_start.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/score.h"

namespace pinode {
namespace {

Matrix PriorPrediction(const IdentificationProblem& problem, int r,
                       const Vector& prior, const IdentifiedModel& model) {
  const size_t index = static_cast<size_t>(r);
  const int num_channels =
      static_cast<int>(problem.records[index].channels.size());
  const bool has_sigmas =
      index < model.sigmas.size() && model.sigmas[index].size() == num_channels;
  const Vector sigmas =
      has_sigmas ? model.sigmas[index] : Vector::Ones(num_channels);
  Vector start;
  const Eigen::Index first = FreeRunStart(problem, r, prior, sigmas, &start);
  RecordScore score;
  ScoreRecord(problem, r, prior, start, first, &score, Keep::kChannels);
  return score.finite ? std::move(score.prediction) : Matrix();
}

}  // namespace

PriorComparison CompareWithPrior(const IdentificationProblem& problem,
                                 const IdentificationSummary& summary,
                                 const IdentifiedModel& model) {
  PriorComparison result;
  if (!problem.IsValid(&result.why_no_modes)) return result;
  const ParameterLayout layout(problem);
  const Vector prior = layout.InitialValues();
  result.predictions.resize(problem.records.size());
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (r >= summary.records.size()) continue;
    result.predictions[r] =
        PriorPrediction(problem, static_cast<int>(r), prior, model);
  }
  if (model.parameters.size() != layout.num_parameters()) return result;
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<ModePair> modes;
  if (CompareModes(
          dynamics.HeldModel(prior.head(layout.num_dynamics())),
          dynamics.HeldModel(model.parameters.head(layout.num_dynamics())),
          &modes, &result.why_no_modes)) {
    result.modes = std::move(modes);
  }
  return result;
}

}  // namespace pinode
