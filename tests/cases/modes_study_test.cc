// What pinode_modes' identification reaches over many records: how often its
// intervals hold the truth, how often it misses modes or sees some that are not
// there. Run by hand (ctest --preset study); tests/benchmarks/README.md has the
// figures.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/stabilisation.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

// How often intervals hold the truth, and the errors in standard deviations.
struct Coverage {
  int inside = 0;
  int count = 0;
  double squares = 0.0;
  // `quantile`: half the width of the interval in standard deviations.
  void Add(double error, double sigma, double quantile) {
    ++count;
    if (std::abs(error) <= quantile * sigma) ++inside;
    squares += error * error / (sigma * sigma);
  }
  void Add(const Coverage& other) {
    inside += other.inside;
    count += other.count;
    squares += other.squares;
  }
  double percent() const { return 100.0 * inside / std::max(1, count); }
  double deviation() const { return std::sqrt(squares / std::max(1, count)); }
};

struct ModesStudy {
  std::vector<Coverage> frequency, damping;  // per mode
  std::vector<Coverage> shape;               // per mode, all entries
  int missed = 0;
  int spurious = 0;
  int modes = 0;
};

ModesStudy RunStudy(
    const TestChain& chain, int seeds,
    const std::function<ResponseRecord(unsigned seed)>& simulate) {
  ModesStudy study;
  const size_t count = static_cast<size_t>(chain.masses());
  study.frequency.resize(count);
  study.damping.resize(count);
  study.shape.resize(count);
  std::mutex mutex;
  ParallelFor(seeds, DefaultThreads(), [&](int seed, int) {
    const ResponseRecord record = simulate(static_cast<unsigned>(seed + 1));
    ModesOfRecord result;
    std::string error;
    ASSERT_TRUE(IdentifyModes(record, {}, &result, &error)) << error;
    const std::lock_guard<std::mutex> lock(mutex);
    std::vector<bool> used(result.modes.size(), false);
    for (size_t m = 0; m < count; ++m) {
      const int row = static_cast<int>(m);
      const Vector shape = chain.shapes.col(row);
      ++study.modes;
      int best = -1;
      double nearest = 0.02;
      for (size_t i = 0; i < used.size(); ++i) {
        if (used[i]) continue;
        const double apart =
            std::abs(result.modes[i].frequency_hz / chain.frequency_hz[row] -
                     1.0) +
            0.1 * (1.0 - ComplexMac(result.modes[i].shape,
                                    shape.cast<std::complex<double>>()));
        if (apart < nearest) {
          nearest = apart;
          best = static_cast<int>(i);
        }
      }
      if (best < 0) {
        ++study.missed;
        continue;
      }
      used[static_cast<size_t>(best)] = true;
      const IdentifiedMode& mode = result.modes[static_cast<size_t>(best)];
      const double t = StudentQuantile(mode.degrees_of_freedom);
      study.frequency[m].Add(mode.frequency_hz - chain.frequency_hz[row],
                             mode.frequency_sigma, t);
      study.damping[m].Add(mode.damping_ratio - chain.damping_ratio,
                           mode.damping_sigma, t);
      Eigen::Index largest = 0;
      mode.shape.cwiseAbs().maxCoeff(&largest);
      for (Eigen::Index i = 0; i < shape.size(); ++i) {
        if (i == largest) continue;
        study.shape[m].Add(mode.shape[i].real() - shape[i] / shape[largest],
                           mode.shape_sigma_real[i], t);
        study.shape[m].Add(mode.shape[i].imag(), mode.shape_sigma_imaginary[i],
                           t);
      }
    }
    study.spurious +=
        static_cast<int>(std::count(used.begin(), used.end(), false));
  });
  return study;
}

ModesStudy RunStudy(const TestChain& chain, double step, Eigen::Index samples,
                    const std::vector<int>& derivatives,
                    const TestExcitation& excitation, int seeds) {
  return RunStudy(chain, seeds, [&](unsigned seed) {
    return SimulateChain(chain, step, samples, seed, derivatives, excitation);
  });
}

// All intervals of a study.
Coverage OverAll(const ModesStudy& study) {
  Coverage all;
  for (const auto* parts : {&study.frequency, &study.damping, &study.shape}) {
    for (const Coverage& part : *parts) all.Add(part);
  }
  return all;
}

void Report(const std::string& name, const TestChain& chain,
            const ModesStudy& study) {
  std::printf("%s\n", name.c_str());
  for (size_t m = 0; m < study.frequency.size(); ++m) {
    std::printf("  %8.4f Hz:", chain.frequency_hz[static_cast<int>(m)]);
    const std::pair<const char*, const Coverage*> parts[] = {
        {"frequency", &study.frequency[m]},
        {"damping", &study.damping[m]},
        {"shape", &study.shape[m]}};
    for (const auto& [what, part] : parts) {
      std::printf(" %s %5.1f %% (%.2f)", what, part->percent(),
                  part->deviation());
    }
    std::printf("\n");
  }
  const Coverage all = OverAll(study);
  std::printf("  all %.1f %% (%.2f); missed %d of %d, spurious %d\n",
              all.percent(), all.deviation(), study.missed, study.modes,
              study.spurious);
}

void ExpectHonest(const ModesStudy& study) {
  for (size_t m = 0; m < study.frequency.size(); ++m) {
    EXPECT_GE(study.frequency[m].percent(), 89.0);
    EXPECT_GE(study.shape[m].percent(), 89.0);
    EXPECT_GE(study.damping[m].percent(), 85.0);
  }
  EXPECT_GE(OverAll(study).percent(), 93.0);
  EXPECT_LE(study.missed, 0.05 * study.modes);
  EXPECT_LE(study.spurious, 0.02 * study.modes);
}

// Of 200 records: each of the figures, and all intervals together.
void ExpectInBetween(const ModesStudy& study) {
  for (const auto* parts : {&study.frequency, &study.damping, &study.shape}) {
    for (const Coverage& part : *parts) {
      EXPECT_GE(part.percent(), 89.0);
      EXPECT_LE(part.percent(), 99.0);
    }
  }
  EXPECT_LE(OverAll(study).percent(), 97.0);
}

// Loads that nobody measured, on two chains.
TEST(ModesStudy, UnmeasuredForces) {
  const TestChain three(3, 2000.0);
  TestExcitation excitation;
  excitation.memory = 0.9;
  const ModesStudy coloured =
      RunStudy(three, 0.01, 60000, {2}, excitation, 200);
  Report("three storeys, accelerations, 10 min at 100 Hz", three, coloured);
  ExpectHonest(coloured);
  ExpectInBetween(coloured);
  const TestChain five(5, 1500.0, 0.015);
  const ModesStudy mixed = RunStudy(five, 0.02, 60000, {2, 1, 0}, {}, 200);
  Report(
      "five storeys, accelerations, velocities, displacements, 20 min at "
      "50 Hz",
      five, mixed);
  ExpectHonest(mixed);
  ExpectInBetween(mixed);
  Coverage all = OverAll(coloured);
  all.Add(OverAll(mixed));
  std::printf("both: %.1f %% (%.2f) of %d intervals\n", all.percent(),
              all.deviation(), all.count);
  EXPECT_GE(all.percent(), 93.0);
  EXPECT_LE(all.percent(), 97.0);
}

TEST(ModesStudy, CloselySpacedModes) {
  Matrix stiffness(2, 2);
  stiffness << 1.0, 0.01, 0.01, 1.0;
  const double w = kTwoPi * 1.2;
  const TestChain chain(w * w * stiffness, 0.01);
  const ModesStudy study = RunStudy(chain, 0.05, 36000, {2}, {}, 100);
  Report("two modes 1 % apart at 1.2 Hz, 30 min at 20 Hz", chain, study);
  EXPECT_LE(study.missed, 10);  // both in 95 of 100
}

// Deterministic-stochastic: one of three forces is measured.
TEST(ModesStudy, MeasuredAndUnmeasuredForces) {
  const TestChain chain(3, 2000.0);
  TestExcitation excitation;
  excitation.common = 0.0;
  excitation.measured = 1;
  const ModesStudy study = RunStudy(chain, 0.02, 15000, {2}, excitation, 60);
  Report("three storeys, one of three forces measured, 5 min at 50 Hz", chain,
         study);
  ExpectHonest(study);
}

TEST(ModesStudy, GroundMotion) {
  const TestChain chain(3, 2000.0);
  TestExcitation excitation;
  excitation.base = true;
  excitation.memory = 0.9;
  excitation.sensor_noise = 0.1;
  excitation.measured = 1;
  const ModesStudy study = RunStudy(chain, 0.02, 15000, {2}, excitation, 60);
  Report("three storeys, ground motion measured, 10 % noise, 5 min at 50 Hz",
         chain, study);
  ExpectHonest(study);
}

TEST(ModesStudy, RingDowns) {
  const TestChain chain(3, 900.0);
  const ModesStudy study = RunStudy(chain, 100, [&](unsigned seed) {
    return SimulateRingDown(chain, 0.02, 1000, seed, 0.1);
  });
  Report("three storeys left to themselves, 10 % noise, 20 s at 50 Hz", chain,
         study);
  ExpectHonest(study);
}

}  // namespace
}  // namespace pinode
