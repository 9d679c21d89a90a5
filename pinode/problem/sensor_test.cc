#include "pinode/problem/sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/constants.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

constexpr int kSamples = 40;
constexpr double kStep = 0.02;

// Two channels of a one-DOF chain; the second has gain, offset and delay.
class SensorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    problem_.dynamics = testing::MakeGroupedChain(1, 10.0, 0.1);
    problem_.sensors.name = "sensors";
    for (const char* name : {"gain", "offset", "delay"}) {
      Parameter parameter;
      parameter.name = name;
      problem_.sensors.parameters.push_back(parameter);
    }
    problem_.sensors.SetValues(Eigen::Vector3d(1.3, -0.2, 0.007));
    record_ = testing::MakeExcitedRecord(*problem_.dynamics, kSamples, kStep);
    record_.channels = {
        testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
        testing::MakeChannel("v", Quantity::kVelocity, 1, 0)};
  }

  void UseSensor() {
    record_.channels[1].gain = 0;
    record_.channels[1].offset = 1;
    record_.channels[1].delay = 2;
  }

  // Value of an ideal sensor: 0.9 Hz, a fifty-fifth of the sampling rate.
  static double Ideal(int channel, double t) {
    return std::sin(5.7 * t + channel);
  }

  struct Shown {
    Vector prediction;
    Matrix rows;
    std::vector<bool> valid;
  };
  // Rows: d/d(x, v) stand for any linear map of the state; here +-3 times the
  // prediction. Columns of free: k1, gain, offset, delay.
  Shown Apply(const Vector& sensors) const {
    const ParameterLayout layout(problem_);
    Shown shown;
    shown.prediction.resize(2 * kSamples);
    for (int i = 0; i < kSamples; ++i) {
      for (int c = 0; c < 2; ++c) {
        shown.prediction[2 * i + c] = Ideal(c, i * kStep);
      }
    }
    shown.rows = Matrix::Zero(2 * kSamples, 2 + layout.num_free());
    shown.rows.col(0) = 3.0 * shown.prediction;
    shown.rows.col(1) = -3.0 * shown.prediction;
    shown.valid.assign(2 * kSamples, true);
    Vector parameters = layout.InitialValues();
    parameters.tail(3) = sensors;
    ApplySensors(layout, parameters, record_, true, shown.prediction,
                 shown.rows, &shown.valid);
    return shown;
  }

  IdentificationProblem problem_;
  IdentificationRecord record_;
};

TEST_F(SensorTest, IdealSensorsChangeNothing) {
  const Shown shown = Apply(Vector(problem_.sensors.Values()));
  for (int i = 0; i < kSamples; ++i) {
    for (int c = 0; c < 2; ++c) {
      EXPECT_NEAR(shown.prediction[2 * i + c], Ideal(c, i * kStep), 1e-14);
    }
  }
  EXPECT_EQ(shown.rows.rightCols(4).norm(), 0.0);
}

TEST_F(SensorTest, ShowsGainOffsetAndDelay) {
  UseSensor();
  const Shown shown = Apply(problem_.sensors.Values());
  // The other channel stays as it is.
  for (int i = 0; i < kSamples; ++i) {
    EXPECT_EQ(shown.prediction[2 * i], Ideal(0, i * kStep));
    EXPECT_EQ(shown.rows(2 * i, 0), 3.0 * Ideal(0, i * kStep));
  }
  for (int i = 0; i < kSamples; ++i) {
    const double ideal = Ideal(1, i * kStep - 0.007);
    EXPECT_NEAR(shown.prediction[2 * i + 1], 1.3 * ideal - 0.2, 1e-4) << i;
    // Derivatives by the state are delayed and scaled, but have no offset.
    EXPECT_NEAR(shown.rows(2 * i + 1, 0), 3.0 * 1.3 * ideal, 4e-4) << i;
    EXPECT_NEAR(shown.rows(2 * i + 1, 1), -3.0 * 1.3 * ideal, 4e-4) << i;
  }
}

TEST_F(SensorTest, DerivativesEqualDifferences) {
  UseSensor();
  const Vector sensors = problem_.sensors.Values();
  const Shown shown = Apply(sensors);
  for (int p = 0; p < 3; ++p) {
    const Vector expected = testing::Differentiate(
        [&](double h) {
          Vector moved = sensors;
          moved[p] += h;
          return Apply(moved).prediction;
        },
        1e-3);
    EXPECT_LT((shown.rows.col(3 + p) - expected).norm(),
              1e-8 * (1.0 + expected.norm()))
        << problem_.sensors.parameters[static_cast<size_t>(p)].name;
  }
  // A stiffness does not act through the sensor.
  EXPECT_EQ(shown.rows.col(2).norm(), 0.0);
}

TEST_F(SensorTest, FixedSensorParametersHaveNoColumn) {
  UseSensor();
  problem_.sensors.parameters[0].free = false;
  const Shown shown = Apply(problem_.sensors.Values());
  ASSERT_EQ(shown.rows.cols(), 2 + 3);
  EXPECT_EQ(shown.rows(1, 3), 1.0);  // offset
  EXPECT_NE(shown.rows(1, 4), 0.0);  // delay
}

// A sine at a tenth of the sampling rate, a fraction of a sample late.
TEST_F(SensorTest, ReproducesADelayedSine) {
  record_.channels[1].delay = 2;
  const ParameterLayout layout(problem_);
  for (double fraction : {-1.4, -0.5, 0.25, 0.5, 0.8, 3.3}) {
    Vector prediction(2 * kSamples);
    for (int i = 0; i < kSamples; ++i) {
      prediction[2 * i] = 0.0;
      prediction[2 * i + 1] = std::sin(kTwoPi * 0.1 * i);
    }
    Matrix rows(2 * kSamples, 0);
    std::vector<bool> valid(2 * kSamples, true);
    Vector parameters = layout.InitialValues();
    parameters[layout.num_dynamics() + 2] = fraction * kStep;
    ApplySensors(layout, parameters, record_, false, prediction, rows, &valid);
    double worst = 0.0;
    int count = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double position = i - fraction;
      const bool inside = position >= -0.5 && position <= kSamples - 0.5;
      EXPECT_EQ(valid[static_cast<size_t>(2 * i + 1)], inside)
          << fraction << " at " << i;
      EXPECT_TRUE(valid[static_cast<size_t>(2 * i)]);
      if (position < 1.0 || position > kSamples - 2.0) continue;
      const double error =
          prediction[2 * i + 1] - std::sin(kTwoPi * 0.1 * position);
      worst = std::max(worst, std::abs(error));
      ++count;
    }
    // Between nodes of a cubic: u^2 (1 - u)^2 ... / 24 times (2 pi / 10)^4, at
    // most 0.0037.
    EXPECT_LT(worst, 4e-3) << fraction;
    EXPECT_GT(count, 30);
  }
}

TEST_F(SensorTest, TooFewSamplesForADelayAreInvalid) {
  record_.channels[1].delay = 2;
  const ParameterLayout layout(problem_);
  Vector prediction = Vector::Ones(2 * 3);
  Matrix rows(2 * 3, 0);
  std::vector<bool> valid(2 * 3, true);
  ApplySensors(layout, layout.InitialValues(), record_, false, prediction, rows,
               &valid);
  EXPECT_EQ(valid, (std::vector<bool>{true, false, true, false, true, false}));
}

}  // namespace
}  // namespace pinode
