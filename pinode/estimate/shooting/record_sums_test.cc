#include "pinode/estimate/shooting/record_sums.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "gtest/gtest.h"

namespace pinode {
namespace {

constexpr int kRows = 5;
constexpr int kChannels = 3;
constexpr int kColumns = 4;

RecordSums Zero() {
  RecordSums zero;
  zero.costs = Vector::Zero(kChannels);
  zero.end = Vector::Zero(kRows);
  zero.products = Matrix::Zero(kRows, kChannels);
  zero.grams.assign(2, Matrix::Zero(kRows, kRows));
  zero.hessians.assign(1, Matrix::Zero(kColumns, kColumns));
  return zero;
}

// All that a piece adds up, as numbers of very different sizes.
std::vector<double> Numbers(int piece) {
  std::mt19937 random(static_cast<unsigned>(piece));
  std::normal_distribution<double> normal;
  std::vector<double> numbers(5);
  for (double& number : numbers) number = std::exp(20.0 * normal(random));
  return numbers;
}

void AddPiece(int piece, PieceSums* sums) {
  const std::vector<double> numbers = Numbers(piece);
  RecordSums* into = sums->piece();
  into->costs.array() += numbers[0];
  into->products.array() += numbers[1];
  into->grams[0].triangularView<Eigen::Lower>() +=
      Matrix::Constant(kRows, kRows, numbers[2]);
  into->grams[1](3, 1) += numbers[3];
  into->hessians[0].triangularView<Eigen::Lower>() +=
      Matrix::Constant(kColumns, kColumns, -numbers[4]);
  sums->Close();
}

// Of pieces [0, count), by shares of so many.
RecordSums SumByShares(int count, int share) {
  PieceSums all(Zero());
  for (int first = 0; first < count; first += share) {
    PieceSums some(Zero());
    for (int p = first; p < std::min(count, first + share); ++p) {
      AddPiece(p, &some);
    }
    all.Add(&some);
  }
  return all.Take();
}

TEST(RecordSumsTest, DoNotDependOnTheShares) {
  const RecordSums one = SumByShares(60, 60);
  for (const int share : {1, 7, 30}) {
    const RecordSums other = SumByShares(60, share);
    EXPECT_EQ(other.costs, one.costs);
    EXPECT_EQ(other.products, one.products);
    EXPECT_EQ(other.grams[0], one.grams[0]);
    EXPECT_EQ(other.grams[1], one.grams[1]);
    EXPECT_EQ(other.hessians[0], one.hessians[0]);
    EXPECT_EQ(other.end, one.end);
  }
}

TEST(RecordSumsTest, AreTheSumsToTheLastDigit) {
  const RecordSums sums = SumByShares(60, 13);
  std::vector<long double> expected(5, 0.0L);
  for (int p = 0; p < 60; ++p) {
    const std::vector<double> numbers = Numbers(p);
    for (size_t i = 0; i < 5; ++i) expected[i] += numbers[i];
  }
  const auto as_double = [&](size_t i) {
    return static_cast<double>(expected[i]);
  };
  EXPECT_DOUBLE_EQ(sums.costs[2], as_double(0));
  EXPECT_DOUBLE_EQ(sums.products(4, 2), as_double(1));
  EXPECT_DOUBLE_EQ(sums.grams[0](4, 0), as_double(2));
  EXPECT_DOUBLE_EQ(sums.grams[1](3, 1), as_double(3));
  EXPECT_DOUBLE_EQ(sums.hessians[0](3, 3), -as_double(4));
  // Of triangles nothing else is looked at.
  EXPECT_EQ(sums.grams[0](0, 4), 0.0);
  EXPECT_EQ(sums.grams[1](3, 2), 0.0);
}

}  // namespace
}  // namespace pinode
