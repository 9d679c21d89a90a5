#include "pinode/discover/stepwise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

// 1/2 |y - X theta|^2 for y = 2 x_1 - x_4 + noise of standard deviation 1, x_2
// being nearly x_1.
class Stepwise : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::Gaussian gaussian(3);
    x_ = gaussian.Draw(400, 8);
    x_.col(2) = x_.col(1) + 0.2 * x_.col(2);
    x_.col(7) = 1e6 * x_.col(7);
    const Vector y =
        2.0 * x_.col(1) - x_.col(4) + Vector(gaussian.Draw(400, 1));
    cost_.hessian = x_.transpose() * x_;
    cost_.gradient = -x_.transpose() * y;
    options_.prices =
        Vector::Constant(8, std::log(400.0) + 2.0 * std::log(8.0));
    options_.optional.assign(8, true);
    options_.signs.assign(8, 0);
    options_.smallest = Vector::Zero(8);
  }

  Matrix x_;
  QuadraticCost cost_;
  StepwiseOptions options_;
};

TEST_F(Stepwise, FindsTheTrueEntriesFromAnyStart) {
  EXPECT_THAT(SelectStepwise(cost_, options_, {}), ElementsAre(1, 4));
  EXPECT_THAT(SelectStepwise(cost_, options_, {0, 3, 5, 6, 7}),
              ElementsAre(1, 4));
  // From the wrong one of two columns that are nearly the same.
  EXPECT_THAT(SelectStepwise(cost_, options_, {2}), ElementsAre(1, 4));
  const Vector theta = MinimizeOn(cost_, {1, 4});
  EXPECT_NEAR(theta[1], 2.0, 0.15);
  EXPECT_NEAR(theta[4], -1.0, 0.15);
  EXPECT_EQ(theta[0], 0.0);
}

// Two columns that do nearly the same work.
TEST_F(Stepwise, PrefersTheCheaperEntry) {
  const double loss = cost_.gradient.dot(MinimizeOn(cost_, {2, 4})) -
                      cost_.gradient.dot(MinimizeOn(cost_, {1, 4}));
  ASSERT_GT(loss, 0.0);
  options_.prices[1] += loss + 0.1;
  EXPECT_THAT(SelectStepwise(cost_, options_, {1, 4}), ElementsAre(2, 4));
  options_.prices[1] -= 0.2;
  EXPECT_THAT(SelectStepwise(cost_, options_, {2, 4}), ElementsAre(1, 4));
}

// The residual of y after the sum calls for neither part alone.
TEST_F(Stepwise, FindsTwoEntriesBehindNearlyTheirSum) {
  x_.col(6) = 2.0 * x_.col(1) - x_.col(4) + 0.2 * x_.col(6);
  const Vector noise = testing::Gaussian(4).Draw(400, 1);
  const Vector y = 2.0 * x_.col(1) - x_.col(4) + 0.5 * noise;
  cost_.hessian = x_.transpose() * x_ / 0.25;
  cost_.gradient = -x_.transpose() * y / 0.25;
  EXPECT_THAT(SelectStepwise(cost_, options_, {}), ElementsAre(1, 4));
  EXPECT_THAT(SelectStepwise(cost_, options_, {6}), ElementsAre(1, 4));
}

TEST_F(Stepwise, KeepsWhatIsNotOptional) {
  options_.optional[7] = false;
  EXPECT_THAT(SelectStepwise(cost_, options_, {}), ElementsAre(1, 4, 7));
}

TEST_F(Stepwise, KeepsSignsAndSmallestValues) {
  options_.signs[4] = 1;
  EXPECT_THAT(SelectStepwise(cost_, options_, {}), ElementsAre(1));
  options_.signs[4] = -1;
  EXPECT_THAT(SelectStepwise(cost_, options_, {}), ElementsAre(1, 4));
  options_.smallest[4] = 1.5;
  EXPECT_THAT(SelectStepwise(cost_, options_, {}), ElementsAre(1));
}

TEST_F(Stepwise, TakesOneOfTwoEqualColumnsAndNoneThatIsZero) {
  x_.col(2) = x_.col(1);
  x_.col(5).setZero();
  const Vector y = 2.0 * x_.col(1);
  cost_.hessian = x_.transpose() * x_;
  cost_.gradient = -x_.transpose() * y;
  EXPECT_EQ(SelectStepwise(cost_, options_, {}).size(), 1u);
}

}  // namespace
}  // namespace pinode
