#include "pinode/integrate/exponential_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/integrate/segment.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/figure_testing.h"
#include "tests/support/integrate_testing.h"

namespace pinode {
namespace {

constexpr double kSampling = 0.05;

Excitation Quake(int samples, Interpolation interpolation) {
  Matrix values(2, samples);
  for (int i = 0; i < samples; ++i) {
    const double t = kSampling * i;
    values.col(i) << 3.0 * std::sin(4.1 * t) + 2.0 * std::sin(1.3 * t),
        2.0 * std::cos(2.7 * t);
  }
  return Excitation(0.0, kSampling, values, interpolation);
}

// A chain with groups of all kinds, a hardening spring between two masses,
// hysteresis to the ground, and a term that acts as an acceleration.
std::unique_ptr<StructuralDynamics> WithLaws(const StructuralModel& model) {
  auto dynamics =
      std::make_unique<StructuralDynamics>(model, testing::GroundAndForce());
  std::string error;
  testing::AddGroupsOfAllKinds(SpringMatrix(3, 0, 1), dynamics.get(),
                               /*free_damping=*/false);
  CHECK(dynamics->AddElement("hard", "cubic", 0, 1, {4.0}, &error)) << error;
  // Without |w|, which has a kink.
  CHECK(dynamics->AddElement("slip", "bouc_wen", Feature::kGround, 1,
                             {5.0, 1.0, 0.0, 0.5, 2.0}, &error))
      << error;
  LawTerm oil;
  CHECK(
      MakeElement("oil", "cubic", 3, Feature::kGround, 0, {0.05}, &oil, &error))
      << error;
  oil.acts_as = ActsAs::kAcceleration;
  oil.outputs = -oil.outputs;
  CHECK(dynamics->AddLaw(std::move(oil), &error)) << error;
  return dynamics;
}

TEST(ExponentialStep, SuitsGroupsAndLaws) {
  const StructuralModel model = testing::MakeChain(3, 10.0, 0.5);
  auto dynamics = WithLaws(model);
  EXPECT_TRUE(ExponentialStep::Suits(*dynamics));
  EXPECT_FALSE(ExponentialStep::Suits(
      StructuralDynamics(model, std::vector<InputSpec>{})));
  std::string error;
  StructuralDynamics moved(
      model, std::vector<InputSpec>{
                 {InputSpec::Kind::kPrescribedDisplacement, 2, "x"},
                 {InputSpec::Kind::kPrescribedVelocity, 2, "v"},
                 {InputSpec::Kind::kPrescribedAcceleration, 2, "a"}});
  ASSERT_TRUE(moved.AddElement("hard", "cubic", 0, 1, {4.0}, &error)) << error;
  EXPECT_FALSE(ExponentialStep::Suits(moved));
  StructuralDynamics following(
      model,
      std::vector<InputSpec>{{InputSpec::Kind::kCovariate, 0, "warmth"}});
  ASSERT_TRUE(following.AddElement("hard", "cubic", 0, 1, {4.0}, &error))
      << error;
  EXPECT_TRUE(ExponentialStep::Suits(following));
  GroupTerm group;
  group.alpha.name = group.group.name = "soil";
  group.group.matrix = SpringMatrix(3, 0, 1);
  group.follows = GroupTerm::Follows::kCovariate;
  group.input = 0;
  ASSERT_TRUE(following.AddGroup(group, &error)) << error;
  EXPECT_FALSE(ExponentialStep::Suits(following));
}

TEST(ExponentialStep, IsOfFourthOrder) {
  const auto dynamics = WithLaws(testing::MakeChain(3, 10.0, 0.5));
  const testing::ChannelRunner runner(*dynamics);
  const Vector theta = dynamics->Parameters();
  Vector start = Vector::Zero(7);
  start.head(6) = Vector::LinSpaced(6, -0.5, 0.6);
  const Excitation quake = Quake(400, Interpolation::kLinear);
  const Matrix fine = runner.Run(theta, start, IntegrationGrid(quake, 64));
  std::vector<double> errors;
  for (const int steps : {1, 2, 4}) {
    const Matrix channels = runner.Run(
        theta, start, IntegrationGrid(quake, steps, Integrator::kExponential));
    errors.push_back((channels - fine).norm() / fine.norm());
  }
  const double plain =
      (runner.Run(theta, start, IntegrationGrid(quake, 1)) - fine).norm() /
      fine.norm();
  EXPECT_LT(errors[0], plain);
  EXPECT_LT(errors[1], errors[0] / 10.0);
  EXPECT_LT(errors[2], errors[1] / 10.0);
  testing::ReportFigure("exponential steps, error of 4 a sample",
                        testing::AtMost(1e-6), errors[2]);
  EXPECT_LT(errors[2], 1e-6);
}

class ExponentialDerivatives : public ::testing::TestWithParam<Interpolation> {
};

TEST_P(ExponentialDerivatives, AreThoseOfItsSteps) {
  const auto dynamics = WithLaws(testing::MakeChain(3, 10.0, 0.5));
  const testing::ChannelRunner runner(*dynamics);
  const Vector theta = dynamics->Parameters();
  Vector start = Vector::Zero(7);
  start.head(6) = Vector::LinSpaced(6, -0.5, 0.6);
  start[6] = 0.3;
  const IntegrationGrid grid(Quake(120, GetParam()), 2,
                             Integrator::kExponential);
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics->Prepare(theta, &prepared, &error));
  SegmentPropagator propagator(*dynamics, DerivativeMethod::kTangents);
  SegmentTangents values, all, by_parameters;
  const auto propagate = [&](SegmentColumns columns, SegmentTangents* result) {
    return propagator.Propagate(prepared, runner.observation, grid, start, 0,
                                grid.num_intervals(), true, columns, result);
  };
  ASSERT_TRUE(propagate(SegmentColumns::kNone, &values));
  ASSERT_TRUE(propagate(SegmentColumns::kAll, &all));
  ASSERT_TRUE(propagate(SegmentColumns::kParameters, &by_parameters));
  EXPECT_LT((values.channels - all.channels).norm(),
            1e-12 * all.channels.norm());
  EXPECT_LT((runner.Run(theta, start, grid) - all.channels).norm(),
            1e-12 * all.channels.norm());
  const int np = dynamics->num_tangent_columns();
  ASSERT_EQ(all.jacobian().cols(), 7 + np);
  EXPECT_LT((all.jacobian().rightCols(np) - by_parameters.jacobian()).norm(),
            1e-12 * by_parameters.jacobian().norm());
  for (int j = 0; j < 7 + np; ++j) {
    const auto run = [&](double step) {
      Vector moved_start = start;
      Vector moved = theta;
      if (j < 7) {
        moved_start[j] += step;
      } else {
        moved[dynamics->tangent_columns()[static_cast<size_t>(j - 7)]] += step;
      }
      return runner.Run(moved, moved_start, grid);
    };
    constexpr double kStep = 1e-3;
    const Matrix coarse = (run(kStep) - run(-kStep)) / (2.0 * kStep);
    const Matrix fine = (run(0.5 * kStep) - run(-0.5 * kStep)) / kStep;
    const Matrix slope = (4.0 * fine - coarse) / 3.0;
    const Vector flat = Eigen::Map<const Vector>(slope.data(), slope.size());
    EXPECT_LT((all.jacobian().col(j) - flat).norm(),
              1e-7 * std::max(flat.norm(), 1e-3))
        << j;
  }
}

INSTANTIATE_TEST_SUITE_P(Interpolations, ExponentialDerivatives,
                         ::testing::Values(Interpolation::kHeld,
                                           Interpolation::kLinear,
                                           Interpolation::kCubic));

// A mode at 5 kHz, sampled at 20 Hz, together with a hardening spring. The
// error of the stiff mode itself is small too, in strains and accelerations.
TEST(ExponentialStep, DoesNotFollowTheHighestMode) {
  StructuralModel model = testing::MakeChain(3, 10.0, 0.5);
  const auto soft = WithLaws(model);
  const double stiff = std::pow(2.0 * kPi * 5000.0, 2);
  model.stiffness(2, 2) += stiff;
  model.damping(2, 2) += 0.02 * std::sqrt(stiff);
  const auto dynamics = WithLaws(model);
  const Excitation quake = Quake(100, Interpolation::kLinear);
  const testing::ChannelRunner runner(*dynamics);
  const Vector theta = dynamics->Parameters();
  const Vector start = Vector::Zero(7);
  const Matrix fine = runner.Run(theta, start, IntegrationGrid(quake, 4000));
  const Matrix steps = runner.Run(
      theta, start, IntegrationGrid(quake, 4, Integrator::kExponential));
  for (Eigen::Index c = 0; c < fine.rows(); ++c) {
    EXPECT_LT((steps.row(c) - fine.row(c)).norm(), 1e-6 * fine.row(c).norm())
        << c;
  }
  const testing::ChannelRunner soft_runner(*soft);
  const Matrix soft_fine =
      soft_runner.Run(theta, start, IntegrationGrid(quake, 256));
  const Matrix soft_steps = soft_runner.Run(
      theta, start, IntegrationGrid(quake, 4, Integrator::kExponential));
  EXPECT_LT((steps.topRows(2) - fine.topRows(2)).norm() / fine.norm(),
            2.0 * (soft_steps - soft_fine).norm() / soft_fine.norm());
}

}  // namespace
}  // namespace pinode
