#include "pinode/integrate/segment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/integrate/free_run.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace {

Excitation SomeExcitation(Interpolation interpolation, int samples) {
  Matrix values(3, samples);
  for (int i = 0; i < samples; ++i) {
    values.col(i) << std::sin(1.3 * i), 0.5 * std::cos(0.7 * i), 1.0 + 0.1 * i;
  }
  return Excitation(0.2, 0.05, values, interpolation);
}

std::vector<Observation> SomeObservations() {
  return {{"x1", Quantity::kDisplacement, Vector::Unit(3, 0)},
          {"v2", Quantity::kVelocity, Vector::Unit(3, 1)},
          {"a2", Quantity::kAbsoluteAcceleration, Vector::Unit(3, 1)},
          {"a3", Quantity::kRelativeAcceleration, Vector::Unit(3, 2)}};
}

class SegmentDerivatives : public ::testing::TestWithParam<Interpolation> {
 protected:
  void SetUp() override {
    dynamics_ = testing::MakeEverything();
    std::string error;
    ASSERT_TRUE(
        dynamics_->Prepare(dynamics_->Parameters(), &prepared_, &error));
    observation_ = ObservationMap(*dynamics_, SomeObservations());
    grid_ = IntegrationGrid(SomeExcitation(GetParam(), 12), 2);
    start_ = Vector::LinSpaced(dynamics_->num_states(), -0.5, 0.6);
  }

  SegmentTangents Propagate(DerivativeMethod method) {
    SegmentPropagator propagator(*dynamics_, method);
    SegmentTangents result;
    EXPECT_TRUE(propagator.Propagate(prepared_, observation_, grid_, start_, 2,
                                     11, true, SegmentColumns::kAll, &result));
    return result;
  }

  // `way`: the method with which the tangents are compared.
  static void ReportWorst(const std::string& way, double limit, double worst) {
    const char* names[] = {"held", "linear", "cubic"};
    testing::ReportFigure("tangents against " + way + ", every term, " +
                              names[static_cast<int>(GetParam())] +
                              " input: worst column, relative",
                          testing::AtMost(limit), worst);
  }

  std::unique_ptr<StructuralDynamics> dynamics_;
  StructuralDynamics::Prepared prepared_;
  ObservationMap observation_;
  IntegrationGrid grid_;
  Vector start_;
};

TEST_P(SegmentDerivatives, TangentsEqualWideJets) {
  const SegmentTangents tangents = Propagate(DerivativeMethod::kTangents);
  const SegmentTangents jets = Propagate(DerivativeMethod::kJets);
  EXPECT_LT((tangents.channels - jets.channels).norm(),
            1e-13 * jets.channels.norm());
  EXPECT_LT((tangents.end_state - jets.end_state).norm(),
            1e-13 * jets.end_state.norm());
  constexpr double kLimit = 1e-11;
  double worst = 0.0;
  const auto compare = [&](const Matrix& tangent, const Matrix& jet) {
    for (Eigen::Index j = 0; j < jet.cols(); ++j) {
      const double error =
          (tangent.col(j) - jet.col(j)).norm() / jet.col(j).norm();
      EXPECT_LT(error, kLimit) << "column " << j;
      worst = testing::Worse(worst, error);
    }
  };
  compare(tangents.jacobian(), jets.jacobian());
  compare(tangents.end_sensitivity, jets.end_sensitivity);
  ReportWorst("wide Jets", kLimit, worst);
}

// Ridders' extrapolation of central differences (C. J. F. Ridders, Advances in
// Engineering Software 4 (1982) 75-76) of a vector function.
template <typename Function>
Vector RiddersDerivative(const Function& function, double step) {
  constexpr int kLevels = 8;
  constexpr double kShrink = 1.4;
  std::vector<std::vector<Vector>> table(kLevels);
  Vector best;
  double best_error = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kLevels; ++i) {
    table[i].push_back((function(step) - function(-step)) / (2.0 * step));
    double factor = kShrink * kShrink;
    for (int j = 1; j <= i; ++j) {
      table[i].push_back((table[i][j - 1] * factor - table[i - 1][j - 1]) /
                         (factor - 1.0));
      factor *= kShrink * kShrink;
      const double error = std::max((table[i][j] - table[i][j - 1]).norm(),
                                    (table[i][j] - table[i - 1][j - 1]).norm());
      if (error < best_error) {
        best_error = error;
        best = table[i][j];
      }
    }
    step /= kShrink;
  }
  return best;
}

TEST_P(SegmentDerivatives, TangentsMatchRiddersDifferences) {
  const SegmentTangents tangents = Propagate(DerivativeMethod::kTangents);
  const int ns = dynamics_->num_states();
  const Vector theta = dynamics_->Parameters();
  constexpr double kLimit = 1e-6;
  double worst = 0.0;
  for (int j = 0; j < ns + theta.size(); ++j) {
    const auto run = [&](double step) {
      Vector start = start_;
      Vector moved = theta;
      (j < ns ? start[j] : moved[j - ns]) += step;
      StructuralDynamics::Prepared prepared;
      std::string error;
      CHECK(dynamics_->Prepare(moved, &prepared, &error));
      Trajectory trajectory;
      CHECK(FreeRun(*dynamics_, prepared, observation_, grid_, start, 2, 11,
                    &trajectory));
      return Vector(Eigen::Map<const Vector>(trajectory.channels.data(),
                                             trajectory.channels.size()));
    };
    // Step of the differences. It is so small that no stage crosses the corner
    // of the bilinear spring, and larger for a parameter whose effect would
    // vanish in rounding.
    const double step =
        std::clamp(3e-4 / tangents.jacobian().col(j).norm(), 3e-4, 3e-2);
    const Vector difference = RiddersDerivative(run, step);
    const double error =
        (tangents.jacobian().col(j) - difference).norm() / difference.norm();
    EXPECT_LT(error, kLimit) << "column " << j;
    worst = testing::Worse(worst, error);
  }
  ReportWorst("Ridders differences", kLimit, worst);
}

INSTANTIATE_TEST_SUITE_P(Interpolations, SegmentDerivatives,
                         ::testing::Values(Interpolation::kHeld,
                                           Interpolation::kLinear,
                                           Interpolation::kCubic));

TEST(Segment, StartColumnsAloneEqualThoseOfTheFullRun) {
  const auto dynamics = testing::MakeEverything();
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  const ObservationMap observation(*dynamics, SomeObservations());
  const IntegrationGrid grid(SomeExcitation(Interpolation::kLinear, 8), 1);
  const int ns = dynamics->num_states();
  const Vector start = Vector::LinSpaced(ns, -0.5, 0.6);
  for (auto method : {DerivativeMethod::kTangents, DerivativeMethod::kJets}) {
    SegmentPropagator propagator(*dynamics, method);
    SegmentTangents full, alone;
    ASSERT_TRUE(propagator.Propagate(prepared, observation, grid, start, 0, 7,
                                     false, SegmentColumns::kAll, &full));
    ASSERT_TRUE(propagator.Propagate(prepared, observation, grid, start, 0, 7,
                                     false, SegmentColumns::kStart, &alone));
    EXPECT_EQ(alone.jacobian().cols(), ns);
    EXPECT_LT((alone.jacobian() - full.jacobian().leftCols(ns)).norm(),
              1e-13 * alone.jacobian().norm());
    EXPECT_LT(
        (alone.end_sensitivity - full.end_sensitivity.leftCols(ns)).norm(),
        1e-13 * alone.end_sensitivity.norm());
  }
}

// Factors of the channels and columns around the derivatives, if the whole
// state is measured in its order, and with one more channel.
TEST(Segment, RowsAreWeightedWhereTheyLie) {
  for (const int n : {1, 3, 4, 5}) {
    StructuralDynamics dynamics(testing::MakeChain(n, 10.0, 0.5),
                                {{InputSpec::Kind::kForce, 0, "force"}});
    std::string error;
    ASSERT_TRUE(dynamics.AddElement("spring", "cubic", -1, 0, {30.0}, &error))
        << error;
    StructuralDynamics::Prepared prepared;
    ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
    Matrix force(1, 9);
    for (int i = 0; i < 9; ++i) force(0, i) = std::sin(1.3 * i);
    const IntegrationGrid grid(
        Excitation(0.0, 0.05, force, Interpolation::kLinear), 2);
    const Vector start = Vector::LinSpaced(2 * n, -0.5, 0.6);
    std::vector<Observation> state;
    for (int k = 0; k < 2 * n; ++k) {
      state.push_back({"h" + std::to_string(k),
                       k < n ? Quantity::kDisplacement : Quantity::kVelocity,
                       Vector::Unit(n, k % n)});
    }
    const ObservationMap whole(dynamics, state);
    state.push_back({"a", Quantity::kAbsoluteAcceleration, Vector::Unit(n, 0)});
    const ObservationMap more(dynamics, state);
    for (auto method : {DerivativeMethod::kTangents, DerivativeMethod::kJets}) {
      SegmentPropagator propagator(dynamics, method);
      const auto run = [&](const ObservationMap& map, SegmentTangents* result) {
        return propagator.Propagate(prepared, map, grid, start, 0, 8, true,
                                    SegmentColumns::kAll, result);
      };
      SegmentTangents plain, weighted, of_whole;
      weighted.columns_before = 2;
      weighted.columns_behind = 3;
      weighted.factors = Vector::LinSpaced(2 * n + 1, 0.5, 7.0);
      of_whole.factors = weighted.factors.head(2 * n);
      ASSERT_TRUE(run(more, &plain) && run(more, &weighted) &&
                  run(whole, &of_whole));
      EXPECT_EQ(weighted.rows.cols(), plain.rows.cols() + 5);
      EXPECT_EQ(weighted.channels, plain.channels);
      Matrix expected = plain.jacobian();
      Matrix of_state(of_whole.rows.rows(), expected.cols());
      for (Eigen::Index i = 0; i < 9; ++i) {
        auto rows = expected.middleRows(i * (2 * n + 1), 2 * n + 1);
        rows.array().colwise() *= weighted.factors.array();
        of_state.middleRows(i * 2 * n, 2 * n) = rows.topRows(2 * n);
      }
      EXPECT_LT((weighted.jacobian() - expected).norm(),
                1e-14 * expected.norm());
      EXPECT_LT((of_whole.jacobian() - of_state).norm(),
                1e-14 * of_state.norm());
    }
  }
}

// Columns that were not requested are missing, and the others are the same.
TEST(Segment, ColumnsDoNotDependOnEachOther) {
  const auto dynamics = testing::MakeEverything();
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  const ObservationMap observation(*dynamics, SomeObservations());
  const IntegrationGrid grid(SomeExcitation(Interpolation::kCubic, 8), 2);
  const int ns = dynamics->num_states();
  const int np = dynamics->num_tangent_columns();
  const Vector start = Vector::LinSpaced(ns, -0.5, 0.6);
  for (auto method : {DerivativeMethod::kTangents, DerivativeMethod::kJets}) {
    SegmentPropagator propagator(*dynamics, method);
    SegmentTangents all, parameters, none;
    ASSERT_TRUE(propagator.Propagate(prepared, observation, grid, start, 0, 7,
                                     true, SegmentColumns::kAll, &all));
    ASSERT_TRUE(propagator.Propagate(prepared, observation, grid, start, 0, 7,
                                     true, SegmentColumns::kParameters,
                                     &parameters));
    ASSERT_TRUE(propagator.Propagate(prepared, observation, grid, start, 0, 7,
                                     true, SegmentColumns::kNone, &none));
    EXPECT_EQ(parameters.jacobian().cols(), np);
    EXPECT_LT((parameters.jacobian() - all.jacobian().rightCols(np)).norm(),
              1e-13 * all.jacobian().norm());
    EXPECT_LT(
        (parameters.end_sensitivity - all.end_sensitivity.rightCols(np)).norm(),
        1e-13 * all.end_sensitivity.norm());
    EXPECT_EQ(none.jacobian().cols(), 0);
    EXPECT_LT((none.channels - all.channels).norm(),
              1e-13 * all.channels.norm());
    EXPECT_LT((none.end_state - all.end_state).norm(),
              1e-13 * all.end_state.norm());
  }
}

// Groups of every matrix, two inputs, a coupled mass, and a segment longer than
// the blocks of LinearSegment. Compares all methods, and differences of runs
// that compute their steps one by one.
class LinearSegments : public ::testing::TestWithParam<Interpolation> {};

TEST_P(LinearSegments, EqualStepsTakenOneByOne) {
  StructuralModel model = testing::MakeChain(3, 10.0, 0.5);
  model.mass(0, 1) = model.mass(1, 0) = 0.1;
  model.support_mass_coupling(0, 0) = 0.2;
  StructuralDynamics dynamics(
      model, {{InputSpec::Kind::kGroundAcceleration, 0, "ground"},
              {InputSpec::Kind::kForce, 1, "force"},
              {InputSpec::Kind::kCovariate, 0, "temperature"}});
  std::string error;
  int count = 0;
  for (const auto target :
       {MatrixGroup::Target::kStiffness, MatrixGroup::Target::kDamping,
        MatrixGroup::Target::kMass, MatrixGroup::Target::kStiffness}) {
    GroupTerm group;
    group.alpha.name = group.group.name = "g" + std::to_string(count);
    group.group.target = target;
    group.group.matrix = SpringMatrix(3, count % 3 - 1, count % 3);
    group.alpha.value = 0.1 + 0.05 * count;
    group.alpha.free = count != 3;
    ++count;
    ASSERT_TRUE(dynamics.AddGroup(group, &error)) << error;
  }
  ASSERT_TRUE(dynamics.IsLinear());
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
  const ObservationMap observation(dynamics, SomeObservations());
  constexpr int kSamples = 200;
  for (const int substeps : {1, 3, 6}) {
    const IntegrationGrid grid(SomeExcitation(GetParam(), kSamples), substeps);
    const Vector start = Vector::LinSpaced(6, -0.5, 0.6);
    for (const auto columns :
         {SegmentColumns::kNone, SegmentColumns::kStart,
          SegmentColumns::kParameters, SegmentColumns::kAll}) {
      for (const bool observe_last : {false, true}) {
        SegmentTangents tangents, jets;
        SegmentPropagator by_map(dynamics, DerivativeMethod::kTangents);
        SegmentPropagator by_steps(dynamics, DerivativeMethod::kJets);
        ASSERT_TRUE(by_map.Propagate(prepared, observation, grid, start, 2,
                                     kSamples - 1, observe_last, columns,
                                     &tangents));
        ASSERT_TRUE(by_steps.Propagate(prepared, observation, grid, start, 2,
                                       kSamples - 1, observe_last, columns,
                                       &jets));
        ASSERT_EQ(
            tangents.jacobian().cols(),
            (HasStart(columns) ? 6 : 0) + (HasParameters(columns) ? 3 : 0));
        ASSERT_EQ(tangents.jacobian().rows(), jets.jacobian().rows());
        EXPECT_LT((tangents.channels - jets.channels).norm(),
                  1e-12 * jets.channels.norm());
        EXPECT_LT((tangents.end_state - jets.end_state).norm(),
                  1e-12 * jets.end_state.norm());
        for (Eigen::Index j = 0; j < jets.jacobian().cols(); ++j) {
          EXPECT_LT(
              (tangents.jacobian().col(j) - jets.jacobian().col(j)).norm(),
              1e-11 * jets.jacobian().col(j).norm())
              << j;
          EXPECT_LT(
              (tangents.end_sensitivity.col(j) - jets.end_sensitivity.col(j))
                  .norm(),
              1e-11 * jets.end_sensitivity.col(j).norm())
              << j;
        }
        // Other parameters have another map. The previous parameters get their
        // own map again.
        StructuralDynamics::Prepared other;
        ASSERT_TRUE(
            dynamics.Prepare(1.5 * dynamics.Parameters(), &other, &error));
        SegmentTangents moved, again;
        ASSERT_TRUE(by_map.Propagate(other, observation, grid, start, 2,
                                     kSamples - 1, observe_last, columns,
                                     &moved));
        EXPECT_GT((moved.channels - tangents.channels).norm(),
                  1e-3 * tangents.channels.norm());
        ASSERT_TRUE(by_map.Propagate(prepared, observation, grid, start, 2,
                                     kSamples - 1, observe_last, columns,
                                     &again));
        EXPECT_EQ(again.channels, tangents.channels);
        EXPECT_EQ(again.jacobian(), tangents.jacobian());
        Trajectory trajectory;
        ASSERT_TRUE(FreeRun(dynamics, prepared, observation, grid, start, 2,
                            kSamples - 1, &trajectory));
        EXPECT_LT(
            (trajectory.channels.leftCols(jets.channels.cols()) - jets.channels)
                .norm(),
            1e-12 * jets.channels.norm());
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Interpolations, LinearSegments,
                         ::testing::Values(Interpolation::kHeld,
                                           Interpolation::kLinear,
                                           Interpolation::kBandLimited));

// A chain of three with a law of every kind of state. The motion of the last
// DOF is prescribed.
std::unique_ptr<StructuralDynamics> MakeMovedChain(
    const std::vector<InputSpec>& inputs) {
  auto dynamics = std::make_unique<StructuralDynamics>(
      testing::MakeChain(3, 10.0, 0.5), inputs);
  std::string error;
  GroupTerm group;
  group.alpha.name = group.group.name = "k3";
  group.group.matrix = SpringMatrix(3, 1, 2);
  group.alpha.value = 0.3;
  CHECK(dynamics->AddGroup(group, &error)) << error;
  CHECK(dynamics->AddElement("hard", "cubic", 1, 2, {0.8}, &error)) << error;
  CHECK(dynamics->AddElement("damper", "bouc_wen", Feature::kGround, 2,
                             {2.0, 1.0, 0.6, 0.3, 1.6}, &error))
      << error;
  return dynamics;
}

const std::vector<InputSpec>& MotionOfTheThird() {
  static const auto& inputs = *new std::vector<InputSpec>{
      {InputSpec::Kind::kPrescribedDisplacement, 2, "x3"},
      {InputSpec::Kind::kPrescribedVelocity, 2, "v3"},
      {InputSpec::Kind::kPrescribedAcceleration, 2, "a3"}};
  return inputs;
}

// The force that moves the free chain equals that of the chain with prescribed
// motion.
TEST(PrescribedSegment, ForceIsTheOneThatMakesTheMotion) {
  constexpr int kSamples = 400;
  constexpr double kStep = 0.01;
  Matrix force(1, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    force(0, i) = 3.0 * std::sin(0.06 * i) * std::sin(0.011 * i);
  }
  const auto pushed = MakeMovedChain({{InputSpec::Kind::kForce, 2, "f"}});
  const auto run = [](const StructuralDynamics& dynamics,
                      const std::vector<Observation>& observations,
                      const Matrix& input) {
    StructuralDynamics::Prepared prepared;
    std::string error;
    CHECK(dynamics.Prepare(dynamics.Parameters(), &prepared, &error)) << error;
    const Excitation excitation(0.0, kStep, input, Interpolation::kCubic);
    Trajectory trajectory;
    // The start's entries of the third DOF do not matter.
    Vector start = Vector::Zero(dynamics.num_states());
    if (!dynamics.prescribed().empty()) start[2] = start[5] = 9.0;
    CHECK(FreeRun(dynamics, prepared, ObservationMap(dynamics, observations),
                  IntegrationGrid(excitation, 4), start, 0, kSamples - 1,
                  &trajectory));
    return trajectory;
  };
  const Trajectory free =
      run(*pushed,
          {{"a3", Quantity::kRelativeAcceleration, Vector::Unit(3, 2)}}, force);
  Matrix motion(3, kSamples);
  motion << free.states.row(2), free.states.row(5), free.channels;
  const auto moved = MakeMovedChain(MotionOfTheThird());
  const Trajectory found =
      run(*moved, {{"f3", Quantity::kForce, Vector::Unit(3, 2)}}, motion);
  EXPECT_LT((found.channels - force).norm(), 1e-5 * force.norm());
  EXPECT_LT((found.states - free.states).norm(), 1e-5 * free.states.norm());
  EXPECT_EQ(found.states.row(2), motion.row(0));
}

TEST(PrescribedSegment, TangentsEqualWideJetsAndDifferences) {
  const auto dynamics = MakeMovedChain(MotionOfTheThird());
  const ObservationMap observation(
      *dynamics, {{"f3", Quantity::kForce, Vector::Unit(3, 2)},
                  {"x1", Quantity::kDisplacement, Vector::Unit(3, 0)},
                  {"a2", Quantity::kRelativeAcceleration, Vector::Unit(3, 1)}});
  const IntegrationGrid grid(SomeExcitation(Interpolation::kLinear, 12), 2);
  const int ns = dynamics->num_states();
  const Vector start = Vector::LinSpaced(ns, -0.5, 0.6);
  const auto propagate = [&](const Vector& theta, DerivativeMethod method) {
    StructuralDynamics::Prepared prepared;
    std::string error;
    CHECK(dynamics->Prepare(theta, &prepared, &error)) << error;
    SegmentPropagator propagator(*dynamics, method);
    SegmentTangents result;
    CHECK(propagator.Propagate(prepared, observation, grid, start, 0, 11, true,
                               SegmentColumns::kAll, &result));
    return result;
  };
  const Vector theta = dynamics->Parameters();
  const auto tangents = propagate(theta, DerivativeMethod::kTangents);
  const auto jets = propagate(theta, DerivativeMethod::kJets);
  EXPECT_LT((tangents.jacobian() - jets.jacobian()).norm(),
            1e-12 * jets.jacobian().norm());
  EXPECT_LT((tangents.end_sensitivity - jets.end_sensitivity).norm(),
            1e-12 * jets.end_sensitivity.norm());
  for (const int held : {2, 5}) {
    EXPECT_TRUE(tangents.end_sensitivity.row(held).isZero(0.0));
    EXPECT_TRUE(tangents.jacobian().col(held).isZero(0.0));
  }
  constexpr double kStep = 1e-6;
  for (int j = 0; j < dynamics->num_tangent_columns(); ++j) {
    const Vector step =
        kStep * Vector::Unit(theta.size(), dynamics->tangent_columns()[j]);
    const Matrix slope =
        (propagate(theta + step, DerivativeMethod::kTangents).channels -
         propagate(theta - step, DerivativeMethod::kTangents).channels) /
        (2.0 * kStep);
    const Vector column = tangents.jacobian().col(ns + j);
    EXPECT_LT(
        (Eigen::Map<const Vector>(slope.data(), slope.size()) - column).norm(),
        1e-7 * column.norm())
        << j;
  }
}

TEST(Segment, DivergenceNamesSampleAndState) {
  StructuralModel model = testing::MakeChain(2, 1.0, 0.0);
  model.stiffness *= -1e6;  // explodes
  const StructuralDynamics dynamics(model, {});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error));
  const ObservationMap observation(
      dynamics, {{"x", Quantity::kDisplacement, Vector::Unit(2, 0)}});
  const IntegrationGrid grid(0.0, 0.05, 200, 1);
  SegmentPropagator propagator(dynamics, DerivativeMethod::kTangents);
  SegmentTangents result;
  EXPECT_FALSE(propagator.Propagate(prepared, observation, grid,
                                    Vector::Ones(4), 0, 199, true,
                                    SegmentColumns::kStart, &result));
  EXPECT_GT(result.failed_sample, 0);
  EXPECT_LT(result.failed_sample, 199);
  EXPECT_GE(result.failed_state, 0);
  Trajectory trajectory;
  EXPECT_FALSE(FreeRun(dynamics, prepared, observation, grid, Vector::Ones(4),
                       0, 199, &trajectory));
  EXPECT_EQ(trajectory.failed_sample, result.failed_sample);
}

}  // namespace
}  // namespace pinode
