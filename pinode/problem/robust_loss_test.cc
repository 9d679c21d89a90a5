#include "pinode/problem/robust_loss.h"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

namespace pinode {
namespace {

TEST(RobustLoss, EqualsThatOfCeres) {
  const double scale = 1.3;
  const ceres::HuberLoss huber(scale);
  const ceres::CauchyLoss cauchy(scale);
  for (const double s : {0.0, 0.1, 1.68, 1.7, 30.0, 1e8}) {
    double expected[3], rho, slope;
    huber.Evaluate(s, expected);
    EvaluateRobustLoss(RobustLoss::kHuber, scale, s, &rho, &slope);
    EXPECT_DOUBLE_EQ(rho, expected[0]) << s;
    EXPECT_DOUBLE_EQ(slope, expected[1]) << s;
    cauchy.Evaluate(s, expected);
    EvaluateRobustLoss(RobustLoss::kCauchy, scale, s, &rho, &slope);
    EXPECT_NEAR(rho, expected[0], 1e-14 * (1.0 + expected[0])) << s;
    EXPECT_DOUBLE_EQ(slope, expected[1]) << s;
    EXPECT_LE(slope * s, rho * (1.0 + 1e-15)) << s;
    EvaluateRobustLoss(RobustLoss::kNone, scale, s, &rho, &slope);
    EXPECT_EQ(rho, s);
    EXPECT_EQ(slope, 1.0);
  }
}

}  // namespace
}  // namespace pinode
