#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "pinode/estimate/fit/fit_once.h"
#include "tests/support/bouncing_ball_testing.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace {

constexpr double kNoise = 0.002;
constexpr double kFlightStep = 0.005;

// Three bounces. Stiffness and damping begin at less than a half of the truth.
TEST(ImpactFit, FindsTheStop) {
  constexpr Eigen::Index kFlightSamples = 401;
  IdentificationRecord record;
  record.name = "flight";
  record.substeps = 10;
  record.start = IdentificationRecord::Start::kKnown;
  record.known_start = Vector::Zero(2);
  record.excitation =
      Excitation(0.0, kFlightStep, Matrix::Zero(0, kFlightSamples),
                 Interpolation::kLinear);
  MeasuredChannel channel;
  channel.observation = {"y", Quantity::kDisplacement, Vector::Unit(1, 0)};
  channel.values.resize(kFlightSamples);
  const Vector truth = (Vector(3) << -9.8, 5000.0, 15.0).finished();
  testing::BallPath path(truth);
  testing::Gaussian noise(11);
  for (Eigen::Index i = 0; i < kFlightSamples; ++i) {
    channel.values[i] = path.At(kFlightStep * static_cast<double>(i))[0] +
                        kNoise * noise.Next();
  }
  record.channels.push_back(std::move(channel));
  IdentificationProblem problem;
  problem.dynamics =
      testing::MakeBall((Vector(3) << -9.0, 2000.0, 5.0).finished());
  problem.records.push_back(std::move(record));

  FitSummary summary;
  IdentifiedModel model;
  FitOnce(problem, IdentificationOptions(), nullptr, &summary, &model);
  EXPECT_EQ(summary.termination, Termination::kConverged) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const ParameterEstimate& estimate =
        summary.parameters[static_cast<size_t>(k)];
    EXPECT_LT(std::abs(estimate.value - truth[k]), 3.0 * estimate.sigma)
        << estimate.name;
    EXPECT_LT(estimate.sigma, 0.02 * std::abs(truth[k])) << estimate.name;
  }
  EXPECT_NEAR(summary.records[0].channels[0].rmse, kNoise, 0.1 * kNoise);
}

}  // namespace
}  // namespace pinode
