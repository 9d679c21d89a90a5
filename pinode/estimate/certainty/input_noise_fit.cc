#include "pinode/estimate/certainty/input_noise_fit.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/certainty/input_noise.h"
#include "pinode/estimate/certainty/input_noise_filter.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/start/initial_states.h"

namespace pinode {
namespace {

// Iterations after which a fit counts as not converged.
constexpr int kMaxIterations = 50;

// Limits of convergence: the step in standard deviations of the parameters, and
// the change of the sensors' noise levels.
constexpr double kSmallestStep = 1e-4;
constexpr double kSmallestNoiseChange = 1e-4;

// Range of a free start in multiples of the RMS of each state: the weak prior
// of multiple shooting.
constexpr double kStartScales = 100.0;

// Smallest noise estimate as a share of the channel's residual.
constexpr double kLeastNoise = 1e-6;

// A point of the iteration: parameters and errors of the excitation.
struct Point {
  Vector free;
  std::vector<Matrix> errors;  // noisy inputs x samples, per training record
};

class Fitter {
 public:
  Fitter(const IdentificationProblem& problem, const ParameterLayout& layout,
         const MultipleShooting::Options& options, const Vector& decays,
         const InputNoiseFit& fit)
      : problem_(problem),
        layout_(layout),
        options_(options),
        decays_(decays),
        sigmas_(fit.sigmas),
        trajectories_(fit.trajectories) {
    for (size_t r = 0; r < problem.records.size(); ++r) {
      const IdentificationRecord& record = problem.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      train_.push_back(static_cast<int>(r));
      inputs_.push_back(record.NoisyInputs());
      point_.errors.push_back(Matrix::Zero(
          static_cast<int>(inputs_.back().size()), record.num_samples()));
      floors_.push_back(kLeastNoise * fit.sigmas[train_.size() - 1]);
    }
    point_.free = fit.free;
    for (int index : layout.free()) {
      const Parameter& parameter = layout.parameter(index);
      lower_.push_back(parameter.lower);
      upper_.push_back(parameter.upper);
    }
  }

  bool Covariance(CovarianceEstimate* covariance);
  bool Run(const InputNoiseCallback& go_on, InputNoiseFit* fit,
           std::string* error);

 private:
  // Sets up multiple shooting, one segment per record, under the corrected
  // excitation.
  void Correct(const Point& point);
  bool Cost(const Point& point, double* cost);
  // Normal equations of the data for the parameters, and the terms of the
  // priors.
  struct Equations {
    Matrix data;
    Vector right;
    Matrix priors;
    Vector prior_gradient;
    double num_residuals = 0.0;
  };
  // Linearisation of one record, whose errors and start are eliminated by the
  // filter.
  struct Eliminated {
    LinearizedRecord linearized;
    std::unique_ptr<InputNoiseFilter> filter;
    Vector pseudo_residuals;
    Matrix jacobian;
  };
  // Adds a record. `residuals` and `jacobian` are weighted, as from
  // WeightedResiduals.
  void AddRecord(size_t t, const Vector& parameters, const Matrix& residuals,
                 Matrix jacobian, Equations* equations,
                 Eliminated* eliminated) const;
  [[nodiscard]] bool StepWithinBounds(const Matrix& hessian,
                                      const Vector& right, Vector* delta) const;
  // Takes a Gauss-Newton step to the minimum of the problem linearised at
  // point_.
  bool Propose(Point* proposed, double* step);
  // Returns the response to the errors, weighted, channels fastest.
  Vector Response(const LinearizedRecord& record, const Matrix& errors,
                  const Vector& sigmas) const;

  const IdentificationProblem& problem_;
  const ParameterLayout& layout_;
  const MultipleShooting::Options options_;
  const Vector decays_;
  std::vector<int> train_;
  std::vector<std::vector<int>> inputs_;
  std::vector<double> lower_, upper_;
  std::vector<Vector> floors_;

  Point point_;
  std::vector<Vector> sigmas_;
  std::vector<Matrix> trajectories_;
  IdentificationProblem corrected_;
  std::unique_ptr<Objective> objective_;
  // Covariance and noise levels of the last proposal.
  CovarianceEstimate covariance_;
  std::vector<Vector> next_sigmas_;
};

void Fitter::Correct(const Point& point) {
  corrected_ = problem_;
  std::vector<Vector> scales;
  for (size_t t = 0; t < train_.size(); ++t) {
    IdentificationRecord& record =
        corrected_.records[static_cast<size_t>(train_[t])];
    Matrix samples = record.excitation->samples();
    for (size_t j = 0; j < inputs_[t].size(); ++j) {
      samples.row(inputs_[t][j]) += point.errors[t].row(static_cast<int>(j));
    }
    record.excitation.emplace(record.excitation->start_time(),
                              record.excitation->step(), samples,
                              record.excitation->interpolation());
    scales.push_back(StateScales(problem_, trajectories_[t]));
  }
  objective_ = std::make_unique<Objective>(corrected_, layout_, options_);
  SetSegments(0, trajectories_, &objective_->shooting());
  objective_->shooting().SetStateScales(scales);
  objective_->shooting().SetSigmas(sigmas_);
  objective_->priors().SetDecays(decays_);
}

bool Fitter::Cost(const Point& point, double* cost) {
  Correct(point);
  if (!objective_->Evaluate(point.free, cost)) return false;
  for (size_t t = 0; t < train_.size(); ++t) {
    const Vector& sigma =
        problem_.records[static_cast<size_t>(train_[t])].input_sigma;
    for (size_t j = 0; j < inputs_[t].size(); ++j) {
      *cost += 0.5 * point.errors[t].row(static_cast<int>(j)).squaredNorm() /
               std::pow(sigma[inputs_[t][j]], 2);
    }
  }
  return std::isfinite(*cost);
}

Vector Fitter::Response(const LinearizedRecord& record, const Matrix& errors,
                        const Vector& sigmas) const {
  const int nc = static_cast<int>(sigmas.size());
  const auto samples = static_cast<Eigen::Index>(record.samples.size());
  Vector response(nc * samples);
  Vector state = Vector::Zero(problem_.dynamics->num_states());
  for (Eigen::Index i = 0; i < samples; ++i) {
    const LinearizedRecord::Sample& sample =
        record.samples[static_cast<size_t>(i)];
    response.segment(i * nc, nc) =
        (sample.by_state * state + sample.by_input * errors.col(i))
            .cwiseQuotient(sigmas);
    if (i + 1 == samples) break;
    state = sample.transition * state + sample.left * errors.col(i) +
            sample.right * errors.col(i + 1);
  }
  return response;
}

void Fitter::AddRecord(size_t t, const Vector& parameters,
                       const Matrix& residuals, Matrix jacobian,
                       Equations* equations, Eliminated* eliminated) const {
  const IdentificationRecord& record =
      corrected_.records[static_cast<size_t>(train_[t])];
  const int nc = static_cast<int>(residuals.rows());
  const Eigen::Index samples = residuals.cols();
  const Eigen::Index n = jacobian.cols();
  eliminated->linearized = LinearizeRecord(
      corrected_, layout_, train_[t], inputs_[t], parameters, trajectories_[t]);
  const LinearizedRecord& linearized = eliminated->linearized;
  Vector start_sigmas = Vector::Zero(problem_.dynamics->num_states());
  if (record.start == IdentificationRecord::Start::kFree) {
    start_sigmas = kStartScales * StateScales(problem_, trajectories_[t]);
  }
  // Residuals that the fit leaves out are zero, with zero derivatives.
  Matrix noise(nc, samples);
  for (Eigen::Index i = 0; i < samples; ++i) {
    for (int c = 0; c < nc; ++c) {
      const bool missing =
          residuals(c, i) == 0.0 && jacobian.row(i * nc + c).isZero(0.0);
      noise(c, i) = missing ? kNaN : sigmas_[t][c];
      if (!missing) equations->num_residuals += 1.0;
    }
  }
  eliminated->filter = std::make_unique<InputNoiseFilter>(
      linearized, Vector(record.input_sigma(inputs_[t])), start_sigmas, noise);

  // y - yhat is the response to all of the errors. The weighted residuals have
  // the opposite sign, and no longer contain the corrected errors.
  const Vector flat = Eigen::Map<const Vector>(residuals.data(), nc * samples);
  Matrix columns(nc * samples, n + 1);
  columns.leftCols(n) = jacobian;
  columns.col(n) = Response(linearized, point_.errors[t], sigmas_[t]) - flat;
  equations->priors.noalias() -= jacobian.transpose() * jacobian;
  equations->prior_gradient.noalias() -= jacobian.transpose() * flat;
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    columns.row(row) *= sigmas_[t][row % nc];
  }
  const Matrix information = eliminated->filter->Information(columns);
  equations->data += information.topLeftCorner(n, n);
  equations->right += information.topRightCorner(n, 1);
  eliminated->pseudo_residuals = columns.col(n);
  eliminated->jacobian = columns.leftCols(n);
}

bool Fitter::StepWithinBounds(const Matrix& hessian, const Vector& right,
                              Vector* delta) const {
  const int n = layout_.num_free();
  // Parameters at a bound stay there if they would leave it.
  std::vector<int> moving;
  for (int j = 0; j < n; ++j) {
    const double value = point_.free[j];
    const size_t index = static_cast<size_t>(j);
    if ((value <= lower_[index] && right[j] < 0.0) ||
        (value >= upper_[index] && right[j] > 0.0)) {
      continue;
    }
    moving.push_back(j);
  }
  *delta = Vector::Zero(n);
  if (static_cast<int>(moving.size()) == n) {
    *delta = covariance_.covariance * right;
  } else if (!moving.empty()) {
    Matrix null_space, free_root;
    if (!InvertInformation(hessian(moving, moving), &free_root, &null_space)) {
      return false;
    }
    (*delta)(moving) = free_root * (free_root.transpose() * right(moving));
  }
  for (int j = 0; j < n; ++j) {
    const size_t index = static_cast<size_t>(j);
    (*delta)[j] =
        std::clamp(point_.free[j] + (*delta)[j], lower_[index], upper_[index]) -
        point_.free[j];
  }
  return true;
}

bool Fitter::Propose(Point* proposed, double* step) {
  Correct(point_);
  CondensedSystem system;
  std::vector<Matrix> residuals, jacobians;
  MultipleShooting& shooting = objective_->shooting();
  if (!objective_->Linearize(point_.free, &system) ||
      !WeightedResiduals(point_.free, true, &shooting, &residuals,
                         &jacobians) ||
      !RunTrajectories(shooting, point_.free, &trajectories_)) {
    return false;
  }
  Vector parameters = layout_.InitialValues();
  layout_.SetFree(point_.free, &parameters);
  const int n = layout_.num_free();
  Equations equations{Matrix::Zero(n, n), Vector::Zero(n), system.hessian,
                      system.gradient, 0.0};
  std::vector<Eliminated> eliminated(train_.size());
  for (size_t t = 0; t < train_.size(); ++t) {
    AddRecord(t, parameters, residuals[t], std::move(jacobians[t]), &equations,
              &eliminated[t]);
  }

  Matrix root;
  const Matrix hessian = equations.data + equations.priors;
  if (!InvertInformation(hessian, &root, &covariance_.null_space)) return false;
  covariance_.covariance = root * root.transpose();
  Vector delta;
  if (!StepWithinBounds(hessian, equations.right - equations.prior_gradient,
                        &delta)) {
    return false;
  }
  proposed->free = point_.free + delta;
  *step = std::sqrt(std::max(0.0, delta.dot(hessian * delta)));

  const double used = (root.transpose() * equations.data * root).trace();
  const double share =
      std::max(0.1, 1.0 - used / std::max(1.0, equations.num_residuals));
  proposed->errors.resize(train_.size());
  next_sigmas_ = sigmas_;
  for (size_t t = 0; t < train_.size(); ++t) {
    const IdentificationRecord& record =
        problem_.records[static_cast<size_t>(train_[t])];
    Vector mean_square;
    eliminated[t].filter->Smooth(
        eliminated[t].pseudo_residuals - eliminated[t].jacobian * delta,
        &proposed->errors[t], &mean_square);
    for (int c = 0; c < mean_square.size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      if (channel.sigma > 0.0 || !channel.fit) continue;
      next_sigmas_[t][c] =
          std::max(std::sqrt(mean_square[c] / share), floors_[t][c]);
    }
  }
  return proposed->free.allFinite();
}

bool Fitter::Covariance(CovarianceEstimate* covariance) {
  Point proposed;
  double step = 0.0;
  if (!Propose(&proposed, &step)) return false;
  *covariance = covariance_;
  covariance->method = "errors in variables";
  covariance->quantile = StudentQuantile(1e6);
  return true;
}

bool Fitter::Run(const InputNoiseCallback& go_on, InputNoiseFit* fit,
                 std::string* error) {
  constexpr int kMaxHalvings = 10;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Point proposed;
    double step = 0.0;
    double before = 0.0;
    if (!Cost(point_, &before) || !Propose(&proposed, &step)) {
      *error = "the trajectory is not finite";
      return false;
    }
    double after = 0.0;
    double share = 1.0;
    Point point = proposed;
    int halvings = 0;
    while (!Cost(point, &after) || after > before * (1.0 + 1e-9)) {
      if (++halvings > kMaxHalvings) {
        *error = "no step lowers the cost";
        return false;
      }
      share *= 0.5;
      point.free = point_.free + share * (proposed.free - point_.free);
      for (size_t t = 0; t < point.errors.size(); ++t) {
        point.errors[t] =
            point_.errors[t] + share * (proposed.errors[t] - point_.errors[t]);
      }
    }
    point_ = point;
    double change = 0.0;
    for (size_t t = 0; t < sigmas_.size(); ++t) {
      for (int c = 0; c < sigmas_[t].size(); ++c) {
        change = std::max(
            change, std::abs(std::log(next_sigmas_[t][c] / sigmas_[t][c])));
      }
    }
    VLOG(1) << "input noise: iteration " << iteration << ", cost " << after
            << ", step " << share * step << " standard deviations";
    if (share == 1.0 && step < kSmallestStep && change < kSmallestNoiseChange) {
      fit->free = point_.free;
      fit->sigmas = sigmas_;
      fit->cost = after;
      fit->starts = objective_->shooting().starts();
      return RunTrajectories(objective_->shooting(), point_.free,
                             &fit->trajectories) &&
             Covariance(&fit->covariance);
    }
    sigmas_ = next_sigmas_;
    if (go_on && !go_on(point_.free, after)) {
      *error = "interrupted";
      return false;
    }
  }
  *error = "no convergence";
  return false;
}

}  // namespace

bool CanFitWithInputNoise(const IdentificationProblem& problem,
                          RobustLoss loss) {
  if (loss != RobustLoss::kNone) return false;
  bool any = false;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    any = any || !record.NoisyInputs().empty();
    if (record.filter != nullptr ||
        record.excitation->interpolation() == Interpolation::kCubic ||
        record.excitation->interpolation() == Interpolation::kBandLimited) {
      return false;
    }
  }
  return any;
}

bool FitWithInputNoise(const IdentificationProblem& problem,
                       const ParameterLayout& layout,
                       const MultipleShooting::Options& options,
                       const Vector& decays, const InputNoiseCallback& go_on,
                       InputNoiseFit* fit, std::string* error) {
  Fitter fitter(problem, layout, options, decays, *fit);
  return fitter.Run(go_on, fit, error);
}

bool InputNoiseCovariance(const IdentificationProblem& problem,
                          const ParameterLayout& layout,
                          const MultipleShooting::Options& options,
                          const Vector& decays, InputNoiseFit* fit) {
  Fitter fitter(problem, layout, options, decays, *fit);
  return fitter.Covariance(&fit->covariance);
}

}  // namespace pinode
