#include "pinode/discover/support_window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

constexpr int kCount = 9;
constexpr double kWindow = 12.0;

// 1/2 |y - X theta|^2 with columns that are hard to tell apart: x_2 is nearly
// x_1, and x_6 nearly x_4 + x_5.
class SupportWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::Gaussian gaussian(5);
    Matrix x = gaussian.Draw(300, kCount);
    x.col(2) = x.col(1) + 0.1 * x.col(2);
    x.col(6) = x.col(4) + x.col(5) + 0.15 * x.col(6);
    x.col(7) = 1e5 * x.col(7);
    const Vector y = x.col(1) + 0.5 * x.col(4) + 0.5 * x.col(5) + x.col(8) +
                     Vector(gaussian.Draw(300, 1));
    cost_.hessian = x.transpose() * x;
    cost_.gradient = -x.transpose() * y;
    options_.prices = Vector::Constant(kCount, std::log(300.0));
    options_.optional.assign(kCount, true);
    options_.optional[8] = false;
    options_.signs.assign(kCount, 0);
    options_.smallest = Vector::Zero(kCount);
  }

  // Criterion of a support by the normal equations.
  double Criterion(const std::vector<int>& support) const {
    const Matrix hessian = cost_.hessian(support, support);
    const Vector gradient = cost_.gradient(support);
    double criterion = -gradient.dot(hessian.ldlt().solve(gradient));
    for (const int j : support) criterion += options_.prices[j];
    return criterion;
  }

  // All supports with entry 8 in the window, by enumeration.
  std::map<std::vector<int>, double> All() const {
    std::map<std::vector<int>, double> all;
    double least = 1e300;
    for (int bits = 0; bits < (1 << 8); ++bits) {
      std::vector<int> support;
      for (int j = 0; j < 8; ++j) {
        if ((bits >> j) & 1) support.push_back(j);
      }
      support.push_back(8);
      all[support] = Criterion(support);
      least = std::min(least, all[support]);
    }
    for (auto entry = all.begin(); entry != all.end();) {
      entry = entry->second > least + kWindow ? all.erase(entry) : ++entry;
    }
    return all;
  }

  QuadraticCost cost_;
  StepwiseOptions options_;
};

TEST_F(SupportWindow, HasWhatEnumerationFinds) {
  const std::map<std::vector<int>, double> all = All();
  ASSERT_GT(all.size(), 20u);
  const std::vector<int> best =
      SelectStepwise(cost_, options_, std::vector<int>());
  const std::vector<WeighedSupport> found =
      SupportsWithin(cost_, options_, best, kWindow, 1000);
  ASSERT_EQ(found.size(), all.size());
  EXPECT_EQ(found.front().support, best);
  for (size_t k = 0; k < found.size(); ++k) {
    const auto entry = all.find(found[k].support);
    ASSERT_NE(entry, all.end()) << k;
    EXPECT_NEAR(found[k].criterion, entry->second, 1e-6) << k;
    EXPECT_GE(found[k].criterion, found[k > 0 ? k - 1 : 0].criterion);
  }
}

// A bad start stays in the list, and the better ones are found from it.
TEST_F(SupportWindow, KeepsTheStartAndFindsTheBetterOnes) {
  const std::vector<WeighedSupport> found =
      SupportsWithin(cost_, options_, {0, 3}, kWindow, 1000);
  EXPECT_EQ(found.front().support,
            SelectStepwise(cost_, options_, std::vector<int>()));
  EXPECT_THAT(found.back().support, ElementsAre(0, 3, 8));
  EXPECT_EQ(found.size(), All().size() + 1);
}

TEST_F(SupportWindow, KeepsSignsAndSmallestValues) {
  options_.signs[1] = -1;
  options_.smallest[2] = 10.0;
  const std::vector<WeighedSupport> all =
      SupportsWithin(cost_, options_, {8}, kWindow, 1000);
  ASSERT_GT(all.size(), 5u);
  for (const WeighedSupport& found : all) {
    if (found.support == std::vector<int>{8}) continue;
    const Vector theta = MinimizeOn(cost_, found.support);
    EXPECT_LE(theta[1], 0.0);
    EXPECT_TRUE(theta[2] == 0.0 || std::abs(theta[2]) >= 10.0);
  }
}

// A start with a value of the wrong sign lies far below the supports that are
// allowed. It must not hide them.
TEST_F(SupportWindow, LeavesAStartThatIsNotAllowed) {
  options_.signs[1] = -1;
  options_.smallest[2] = 10.0;
  const std::vector<int> start = {1, 4, 5, 8};
  const std::vector<WeighedSupport> found =
      SupportsWithin(cost_, options_, {1, 4, 5}, kWindow, 1000);
  ASSERT_GT(found.size(), 5u);
  EXPECT_EQ(found[0].support, start);
  EXPECT_GT(found[1].criterion, found[0].criterion + kWindow);
  std::vector<std::vector<int>> supports[2];
  for (const WeighedSupport& near : found) {
    if (near.support != start) supports[0].push_back(near.support);
  }
  for (const WeighedSupport& near :
       SupportsWithin(cost_, options_, {8}, kWindow, 1000)) {
    if (near.support.size() > 1) supports[1].push_back(near.support);
  }
  EXPECT_EQ(supports[0], supports[1]);
}

}  // namespace
}  // namespace pinode
