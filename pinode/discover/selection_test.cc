#include "pinode/discover/selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Criterion = SelectionOptions::Criterion;

Selection Selected(const RegressionProblem& problem,
                   const std::vector<std::vector<int>>& supports,
                   const SelectionOptions& options) {
  Selection selection;
  std::string error;
  EXPECT_TRUE(SelectSupport(problem, supports, options, &selection, &error))
      << error;
  return selection;
}

std::vector<std::vector<int>> LassoSupports(const RegressionProblem& problem) {
  LassoPath path;
  std::string error;
  EXPECT_TRUE(SolveLassoPath(problem, {}, &path, &error)) << error;
  return Supports(path);
}

TEST(NumIndependent, OfWhiteAndOfCorrelatedNoise) {
  testing::Gaussian random(1);
  const Vector white = random.Draw(20000, 1);
  EXPECT_GT(NumIndependent({white}), 0.9 * 20000);
  EXPECT_LE(NumIndependent({white}), 20000.0);
  // A first-order autoregression: 1 + 2 sum rho^k = (1 + rho) / (1 - rho).
  Vector correlated = random.Draw(40000, 1);
  for (Eigen::Index i = 1; i < correlated.size(); ++i) {
    correlated[i] += 0.8 * correlated[i - 1];
  }
  EXPECT_NEAR(NumIndependent({correlated}), 40000.0 / 9.0, 600.0);
  EXPECT_NEAR(NumIndependent({correlated.head(20000), correlated.tail(20000)}),
              40000.0 / 9.0, 600.0);
  // Noise that alternates, as that of derivatives, counts in full.
  const Vector differences = white.tail(19999) - white.head(19999);
  EXPECT_EQ(NumIndependent({differences}), 19999.0);
  EXPECT_EQ(NumIndependent({Vector::Zero(7)}), 7.0);
  // A constant is one value, however long.
  EXPECT_LT(NumIndependent({Vector::Ones(1000)}), 2.0);
}

TEST(Selection, NumbersByHand) {
  testing::Gaussian random(2);
  const Matrix theta = random.Draw(60, 4);
  const Vector y = theta.col(1) + 0.2 * random.Draw(60, 1);
  SelectionOptions options;
  options.autocorrelation = false;
  options.backward_elimination = false;
  options.num_blocks = 3;
  const Selection selection =
      Selected(testing::Problem(theta, y), {{0, 1}, {1}, {1}}, options);
  // Doubles once, the empty one added, by number of terms.
  ASSERT_EQ(selection.entries.size(), 3u);
  EXPECT_THAT(selection.entries[0].support, IsEmpty());
  EXPECT_THAT(selection.entries[1].support, ElementsAre(1));
  EXPECT_THAT(selection.entries[2].support, ElementsAre(0, 1));
  EXPECT_EQ(selection.num_independent, 60.0);
  EXPECT_EQ(selection.chosen, 1);
  for (const SelectionEntry& entry : selection.entries) {
    double squares = y.squaredNorm();
    double held_back = 0.0;
    if (!entry.support.empty()) {
      const Matrix columns = theta(Eigen::all, entry.support);
      const Vector fit = columns.colPivHouseholderQr().solve(y);
      squares = (y - columns * fit).squaredNorm();
      for (size_t i = 0; i < entry.support.size(); ++i) {
        EXPECT_NEAR(entry.coefficients[entry.support[i]],
                    fit[static_cast<Eigen::Index>(i)], 1e-14);
      }
    }
    for (int block = 0; block < 3; ++block) {
      std::vector<int> in, out;
      for (int i = 0; i < 60; ++i) (i / 20 == block ? out : in).push_back(i);
      Vector residual = y(out);
      if (!entry.support.empty()) {
        const Matrix columns = theta(Eigen::all, entry.support);
        const Vector fit = Matrix(columns(in, Eigen::all))
                               .colPivHouseholderQr()
                               .solve(Vector(y(in)));
        residual -= columns(out, Eigen::all) * fit;
      }
      held_back += residual.squaredNorm() / 20.0 / 3.0;
    }
    EXPECT_NEAR(entry.sum_of_squares, squares, 1e-12 * squares);
    EXPECT_NEAR(
        entry.bic,
        60.0 * std::log(squares / 60.0) + entry.num_terms * std::log(60.0),
        1e-10);
    EXPECT_NEAR(entry.held_back, held_back, 1e-12 * held_back);
  }
  const SelectionEntry& best = selection.entries[1];
  EXPECT_EQ(
      std::min({selection.entries[0].held_back_excess, best.held_back_excess,
                selection.entries[2].held_back_excess}),
      0.0);
}

class DuffingSelection
    : public ::testing::TestWithParam<std::tuple<Criterion, double>> {};

// The true terms and no other, of 20 nearly dependent ones, in every seed.
TEST_P(DuffingSelection, FindsTheTrueTerms) {
  const auto [criterion, noise] = GetParam();
  SelectionOptions options;
  options.criterion = criterion;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const RegressionProblem problem = testing::Duffing(400, noise, seed);
    const Selection selection =
        Selected(problem, LassoSupports(problem), options);
    EXPECT_EQ(selection.best().support, testing::DuffingSupport())
        << "noise " << noise << ", seed " << seed;
    if (noise == 0.0) {
      EXPECT_NEAR(selection.best().coefficients[5], -6.0, 1e-10);
      break;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Noise, DuffingSelection,
    ::testing::Combine(::testing::Values(Criterion::kBic, Criterion::kHeldBack),
                       ::testing::Values(0.0, 0.01, 0.05)));

// Slowly varying errors, as a network makes along a trajectory, look like many
// terms to who takes neighbouring samples for independent.
TEST(Selection, CorrelatedErrorsAreNoEvidence) {
  int without = 0;
  int with = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    RegressionProblem problem = testing::Duffing(400, 0.0, 1);
    testing::Gaussian random(seed);
    Vector error = random.Draw(400, 1);
    for (Eigen::Index i = 1; i < 400; ++i) error[i] += 0.95 * error[i - 1];
    problem.outputs[0].y += 0.01 * error;
    const auto supports = LassoSupports(problem);
    SelectionOptions options;
    with += Selected(problem, supports, options).best().support ==
                    testing::DuffingSupport()
                ? 1
                : 0;
    options.autocorrelation = false;
    without += Selected(problem, supports, options).best().support ==
                       testing::DuffingSupport()
                   ? 1
                   : 0;
  }
  EXPECT_GE(with, 9);
  EXPECT_LE(without, 5);
}

TEST(Selection, EliminationFindsWhatThePathPassesBy) {
  const RegressionProblem problem = testing::Duffing(400, 0.01, 2);
  SelectionOptions options;
  const std::vector<std::vector<int>> supports = {{0}, {0, 1, 2, 5, 9}};
  const Selection selection = Selected(problem, supports, options);
  EXPECT_EQ(selection.best().support, testing::DuffingSupport());
  // The empty one, two given, and one of each size below five.
  EXPECT_EQ(selection.entries.size(), 3u + 4u - 1u);
  options.backward_elimination = false;
  EXPECT_EQ(Selected(problem, supports, options).best().support, supports[1]);
}

TEST(Selection, RoundingIsNotExplained) {
  // Exact data, and a term of the size of rounding: nothing but rounding would
  // be gained by it.
  testing::Gaussian random(3);
  const Matrix theta = random.Draw(200, 6);
  const Vector y = theta.col(2) - 3.0 * theta.col(4) + 1e-11 * theta.col(0);
  for (Criterion criterion : {Criterion::kBic, Criterion::kHeldBack}) {
    SelectionOptions options;
    options.criterion = criterion;
    const std::vector<std::vector<int>> supports = {
        {2}, {2, 4}, {0, 2, 4}, {0, 1, 2, 3, 4, 5}};
    EXPECT_THAT(
        Selected(testing::Problem(theta, y), supports, options).best().support,
        ElementsAre(2, 4));
  }
}

TEST(Selection, ConstraintsHoldInEveryFit) {
  RegressionProblem problem = testing::Duffing(400, 0.01, 4);
  problem.constraints = {CoefficientConstraint::Given("v", -0.3),
                         CoefficientConstraint::Equal({"x", "x^3"}, {2, 3})};
  const Selection selection =
      Selected(problem, LassoSupports(problem), SelectionOptions());
  EXPECT_THAT(selection.best().support, ElementsAre(0, 5));
  EXPECT_EQ(selection.best().num_terms, 1);
  for (const SelectionEntry& entry : selection.entries) {
    EXPECT_EQ(entry.coefficients[1], -0.3);
    EXPECT_NEAR(entry.coefficients[0] / 2.0, entry.coefficients[5] / 3.0,
                1e-14);
  }
}

TEST(Selection, RecordsStayApart) {
  RegressionProblem problem = testing::Duffing(300, 0.01, 5);
  problem.record_starts = {0, 100, 220};
  const Selection selection =
      Selected(problem, LassoSupports(problem), SelectionOptions());
  EXPECT_EQ(selection.best().support, testing::DuffingSupport());
}

// The condensed form chooses as the whole one.
TEST(SelectByBic, AgreesWithSelectSupport) {
  const RegressionProblem problem = testing::Duffing(400, 0.05, 6);
  SelectionOptions options;
  const Selection selection =
      Selected(problem, LassoSupports(problem), options);
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  EXPECT_EQ(SelectByBic(Condense(problem, map), map, LassoSupports(problem),
                        selection.num_independent, options),
            selection.best().support);
}

TEST(SelectByLoss, TakesTheFewestTermsWithinIt) {
  const RegressionProblem problem = testing::Duffing(400, 0.05, 6);
  const SelectionOptions options;
  const Selection selection =
      Selected(problem, LassoSupports(problem), options);
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  const LeastSquaresSystem system = Condense(problem, map);
  std::vector<int> all(static_cast<size_t>(map.num_free()));
  for (int j = 0; j < map.num_free(); ++j) all[static_cast<size_t>(j)] = j;
  const double least = system.SumOfSquares(FitSupport(system, map, all));
  const auto select = [&](double loss) {
    return SelectByLoss(system, map, LassoSupports(problem),
                        selection.num_independent, loss, options);
  };
  for (const SelectionEntry& entry : selection.entries) {
    const double loss = entry.sum_of_squares - least;
    const std::vector<int> support = select(loss * (1.0 + 1e-9) + 1e-12);
    EXPECT_LE(support.size(), entry.support.size());
    EXPECT_LE(system.SumOfSquares(FitSupport(system, map, support)),
              entry.sum_of_squares * (1.0 + 1e-9) + 1e-12);
    for (const SelectionEntry& other : selection.entries) {
      if (other.support.size() < support.size()) {
        EXPECT_GT(other.sum_of_squares - least, loss);
      }
    }
  }
  EXPECT_TRUE(select(1e300).empty());
}

TEST(Selection, RefusesBadOptions) {
  RegressionProblem problem = testing::Duffing(50, 0.01, 1);
  Selection selection;
  std::string error;
  SelectionOptions options;
  options.num_blocks = 1;
  EXPECT_FALSE(SelectSupport(problem, {}, options, &selection, &error));
  EXPECT_THAT(error, HasSubstr("num_blocks 1"));
  options = {};
  options.num_standard_errors = NAN;
  EXPECT_FALSE(SelectSupport(problem, {}, options, &selection, &error));
  EXPECT_THAT(error, HasSubstr("num_standard_errors nan"));
  options = {};
  options.noise_floor = -1.0;
  EXPECT_FALSE(SelectSupport(problem, {}, options, &selection, &error));
  EXPECT_THAT(error, HasSubstr("noise_floor -1"));
  problem = testing::Problem(Matrix::Ones(1, 1), Vector::Ones(1));
  EXPECT_FALSE(SelectSupport(problem, {}, {}, &selection, &error));
  EXPECT_THAT(error, HasSubstr("1 samples make no two blocks"));
  EXPECT_EQ(selection.chosen, -1);
}

}  // namespace
}  // namespace pinode
