#include "pinode/discover/term_prices.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pinode {
namespace {

DiscoveredTerm Term(const std::string& basis) {
  DiscoveredTerm term;
  term.basis = basis;
  return term;
}

class TermPricesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    equations_.resize(2);
    for (size_t e = 0; e < 2; ++e) {
      equations_[e].network = "nn";
      equations_[e].output = e == 0 ? "u1" : "u2";
      Add("x", 1, &equations_[e]);
      Add("x^2", 2, &equations_[e]);
      Add("x*v", 2, &equations_[e]);
    }
    Add("sin(x)", kNotAMonomial, &equations_[0]);
  }
  static void Add(const std::string& basis, int degree,
                  DiscoveredEquation* equation) {
    DiscoveryCandidate candidate;
    candidate.basis = basis;
    candidate.degree = degree;
    equation->candidates.push_back(candidate);
  }

  std::vector<DiscoveredEquation> equations_;
};

TEST_F(TermPricesTest, AreSharedByTheKindsAndThenByTheirCandidates) {
  const TermPrices prices(100, equations_);
  const auto price = [](int num) {
    return std::log(100.0) + 2.0 * std::log(num);
  };
  // Three kinds: two linear candidates, four quadratic ones, one other.
  EXPECT_DOUBLE_EQ(prices.Of(equations_[0], Term("x")), price(3 * 2));
  EXPECT_DOUBLE_EQ(prices.Of(equations_[1], Term("x*v")), price(3 * 4));
  EXPECT_DOUBLE_EQ(prices.Of(equations_[0], Term("sin(x)")), price(3));
  // No candidate of that equation.
  EXPECT_DOUBLE_EQ(prices.Of(equations_[1], Term("sin(x)")), std::log(100.0));
}

// With one of four quadratic candidates a term, the beta-binomial prior of the
// number of terms, 1 / C(4, k), changes by C(4, 1) / C(4, 0) = 4 and by
// C(4, 2) / C(4, 1) = 1.5. The price lies between these.
TEST_F(TermPricesTest, FollowTheRateAtWhichAKindHasTerms) {
  equations_[0].terms = {Term("x"), Term("x^2")};
  equations_[1].terms = {Term("x")};
  const TermPrices prices = TermPrices::AtRatesOf(100, equations_);
  const double of_one = std::log(100.0);
  EXPECT_DOUBLE_EQ(prices.Of(equations_[0], Term("x*v")),
                   of_one + 2.0 * std::log(4.0 / 2.0));
  EXPECT_DOUBLE_EQ(prices.Of(equations_[1], Term("x")),
                   of_one + 2.0 * std::log(1.0 / 3.0));
  EXPECT_DOUBLE_EQ(prices.Of(equations_[0], Term("sin(x)")),
                   of_one + 2.0 * std::log(2.0));
}

TEST_F(TermPricesTest, AreNotAskedOfGivenTerms) {
  const TermPrices prices(100, equations_);
  equations_[0].terms = {Term("x"), Term("x^2")};
  equations_[1].terms = {Term("x^2")};
  const double all = prices.Sum(equations_);
  EXPECT_DOUBLE_EQ(all, prices.Of(equations_[0], Term("x")) +
                            2.0 * prices.Of(equations_[0], Term("x^2")));
  equations_[1].terms[0].given = true;
  EXPECT_DOUBLE_EQ(all - prices.Sum(equations_),
                   prices.Of(equations_[0], Term("x^2")));
}

}  // namespace
}  // namespace pinode
