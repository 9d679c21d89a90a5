#include "pinode/study/problem/prior_comparison.h"

#include <utility>

#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

PriorComparison CompareWithPrior(const IdentificationProblem& problem,
                                 const IdentifiedModel& model) {
  PriorComparison result;
  if (!problem.IsValid(&result.why_no_modes)) return result;
  const ParameterLayout layout(problem);
  if (model.parameters.size() != layout.num_parameters()) return result;
  const Vector prior = layout.InitialValues();
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

PriorRuns::PriorRuns(const IdentificationProblem& problem,
                     const IdentifiedModel& model)
    : problem_(problem), model_(model) {
  std::string error;
  valid_ = problem.IsValid(&error);
  if (valid_) prior_ = ParameterLayout(problem).InitialValues();
}

Matrix PriorRuns::Run(int record, const std::vector<int>& channels) {
  if (!valid_) return Matrix();
  return PredictChannels(problem_, record, channels, prior_, StartOf(record));
}

const Vector& PriorRuns::StartOf(int record) {
  const auto known = starts_.find(record);
  if (known != starts_.end()) return known->second;
  const auto r = static_cast<size_t>(record);
  const auto num_channels =
      static_cast<Eigen::Index>(problem_.records.at(r).channels.size());
  const bool has_sigmas =
      r < model_.sigmas.size() && model_.sigmas[r].size() == num_channels;
  const Vector sigmas =
      has_sigmas ? model_.sigmas[r] : Vector::Ones(num_channels);
  Vector start;
  FreeRunStart(problem_, record, prior_, sigmas, &start);
  return starts_.emplace(record, std::move(start)).first->second;
}

}  // namespace pinode
