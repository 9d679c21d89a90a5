#include "pinode/estimate/certainty/fitted_cost.h"

#include <algorithm>

#include "pinode/base/statistics.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/estimate/start/initial_states.h"

namespace pinode {
namespace {

MultipleShooting::Options WithThreads(int num_threads) {
  MultipleShooting::Options options;
  options.num_threads = num_threads;
  return options;
}

// Linearises `objective`, a cost of `problem`, at a fit.
bool LinearizePlaced(const IdentificationProblem& problem,
                     const ParameterLayout& layout,
                     const IdentifiedModel& model,
                     const std::vector<RecordScore>& scores,
                     Objective* objective, CondensedSystem* system) {
  return PlaceAtFit(problem, layout, model, scores, objective) &&
         objective->Linearize(layout.Free(model.parameters), system) &&
         system->hessian.allFinite();
}

}  // namespace

bool PlaceAtFit(const IdentificationProblem& problem,
                const ParameterLayout& layout, const IdentifiedModel& model,
                const std::vector<RecordScore>& scores, Objective* objective) {
  MultipleShooting& shooting = objective->shooting();
  if (model.parameters.size() != layout.num_parameters()) return false;
  std::vector<Vector> sigmas;
  std::vector<Vector> scales;
  std::vector<Vector> starts;
  for (const int record : shooting.train_records()) {
    const size_t r = static_cast<size_t>(record);
    if (r >= scores.size() || r >= model.sigmas.size() || !scores[r].finite ||
        model.sigmas[r].size() !=
            static_cast<Eigen::Index>(problem.records[r].channels.size())) {
      return false;
    }
    sigmas.push_back(model.sigmas[r]);
    const Eigen::Index states = problem.dynamics->num_states();
    if (scores[r].start.size() == states &&
        scores[r].state_mean_squares.size() == states) {
      starts.push_back(scores[r].start);
      scales.push_back(StateScalesOf(problem, scores[r].state_mean_squares));
    } else if (scores[r].states.rows() == states &&
               scores[r].states.cols() == problem.records[r].num_samples()) {
      starts.push_back(scores[r].states.col(0));
      scales.push_back(StateScales(problem, scores[r].states));
    } else {
      return false;
    }
  }
  shooting.SetSigmas(sigmas);
  objective->priors().SetDecays(
      model.decays.size() == layout.num_decay_groups()
          ? model.decays
          : Vector(Vector::Zero(layout.num_decay_groups())));
  shooting.SetStateScales(scales);
  shooting.SetWholeRecords(starts);
  return true;
}

bool LinearizeAtFit(const IdentificationProblem& problem,
                    const ParameterLayout& layout, const IdentifiedModel& model,
                    const std::vector<RecordScore>& scores, int num_threads,
                    FittedCost* cost) {
  Objective objective(problem, layout, WithThreads(num_threads));
  std::vector<Matrix> residuals;
  if (!LinearizePlaced(problem, layout, model, scores, &objective,
                       &cost->system) ||
      !WeightedResiduals(layout.Free(model.parameters), false,
                         &objective.shooting(), &residuals, nullptr)) {
    return false;
  }
  double sum = 0.0;
  int count = 0;
  for (const Matrix& record : residuals) {
    for (Eigen::Index k = 0; k < record.rows(); ++k) {
      sum += AutocorrelationTime(record.row(k).transpose());
      ++count;
    }
  }
  cost->memory = std::max(1.0, sum / std::max(count, 1));
  return true;
}

bool LinearizeAtFit(const IdentificationProblem& problem,
                    const ParameterLayout& layout, const IdentifiedModel& model,
                    const std::vector<RecordScore>& scores, int num_threads,
                    CondensedSystem* system) {
  Objective objective(problem, layout, WithThreads(num_threads));
  return LinearizePlaced(problem, layout, model, scores, &objective, system);
}

}  // namespace pinode
