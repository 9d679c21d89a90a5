#include "pinode/estimate/shooting/multiple_shooting.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/problem/sensor.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using Start = IdentificationRecord::Start;
using testing::SmallFit;

MultipleShooting::Options WithLoss(RobustLoss loss) {
  MultipleShooting::Options options;
  options.loss = loss;
  options.loss_scale = 1.2;
  return options;
}

struct ShootingSetting {
  std::string name;
  Start start;
  int segment_samples;
  RobustLoss loss;
};

class ProjectedGradient : public ::testing::TestWithParam<ShootingSetting> {
 protected:
  // At its second linearisation, with multipliers that are not zero.
  static std::unique_ptr<Objective> LinearizeTwice(
      const SmallFit& fit, const MultipleShooting::Options& options,
      CondensedSystem* system) {
    const int samples = GetParam().segment_samples;
    auto objective = fit.Shoot(samples, options);
    EXPECT_TRUE(objective->Linearize(fit.free, system));
    if (samples > 0) {
      EXPECT_GT(objective->shooting().LargestGap(), 1e-3);
      objective->shooting().UpdateMultipliers();
      EXPECT_TRUE(objective->Linearize(fit.free, system));
    }
    return objective;
  }

  // Starts as good as rounding allows.
  static MultipleShooting::Options WithBestStarts() {
    MultipleShooting::Options options = WithLoss(GetParam().loss);
    options.starts.tolerance = 1e-14;
    options.starts.change_tolerance = 0.0;
    options.starts.max_iterations = 300;
    return options;
  }
};

// d f / d theta along random directions and along single parameters: the
// derivative of the projected cost is exact although the starts are not moved
// by it.
TEST_P(ProjectedGradient, EqualsDifferencesOfTheCost) {
  const SmallFit fit(GetParam().start);
  CondensedSystem system;
  auto objective = LinearizeTwice(fit, WithBestStarts(), &system);
  double cost = 0.0;
  ASSERT_TRUE(objective->Evaluate(fit.free, &cost));
  EXPECT_DOUBLE_EQ(cost, system.cost);

  // The rate of the hysteresis has a kink where the slip changes its
  // direction. Free starts can come to rest on it for a whole range of
  // parameters, in which the cost bends more and the gradient belongs to one
  // side of the kink. One such range begins where the offset of x1 is smaller
  // by 1e-4; the steps must not reach it.
  constexpr double kStep = 2e-5;
  const int n = static_cast<int>(fit.free.size());
  ASSERT_EQ(system.gradient.size(), n);
  testing::Gaussian random(8);
  for (int j = 0; j < n + 3; ++j) {
    const Vector direction =
        j < n ? Vector(Vector::Unit(n, j)) : random.Draw(n).normalized();
    const auto moved = [&](double h) {
      double value = 0.0;
      EXPECT_TRUE(objective->Evaluate(fit.free + h * direction, &value));
      return Vector::Constant(1, value);
    };
    const double expected = testing::Differentiate(moved, kStep)[0];
    EXPECT_NEAR(direction.dot(system.gradient), expected,
                1e-6 * system.gradient.norm() + 1e-6 * std::abs(expected))
        << (j < n ? fit.layout
                        ->parameter(fit.layout->free()[static_cast<size_t>(j)])
                        .name
                  : "a random direction");
  }
}

// The point at hand is not propagated again, and anything that changes the cost
// or goes elsewhere makes it another one.
TEST(MultipleShooting, LinearizesAPointOnce) {
  const SmallFit fit(Start::kRest);
  auto objective = fit.Shoot(0, MultipleShooting::Options());
  MultipleShooting& shooting = objective->shooting();
  CondensedSystem first, again;
  ASSERT_TRUE(objective->Linearize(fit.free, &first));
  const int64_t work = shooting.sweep().work();
  ASSERT_TRUE(objective->Linearize(fit.free, &again));
  EXPECT_EQ(shooting.sweep().work(), work);
  EXPECT_EQ(again.cost, first.cost);
  EXPECT_EQ(again.gradient, first.gradient);
  EXPECT_EQ(again.hessian, first.hessian);

  double cost = 0.0;
  ASSERT_TRUE(objective->Evaluate(1.01 * fit.free, &cost));
  ASSERT_TRUE(objective->Linearize(1.01 * fit.free, &again));
  EXPECT_EQ(again.cost, cost);
  EXPECT_NE(again.gradient, first.gradient);
  ASSERT_TRUE(objective->Linearize(fit.free, &again));
  EXPECT_EQ(again.gradient, first.gradient);

  std::vector<Vector> sigmas;
  for (const int r : shooting.train_records()) {
    sigmas.push_back(Vector::Constant(
        static_cast<Eigen::Index>(
            fit.problem.records[static_cast<size_t>(r)].channels.size()),
        123.0));
  }
  shooting.SetSigmas(sigmas);
  ASSERT_TRUE(objective->Linearize(fit.free, &again));
  EXPECT_NE(again.cost, first.cost);
  EXPECT_GT(shooting.sweep().work(), work);
}

// Starts are solved for no better than the outer iteration needs. The
// reweighted least squares of a loss as strong as this one use up their steps.
TEST_P(ProjectedGradient, IsCloseWithStartsSolvedAsUsual) {
  const SmallFit fit(GetParam().start);
  CondensedSystem best, usual;
  LinearizeTwice(fit, WithBestStarts(), &best);
  LinearizeTwice(fit, WithLoss(GetParam().loss), &usual);
  const double limit = GetParam().loss == RobustLoss::kCauchy ? 1e-3 : 1e-5;
  EXPECT_LT((usual.gradient - best.gradient).norm(),
            limit * best.gradient.norm());
}

INSTANTIATE_TEST_SUITE_P(
    All, ProjectedGradient,
    ::testing::ValuesIn(std::vector<ShootingSetting>{
        ShootingSetting{"RestSingle", Start::kRest, 0, RobustLoss::kNone},
        ShootingSetting{"KnownSingle", Start::kKnown, 0, RobustLoss::kNone},
        ShootingSetting{"FreeSingle", Start::kFree, 0, RobustLoss::kNone},
        ShootingSetting{"RestSegments", Start::kRest, 7, RobustLoss::kNone},
        ShootingSetting{"KnownSegments", Start::kKnown, 10, RobustLoss::kNone},
        ShootingSetting{"FreeSegments", Start::kFree, 7, RobustLoss::kNone},
        ShootingSetting{"FreeSegmentsHuber", Start::kFree, 7,
                        RobustLoss::kHuber},
        ShootingSetting{"FreeSegmentsCauchy", Start::kFree, 7,
                        RobustLoss::kCauchy},
        ShootingSetting{"RestSingleCauchy", Start::kRest, 0,
                        RobustLoss::kCauchy}}),
    [](const auto& setting) { return setting.param.name; });

// F and its Gauss-Newton normal equations over all starts and parameters, put
// together row by row at the starts given.
struct DenseSystem {
  double cost = 0.0;
  Vector start_gradient;
  Vector gradient;  // condensed
  Matrix hessian;   // condensed
};

DenseSystem AssembleDense(const SmallFit& fit,
                          const std::vector<Matrix>& starts,
                          const std::vector<Matrix>& multipliers, double mu) {
  const ParameterLayout& layout = *fit.layout;
  const StructuralDynamics& dynamics = *fit.problem.dynamics;
  const int ns = dynamics.num_states();
  const int nf = layout.num_free();
  int num_starts = 0;
  for (const Matrix& record : starts)
    num_starts += static_cast<int>(record.cols());
  const int unknowns = ns * num_starts + nf;

  std::vector<Vector> rows;
  std::vector<double> residuals;
  Vector all = layout.InitialValues();
  layout.SetFree(fit.free, &all);
  StructuralDynamics::Prepared prepared;
  std::string error;
  EXPECT_TRUE(
      dynamics.Prepare(all.head(layout.num_dynamics()), &prepared, &error));
  std::vector<int> known;  // columns that are not unknown
  int offset = 0;
  for (size_t r = 0; r < starts.size(); ++r) {
    const IdentificationRecord& record = fit.problem.records[r];
    const int nc = static_cast<int>(record.channels.size());
    const int count = static_cast<int>(starts[r].cols());
    std::vector<Observation> observations;
    for (const auto& channel : record.channels) {
      observations.push_back(channel.observation);
    }
    const ObservationMap observation(dynamics, observations);
    const IntegrationGrid grid(*record.excitation, record.substeps);
    SegmentPropagator propagator(dynamics, DerivativeMethod::kJets);
    const Eigen::Index last_sample = record.num_samples() - 1;
    for (int k = 0; k < count; ++k) {
      const Eigen::Index first = last_sample * k / count;
      const Eigen::Index last = last_sample * (k + 1) / count;
      SegmentTangents tangents;
      EXPECT_TRUE(propagator.Propagate(
          prepared, observation, grid, starts[r].col(k), first, last,
          k + 1 == count, SegmentColumns::kAll, &tangents));
      const auto widen = [&](const Matrix& narrow) {
        Matrix wide = Matrix::Zero(narrow.rows(), ns + nf);
        wide.leftCols(narrow.cols()) = narrow;
        return wide;
      };
      Matrix jacobian = widen(tangents.jacobian());
      Vector prediction = Eigen::Map<const Vector>(tangents.channels.data(),
                                                   tangents.channels.size());
      std::vector<bool> valid(static_cast<size_t>(prediction.size()), true);
      ApplySensors(layout, all, record, true, prediction, jacobian, &valid);
      const auto add = [&](double residual, const RowVector& by_start,
                           const RowVector& by_next, const RowVector& by_free) {
        Vector row = Vector::Zero(unknowns);
        row.segment((offset + k) * ns, ns) = by_start;
        if (by_next.size() > 0)
          row.segment((offset + k + 1) * ns, ns) = by_next;
        row.tail(nf) = by_free;
        rows.push_back(row);
        residuals.push_back(residual);
      };
      for (int i = 0; i < prediction.size(); ++i) {
        const MeasuredChannel& channel =
            record.channels[static_cast<size_t>(i % nc)];
        const double value = channel.values[first + i / nc];
        if (!channel.fit || std::isnan(value) ||
            !valid[static_cast<size_t>(i)]) {
          continue;
        }
        const double sigma = fit.sigmas[r][i % nc];
        add((prediction[i] - value) / sigma, jacobian.row(i).head(ns) / sigma,
            RowVector(), jacobian.row(i).tail(nf) / sigma);
      }
      if (k + 1 < count) {
        const Matrix end = widen(tangents.end_sensitivity);
        for (int i = 0; i < ns; ++i) {
          const double weight = std::sqrt(mu) / fit.scales[r][i];
          const double gap = tangents.end_state[i] - starts[r](i, k + 1);
          add(weight * gap + std::sqrt(mu) * multipliers[r](i, k),
              weight * end.row(i).head(ns),
              RowVector(-weight * RowVector::Unit(ns, i)),
              weight * end.row(i).tail(nf));
        }
      }
      if (k == 0 && record.start == Start::kFree) {
        for (int i = 0; i < ns; ++i) {
          const double weight = 1e-2 / fit.scales[r][i];
          add(weight * starts[r](i, 0), weight * RowVector::Unit(ns, i),
              RowVector(), RowVector::Zero(nf));
        }
      } else if (k == 0) {
        for (int i = 0; i < ns; ++i) known.push_back(offset * ns + i);
      }
    }
    offset += count;
  }
  for (int j = 0; j < nf; ++j) {
    const int index = layout.free()[static_cast<size_t>(j)];
    const Parameter& parameter = layout.parameter(index);
    Vector row = Vector::Zero(unknowns);
    if (parameter.HasPrior()) {
      row[ns * num_starts + j] = 1.0 / parameter.prior_sigma;
      rows.push_back(row);
      residuals.push_back((fit.free[j] - parameter.prior_mean) /
                          parameter.prior_sigma);
    }
    if (layout.DecayGroupOf(index) >= 0) {
      const double root = std::sqrt(fit.decays[layout.DecayGroupOf(index)]);
      row[ns * num_starts + j] = root;
      rows.push_back(row);
      residuals.push_back(root * fit.free[j]);
    }
  }
  Matrix jacobian(static_cast<int>(rows.size()), unknowns);
  Vector residual(static_cast<int>(rows.size()));
  for (size_t i = 0; i < rows.size(); ++i) {
    jacobian.row(static_cast<int>(i)) = rows[i];
    residual[static_cast<int>(i)] = residuals[i];
  }
  for (int column : known) jacobian.col(column).setZero();

  const int m = ns * num_starts;
  Matrix H = jacobian.transpose() * jacobian;
  const Vector g = jacobian.transpose() * residual;
  for (int column : known) H(column, column) = 1.0;
  DenseSystem dense;
  dense.cost = 0.5 * residual.squaredNorm();
  dense.start_gradient = g.head(m);
  const Eigen::LDLT<Matrix> factor(H.topLeftCorner(m, m));
  dense.hessian =
      H.bottomRightCorner(nf, nf) -
      H.bottomLeftCorner(nf, m) * factor.solve(H.topRightCorner(m, nf));
  dense.gradient =
      g.tail(nf) - H.bottomLeftCorner(nf, m) * factor.solve(g.head(m));
  return dense;
}

class DenseOracle : public ::testing::TestWithParam<ShootingSetting> {};

TEST_P(DenseOracle, CondensedSystemIsTheSchurComplement) {
  const ShootingSetting& setting = GetParam();
  const SmallFit fit(setting.start);
  auto objective =
      fit.Shoot(setting.segment_samples, MultipleShooting::Options());
  CondensedSystem system;
  std::vector<Matrix> multipliers;
  for (size_t r = 0; r < fit.states.size(); ++r) {
    multipliers.push_back(
        Matrix::Zero(fit.problem.dynamics->num_states(),
                     objective->shooting().record(r).num_segments() - 1));
  }
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(objective->Linearize(fit.free, &system));
    const DenseSystem dense =
        AssembleDense(fit, objective->shooting().starts(), multipliers,
                      objective->shooting().gap_penalty());
    EXPECT_NEAR(system.cost, dense.cost, 1e-11 * dense.cost);
    const double size = dense.gradient.norm();
    EXPECT_LT((system.gradient - dense.gradient).norm(), 1e-9 * size);
    EXPECT_LT((system.hessian - dense.hessian).norm(),
              1e-9 * dense.hessian.norm());
    EXPECT_EQ(system.hessian, system.hessian.transpose());
    if (IsSingleShooting(objective->shooting())) break;
    // lambda += D^-1 gap, from the states as they are at the ends.
    std::vector<Matrix> trajectories;
    ASSERT_TRUE(
        RunTrajectories(objective->shooting(), fit.free, &trajectories));
    StructuralDynamics::Prepared prepared;
    std::string error;
    Vector all = fit.layout->InitialValues();
    fit.layout->SetFree(fit.free, &all);
    ASSERT_TRUE(fit.problem.dynamics->Prepare(
        all.head(fit.layout->num_dynamics()), &prepared, &error));
    for (size_t r = 0; r < fit.states.size(); ++r) {
      const IdentificationRecord& record = fit.problem.records[r];
      const IntegrationGrid grid(*record.excitation, record.substeps);
      const int count = objective->shooting().record(r).num_segments();
      SegmentPropagator propagator(*fit.problem.dynamics,
                                   DerivativeMethod::kTangents);
      const ObservationMap observation(*fit.problem.dynamics,
                                       {record.channels[0].observation});
      for (int k = 0; k + 1 < count; ++k) {
        const Eigen::Index last_sample = record.num_samples() - 1;
        SegmentTangents tangents;
        ASSERT_TRUE(propagator.Propagate(
            prepared, observation, grid,
            objective->shooting().starts()[r].col(k), last_sample * k / count,
            last_sample * (k + 1) / count, false, SegmentColumns::kStart,
            &tangents));
        multipliers[r].col(k) +=
            (tangents.end_state - objective->shooting().starts()[r].col(k + 1))
                .cwiseQuotient(fit.scales[r]);
      }
    }
    objective->shooting().UpdateMultipliers();
    // A firmer penalty with the same force.
    objective->shooting().SetGapPenalty(21.0);
    for (Matrix& lambda : multipliers) lambda *= 7.0 / 21.0;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, DenseOracle,
    ::testing::Values(
        ShootingSetting{"Rest", Start::kRest, 7, RobustLoss::kNone},
        ShootingSetting{"Known", Start::kKnown, 9, RobustLoss::kNone},
        ShootingSetting{"Free", Start::kFree, 7, RobustLoss::kNone},
        // So many gaps that they are added in several parts.
        ShootingSetting{"FreeShort", Start::kFree, 1, RobustLoss::kNone},
        ShootingSetting{"FreeSingle", Start::kFree, 0, RobustLoss::kNone},
        ShootingSetting{"RestSingle", Start::kRest, 0, RobustLoss::kNone}),
    [](const auto& setting) { return setting.param.name; });

TEST(MultipleShooting, StartsAreTheBestOnes) {
  const SmallFit fit(Start::kFree);
  auto objective = fit.Shoot(7, MultipleShooting::Options());
  double cost = 0.0;
  ASSERT_TRUE(objective->Evaluate(fit.free, &cost));
  std::vector<Matrix> zero;
  for (size_t r = 0; r < fit.states.size(); ++r) {
    zero.push_back(Matrix::Zero(fit.states[r].rows(),
                                objective->shooting().starts()[r].cols() - 1));
  }
  // Any other starts cost more.
  testing::Gaussian random(2);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<Matrix> moved = objective->shooting().starts();
    for (Matrix& starts : moved) {
      for (int k = 0; k < starts.cols(); ++k) {
        starts.col(k) += 1e-3 * random.Draw(static_cast<int>(starts.rows()));
      }
    }
    EXPECT_GT(AssembleDense(fit, moved, zero, 7.0).cost, cost);
  }
}

TEST(MultipleShooting, CutsRecordsEvenly) {
  const SmallFit fit(Start::kFree);
  auto objective = fit.Shoot(7, MultipleShooting::Options());
  EXPECT_EQ(objective->shooting().record(0).num_segments(), 4);
  EXPECT_EQ(objective->shooting().record(1).num_segments(), 3);
  EXPECT_FALSE(IsSingleShooting(objective->shooting()));
  SetSegments(0, fit.states, &objective->shooting());
  EXPECT_EQ(objective->shooting().record(0).num_segments(), 1);
  EXPECT_TRUE(IsSingleShooting(objective->shooting()));
  EXPECT_EQ(objective->shooting().starts()[0].cols(), 1);
  EXPECT_EQ(objective->shooting().starts()[0].col(0), fit.states[0].col(0));
}

// What is kept of trajectories gives all of them again.
TEST(MultipleShooting, OutlinesAreTrajectories) {
  const SmallFit fit(Start::kFree);
  auto objective = fit.Shoot(7, MultipleShooting::Options());
  MultipleShooting& shooting = objective->shooting();
  double cost = 0.0;
  ASSERT_TRUE(objective->Evaluate(fit.free, &cost));
  TrajectoryOutlines outlines;
  ASSERT_TRUE(OutlineTrajectories(shooting, fit.free, &outlines));
  std::vector<Matrix> trajectories, again;
  ASSERT_TRUE(RunTrajectories(shooting, fit.free, &trajectories));
  for (size_t r = 0; r < trajectories.size(); ++r) {
    const Vector expected = trajectories[r].rowwise().squaredNorm() /
                            static_cast<double>(trajectories[r].cols());
    EXPECT_LT((outlines.records[r].mean_squares - expected).norm(),
              1e-13 * expected.norm());
  }
  for (const int samples : {0, 7, 3, 11}) {
    SetSegments(samples, trajectories, &shooting);
    const std::vector<Matrix> starts = shooting.starts();
    SetSegmentsAtRest(samples, &shooting);
    EXPECT_TRUE(shooting.starts()[0].isZero(0.0));
    ASSERT_TRUE(SetSegmentsAlong(samples, outlines, &shooting));
    EXPECT_EQ(shooting.starts(), starts);
    ASSERT_TRUE(RunTrajectories(shooting, outlines, &again));
    EXPECT_EQ(again, trajectories);
  }
}

// What an evaluation depends on must not be remembered past a change of it.
TEST(MultipleShooting, SettingsTakeEffectAtTheSamePoint) {
  const SmallFit fit(Start::kFree);
  const auto fresh = [&fit](double mu, const Vector& decays) {
    auto objective = fit.Shoot(7, MultipleShooting::Options());
    objective->shooting().SetGapPenalty(mu);
    objective->priors().SetDecays(decays);
    double cost = 0.0;
    EXPECT_TRUE(objective->Evaluate(fit.free, &cost));
    return cost;
  };
  auto objective = fit.Shoot(7, MultipleShooting::Options());
  double cost = 0.0;
  ASSERT_TRUE(objective->Evaluate(fit.free, &cost));
  EXPECT_NEAR(cost, fresh(7.0, fit.decays), 1e-8 * cost);
  objective->shooting().SetGapPenalty(70.0);
  ASSERT_TRUE(objective->Evaluate(fit.free, &cost));
  EXPECT_NEAR(cost, fresh(70.0, fit.decays), 1e-8 * cost);
  objective->priors().SetDecays(3.0 * fit.decays);
  ASSERT_TRUE(objective->Evaluate(fit.free, &cost));
  EXPECT_NEAR(cost, fresh(70.0, 3.0 * fit.decays), 1e-8 * cost);
  EXPECT_GT(std::abs(fresh(7.0, fit.decays) - fresh(70.0, fit.decays)), 1e-3);
}

TEST(MultipleShooting, ThreadsDoNotMatter) {
  const SmallFit fit(Start::kFree);
  const auto solve = [&fit](int threads) {
    MultipleShooting::Options options;
    options.num_threads = threads;
    auto objective = fit.Shoot(4, options);
    CondensedSystem system;
    EXPECT_TRUE(objective->Linearize(fit.free, &system));
    return system;
  };
  const CondensedSystem one = solve(1);
  for (int threads : {2, 3, 5}) {
    const CondensedSystem first = solve(threads);
    const CondensedSystem second = solve(threads);
    EXPECT_EQ(first.cost, second.cost);
    EXPECT_EQ(first.gradient, second.gradient);
    EXPECT_EQ(first.hessian, second.hessian);
    EXPECT_NEAR(first.cost, one.cost, 1e-12 * one.cost);
    EXPECT_LT((first.gradient - one.gradient).norm(),
              1e-12 * one.gradient.norm());
    EXPECT_LT((first.hessian - one.hessian).norm(), 1e-12 * one.hessian.norm());
  }
}

TEST(MultipleShooting, JetsGiveTheSame) {
  const SmallFit fit(Start::kFree);
  CondensedSystem systems[2];
  for (int m = 0; m < 2; ++m) {
    MultipleShooting::Options options;
    options.derivatives =
        m == 0 ? DerivativeMethod::kTangents : DerivativeMethod::kJets;
    ASSERT_TRUE(fit.Shoot(7, options)->Linearize(fit.free, &systems[m]));
  }
  EXPECT_NEAR(systems[0].cost, systems[1].cost, 1e-11 * systems[0].cost);
  EXPECT_LT((systems[0].gradient - systems[1].gradient).norm(),
            1e-11 * systems[0].gradient.norm());
  EXPECT_LT((systems[0].hessian - systems[1].hessian).norm(),
            1e-11 * systems[0].hessian.norm());
}

// Residuals and their condensed Jacobian reproduce cost and gradient.
TEST(MultipleShooting, WeightedResidualsAreThoseOfTheCost) {
  for (RobustLoss loss : {RobustLoss::kNone, RobustLoss::kHuber}) {
    const SmallFit fit(Start::kRest);
    auto objective = fit.Shoot(0, WithLoss(loss));
    CondensedSystem system;
    std::vector<Matrix> residuals, jacobians;
    ASSERT_TRUE(objective->Linearize(fit.free, &system));
    ASSERT_TRUE(WeightedResiduals(fit.free, true, &objective->shooting(),
                                  &residuals, &jacobians));
    Vector gradient = Vector::Zero(fit.free.size());
    double cost = 0.0;
    for (size_t r = 0; r < residuals.size(); ++r) {
      const Vector flat =
          Eigen::Map<const Vector>(residuals[r].data(), residuals[r].size());
      gradient += jacobians[r].transpose() * flat;
      cost += 0.5 * flat.squaredNorm();
      EXPECT_EQ(residuals[r].row(3).norm(), 0.0);  // not fitted
    }
    EXPECT_EQ(residuals[0](0, 4), 0.0);  // missing
    EXPECT_NE(residuals[0](0, 5), 0.0);
    for (int j = 0; j < fit.free.size(); ++j) {
      const int index = fit.layout->free()[static_cast<size_t>(j)];
      const Parameter& parameter = fit.layout->parameter(index);
      if (parameter.HasPrior()) {
        const double r =
            (fit.free[j] - parameter.prior_mean) / parameter.prior_sigma;
        gradient[j] += r / parameter.prior_sigma;
        cost += 0.5 * r * r;
      }
      const int group = fit.layout->DecayGroupOf(index);
      if (group < 0) continue;
      gradient[j] += fit.decays[group] * fit.free[j];
      cost += 0.5 * fit.decays[group] * fit.free[j] * fit.free[j];
    }
    EXPECT_LT((gradient - system.gradient).norm(),
              1e-10 * system.gradient.norm());
    if (loss == RobustLoss::kNone) {
      EXPECT_NEAR(cost, system.cost, 1e-10 * cost);
    }
  }
}

class BendAlong : public ::testing::TestWithParam<Start> {};

// J'r'' against second differences of the residuals. A search that ends with
// its first trial leaves starts where the last linearisation predicts them, on
// a straight line.
TEST_P(BendAlong, EqualsSecondDifferences) {
  const SmallFit fit(GetParam());
  MultipleShooting::Options options;
  options.starts.max_iterations = 1;
  auto objective = fit.Shoot(0, options);
  MultipleShooting& shooting = objective->shooting();
  const Vector step = 1e-3 * fit.free;
  CondensedSystem system;
  Vector bend;
  ASSERT_TRUE(objective->Linearize(fit.free, &system));
  EXPECT_FALSE(shooting.BendAlong(step, &bend)) << "nothing was kept";
  shooting.KeepRows(true);
  ASSERT_TRUE(objective->Linearize(fit.free, &system));
  ASSERT_TRUE(shooting.BendAlong(step, &bend));
  // A trial leaves what was kept as it is.
  double cost = 0.0;
  ASSERT_TRUE(objective->Evaluate(fit.free + step, &cost));
  Vector again;
  ASSERT_TRUE(shooting.BendAlong(step, &again));
  EXPECT_EQ(again, bend);

  const auto residuals = [&](double share) {
    double there = 0.0;
    std::vector<Matrix> result;
    EXPECT_TRUE(objective->Evaluate(fit.free + share * step, &there));
    EXPECT_TRUE(WeightedResiduals(fit.free + share * step, false, &shooting,
                                  &result, nullptr));
    return result;
  };
  constexpr double kShare = 0.5;
  std::vector<Matrix> ahead = residuals(kShare);
  const std::vector<Matrix> behind = residuals(-kShare);
  ASSERT_TRUE(objective->Linearize(fit.free, &system));
  std::vector<Matrix> here, jacobians;
  ASSERT_TRUE(WeightedResiduals(fit.free, true, &shooting, &here, &jacobians));
  Vector expected = Vector::Zero(step.size());
  for (size_t r = 0; r < here.size(); ++r) {
    ahead[r] += behind[r] - 2.0 * here[r];
    expected += jacobians[r].transpose() *
                Eigen::Map<const Vector>(ahead[r].data(), ahead[r].size()) /
                (kShare * kShare);
  }
  EXPECT_GT(expected.norm(), 0.0);
  EXPECT_LT((bend - expected).norm(), 0.02 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Starts, BendAlong,
                         ::testing::Values(Start::kRest, Start::kFree));

TEST(MultipleShooting, SaysWhereItDiverges) {
  IdentificationProblem problem;
  auto dynamics = testing::MakeGroupedChain(1, 4000.0, 0.0);
  Vector theta = dynamics->Parameters();
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.02);
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  const Matrix states =
      testing::Simulate(*dynamics, theta, Vector::Zero(2), 0.0, 1, &record);
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  const ParameterLayout layout(problem);
  MultipleShooting shooting(problem, layout, MultipleShooting::Options());
  SetSegments(0, {states}, &shooting);
  double cost = 0.0;
  ASSERT_TRUE(shooting.Evaluate(Vector::Zero(1), &cost));
  EXPECT_FALSE(shooting.state().divergence().Happened());
  // Negative stiffness: e^(sqrt(8000) t).
  ASSERT_FALSE(shooting.Evaluate(Vector::Constant(1, -3.0), &cost));
  const Divergence& divergence = shooting.state().divergence();
  ASSERT_TRUE(divergence.Happened());
  EXPECT_EQ(divergence.record, 0);
  EXPECT_EQ(divergence.segment, 0);
  EXPECT_GT(divergence.sample, 100);
  EXPECT_LT(divergence.sample, 160);
  EXPECT_GE(divergence.state, 0);
  EXPECT_TRUE(shooting.Evaluate(Vector::Zero(1), &cost));
}

}  // namespace
}  // namespace pinode
