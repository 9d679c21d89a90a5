#include "pinode/estimate/ambient/ambient_cost.h"

#include <cmath>
#include <memory>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/ambient/ambient_evidence.h"
#include "pinode/estimate/ambient/ambient_score.h"
#include "tests/support/ambient_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/ranks_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

TEST(AmbientCostTest, GradientIsThatOfTheCost) {
  const TestChain chain = RayleighChain(3);
  ExpectGradientOfCost(
      ProblemOfChain(chain, kChainSpring, 0.002,
                     RecordOfChain(chain, 300.0, 1, 0.5, {2, 1, 0})));
}

// The spectrum of a line is then the mean of two.
TEST(AmbientCostTest, GradientWithFewerLoadsThanChannels) {
  const TestChain chain = RayleighChain(2);
  AmbientRecord record = RecordOfChain(chain, 300.0, 1, 0.5);
  // Between the two, with noise of its own.
  Observation middle = record.channels[0];
  middle.name = "middle";
  middle.weights = Vector::Constant(2, 0.5);
  record.channels.push_back(middle);
  record.samples.conservativeResize(3, Eigen::NoChange);
  record.samples.row(2) = 0.5 * record.samples.topRows(2).colwise().sum();
  std::mt19937 generator(2);
  std::normal_distribution<double> noise(
      0.0, 0.02 * StandardDeviationOfPresent(record.samples.row(0)));
  for (double& value : record.samples.row(2)) value += noise(generator);
  record.loads = Matrix::Identity(2, 2);
  record.areas = {"u1", "u2"};
  for (const bool correlated : {true, false}) {
    record.correlated = correlated;
    ExpectGradientOfCost(ProblemOfChain(chain, kChainSpring, 0.002, record));
  }
}

// The band is summed in the same pieces, whoever has them.
TEST(AmbientCostTest, RanksFindTheSameBits) {
  const TestChain chain = RayleighChain(3);
  const IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.05, RecordOfChain(chain, 80.0, 4, 0.5));
  const ParameterLayout layout(problem);
  struct Found {
    CondensedSystem system;
    Matrix products;
    AmbientScore score;
    LoadEvidence evidence;
  };
  const auto find = [&](Communicator* ranks) {
    Found found;
    AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 1, ranks);
    const Vector free = layout.Free(layout.InitialValues());
    EXPECT_TRUE(cost.Linearize(free, &found.system)) << cost.Failure();
    EXPECT_TRUE(cost.Linearize(0.99 * free, &found.system)) << cost.Failure();
    found.products = cost.score_products();
    EXPECT_TRUE(ScoreAmbient(free, &cost, &found.score));
    found.evidence = JudgeLoads(free, &cost);
    return found;
  };
  const Found alone = find(nullptr);
  for (const int size : {2, 3}) {
    std::vector<Found> all(static_cast<size_t>(size));
    testing::ThreadRanks(size).Run([&](Communicator* ranks) {
      all[static_cast<size_t>(ranks->rank())] = find(ranks);
    });
    for (const Found& found : all) {
      EXPECT_EQ(found.system.cost, alone.system.cost);
      EXPECT_EQ(found.system.gradient, alone.system.gradient);
      EXPECT_EQ(found.system.hessian, alone.system.hessian);
      EXPECT_EQ(found.products, alone.products);
      EXPECT_EQ(found.score.chi_square, alone.score.chi_square);
      EXPECT_EQ(found.score.modelled, alone.score.modelled);
      EXPECT_EQ(found.evidence.log_likelihood, alone.evidence.log_likelihood);
      EXPECT_EQ(found.evidence.price, alone.evidence.price);
      EXPECT_EQ(found.evidence.finer_gain, alone.evidence.finer_gain);
      EXPECT_EQ(found.evidence.finer_price, alone.evidence.finer_price);
    }
  }
}

TEST(AmbientCostFigures, FindsStoreysUnderColouredWind) {
  const TestChain chain = RayleighChain(3);
  const IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.15, RecordOfChain(chain, 600.0, 2, 0.9));
  const IdentificationSummary summary = SummaryOfFit(problem);
  EXPECT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.ambient.size(), 1u);
  for (size_t i = 0; i < 3; ++i) {
    const ParameterEstimate& k = summary.parameters[i];
    EXPECT_NEAR(k.value, 0.0, 4.0 * k.sigma);
    EXPECT_LT(k.sigma, 0.02);
  }
  EXPECT_GT(summary.ambient[0].explained.minCoeff(), 0.9);
}

// Absolute accelerations above a base whose motion nobody measured, in both
// senses: what it does to the masses, and what sensors see of it. One motion
// alone leaves so little open that two modes must have their damping exactly;
// and what the transfer function turns within a spectral line is more than good
// sensors would hide.
TEST(AmbientCostFigures, FindsStoreysOnAMovingBase) {
  const TestChain chain = RayleighChain(2);
  for (const double noise : {0.02, 0.01, 0.003}) {
    IdentificationProblem problem = ProblemOfChain(
        chain, kChainSpring, 0.1,
        RecordOfChain(chain, 600.0, 3, 0.9, {2}, /*base=*/true, noise));
    problem.ambient[0].base = Matrix::Ones(2, 1);
    std::string error;
    ASSERT_TRUE(problem.IsValid(&error)) << error;
    const IdentificationSummary summary = SummaryOfFit(problem);
    EXPECT_TRUE(summary.usable()) << noise << ": " << summary.message;
    ASSERT_EQ(summary.ambient.size(), 1u);
    EXPECT_GT(summary.ambient[0].probability, 0.01) << noise;
    for (size_t i = 0; i < 2; ++i) {
      const ParameterEstimate& k = summary.parameters[i];
      EXPECT_NEAR(k.value, 0.0, 4.0 * k.sigma) << noise;
      EXPECT_LT(k.sigma, 0.02) << noise;
    }
  }
}

// The fourth mode lies 1.7 times as high as the band ends; what forces on it do
// there is far more than noise.
TEST(AmbientCostFigures, ModesBeyondTheBandAreLoadedToo) {
  const TestChain chain = RayleighChain(4);
  IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.05, RecordOfChain(chain, 600.0, 5, 0.5));
  problem.ambient[0].highest_frequency = chain.frequency_hz[3] / 1.7;
  const IdentificationSummary summary = SummaryOfFit(problem);
  EXPECT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.ambient.size(), 1u);
  EXPECT_GT(summary.ambient[0].probability, 0.001);
  for (const double left : summary.ambient[0].information_left) {
    EXPECT_GT(left, 0.05);
  }
}

// One logger at 50 Hz and one at 25 Hz, at other times: each with its own
// lines, and what they say together is more than either says alone.
TEST(AmbientCostFigures, RecordsOfDifferingRates) {
  const TestChain chain = RayleighChain(3);
  IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.05, RecordOfChain(chain, 300.0, 6, 0.5));
  IdentificationOptions options;
  options.num_threads = 2;
  IdentificationSummary alone, both;
  IdentifiedModel model;
  testing::FitAndJudge(problem, options, nullptr, &alone, &model);
  AmbientRecord slow = RecordOfChain(chain, 300.0, 7, 0.5);
  slow.name = "slow";
  Matrix samples(3, slow.samples.cols() / 2);
  for (Eigen::Index c = 0; c < 3; ++c) {
    samples.row(c) = Resample(slow.samples.row(c), 0.02, 0.04)
                         .head(samples.cols())
                         .transpose();
  }
  slow.samples = samples;
  slow.sampling_step = 0.04;
  problem.ambient.push_back(slow);
  testing::FitAndJudge(problem, options, nullptr, &both, &model);
  EXPECT_TRUE(both.usable()) << both.message;
  ASSERT_EQ(both.ambient.size(), 2u);
  EXPECT_LE(both.ambient[1].highest_frequency, 12.5);
  for (size_t i = 0; i < 3; ++i) {
    const ParameterEstimate& k = both.parameters[i];
    EXPECT_NEAR(k.value, 0.0, 4.0 * k.sigma);
    // Twice as much data, but for what differs by chance.
    EXPECT_LT(k.sigma, 0.85 * alone.parameters[i].sigma);
    EXPECT_GT(k.sigma, 0.55 * alone.parameters[i].sigma);
  }
}

// One sensor, and a spectrum of the loads that may change within the width of a
// mode: the peak is the structure's or the loads', whoever looks.
TEST(AmbientCostTest, LoadsThatExplainEverythingAreSaid) {
  const TestChain chain = RayleighChain(1);
  IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.0, RecordOfChain(chain, 300.0, 8, 0.5));
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, {}, nullptr, &summary, &model);
  ASSERT_EQ(summary.ambient.size(), 1u);
  EXPECT_TRUE(summary.usable()) << summary.message;
  EXPECT_GT(summary.ambient[0].most_information_left, 0.3);
  EXPECT_LE(summary.ambient[0].most_information_left, 1.0);
  problem.ambient[0].knots = 400;
  testing::FitAndJudge(problem, {}, nullptr, &summary, &model);
  ASSERT_EQ(summary.ambient.size(), 1u);
  EXPECT_FALSE(summary.usable());
  EXPECT_LT(summary.ambient[0].most_information_left, 0.01);
  EXPECT_THAT(summary.message,
              HasSubstr("loads explain all of ambient record 'wind'"));
  ASSERT_FALSE(summary.remarks.empty());
  EXPECT_THAT(summary.remarks.back(), HasSubstr("'k1'"));
}

// A model of which nothing is unknown.
TEST(AmbientCostTest, LoadsAloneAreFound) {
  const TestChain chain = RayleighChain(2);
  const StructuralModel model = MakeStructuralModel(
      Matrix::Identity(2, 2), 0.5 * Matrix::Identity(2, 2), chain.stiffness);
  IdentificationProblem problem;
  problem.dynamics =
      std::make_shared<StructuralDynamics>(model, std::vector<InputSpec>{});
  problem.ambient.push_back(RecordOfChain(chain, 100.0, 9, 0.5));
  const ParameterLayout layout(problem);
  AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 1);
  CondensedSystem system;
  ASSERT_TRUE(cost.Linearize(Vector(), &system)) << cost.Failure();
  EXPECT_EQ(system.gradient.size(), 0);
  AmbientScore score;
  ASSERT_TRUE(ScoreAmbient(Vector(), &cost, &score)) << cost.Failure();
  EXPECT_EQ(score.information_left.size(), 0);
  EXPECT_EQ(score.most_information_left, 1.0);
}

TEST(AmbientCostTest, SaysWhatIsWrong) {
  const TestChain chain = RayleighChain(2);
  IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.0, RecordOfChain(chain, 20.0, 1, 0.5));
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error)) << error;
  problem.ambient[0].samples.row(1).setConstant(1.0);
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("channel 'u2' is dead"));
  problem.ambient[0].channels[0].quantity = Quantity::kForce;
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("'u1' is a force"));
  problem.ambient[0] = RecordOfChain(chain, 20.0, 1, 0.5);
  problem.ambient[0].knots = 2000;
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("2000 knots with 3 numbers each is too fine"));
}

TEST(AmbientCostTest, ChannelsWhoseGapsLeaveLittleInCommon) {
  const TestChain chain = RayleighChain(6);
  IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.0, RecordOfChain(chain, 40.0, 1, 0.5));
  Matrix& samples = problem.ambient[0].samples;
  const Eigen::Index gap = samples.cols() / 11;
  for (Eigen::Index c = 0; c < 6; ++c) {
    samples.row(c).segment(c * gap, gap).setConstant(std::nan(""));
    std::string error;
    EXPECT_EQ(problem.IsValid(&error), c < 5) << error;
    if (c < 5) continue;
    EXPECT_THAT(error, HasSubstr("Only 46 % of the record is free"));
  }
}

}  // namespace
}  // namespace pinode
