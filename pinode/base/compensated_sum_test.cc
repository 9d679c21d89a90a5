#include "pinode/base/compensated_sum.h"

#include <random>
#include <vector>

#include "gtest/gtest.h"

namespace pinode {
namespace {

TEST(CompensatedSum, KeepsWhatASumForgets) {
  Vector sum = Vector::Zero(1);
  Vector rest = Vector::Zero(1);
  for (const double term : {1e16, 1.0, -1e16}) {
    AddCompensated(Vector::Constant(1, term), sum, rest);
  }
  EXPECT_EQ(sum[0] + rest[0], 1.0);
}

// Sums terms that nearly cancel, forwards and backwards, over more than one
// chunk.
TEST(CompensatedSum, DoesNotDependOnTheOrder) {
  constexpr int kSize = 600;
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  std::vector<Vector> terms;
  Vector last = Vector::Zero(kSize);
  for (int k = 0; k < 1000; ++k) {
    terms.push_back(
        Vector::NullaryExpr(kSize, [&] { return normal(generator); }));
    last -= terms.back();
  }
  terms.push_back(last);
  Vector sums[2] = {Vector::Zero(kSize), Vector::Zero(kSize)};
  Vector rests[2] = {Vector::Zero(kSize), Vector::Zero(kSize)};
  for (size_t k = 0; k < terms.size(); ++k) {
    AddCompensated(terms[k], sums[0], rests[0]);
    AddCompensated(terms[terms.size() - 1 - k], sums[1], rests[1]);
  }
  const Vector forwards = sums[0] + rests[0];
  const Vector backwards = sums[1] + rests[1];
  EXPECT_GT(forwards.norm(), 1e-14);
  EXPECT_LT((forwards - backwards).norm(), 1e-12 * forwards.norm());
}

}  // namespace
}  // namespace pinode
