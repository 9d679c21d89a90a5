#include "pinode/estimate/ambient/ambient_evidence.h"

#include <cmath>

#include "gtest/gtest.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/verdict_limits.h"
#include "tests/support/ambient_testing.h"

namespace pinode {
namespace {

AmbientScore ScoreOfFit(IdentificationProblem problem, int knots) {
  problem.ambient[0].knots = knots;
  const IdentificationSummary summary = SummaryOfFit(problem);
  EXPECT_TRUE(summary.usable()) << summary.message;
  return summary.ambient.at(0);
}

// Forces on three masses that begin to fall at 1.6 Hz, below the first mode; or
// a base that moves so.
IdentificationProblem ChainUnderWind(bool base = false) {
  const TestChain chain = RayleighChain(3);
  IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.02,
                     RecordOfChain(chain, 300.0, 1, 0.96, {2}, base));
  if (base) problem.ambient[0].base = Matrix::Ones(3, 1);
  return problem;
}

// What one step of scoring promises is what a fit finds, but for what it would
// find in several.
void ExpectPromiseKept(const IdentificationProblem& problem, int knots) {
  const LoadEvidence coarse = ScoreOfFit(problem, knots).evidence;
  ASSERT_EQ(coarse.finer_knots, 2 * knots - 1);
  const LoadEvidence fine = ScoreOfFit(problem, coarse.finer_knots).evidence;
  const double gain = fine.log_likelihood - coarse.log_likelihood;
  const double price = fine.price - coarse.price;
  EXPECT_NEAR(coarse.finer_gain, gain, 2.5 + 0.35 * gain) << knots;
  EXPECT_NEAR(coarse.finer_price, price, 0.2 * price) << knots;
}

TEST(AmbientEvidence, FinerFitsKeepWhatWasPromised) {
  const IdentificationProblem problem = ChainUnderWind();
  for (const int knots : {2, 3, 5}) ExpectPromiseKept(problem, knots);
}

// Loads of which nothing holds covariances.
TEST(AmbientEvidence, PromiseOfOneLoadIsKept) {
  ExpectPromiseKept(ChainUnderWind(/*base=*/true), 3);
}

// Two knots are not refused, for chance might have made what they leave; knots
// an octave apart are as many as the record speaks for.
TEST(AmbientEvidence, SeesWhatIsNotRefused) {
  const IdentificationProblem problem = ChainUnderWind();
  const AmbientScore two = ScoreOfFit(problem, 2);
  EXPECT_GT(two.probability, limits::kSpectrumProbability);
  EXPECT_TRUE(two.evidence.PromisesMore());
  const AmbientScore octaves = ScoreOfFit(problem, 0);
  EXPECT_GT(octaves.num_knots, 3);
  EXPECT_EQ(octaves.evidence.finer_knots, 2 * octaves.num_knots - 1);
  EXPECT_FALSE(octaves.evidence.PromisesMore());
  EXPECT_GT(octaves.evidence.log_likelihood - octaves.evidence.price,
            two.evidence.log_likelihood - two.evidence.price);
}

// The same record twice as long: each number of the spectrum that it tells is
// taken off half the logarithm of two more.
TEST(AmbientEvidence, PriceGrowsWithTheLogarithmOfTheRecord) {
  const TestChain chain = RayleighChain(2);
  const auto price_of = [&chain](double seconds) {
    IdentificationProblem problem = ProblemOfChain(
        chain, kChainSpring, 0.0, RecordOfChain(chain, seconds, 2, 0.5));
    problem.ambient[0].knots = 2;
    const ParameterLayout layout(problem);
    AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 2);
    return JudgeLoads(layout.Free(layout.InitialValues()), &cost).price;
  };
  // Of two knots three each, and two of noise; not all are told by all lines.
  const double all = 8.0 * 0.5 * std::log(2.0);
  const double found = price_of(800.0) - price_of(400.0);
  EXPECT_GT(found, 0.8 * all);
  EXPECT_LT(found, 1.05 * all);
}

TEST(AmbientEvidence, WhiteLoadsHaveNoFinerSpectrum) {
  IdentificationProblem problem = ChainUnderWind();
  problem.ambient[0].knots = 1;
  const ParameterLayout layout(problem);
  AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 2);
  const LoadEvidence evidence =
      JudgeLoads(layout.Free(layout.InitialValues()), &cost);
  EXPECT_GT(evidence.price, 0.0);
  EXPECT_EQ(evidence.finer_knots, 0);
  EXPECT_FALSE(evidence.PromisesMore());
}

}  // namespace
}  // namespace pinode
