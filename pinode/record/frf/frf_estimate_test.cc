// Frequency response functions from records, against SciPy and closed forms.

#include "pinode/record/frf/frf_estimate.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// Even random numbers from -0.5 to 0.5 that a script can repeat.
class EvenNumbers {
 public:
  explicit EvenNumbers(uint32_t seed) : state_(seed) {}
  double operator()() {
    state_ = 1664525U * state_ + 1013904223U;
    return static_cast<double>(state_) / 4294967296.0 - 0.5;
  }

 private:
  uint32_t state_;
};

// Two forces that have something in common, and two responses with noise.
ForcedRecord MakeTwoForces(Index samples, uint32_t seed) {
  EvenNumbers random(seed);
  ForcedRecord record;
  record.name = "shakers";
  record.sampling_step = 0.01;
  record.forces.resize(2, samples);
  record.responses.resize(2, samples);
  double a[2] = {0.0, 0.0};
  double b[2] = {0.0, 0.0};
  for (Index k = 0; k < samples; ++k) {
    const double x = random();
    const double z = 0.4 * x + random();
    const double e0 = random();
    const double e1 = random();
    const double m = 1.6 * a[0] - 0.9 * a[1] + x - 0.5 * z;
    a[1] = a[0];
    a[0] = m;
    const double v = 0.3 * b[0] - 0.8 * b[1] + 0.7 * z;
    b[1] = b[0];
    b[0] = v;
    record.forces.col(k) << x, z;
    record.responses.col(k) << m + 0.8 * e0, m + v + 0.6 * e1;
  }
  return record;
}

ForcedRecord WithFirstForce(ForcedRecord record) {
  record.forces = Matrix(record.forces.topRows(1));
  return record;
}

FrfEstimate Estimate(const std::vector<ForcedRecord>& records,
                     const FrfEstimateOptions& options) {
  FrfEstimate estimate;
  std::string error;
  EXPECT_TRUE(EstimateFrfs(records, options, &estimate, &error)) << error;
  return estimate;
}

// csd, welch and coherence of SciPy 1.10 with window = "hann" on the same
// numbers; `line` is the index in their arrays.
TEST(FrfEstimateTest, AgreesWithSciPy) {
  const struct {
    Index block, response, line;
    Complex h1, h2;
    double coherence;
  } expected[] = {
      {256,
       0,
       3,
       {2.7432732146096, -0.0583423488753891},
       {3.4027230749749, -0.0723671472856832},
       0.806199374490631},
      {256,
       0,
       40,
       {-0.77097445906648, -1.3445863249212},
       {-1.57194640897158, -2.74148854110083},
       0.490458488066956},
      {256,
       1,
       100,
       {0.462519376860505, -0.38592924745169},
       {1.17502013282853, -0.980444621977137},
       0.393626767693861},
      {240,
       0,
       3,
       {2.6618485283929, -0.199121795047749},
       {3.46862355488294, -0.25947327251194},
       0.767407729975681},
      {240,
       0,
       100,
       {0.147870521699075, -0.137550878015884},
       {2.57720051544725, -2.3973418748341},
       0.0573764132099025},
      {240,
       1,
       40,
       {0.0921287032345333, -1.30795085734852},
       {0.373287761035805, -5.29956495579412},
       0.246803439199006},
  };
  const ForcedRecord record = WithFirstForce(MakeTwoForces(4000, 1));
  for (const auto& one : expected) {
    FrfEstimateOptions options;
    options.block_samples = one.block;
    options.overlap = one.block == 256 ? 0.5 : 0.25;
    const FrfEstimate h1 = Estimate({record}, options);
    options.estimator = FrfEstimator::kH2;
    const FrfEstimate h2 = Estimate({record}, options);
    options.estimator = FrfEstimator::kHv;
    const FrfEstimate hv = Estimate({record}, options);
    const Index line = one.line - 1;
    EXPECT_NEAR(
        h1.frequencies_hz[line],
        100.0 * static_cast<double>(one.line) / static_cast<double>(one.block),
        1e-12);
    EXPECT_LT(std::abs(h1.values(line, one.response) - one.h1), 1e-12);
    EXPECT_LT(std::abs(h2.values(line, one.response) - one.h2), 1e-11);
    // Hv of one force is the geometric mean of both, in their phase.
    EXPECT_LT(std::abs(hv.values(line, one.response) -
                       std::sqrt(std::abs(one.h1) * std::abs(one.h2)) * one.h1 /
                           std::abs(one.h1)),
              1e-11);
    EXPECT_NEAR(h1.coherence(line, one.response), one.coherence, 1e-12);
  }
}

// The same spectra of SciPy, solved for two forces in NumPy; the partial
// coherences from spectra that are conditioned on the other force.
TEST(FrfEstimateTest, TwoForcesAgreeWithSciPy) {
  const struct {
    Index response, line;
    Complex h[2];
    double coherence[2];
  } expected[] = {
      {0,
       3,
       {{3.36541033276782, -0.00221457885788601},
        {-1.46931479987237, 0.00373853520163392}},
       {0.96069524754457, 0.798408298628208}},
      {0,
       100,
       {{0.226638609928542, -0.0337787575951131},
        {0.0441643101342641, -0.0273578228798413}},
       {0.0427012947077617, 0.00402739748898906}},
      {1,
       40,
       {{-0.866587577366198, -1.72176124558658},
        {1.04688162798396, 1.5303365278728}},
       {0.874954315759612, 0.926944339635866}},
  };
  FrfEstimateOptions options;
  options.block_samples = 256;
  const FrfEstimate estimate = Estimate({MakeTwoForces(4000, 1)}, options);
  for (const auto& one : expected) {
    for (Index j = 0; j < 2; ++j) {
      const Index pair = one.response + 2 * j;
      EXPECT_LT(std::abs(estimate.values(one.line - 1, pair) - one.h[j]),
                1e-11);
      EXPECT_NEAR(estimate.coherence(one.line - 1, pair), one.coherence[j],
                  1e-11);
    }
  }
}

// Variances are those of many draws, with blocks that overlap, for one line of
// every response and force.
TEST(FrfEstimateTest, VariancesAreThoseOfDraws) {
  constexpr int kDraws = 300;
  FrfEstimateOptions options;
  options.block_samples = 128;
  const Index line = 24;
  ComplexMatrix values(kDraws, 4);
  Vector variances = Vector::Zero(4);
  for (int draw = 0; draw < kDraws; ++draw) {
    const FrfEstimate estimate = Estimate(
        {MakeTwoForces(2048, 7919U * static_cast<uint32_t>(draw) + 3U)},
        options);
    EXPECT_EQ(estimate.num_blocks, 31);
    values.row(draw) = estimate.values.row(line);
    variances += estimate.variances.row(line).transpose() / kDraws;
  }
  for (Index p = 0; p < 4; ++p) {
    const ComplexVector scatter = values.col(p).array() - values.col(p).mean();
    const double found = scatter.squaredNorm() / (kDraws - 1);
    // The variance of 300 complex draws has a deviation of 6 %.
    EXPECT_NEAR(variances[p] / found, 1.0, 0.18) << p;
  }
}

// A discrete vibrator y_k = 2 r cos(a) y_{k-1} - r^2 y_{k-2} + x_k, whose FRF
// is known, at 1000 Hz.
constexpr double kRadius = 0.996;
constexpr double kAngle = 0.35;
constexpr double kStep = 0.001;

Complex VibratorAt(double hz, double decay_rate = 0.0) {
  const Complex shift = std::exp(-Complex(decay_rate, kTwoPi * hz) * kStep);
  return 1.0 / (1.0 - 2.0 * kRadius * std::cos(kAngle) * shift +
                kRadius * kRadius * shift * shift);
}

ForcedRecord Respond(const Vector& force) {
  ForcedRecord record;
  record.name = "vibrator";
  record.sampling_step = kStep;
  record.forces = force.transpose();
  record.responses = Matrix::Zero(1, force.size());
  for (Index k = 0; k < force.size(); ++k) {
    double y = force[k];
    if (k > 0) {
      y += 2.0 * kRadius * std::cos(kAngle) * record.responses(0, k - 1);
    }
    if (k > 1) y -= kRadius * kRadius * record.responses(0, k - 2);
    record.responses(0, k) = y;
  }
  return record;
}

void AddBlow(Index at, double size, Vector* force) {
  for (Index k = 0; k < 12; ++k) {
    (*force)[at + k] +=
        size * std::sin(kPi * (static_cast<double>(k) + 0.5) / 12.0);
  }
}

TEST(FrfEstimateTest, BlowsAreFoundAndBadOnesLeftOut) {
  Vector force = Vector::Zero(36000);
  EvenNumbers random(5);
  for (const Index at : {500, 6500, 12500, 18500, 24500, 30700}) {
    AddBlow(at, 100.0 + 60.0 * random(), &force);
  }
  AddBlow(6560, 20.0, &force);  // the hammer hits again
  const double limit = 0.8 * force.segment(18500, 12).maxCoeff();
  // Measured force of a blow that the instrument cuts off.
  ForcedRecord record = Respond(force);
  for (Index k = 18500; k < 18512; ++k) {
    record.forces(0, k) = std::min(record.forces(0, k), limit);
  }
  const FrfEstimate estimate = Estimate({record}, {});
  EXPECT_EQ(estimate.excitation, FrfExcitation::kBlows);
  // Blows 2 and 4 are bad; the last one has no complete block.
  EXPECT_EQ(estimate.num_blocks, 3);
  EXPECT_THAT(
      estimate.remarks,
      ElementsAre(HasSubstr("1 blow was left out: the hammer hit again"),
                  HasSubstr("1 blow was left out: the force or a"),
                  HasSubstr("1 blow was left out: the record does not"),
                  HasSubstr("3 independent blocks")));
  for (Index k = 20; k < estimate.frequencies_hz.size() / 4; ++k) {
    const Complex exact = VibratorAt(estimate.frequencies_hz[k]);
    EXPECT_LT(std::abs(estimate.values(k, 0) - exact), 1e-6 * std::abs(exact));
  }
}

FrfEstimate EstimateBlows(const Vector& force, Index block_samples,
                          std::string* error) {
  FrfEstimateOptions options;
  options.excitation = FrfExcitation::kBlows;
  options.block_samples = block_samples;
  FrfEstimate estimate;
  if (EstimateFrfs({Respond(force)}, options, &estimate, error)) error->clear();
  return estimate;
}

// A pulse behind another one, wider than their distance, once ended the search
// beyond its list.
TEST(FrfEstimateTest, WidePulseBehindANarrowOne) {
  Vector force = Vector::Zero(2000);
  force.segment(100, 2).setOnes();
  force.segment(110, 50).setConstant(0.5);
  std::string error;
  EstimateBlows(force, 0, &error);
  EXPECT_THAT(error, HasSubstr("the blows follow each other at once"));
}

TEST(FrfEstimateTest, BlocksHoldTheWholeBlow) {
  Vector force = Vector::Zero(133);
  force.segment(100, 32).setOnes();
  std::string error;
  EstimateBlows(force, 32, &error);
  EXPECT_THAT(error, HasSubstr("the block ends before the blow does"));
  EstimateBlows(force, 31, &error);
  EXPECT_THAT(error, HasSubstr("block has 31 samples, expected at least 32"));
}

// The structure still vibrates from a blow that is left out.
TEST(FrfEstimateTest, RestIsFromAnyBlow) {
  Vector force = Vector::Zero(20000);
  for (const Index at : {500, 6500, 10000, 16000}) AddBlow(at, 100.0, &force);
  AddBlow(6560, 20.0, &force);  // the hammer hits again
  std::string error;
  const FrfEstimate estimate = EstimateBlows(force, 3000, &error);
  EXPECT_EQ(error, "");
  EXPECT_EQ(estimate.num_blocks, 3);
  EXPECT_NEAR(estimate.shortest_rest, 3.44, 0.01);
  EXPECT_NEAR(estimate.block_seconds, 3.0, 1e-12);
}

TEST(FrfEstimateTest, BlockIsWithinTheRecords) {
  const std::vector<ForcedRecord> records = {MakeTwoForces(2000, 1)};
  std::string error;
  FrfEstimateOptions options;
  for (const double seconds : {-1.0, 0.004, 20.01, 1e300, kNaN}) {
    EXPECT_FALSE(FindFrfBlock(records, seconds, &options, &error)) << seconds;
    EXPECT_THAT(error, HasSubstr("expected 0.04 s (4 samples) to 20 s"));
  }
  ASSERT_TRUE(FindFrfBlock(records, 10.23, &options, &error)) << error;
  EXPECT_EQ(options.block_samples, 1000);
  options.excitation = FrfExcitation::kPeriodic;
  ASSERT_TRUE(FindFrfBlock(records, 10.23, &options, &error)) << error;
  EXPECT_EQ(options.block_samples, 1023);
}

TEST(FrfEstimateTest, ExponentialWindowIsAKnownShift) {
  Vector force = Vector::Zero(9000);
  for (const Index at : {100, 900, 1700, 2500, 3300, 4100, 4900, 5700, 6500}) {
    AddBlow(at, 50.0, &force);
  }
  FrfEstimateOptions options;
  options.block_samples = 640;
  const FrfEstimate cut = Estimate({Respond(force)}, options);
  EXPECT_THAT(cut.remarks,
              ElementsAre(HasSubstr("wait longer between the blows")));
  options.exponential_window = 0.03;
  options.force_window = 0.03;
  // Nothing is left of the blow before when the next one comes.
  Vector single = Vector::Zero(9000);
  AddBlow(100, 50.0, &single);
  AddBlow(8000, 40.0, &single);
  const FrfEstimate estimate = Estimate({Respond(single)}, options);
  EXPECT_NEAR(estimate.decay_rate, 1.0 / 0.03, 1e-12);
  for (Index k = 10; k < estimate.frequencies_hz.size() / 4; ++k) {
    const Complex exact =
        VibratorAt(estimate.frequencies_hz[k], estimate.decay_rate);
    EXPECT_LT(std::abs(estimate.values(k, 0) - exact), 1e-6 * std::abs(exact));
  }
}

TEST(FrfEstimateTest, PeriodsGiveExactValuesAndTheirVariance) {
  constexpr Index kPeriod = 500;
  EvenNumbers random(11);
  Vector one(kPeriod);
  for (double& value : one) value = random();
  const ForcedRecord clean = Respond(one.replicate(14, 1));
  FrfEstimateOptions options;
  options.excitation = FrfExcitation::kPeriodic;
  options.block_samples = kPeriod;
  ForcedRecord tail = clean;
  // The vibration of the beginning has decayed after five periods.
  tail.forces = Matrix(clean.forces.rightCols(9 * kPeriod));
  tail.responses = Matrix(clean.responses.rightCols(9 * kPeriod));
  const FrfEstimate exact = Estimate({tail}, options);
  ASSERT_GT(exact.frequencies_hz.size(), 200);
  for (Index k = 0; k < exact.frequencies_hz.size(); ++k) {
    const Complex h = VibratorAt(exact.frequencies_hz[k]);
    EXPECT_LT(std::abs(exact.values(k, 0) - h), 1e-3 * std::abs(h));
  }
  for (double& value : tail.responses.reshaped()) value += 2.0 * random();
  const FrfEstimate noisy = Estimate({tail}, options);
  double ratio = 0.0;
  for (Index k = 0; k < noisy.frequencies_hz.size(); ++k) {
    ratio += std::norm(noisy.values(k, 0) - exact.values(k, 0)) /
             noisy.variances(k, 0);
  }
  // 249 lines; the variance of each has 14 degrees of freedom: 14 / 12 on
  // average.
  ratio /= static_cast<double>(noisy.frequencies_hz.size());
  EXPECT_NEAR(ratio, 14.0 / 12.0, 0.35);
}

TEST(FrfEstimateTest, FewBlowsSaySo) {
  Vector force = Vector::Zero(6000);
  AddBlow(300, 10.0, &force);
  const FrfEstimate estimate = Estimate({Respond(force)}, {});
  EXPECT_EQ(estimate.num_blocks, 1);
  EXPECT_EQ(estimate.coherence.rows(), 0);
  EXPECT_THAT(estimate.remarks, ElementsAre(HasSubstr("one block alone")));
}

TEST(FrfEstimateTest, WrongInputGivesOneLine) {
  const ForcedRecord good = MakeTwoForces(2000, 1);
  using Change = std::function<void(ForcedRecord*, FrfEstimateOptions*)>;
  const struct {
    Change change;
    const char* message;
  } cases[] = {
      {[](ForcedRecord* r, FrfEstimateOptions*) { r->forces.resize(0, 2000); },
       "at least one force"},
      {[](ForcedRecord* r, FrfEstimateOptions*) {
         r->forces.conservativeResize(2, 1999);
       },
       "differ in their samples"},
      {[](ForcedRecord* r, FrfEstimateOptions*) { r->responses(1, 7) = kNaN; },
       "missing samples"},
      {[](ForcedRecord* r, FrfEstimateOptions*) { r->forces.row(1).setZero(); },
       "a force never changes"},
      {[](ForcedRecord* r, FrfEstimateOptions*) {
         r->forces.row(1) = -3.0 * r->forces.row(0);
       },
       "multiples of each other"},
      {[](ForcedRecord*, FrfEstimateOptions* o) {
         o->estimator = FrfEstimator::kH2;
       },
       "H2 is for one force"},
      {[](ForcedRecord*, FrfEstimateOptions* o) { o->overlap = 1.0; },
       "overlap is 1"},
      {[](ForcedRecord*, FrfEstimateOptions* o) { o->block_samples = 4000; },
       "a block has 4000 samples"},
      {[](ForcedRecord*, FrfEstimateOptions* o) {
         o->exponential_window = 1.0;
       },
       "is for blows of a hammer"},
      {[](ForcedRecord*, FrfEstimateOptions* o) { o->force_window = 1.0; },
       "is for blows of a hammer"},
      {[](ForcedRecord*, FrfEstimateOptions* o) {
         o->excitation = FrfExcitation::kPeriodic;
       },
       "periodic excitation is for one force"},
      {[](ForcedRecord* r, FrfEstimateOptions* o) {
         o->excitation = FrfExcitation::kPeriodic;
         *r = WithFirstForce(*r);
       },
       "needs its period"},
  };
  for (const auto& one : cases) {
    ForcedRecord record = good;
    FrfEstimateOptions options;
    one.change(&record, &options);
    FrfEstimate estimate;
    std::string error;
    EXPECT_FALSE(EstimateFrfs({record}, options, &estimate, &error))
        << one.message;
    EXPECT_THAT(error, HasSubstr(one.message));
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(FrfEstimateTest, LengthsAreFastToTransform) {
  EXPECT_EQ(FastLength(1023), 1000);
  EXPECT_EQ(FastLength(1024), 1024);
  EXPECT_EQ(FastLength(7), 6);
  EXPECT_EQ(FastLength(0), 0);
}

}  // namespace
}  // namespace pinode
