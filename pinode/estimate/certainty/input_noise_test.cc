#include "pinode/estimate/certainty/input_noise.h"

#include <gtest/gtest.h>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

class InputSensitivityTest : public ::testing::TestWithParam<Interpolation> {};

// One sample of the excitation after the other is changed and the record run
// again.
TEST_P(InputSensitivityTest, EqualsDifferencesOfTheFreeRun) {
  auto dynamics = testing::MakeSmallNonlinear();
  const int samples = 12;
  const int nc = 3;
  IdentificationProblem problem;
  Parameter gain;
  gain.name = "gain";
  gain.value = 1.4;
  problem.sensors.name = "sensors";
  problem.sensors.parameters = {gain};
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, samples, 0.1, GetParam());
  record.substeps = 2;
  record.channels = {
      testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0),
      testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1),
      testing::MakeChannel("a1", Quantity::kRelativeAcceleration, 2, 0)};
  const Vector start = Vector::LinSpaced(dynamics->num_states(), -0.2, 0.3);
  const Vector theta = dynamics->Parameters();
  const Matrix states =
      testing::Simulate(*dynamics, theta, start, 0.0, 1, &record);
  record.channels[1].gain = 0;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  const ParameterLayout layout(problem);

  const Matrix weights = Matrix::Random(nc * samples, 2);
  const Matrix effect = InputSensitivity(
      LinearizeRecord(problem, layout, 0, {0}, layout.InitialValues(), states),
      0, weights);
  ASSERT_EQ(effect.rows(), 2);
  ASSERT_EQ(effect.cols(), samples);
  for (int i = 0; i < samples; ++i) {
    const Vector expected = testing::Differentiate(
        [&](double h) {
          Matrix inputs = record.excitation->samples();
          inputs(0, i) += h;
          IdentificationRecord moved = record;
          moved.excitation.emplace(0.0, 0.1, inputs, GetParam());
          testing::Simulate(*dynamics, theta, start, 0.0, 1, &moved);
          Vector y(nc * samples);
          for (int j = 0; j < samples; ++j) {
            y[j * nc] = moved.channels[0].values[j];
            y[j * nc + 1] = 1.4 * moved.channels[1].values[j];
            y[j * nc + 2] = moved.channels[2].values[j];
          }
          return Vector(weights.transpose() * y);
        },
        0.02);
    EXPECT_LT((effect.col(i) - expected).norm(), 1e-6 * weights.norm())
        << "sample " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Interpolations, InputSensitivityTest,
                         ::testing::Values(Interpolation::kHeld,
                                           Interpolation::kLinear));

}  // namespace
}  // namespace pinode
