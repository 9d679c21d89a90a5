#include "pinode/estimate/certainty/input_noise_fit.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/integrate/free_run.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using Start = IdentificationRecord::Start;

constexpr double kInputNoise = 0.15;

// A two-DOF chain under a ground motion that is measured with noise.
struct NoisyGround {
  NoisyGround(int samples, Start start, Interpolation interpolation,
              double sigma_given) {
    auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, samples, 0.05, interpolation);
    record.channels = {
        testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0),
        testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1)};
    first = start == Start::kRest ? Vector(Vector::Zero(4))
                                  : Vector(Vector::LinSpaced(4, -0.1, 0.2));
    fit.trajectories = {
        testing::Simulate(*dynamics, truth, first, 0.0, 3, &record)};
    testing::Gaussian random(17);
    sigma = Eigen::Vector2d(0.01, 0.1);
    for (int c = 0; c < 2; ++c) {
      MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      channel.values += sigma[c] * random.Draw(samples);
      channel.sigma = sigma_given * sigma[c];
    }
    record.channels[0].values[7] = std::nan("");
    const Matrix measured = record.excitation->samples() +
                            kInputNoise * random.Draw(samples).transpose();
    record.excitation.emplace(0.0, 0.05, measured, interpolation);
    record.input_sigma = Vector::Constant(1, kInputNoise);
    record.start = start;
    problem.records.push_back(record);
    problem.dynamics = dynamics;
    layout = std::make_unique<ParameterLayout>(problem);
    fit.free = truth + Eigen::Vector2d(0.05, 0.03);
    fit.sigmas = {sigma};
  }

  bool Run(std::string* message) {
    return FitWithInputNoise(problem, *layout, MultipleShooting::Options(),
                             Vector(), go_on, &fit, message);
  }

  IdentificationProblem problem;
  std::unique_ptr<ParameterLayout> layout;
  const Vector truth = Eigen::Vector2d(0.1, -0.05);
  Vector first, sigma;
  InputNoiseCallback go_on;
  InputNoiseFit fit;
};

// The whole problem in the open, for differences by Ceres: parameters, errors
// of the excitation, start.
struct JointResiduals {
  bool operator()(double const* const* parameters, double* residuals) const {
    const StructuralDynamics& dynamics = *ground->problem.dynamics;
    const IdentificationRecord& record = ground->problem.records[0];
    const Eigen::Index samples = record.num_samples();
    const Vector theta = Eigen::Map<const Vector>(parameters[0], 2);
    const Vector errors = Eigen::Map<const Vector>(parameters[1], samples);
    const Vector start = Eigen::Map<const Vector>(parameters[2], 4);
    StructuralDynamics::Prepared prepared;
    std::string error;
    if (!dynamics.Prepare(theta, &prepared, &error)) return false;
    const ObservationMap observation(
        dynamics,
        {record.channels[0].observation, record.channels[1].observation});
    const Excitation excitation(
        0.0, 0.05, record.excitation->samples() + errors.transpose(),
        record.excitation->interpolation());
    Trajectory trajectory;
    if (!FreeRun(dynamics, prepared, observation,
                 IntegrationGrid(excitation, record.substeps), start, 0,
                 samples - 1, &trajectory)) {
      return false;
    }
    int row = 0;
    for (int i = 0; i < samples; ++i) {
      for (int c = 0; c < 2; ++c) {
        const double value = record.channels[static_cast<size_t>(c)].values[i];
        residuals[row++] =
            std::isnan(value)
                ? 0.0
                : (trajectory.channels(c, i) - value) / ground->sigma[c];
      }
    }
    for (int i = 0; i < samples; ++i) {
      residuals[row++] = errors[i] / kInputNoise;
    }
    return true;
  }
  const NoisyGround* ground;
};

struct Setting {
  Start start;
  Interpolation interpolation;
};

class InputNoiseFitTest : public ::testing::TestWithParam<Setting> {};

TEST_P(InputNoiseFitTest, EqualsTheJointFitByCeres) {
  constexpr int kSamples = 60;
  NoisyGround ground(kSamples, GetParam().start, GetParam().interpolation, 1.0);
  std::string message;
  ASSERT_TRUE(ground.Run(&message)) << message;

  auto* cost =
      new ceres::DynamicNumericDiffCostFunction<JointResiduals, ceres::RIDDERS>(
          new JointResiduals{&ground});
  cost->AddParameterBlock(2);
  cost->AddParameterBlock(kSamples);
  cost->AddParameterBlock(4);
  cost->SetNumResiduals(3 * kSamples);
  Vector theta = ground.truth;
  Vector errors = Vector::Zero(kSamples);
  Vector start = ground.first;
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, theta.data(), errors.data(),
                           start.data());
  if (GetParam().start == Start::kRest) {
    problem.SetParameterBlockConstant(start.data());
  }
  ceres::Solver::Options options;
  options.function_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ASSERT_TRUE(summary.IsSolutionUsable());
  ceres::Covariance::Options covariance_options;
  covariance_options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(covariance_options);
  ASSERT_TRUE(covariance.Compute(
      std::vector<std::pair<const double*, const double*>>{
          {theta.data(), theta.data()}},
      &problem));
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> expected;
  ASSERT_TRUE(covariance.GetCovarianceBlock(theta.data(), theta.data(),
                                            expected.data()));

  const CovarianceEstimate& estimate = ground.fit.covariance;
  EXPECT_EQ(estimate.method, "errors in variables");
  // The weak prior on a free start is not in the problem of Ceres.
  EXPECT_LT((estimate.covariance - expected).norm(), 1e-3 * expected.norm());
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(ground.fit.free[i], theta[i], 1e-3 * std::sqrt(expected(i, i)));
  }
  EXPECT_NEAR(ground.fit.cost, summary.final_cost, 1e-4 * summary.final_cost);
  InputNoiseFit at = ground.fit;
  ASSERT_TRUE(InputNoiseCovariance(ground.problem, *ground.layout,
                                   MultipleShooting::Options(), Vector(), &at));
  // Without the errors of the excitation that the fit has found.
  EXPECT_LT((at.covariance.covariance - expected).norm(),
            0.2 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(
    Settings, InputNoiseFitTest,
    ::testing::Values(Setting{Start::kRest, Interpolation::kLinear},
                      Setting{Start::kRest, Interpolation::kHeld},
                      Setting{Start::kFree, Interpolation::kLinear}),
    [](const ::testing::TestParamInfo<Setting>& setting) {
      return std::string(setting.param.start == Start::kRest ? "Rest"
                                                             : "Free") +
             (setting.param.interpolation == Interpolation::kHeld ? "Held"
                                                                  : "Linear");
    });

// Least squares counts the image of the excitation's noise as the sensors'.
TEST(FitWithInputNoise, FindsTheNoiseOfTheSensors) {
  NoisyGround ground(2000, Start::kRest, Interpolation::kLinear, 0.0);
  ground.fit.sigmas = {Vector(5.0 * ground.sigma)};
  std::string message;
  ASSERT_TRUE(ground.Run(&message)) << message;
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(ground.fit.sigmas[0][c], ground.sigma[c],
                0.07 * ground.sigma[c]);
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(ground.fit.free[i], ground.truth[i],
                3.0 * std::sqrt(ground.fit.covariance.covariance(i, i)));
  }
}

TEST(FitWithInputNoise, StaysInsideBounds) {
  NoisyGround ground(200, Start::kRest, Interpolation::kLinear, 1.0);
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeGroupedChain(2, 30.0, 0.3)->model(),
      ground.problem.dynamics->inputs());
  std::string message;
  for (GroupTerm group : ground.problem.dynamics->groups()) {
    if (group.alpha.name == "k1") group.alpha.upper = 0.02;
    ASSERT_TRUE(dynamics->AddGroup(group, &message)) << message;
  }
  ground.problem.dynamics = dynamics;
  ground.layout = std::make_unique<ParameterLayout>(ground.problem);
  ground.fit.free = Vector::Zero(2);
  ASSERT_TRUE(ground.Run(&message)) << message;
  EXPECT_EQ(ground.fit.free[0], 0.02);
  EXPECT_LT(ground.fit.free[1], -0.01);
}

TEST(FitWithInputNoise, LeavesTheFitAloneWhereTheRunIsNotFinite) {
  NoisyGround ground(200, Start::kRest, Interpolation::kLinear, 1.0);
  ground.fit.free = Vector::Constant(2, 1e6);  // far beyond a stable step
  const Vector before = ground.fit.free;
  std::string message;
  EXPECT_FALSE(ground.Run(&message));
  EXPECT_EQ(message, "the trajectory is not finite");
  EXPECT_EQ(ground.fit.free, before);
}

TEST(FitWithInputNoise, StopsWhenTold) {
  NoisyGround ground(200, Start::kRest, Interpolation::kLinear, 1.0);
  const Vector before = ground.fit.free;
  int calls = 0;
  ground.go_on = [&calls](const Vector&, double) { return ++calls < 2; };
  std::string message;
  EXPECT_FALSE(ground.Run(&message));
  EXPECT_EQ(message, "interrupted");
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(ground.fit.free, before);
}

TEST(CanFitWithInputNoise, NeedsNoiseAndAPlainProblem) {
  NoisyGround ground(40, Start::kRest, Interpolation::kLinear, 1.0);
  EXPECT_TRUE(CanFitWithInputNoise(ground.problem, RobustLoss::kNone));
  EXPECT_FALSE(CanFitWithInputNoise(ground.problem, RobustLoss::kHuber));
  ground.problem.records[0].input_sigma.setZero();
  EXPECT_FALSE(CanFitWithInputNoise(ground.problem, RobustLoss::kNone));
  const NoisyGround cubic(40, Start::kRest, Interpolation::kCubic, 1.0);
  EXPECT_FALSE(CanFitWithInputNoise(cubic.problem, RobustLoss::kNone));
}

}  // namespace
}  // namespace pinode
