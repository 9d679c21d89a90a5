#include "pinode/modal/frf/frf_fit.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Deviations from zero from which residuals of neighbouring lines are
// correlated, and a correlation from which they are errors of the model.
constexpr double kBeyondChance = 4.0;
constexpr double kSmoothResiduals = 0.5;
constexpr double kMostCorrelation = 0.99;
// Rounds of fitting and estimating the noise, and the largest change of a
// variance at which they end.
constexpr int kMostRounds = 12;
constexpr double kSmallestNoiseChange = 3e-3;
// Iterations of the likelihood of floor and share.
constexpr int kNoiseIterations = 50;
// Least variance, as a part of the mean square of the output: rounding.
constexpr double kRounding = 1e-24;
// Smallest diagonal of the scaled information that is not rounding, as a part
// of the largest.
constexpr double kSmallestSlope = 1e-20;
// A pole moves by this many of its decay rates at the most in one round.
constexpr double kMostDecays = 10.0;
// Decay rates change by a factor of 1000 at the most in one round.
constexpr double kSmallestDecay = 1e-3;

std::vector<FrfMode> Moved(const std::vector<FrfMode>& start,
                           const double* unknowns) {
  std::vector<FrfMode> modes = start;
  for (FrfMode& mode : modes) {
    const double unit = std::abs(mode.s.real());
    mode.s += unit * Complex(unknowns[0], unknowns[1]);
    unknowns += 2;
    for (Index j = 0; j < mode.participation.size(); ++j) {
      if (j == mode.reference) continue;
      mode.participation[j] += Complex(unknowns[0], unknowns[1]);
      unknowns += 2;
    }
  }
  return modes;
}

// Gives Ceres a problem with fewer residuals and the same cost, gradient and
// matrix of Gauss and Newton: with the normal matrix N = L L^T, gradient g and
// cost c, the Jacobian L^T, the residuals L^-1 g, and one more residual without
// slope.
class ReducedFrfCost : public ceres::CostFunction {
 public:
  ReducedFrfCost(const FrfModel& model, const std::vector<FrfMode>& start)
      : model_(model), start_(start) {
    for (const FrfMode& mode : start) {
      const double unit = std::abs(mode.s.real());
      for (Index i = 0; i < model.unknowns_of_mode(); ++i) {
        units_.push_back(i < 2 ? unit : 1.0);
      }
    }
    const int size = static_cast<int>(units_.size());
    mutable_parameter_block_sizes()->push_back(size);
    set_num_residuals(size + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Vector at = Eigen::Map<const Vector>(
        parameters[0], static_cast<Index>(units_.size()));
    // Ceres asks for the Jacobian where it has just asked for the cost.
    if (at_.size() != at.size() || at_ != at) {
      fit_ = model_.Solve(Moved(start_, parameters[0]));
      at_ = at;
    }
    const FrfFit& fit = fit_;
    if (!std::isfinite(fit.cost) || !fit.normal.allFinite()) return false;
    const Index size = static_cast<Index>(units_.size());
    const Vector units = Eigen::Map<const Vector>(units_.data(), size);
    const Matrix normal = units.asDiagonal() * fit.normal * units.asDiagonal();
    const Vector gradient = units.cwiseProduct(fit.gradient);
    if (!normal.allFinite() || !gradient.allFinite()) return false;
    const Vector scale =
        normal.diagonal()
            .cwiseMax(
                std::max(1e-300, kSmallestSlope * normal.diagonal().maxCoeff()))
            .cwiseSqrt();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        scale.cwiseInverse().asDiagonal() * normal *
        scale.cwiseInverse().asDiagonal());
    // Directions that rounding alone determines stay where they are.
    constexpr double kSmallestEigenvalue = 1e-14;
    const double largest = std::max(solver.eigenvalues().maxCoeff(), 1e-300);
    Vector root = Vector::Zero(size);
    Vector inverse = Vector::Zero(size);
    for (Index i = 0; i < size; ++i) {
      if (solver.eigenvalues()[i] < kSmallestEigenvalue * largest) continue;
      root[i] = std::sqrt(solver.eigenvalues()[i]);
      inverse[i] = 1.0 / root[i];
    }
    Eigen::Map<Vector> out(residuals, size + 1);
    out.head(size) = inverse.asDiagonal() * (solver.eigenvectors().transpose() *
                                             gradient.cwiseQuotient(scale));
    const double rest = fit.cost - out.head(size).squaredNorm();
    out[size] = std::sqrt(std::max(0.0, rest));
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic,
                                     Eigen::RowMajor>;
      Eigen::Map<RowMajor> jacobian(jacobians[0], size + 1, size);
      jacobian.setZero();
      jacobian.topRows(size) = root.asDiagonal() *
                               solver.eigenvectors().transpose() *
                               scale.asDiagonal();
    }
    return true;
  }

 private:
  const FrfModel& model_;
  const std::vector<FrfMode>& start_;
  std::vector<double> units_;
  mutable Vector at_;  // of fit_
  mutable FrfFit fit_;
};

std::vector<FrfMode> Minimise(const FrfModel& model,
                              const std::vector<FrfMode>& start) {
  Vector unknowns =
      Vector::Zero(model.unknowns_of_mode() * static_cast<Index>(start.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(new ReducedFrfCost(model, start), nullptr,
                           unknowns.data());
  for (size_t m = 0; m < start.size(); ++m) {
    const int at =
        static_cast<int>(model.unknowns_of_mode()) * static_cast<int>(m);
    problem.SetParameterLowerBound(unknowns.data(), at, -kMostDecays);
    problem.SetParameterUpperBound(unknowns.data(), at, 1.0 - kSmallestDecay);
    problem.SetParameterUpperBound(unknowns.data(), at + 1, kMostDecays);
    // Im s stays positive.
    problem.SetParameterLowerBound(
        unknowns.data(), at + 1,
        -std::min(kMostDecays,
                  0.9 * start[m].s.imag() / std::abs(start[m].s.real())));
  }
  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return Moved(start, unknowns.data());
}

// Log likelihood of complex normal numbers with these squares and variances,
// but for a constant.
double LogLikelihood(const Vector& squares, const Vector& variances) {
  return -(variances.array().log() + squares.array() / variances.array()).sum();
}

// Maximises the likelihood of floor and share by Fisher's scoring: a regression
// of the squares on 1 and |H|^2, weighted by the inverse square of the variance
// so far.
void FitFloorAndShare(const Vector& squares, const Vector& power,
                      double smallest, double* floor, double* share) {
  *floor = std::max(smallest, squares.mean());
  *share = 0.0;
  // From the relative side too, where a constant floor is no start.
  const double relative =
      (squares.array() / power.array().max(smallest)).mean();
  const Vector as_share = (relative * power.array()).max(smallest).matrix();
  const Vector as_floor = Vector::Constant(squares.size(), *floor);
  if (LogLikelihood(squares, as_share) > LogLikelihood(squares, as_floor)) {
    *floor = smallest;
    *share = relative;
  }
  for (int i = 0; i < kNoiseIterations; ++i) {
    const Vector variance =
        (*floor + *share * power.array()).max(smallest).matrix();
    const Vector weights = variance.cwiseAbs2().cwiseInverse();
    const double a = weights.sum();
    const double b = weights.dot(power);
    const double c = weights.dot(power.cwiseAbs2());
    const double f = weights.dot(squares);
    const double g = weights.dot(power.cwiseProduct(squares));
    const double determinant = a * c - b * b;
    double next_floor =
        determinant > 0.0 ? (c * f - b * g) / determinant : -1.0;
    double next_share =
        determinant > 0.0 ? (a * g - b * f) / determinant : -1.0;
    if (next_floor < smallest) {
      next_floor = smallest;
      next_share = c > 0.0 ? g / c : 0.0;
    } else if (next_share < 0.0) {
      next_floor = f / a;
      next_share = 0.0;
    }
    const double change =
        std::abs(next_floor / *floor - 1.0) +
        std::abs(next_share - *share) / std::max(next_share, 1e-300);
    *floor = std::max(next_floor, smallest);
    *share = next_share;
    if (change < 1e-6) break;
  }
}

// Sets the mean square that a start leaves as the variance of each output. The
// start leaves most at the resonances, which is no noise: it is the same at all
// lines.
void StartVariances(const std::vector<FrfMode>& start, FrfModel* model) {
  const FrfData& data = model->data();
  const Vector squares =
      model->Solve(start).residuals.cwiseAbs2().colwise().mean();
  Matrix variances(data.num_lines(), data.h.cols());
  for (Index o = 0; o < data.outputs; ++o) {
    double sum = 0.0;
    for (Index j = 0; j < data.references; ++j) {
      sum += squares[o + data.outputs * j];
    }
    const double mean =
        std::max(sum / static_cast<double>(data.references), 1e-300);
    for (Index j = 0; j < data.references; ++j) {
      variances.col(o + data.outputs * j).setConstant(mean);
    }
  }
  model->set_variances(std::move(variances), /*even=*/true);
}

// Correlation of the residuals of output o at neighbouring lines, each as a
// part of its deviation. 0 where chance explains it.
double CorrelationOfLines(const FrfData& data, const FrfFit& fit,
                          const Matrix& variances, Index o) {
  double product = 0.0;
  double square = 0.0;
  const Index lines = data.num_lines();
  for (Index j = 0; j < data.references; ++j) {
    const Index pair = o + data.outputs * j;
    const ComplexVector scaled = fit.residuals.col(pair).cwiseQuotient(
        variances.col(pair).cwiseSqrt().cast<Complex>());
    square += scaled.squaredNorm();
    product += scaled.head(lines - 1).dot(scaled.tail(lines - 1)).real();
  }
  const double correlation = square > 0.0 ? product / square : 0.0;
  const double chance =
      1.0 / std::sqrt(2.0 * static_cast<double>(lines * data.references));
  return correlation > kBeyondChance * chance ? correlation : 0.0;
}

}  // namespace

FrfNoise EstimateFrfNoise(const FrfModel& model, const FrfFit& fit,
                          Matrix* variances) {
  const FrfData& data = model.data();
  const Index lines = data.num_lines();
  const Index outputs = data.outputs;
  const Index references = data.references;
  // All outputs share the nonlinear unknowns.
  const double shared = static_cast<double>(model.unknowns_of_mode()) *
                        static_cast<double>(fit.modes.size()) /
                        (2.0 * static_cast<double>(lines * data.h.cols()));
  FrfNoise noise;
  noise.floors.resize(outputs);
  noise.shares = Vector::Zero(outputs);
  Vector floors(outputs);
  Vector shares(outputs);
  double even_likelihood = 0.0;
  double likelihood = 0.0;
  Matrix power(lines, data.h.cols());
  for (Index o = 0; o < outputs; ++o) {
    Vector squares(lines * references);
    Vector own(lines * references);
    for (Index j = 0; j < references; ++j) {
      const Index pair = o + outputs * j;
      power.col(pair) =
          (data.h.col(pair) - fit.residuals.col(pair)).cwiseAbs2();
      own.segment(lines * j, lines) = power.col(pair);
      squares.segment(lines * j, lines) =
          fit.residuals.col(pair).cwiseAbs2().array() /
          (1.0 - shared - fit.leverages.col(pair).array()).max(0.02);
    }
    const double smallest = std::max(kRounding * own.mean(), 1e-300);
    noise.floors[o] = std::max(smallest, squares.mean());
    even_likelihood += LogLikelihood(
        squares, Vector::Constant(squares.size(), noise.floors[o]));
    FitFloorAndShare(squares, own, smallest, &floors[o], &shares[o]);
    likelihood +=
        LogLikelihood(squares, (floors[o] + shares[o] * own.array()).matrix());
  }
  const double values = static_cast<double>(lines * data.h.cols());
  const auto fill = [&] {
    variances->resize(lines, data.h.cols());
    for (Index j = 0; j < references; ++j) {
      for (Index o = 0; o < outputs; ++o) {
        const Index pair = o + outputs * j;
        variances->col(pair) =
            (noise.floors[o] + noise.shares[o] * power.col(pair).array())
                .matrix();
      }
    }
  };
  fill();
  Vector correlations(outputs);
  for (Index o = 0; o < outputs; ++o) {
    correlations[o] = CorrelationOfLines(data, fit, *variances, o);
  }
  noise.even = 2.0 * (likelihood - even_likelihood) <=
                   static_cast<double>(outputs) * std::log(values) ||
               correlations.mean() > kSmoothResiduals;
  noise.log_likelihood = noise.even ? even_likelihood : likelihood;
  if (!noise.even) {
    noise.floors = floors;
    noise.shares = shares;
    fill();
    for (Index o = 0; o < outputs; ++o) {
      correlations[o] = CorrelationOfLines(data, fit, *variances, o);
    }
  }
  // Lines that follow each other count as fewer.
  for (Index o = 0; o < outputs; ++o) {
    const double correlation = std::min(correlations[o], kMostCorrelation);
    const double factor = (1.0 + correlation) / (1.0 - correlation);
    noise.floors[o] *= factor;
    noise.shares[o] *= factor;
  }
  fill();
  return noise;
}

FrfFit FitFrfModes(const std::vector<FrfMode>& start, bool fresh,
                   FrfModel* model, FrfNoise* noise) {
  FrfFit fit;
  Matrix variances;
  if (fresh) StartVariances(start, model);
  std::vector<FrfMode> modes = start;
  for (int round = 0; round < kMostRounds; ++round) {
    modes = Minimise(*model, modes);
    fit = model->Solve(modes);
    const Matrix before = model->variances();
    *noise = EstimateFrfNoise(*model, fit, &variances);
    model->set_variances(variances, noise->even);
    const double change =
        (variances.array() / before.array()).log().abs().mean();
    if (change < kSmallestNoiseChange) break;
  }
  // With the last variances, and their deviations.
  return model->Solve(modes);
}

}  // namespace pinode
