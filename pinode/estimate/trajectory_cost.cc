#include "pinode/estimate/trajectory_cost.h"

#include <algorithm>
#include <utility>

#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/estimate/objective/prior_cost.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/solver/condensed_cost.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/estimate/start/stage_schedule.h"
#include "pinode/problem/assumed_noise.h"

namespace pinode {

struct TrajectoryCost::Owned {
  Owned(IdentificationProblem given, const MultipleShooting::Options& options)
      : problem(std::move(given)),
        layout(problem),
        shooting(problem, layout, options),
        condensed(&shooting, layout.num_free()) {}
  const IdentificationProblem problem;
  const ParameterLayout layout;
  MultipleShooting shooting;
  const CondensedCost condensed;
};

namespace {

// Checks given noise: one positive number per channel and training record, or
// nothing at all. Returns false, with *error, for anything else.
bool AreValidSigmas(const IdentificationProblem& problem,
                    const std::vector<Vector>& sigmas, std::string* error) {
  if (sigmas.empty()) return true;
  if (static_cast<int>(sigmas.size()) != problem.num_train_records()) {
    *error = "there are sigmas for " + std::to_string(sigmas.size()) +
             " training records of " +
             std::to_string(problem.num_train_records());
    return false;
  }
  size_t t = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const Vector& sigma = sigmas[t++];
    if (sigma.size() != static_cast<Eigen::Index>(record.channels.size()) ||
        !sigma.allFinite() || !(sigma.array() > 0.0).all()) {
      *error = "record '" + record.name + "': its sigmas must be " +
               std::to_string(record.channels.size()) +
               " positive numbers, one per channel";
      return false;
    }
  }
  return true;
}

bool AreValidOptions(const IdentificationProblem& problem,
                     const TrajectoryCost::Options& options,
                     std::string* error) {
  if (options.segment_samples < 0 || options.segment_samples == 1) {
    *error = "segment_samples is " + std::to_string(options.segment_samples) +
             ", it must be 0 (one segment a record) or at least 2";
  } else if (!(options.gap_firmness > 0.0)) {
    *error = "gap_firmness must be positive";
  } else if (!(options.loss_scale > 0.0)) {
    *error = "loss_scale must be positive";
  } else if (options.num_threads < 1) {
    *error = "num_threads must be at least 1";
  } else {
    return AreValidSigmas(problem, options.sigmas, error);
  }
  return false;
}

}  // namespace

std::unique_ptr<TrajectoryCost> TrajectoryCost::Create(
    IdentificationProblem problem, const Options& options, std::string* error) {
  if (!problem.IsValid(error) || !AreValidOptions(problem, options, error)) {
    return nullptr;
  }
  if (problem.num_train_records() == 0) {
    *error = "there is no training record";
    return nullptr;
  }
  MultipleShooting::Options shooting_options;
  shooting_options.derivatives = options.derivatives;
  shooting_options.loss = options.loss;
  shooting_options.loss_scale = options.loss_scale;
  shooting_options.num_threads = options.num_threads;
  auto owned = std::make_unique<Owned>(std::move(problem), shooting_options);
  MultipleShooting& shooting = owned->shooting;
  shooting.SetSigmas(options.sigmas.empty()
                         ? AssumedNoise(owned->problem, NoiseTuning())
                         : options.sigmas);
  const Vector free = owned->layout.Free(owned->layout.InitialValues());
  const StageTuning stages;
  TrajectoryOutlines trajectories;
  const auto fail = [&]() {
    *error = "at the initial values " + shooting.Failure();
    return nullptr;
  };
  if (!InitialTrajectories(owned->problem,
                           options.segment_samples > 0
                               ? options.segment_samples
                               : FirstSegmentSamples(owned->problem, stages),
                           free, stages, &shooting, &trajectories) ||
      !SetSegmentsAlong(options.segment_samples, trajectories, &shooting)) {
    return fail();
  }
  shooting.SetGapPenalty(1.0);
  CondensedSystem system;
  if (!shooting.Linearize(free, &system)) return fail();
  if (!IsSingleShooting(shooting)) {
    shooting.SetGapPenalty(options.gap_firmness *
                           std::max(1.0, shooting.state().data_curvature()));
  }
  return std::unique_ptr<TrajectoryCost>(new TrajectoryCost(std::move(owned)));
}

TrajectoryCost::TrajectoryCost(std::unique_ptr<Owned> owned)
    : owned_(std::move(owned)) {
  *mutable_parameter_block_sizes() = owned_->condensed.parameter_block_sizes();
  set_num_residuals(owned_->condensed.num_residuals());
}

TrajectoryCost::~TrajectoryCost() = default;

const ParameterLayout& TrajectoryCost::layout() const { return owned_->layout; }

Vector TrajectoryCost::InitialValues() const {
  return layout().Free(layout().InitialValues());
}

bool TrajectoryCost::Evaluate(double const* const* parameters,
                              double* residuals, double** jacobians) const {
  return owned_->condensed.Evaluate(parameters, residuals, jacobians);
}

std::unique_ptr<ceres::CostFunction> MakePriorCost(
    const ParameterLayout& layout, const Vector& decays) {
  auto cost = std::make_unique<PriorCost>(layout);
  if (decays.size() > 0) cost->SetDecays(decays);
  if (cost->num_priors() == 0) return nullptr;
  return cost;
}

std::unique_ptr<ceres::CostFunction> MakeModalCost(
    const IdentificationProblem& problem, const ParameterLayout& layout) {
  if (problem.modal.empty()) return nullptr;
  return std::make_unique<ModalCost>(problem.modal, *problem.dynamics, layout);
}

}  // namespace pinode
