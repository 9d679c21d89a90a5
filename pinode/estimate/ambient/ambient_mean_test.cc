#include "pinode/estimate/ambient/ambient_mean.h"

#include <cmath>
#include <memory>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/dynamics/feature.h"
#include "pinode/record/filter.h"
#include "tests/support/ambient_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/ranks_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Forces that are measured on all masses, beside as large ones that are not.
AmbientRecord HalfMeasured(const TestChain& chain, double seconds,
                           unsigned seed,
                           const std::vector<int>& derivatives = {2}) {
  const auto simulate = [&](unsigned realisation) {
    return RecordOfChain(chain, seconds, realisation, 0.5, derivatives,
                         /*base=*/false, /*noise=*/0.02, chain.masses());
  };
  AmbientRecord record = simulate(seed);
  record.samples += simulate(seed + 100).samples;
  return record;
}

IdentificationSummary Fitted(const IdentificationProblem& problem) {
  const IdentificationSummary summary = SummaryOfFit(problem);
  return summary;
}

// A sine that begins with the record, from rest: the closed form of one mass.
TEST(AmbientMeanTest, TheRunIsTakenOffBeforeTheTapers) {
  constexpr double kStep = 0.01;
  constexpr double kFrequency = 1.3;  // of the force
  const double w = 2.0 * kPi * 1.1;
  const double ratio = 0.002;
  const double wf = 2.0 * kPi * kFrequency;
  const double wd = w * std::sqrt(1.0 - ratio * ratio);
  StructuralModel model = MakeStructuralModel(
      Matrix::Identity(1, 1), Matrix::Constant(1, 1, 2.0 * ratio * w),
      Matrix::Constant(1, 1, w * w));
  IdentificationProblem problem;
  problem.dynamics = std::make_shared<StructuralDynamics>(
      model, std::vector<InputSpec>{{InputSpec::Kind::kForce, 0, "force_u1"}});
  AmbientRecord record;
  record.name = "sine";
  record.sampling_step = kStep;
  constexpr Eigen::Index kSamples = 6000;  // 60 s, less than the memory's 72 s
  record.samples.resize(1, kSamples);
  Matrix force(1, kSamples);
  // x'' + 2 ratio w x' + w^2 x = sin(wf t).
  const double a = w * w - wf * wf;
  const double b = 2.0 * ratio * w * wf;
  const double scale = 1.0 / (a * a + b * b);
  const double p = b * scale;
  const double q = (ratio * w * p - wf * a * scale) / wd;
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    const double t = kStep * static_cast<double>(k);
    force(0, k) = std::sin(wf * t);
    record.samples(0, k) =
        scale * (a * std::sin(wf * t) - b * std::cos(wf * t)) +
        std::exp(-ratio * w * t) *
            (p * std::cos(wd * t) + q * std::sin(wd * t));
  }
  // One that is missing is bridged in both.
  record.samples(0, 3001) = kNaN;
  record.inputs.emplace(0.0, kStep, force, Interpolation::kCubic);
  Observation channel;
  channel.name = "u1";
  channel.quantity = Quantity::kDisplacement;
  channel.weights = Vector::Ones(1);
  record.channels.push_back(channel);
  const Vector scales = Vector::Ones(1);
  AmbientMean mean(record, *problem.dynamics,
                   LineTransform(record.samples, kStep, 0.5, 3.0), scales, 1);
  std::string error;
  ASSERT_TRUE(mean.SetPoint(Vector(), &error)) << error;
  // What cubic pieces leave of a sine.
  EXPECT_LT(mean.rest().norm(), 1e-4 * mean.measured().norm());
}

TEST(AmbientMeanTest, SlopesAreThoseOfTheRun) {
  const TestChain chain = RayleighChain(3);
  AmbientRecord record = HalfMeasured(chain, 60.0, 1, {2, 1, 0});
  record.samples.row(1).segment(5000, 1500).setConstant(kNaN);
  record.samples(0, 7777) = kNaN;
  const IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.05, record);
  const ParameterLayout layout(problem);
  const Vector free = layout.Free(layout.InitialValues());
  const Vector scales = Vector::LinSpaced(3, 0.5, 2.0);
  AmbientMean mean(problem.ambient[0], *problem.dynamics,
                   LineTransform(problem.ambient[0].samples, 0.004, 0.5, 15.0),
                   scales, 2);
  ASSERT_EQ(mean.num_free(), 5);
  std::string error;
  ASSERT_TRUE(mean.SetSlopes(free, &error)) << error;
  for (Eigen::Index j = 0; j < free.size(); ++j) {
    constexpr double kMove = 1e-5;
    Vector moved = free;
    moved[j] += kMove;
    ASSERT_TRUE(mean.SetPoint(moved, &error)) << error;
    Eigen::MatrixXcd slope = -mean.rest();
    moved[j] -= 2.0 * kMove;
    ASSERT_TRUE(mean.SetPoint(moved, &error)) << error;
    slope = (slope + mean.rest()) / (2.0 * kMove);
    double off = 0.0;
    for (Eigen::Index line = 0; line < slope.cols(); ++line) {
      off += (slope.col(line) - mean.slopes(line).col(j)).squaredNorm();
    }
    EXPECT_LT(std::sqrt(off), 1e-5 * slope.norm()) << "parameter " << j;
  }
}

// A run through the record's filter leaves nothing of such a run.
TEST(AmbientMeanTest, TheFilterIsPartOfTheRun) {
  const TestChain chain = RayleighChain(2);
  AmbientRecord record = HalfMeasured(chain, 20.0, 1);
  record.samples.setZero();
  const Vector scales = Vector::Ones(2);
  const LineTransform transform(record.samples, 0.004, 0.5, 15.0);
  const IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.0, record);
  const ParameterLayout layout(problem);
  const Vector free = layout.Free(layout.InitialValues());
  // Without a record the rest is minus the run.
  AmbientRecord filtered = problem.ambient[0];
  filtered.filter = std::make_shared<ZeroPhaseFilter>(
      FilterOptions{FilterType::kLowPass, {4.0}, 4}, 0.004);
  AmbientMean whole(problem.ambient[0], *problem.dynamics, transform, scales,
                    1);
  AmbientMean part(filtered, *problem.dynamics, transform, scales, 1);
  std::string error;
  ASSERT_TRUE(whole.SetPoint(free, &error)) << error;
  ASSERT_TRUE(part.SetPoint(free, &error)) << error;
  Eigen::MatrixXcd expected = whole.rest();
  const Vector frequency = transform.Apply(record.samples).frequency;
  for (Eigen::Index line = 0; line < frequency.size(); ++line) {
    expected.col(line) *= filtered.filter->Gain(frequency[line]);
  }
  // Not all is left, and what is left is what the filter lets through.
  EXPECT_LT(expected.norm(), 0.9 * whole.rest().norm());
  EXPECT_LT((part.rest() - expected).norm(), 0.02 * expected.norm());
}

// At the truth the information is what the cost bends by, but for chance: where
// the measured loads are ten times as large as the others nearly all of it is
// theirs.
TEST(AmbientMeanTest, InformationIsTheCurvatureOfTheCost) {
  const TestChain chain = RayleighChain(2);
  AmbientRecord record = HalfMeasured(chain, 300.0, 5);
  AmbientRecord loud = RecordOfChain(chain, 300.0, 5, 0.5, {2}, /*base=*/false,
                                     /*noise=*/0.0, chain.masses());
  record.samples += 9.0 * loud.samples;
  const Matrix force = 10.0 * record.inputs->samples();
  record.inputs.emplace(0.0, 0.004, force, Interpolation::kHeld);
  const IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.0, record);
  const ParameterLayout layout(problem);
  Vector free = layout.Free(layout.InitialValues());
  free.tail(2).setOnes();
  AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 2);
  double at_truth = 0.0;
  ASSERT_TRUE(cost.Evaluate(1.001 * free, &at_truth)) << cost.Failure();
  CondensedSystem system;
  ASSERT_TRUE(cost.Linearize(free, &system)) << cost.Failure();
  ASSERT_TRUE(cost.Evaluate(free, &at_truth));
  for (Eigen::Index i = 0; i < free.size(); ++i) {
    const double step = 3.0 / std::sqrt(system.hessian(i, i));
    double forth = 0.0;
    double back = 0.0;
    Vector moved = free;
    moved[i] += step;
    ASSERT_TRUE(cost.Evaluate(moved, &forth));
    moved[i] -= 2.0 * step;
    ASSERT_TRUE(cost.Evaluate(moved, &back));
    const double bend = (forth - 2.0 * at_truth + back) / (step * step);
    EXPECT_NEAR(bend / system.hessian(i, i), 1.0, 0.15) << "parameter " << i;
  }
}

TEST(AmbientMeanTest, GradientIsThatOfTheCost) {
  const TestChain chain = RayleighChain(3);
  ExpectGradientOfCost(ProblemOfChain(
      chain, kChainSpring, 0.002, HalfMeasured(chain, 300.0, 1, {2, 1, 0})));
}

TEST(AmbientMeanTest, RanksFindTheSameBits) {
  const TestChain chain = RayleighChain(3);
  const IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.05, HalfMeasured(chain, 80.0, 4));
  const ParameterLayout layout(problem);
  const auto find = [&](Communicator* ranks) {
    CondensedSystem system;
    AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 1, ranks);
    EXPECT_TRUE(cost.Linearize(layout.Free(layout.InitialValues()), &system))
        << cost.Failure();
    return system;
  };
  const CondensedSystem alone = find(nullptr);
  std::vector<CondensedSystem> all(3);
  testing::ThreadRanks(3).Run([&](Communicator* ranks) {
    all[static_cast<size_t>(ranks->rank())] = find(ranks);
  });
  for (const CondensedSystem& found : all) {
    EXPECT_EQ(found.cost, alone.cost);
    EXPECT_EQ(found.gradient, alone.gradient);
    EXPECT_EQ(found.hessian, alone.hessian);
  }
}

// What is measured of the loads says more than the same record without it.
TEST(AmbientMeanFigures, MeasuredLoadsTellMore) {
  const TestChain chain = RayleighChain(2);
  IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.15, HalfMeasured(chain, 300.0, 2));
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error)) << error;
  const IdentificationSummary both = Fitted(problem);
  ASSERT_TRUE(both.usable()) << both.message;
  ASSERT_EQ(both.ambient.size(), 1u);
  EXPECT_GT(both.ambient[0].probability, 0.01);
  EXPECT_GT(both.ambient[0].coherence_probability, 0.01);
  EXPECT_GT(both.ambient[0].explained.minCoeff(), 0.9);
  EXPECT_GT(both.ambient[0].by_measured_loads.minCoeff(), 0.35);
  EXPECT_LT(both.ambient[0].by_measured_loads.maxCoeff(), 0.65);
  problem.ambient[0].inputs.reset();
  const IdentificationSummary without = Fitted(problem);
  ASSERT_TRUE(without.usable()) << without.message;
  EXPECT_EQ(without.ambient[0].by_measured_loads.size(), 0);
  EXPECT_EQ(without.ambient[0].coherence_probability, 1.0);
  for (size_t i = 0; i < both.parameters.size(); ++i) {
    const ParameterEstimate& k = both.parameters[i];
    EXPECT_LT(k.sigma, 0.9 * without.parameters[i].sigma) << k.name;
    // Of the masses' and the springs' damping there is all that there was.
    EXPECT_NEAR(k.value, i < 2 ? 0.0 : 1.0, 4.0 * k.sigma) << k.name;
  }
}

// Loads of the wrong size, sign or place would pass for more of those that
// nobody measured.
TEST(AmbientMeanFigures, AWrongLoadIsSeen) {
  const TestChain chain = RayleighChain(2);
  const IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.02, HalfMeasured(chain, 200.0, 3));
  const Matrix force = problem.ambient[0].inputs->samples();
  for (const double factor : {1.3, 0.7, -1.0}) {
    IdentificationProblem wrong = problem;
    wrong.ambient[0].inputs.emplace(0.0, 0.004, factor * force,
                                    Interpolation::kHeld);
    const IdentificationSummary summary = Fitted(wrong);
    EXPECT_FALSE(summary.usable()) << factor;
    EXPECT_THAT(summary.message,
                HasSubstr("the rest of record 'wind', without the response to "
                          "its measured loads, still follows these loads"));
  }
}

TEST(AmbientMeanTest, SaysWhatIsWrong) {
  const TestChain chain = RayleighChain(2);
  IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.0, HalfMeasured(chain, 40.0, 1));
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error)) << error;
  const AmbientRecord good = problem.ambient[0];
  Matrix force = good.inputs->samples();
  problem.ambient[0].inputs.emplace(0.0, 0.004, force.leftCols(100).eval(),
                                    Interpolation::kHeld);
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("need a finite row for each input"));
  force(0, 3) = kNaN;
  problem.ambient[0].inputs.emplace(0.0, 0.004, force, Interpolation::kHeld);
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("need a finite row for each input"));

  auto with_law = std::make_shared<StructuralDynamics>(*problem.dynamics);
  ASSERT_TRUE(
      with_law->AddElement("stop", "cubic", Feature::kGround, 0, {1.0}, &error))
      << error;
  problem.dynamics = with_law;
  problem.ambient[0] = good;
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("need a linear model"));
}

}  // namespace
}  // namespace pinode
