#include "pinode/watch/sensor_history.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <random>

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr int kFloors = 6;
constexpr int kModes = 4;
constexpr int kReference = 40;
constexpr double kTwoPi = 6.283185307179586;

// Modes of a chain of equal masses, whose springs are given. It stands on the
// first one.
void Solve(const Vector& springs, Vector* hz, Matrix* shapes) {
  const Eigen::Index floors = springs.size();
  Matrix stiffness = Matrix::Zero(floors, floors);
  for (Eigen::Index i = 0; i < floors; ++i) {
    stiffness(i, i) += springs[i];
    if (i == 0) continue;
    stiffness(i - 1, i - 1) += springs[i];
    stiffness(i, i - 1) -= springs[i];
    stiffness(i - 1, i) -= springs[i];
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(stiffness);
  *hz = solver.eigenvalues().cwiseSqrt() / kTwoPi;
  *shapes = solver.eigenvectors();
}

// Sensors and noise of the shapes, relative to a shape of length one.
struct Sensors {
  std::vector<int> floors = {0, 1, 2, 3, 4, 5};  // that have a sensor
  int num_modes = kModes;
  double noise = 0.01;
};

// Records of the chain. From the record behind the reference on, it has other
// springs.
std::vector<StoredRecord> Records(const Vector& springs,
                                  const Sensors& setup = {}) {
  constexpr int count = 60;
  const Eigen::Index num_sensors =
      static_cast<Eigen::Index>(setup.floors.size());
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<StoredRecord> records;
  for (int r = 0; r < count; ++r) {
    Vector hz;
    Matrix shapes;
    Solve(r < kReference ? Vector::Constant(springs.size(), 4000.0).eval()
                         : springs,
          &hz, &shapes);
    StoredRecord record;
    record.time = 3600.0 * r;
    for (const int floor : setup.floors) {
      record.channels.push_back({"a" + std::to_string(floor + 1), ""});
    }
    for (int m = 0; m < setup.num_modes; ++m) {
      StoredMode mode;
      mode.frequency_hz = hz[m] * (1.0 + 1e-3 * normal(random));
      mode.frequency_sigma = 1e-3 * hz[m];
      // Shapes have no scale and no phase.
      const Complex factor = std::polar(1.0 + r % 3, 0.7 * r);
      mode.shape.resize(num_sensors);
      for (Eigen::Index c = 0; c < num_sensors; ++c) {
        mode.shape[c] =
            factor * (shapes(setup.floors[static_cast<size_t>(c)], m) +
                      setup.noise * Complex(normal(random), normal(random)));
      }
      record.modes.push_back(mode);
    }
    records.push_back(record);
  }
  return records;
}

std::vector<StoredRecord> Records() {
  return Records(Vector::Constant(kFloors, 4000.0));
}

std::vector<SensorChange> Changes(std::vector<StoredRecord>* records) {
  std::vector<bool> is_reference(records->size(), false);
  std::fill(is_reference.begin(), is_reference.begin() + kReference, true);
  return LeaveOutChangedSensors(is_reference, TrackingOptions(), records);
}

template <typename Change>
std::vector<StoredRecord> Faulty(const Change& change) {
  std::vector<StoredRecord> records = Records();
  for (size_t r = 50; r < records.size(); ++r) {
    for (StoredMode& mode : records[r].modes) change(&mode);
  }
  return records;
}

TEST(SensorHistory, IsQuietWithoutAFault) {
  std::vector<StoredRecord> records = Records();
  EXPECT_TRUE(Changes(&records).empty());
  EXPECT_EQ(records.back().modes[0].shape.size(), kFloors);
}

TEST(SensorHistory, NamesATurnedSensorAndLeavesItOut) {
  std::vector<StoredRecord> records =
      Faulty([](StoredMode* mode) { mode->shape[2] *= -1.0; });
  const StoredRecord before = records[55];
  const std::vector<SensorChange> changes = Changes(&records);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].channel, "a3");
  // The third faulty record.
  EXPECT_EQ(changes[0].record, 52);
  EXPECT_EQ(changes[0].fault.find("is turned"), 0u) << changes[0].fault;
  EXPECT_EQ(records[49].channels[2].fault, "");
  EXPECT_EQ(records[50].channels[2].fault, changes[0].fault);
  EXPECT_EQ(records[55].channels[2].fault, changes[0].fault);
  ASSERT_EQ(records[55].modes[1].shape.size(), kFloors - 1);
  EXPECT_EQ(records[55].modes[1].shape[1], before.modes[1].shape[1]);
  EXPECT_EQ(records[55].modes[1].shape[2], before.modes[1].shape[3]);
}

TEST(SensorHistory, NamesAnotherGain) {
  for (const double gain : {0.6, 1.4}) {
    std::vector<StoredRecord> records =
        Faulty([gain](StoredMode* mode) { mode->shape[4] *= gain; });
    const std::vector<SensorChange> changes = Changes(&records);
    ASSERT_EQ(changes.size(), 1u) << gain;
    EXPECT_EQ(changes[0].channel, "a5");
    double stated = 0.0;
    ASSERT_EQ(std::sscanf(changes[0].fault.c_str(), "has %lf times", &stated),
              1)
        << changes[0].fault;
    EXPECT_NEAR(stated, gain, 0.06);
  }
}

TEST(SensorHistory, NamesSwappedSensors) {
  std::vector<StoredRecord> records = Faulty(
      [](StoredMode* mode) { std::swap(mode->shape[1], mode->shape[4]); });
  const std::vector<SensorChange> changes = Changes(&records);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].channel, "a2");
  EXPECT_EQ(changes[0].fault, "is swapped with 'a5'.");
  EXPECT_EQ(changes[1].channel, "a5");
  EXPECT_EQ(records.back().modes[0].shape.size(), kFloors - 2);
}

TEST(SensorHistory, NamesALateSensor) {
  constexpr double kDelay = 0.012;
  std::vector<StoredRecord> records = Faulty([](StoredMode* mode) {
    mode->shape[3] *= std::polar(1.0, -kTwoPi * mode->frequency_hz * kDelay);
  });
  const std::vector<SensorChange> changes = Changes(&records);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].channel, "a4");
  double stated = 0.0;
  ASSERT_EQ(std::sscanf(changes[0].fault.c_str(), "is late by %lf s", &stated),
            1)
      << changes[0].fault;
  EXPECT_NEAR(stated, kDelay, 0.1 * kDelay);
}

// Damage must not be explained away by a sensor.
TEST(SensorHistory, BlamesNoSensorForDamage) {
  for (int spring = 0; spring < kFloors; ++spring) {
    for (const double loss : {0.02, 0.1, 0.3, 0.6}) {
      Vector springs = Vector::Constant(kFloors, 4000.0);
      springs[spring] *= 1.0 - loss;
      std::vector<StoredRecord> records = Records(springs);
      const std::vector<SensorChange> changes = Changes(&records);
      EXPECT_TRUE(changes.empty())
          << spring << " " << loss << ": " << changes[0].channel << " "
          << changes[0].fault;
    }
  }
}

// Few sensors on a higher chain. Three of them cannot tell a gain from damage.
TEST(SensorHistory, FewSensorsBlameNoneForDamage) {
  Sensors setup;
  setup.num_modes = 3;
  setup.noise = 0.003;
  for (const std::vector<int>& floors :
       {std::vector<int>{0, 4, 7}, std::vector<int>{0, 2, 5, 7}}) {
    setup.floors = floors;
    for (int spring = 0; spring < 8; ++spring) {
      for (const double loss : {0.1, 0.3, 0.5}) {
        Vector springs = Vector::Constant(8, 4000.0);
        springs[spring] *= 1.0 - loss;
        std::vector<StoredRecord> records = Records(springs, setup);
        const std::vector<SensorChange> changes = Changes(&records);
        EXPECT_TRUE(changes.empty())
            << floors.size() << " sensors, " << spring << " " << loss << ": "
            << changes[0].channel << " " << changes[0].fault;
      }
    }
  }
}

TEST(SensorHistory, AFaultThatEndsIsOver) {
  std::vector<StoredRecord> records = Records();
  for (size_t r = 45; r < 50; ++r) {
    for (StoredMode& mode : records[r].modes) mode.shape[0] *= -1.0;
  }
  EXPECT_EQ(Changes(&records).size(), 1u);
  EXPECT_EQ(records.back().channels[0].fault, "");
}

TEST(SensorHistory, TwoModesCannotTell) {
  std::vector<StoredRecord> records =
      Faulty([](StoredMode* mode) { mode->shape[2] *= -1.0; });
  for (StoredRecord& record : records) record.modes.resize(2);
  EXPECT_TRUE(Changes(&records).empty());
}

}  // namespace
}  // namespace pinode
