#include "pinode/estimate/trajectory_cost.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/initial_states.h"
#include "pinode/estimate/noise_levels.h"
#include "pinode/estimate/square_root.h"
#include "pinode/estimate/stage_schedule.h"

namespace pinode {

struct TrajectoryCost::Owned {
  Owned(IdentificationProblem given, const MultipleShooting::Options& options)
      : problem(std::move(given)),
        layout(problem),
        shooting(problem, layout, options) {}
  const IdentificationProblem problem;
  const ParameterLayout layout;
  MultipleShooting shooting;
};

namespace {

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
  std::vector<Matrix> states;
  const auto fail = [&]() {
    *error = "at the initial values " + shooting.Failure();
    return nullptr;
  };
  if (!InitialTrajectories(owned->problem,
                           options.segment_samples > 0
                               ? options.segment_samples
                               : FirstSegmentSamples(owned->problem, stages),
                           free, stages, &shooting, &states)) {
    return fail();
  }
  shooting.SetSegments(options.segment_samples, states);
  shooting.SetGapPenalty(1.0);
  CondensedSystem system;
  if (!shooting.Linearize(free, &system)) return fail();
  if (!shooting.IsSingleShooting()) {
    shooting.SetGapPenalty(options.gap_firmness *
                           std::max(1.0, shooting.DataCurvature()));
  }
  auto cost =
      std::make_unique<TrajectoryCost>(&shooting, owned->layout.num_free());
  cost->owned_ = std::move(owned);
  return cost;
}

TrajectoryCost::TrajectoryCost(MultipleShooting* shooting, int num_free)
    : shooting_(shooting) {
  mutable_parameter_block_sizes()->push_back(num_free);
  set_num_residuals(num_free + 1);
}

TrajectoryCost::~TrajectoryCost() = default;

const ParameterLayout& TrajectoryCost::layout() const {
  CHECK(owned_ != nullptr) << "it was not made by Create";
  return owned_->layout;
}

Vector TrajectoryCost::InitialValues() const {
  return layout().Free(layout().InitialValues());
}

bool TrajectoryCost::Evaluate(double const* const* parameters,
                              double* residuals, double** jacobians) const {
  const int n = parameter_block_sizes()[0];
  const Vector free = Eigen::Map<const Vector>(parameters[0], n);
  Eigen::Map<Vector> r(residuals, n + 1);
  const auto begin = std::chrono::steady_clock::now();
  bool ok;
  if (jacobians == nullptr || jacobians[0] == nullptr) {
    double cost = 0.0;
    ok = shooting_->Evaluate(free, &cost);
    r.setZero();
    r[n] = std::sqrt(2.0 * std::max(0.0, cost));
  } else {
    ok = shooting_->Linearize(free, &system_) &&
         SquareRoot(system_.hessian, &root_);
    if (ok) {
      Vector projected = system_.gradient;
      root_.transpose().triangularView<Eigen::Lower>().solveInPlace(projected);
      // Rounding, or a shifted root, must not turn into a negative rest.
      const double total = 2.0 * system_.cost;
      r.head(n) = projected;
      r[n] = std::sqrt(std::max(0.0, total - projected.squaredNorm()));
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic,
                               Eigen::RowMajor>>
          jacobian(jacobians[0], n + 1, n);
      jacobian.topRows(n) = root_;
      jacobian.bottomRows(1).setZero();
      ok = projected.allFinite();
    }
  }
  if (!ok) ++failed_evaluations_;
  jacobian_seconds_ +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
          .count();
  return ok;
}

}  // namespace pinode
