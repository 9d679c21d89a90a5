#include "pinode/record/short_gaps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

// A sine of 20 samples a cycle, 2000 samples.
Vector Sine() {
  Vector values(2000);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] = 3.0 * std::sin(kTwoPi * static_cast<double>(i) / 20.0 + 0.3);
  }
  return values;
}

TEST(ShortGapsTest, ErrorIsTheMeasuredOne) {
  const Vector whole = Sine();
  Vector values = whole;
  Eigen::Index missing = 0;
  for (Eigen::Index i = 5; i < values.size() - 5; i += 23) {
    const Eigen::Index size = 1 + i % 3;
    values.segment(i, size).setConstant(kNaN);
    missing += size;
  }
  const ShortGaps filled = FillShortGaps(&values);
  EXPECT_EQ(filled.num_samples, missing);
  EXPECT_EQ(filled.longest, 3);
  const double truth = (values - whole).norm() / whole.norm();
  EXPECT_GT(truth, 1e-4);
  EXPECT_NEAR(filled.error / truth, 1.0, 0.1);
}

TEST(ShortGapsTest, CubicsAreExact) {
  Vector values(12);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const auto t = static_cast<double>(i);
    values[i] = 1.0 - 2.0 * t + 0.5 * t * t - 0.1 * t * t * t;
  }
  const Vector whole = values;
  values.segment(4, 3).setConstant(kNaN);
  EXPECT_EQ(FillShortGaps(&values).num_samples, 3);
  EXPECT_LT((values - whole).norm(), 1e-11);
}

TEST(ShortGapsTest, OtherGapsStay) {
  Vector values = Sine();
  values[1] = kNaN;                         // one sample before it
  values.segment(50, 4).setConstant(kNaN);  // too long
  values[101] = kNaN;                       // another gap beside it
  values[103] = kNaN;
  values[values.size() - 1] = kNaN;
  const ShortGaps filled = FillShortGaps(&values);
  EXPECT_EQ(filled.num_samples, 0);
  EXPECT_EQ(filled.error, 0.0);
  EXPECT_TRUE(std::isnan(values[1]) && std::isnan(values[53]) &&
              std::isnan(values[101]));
}

// Samples are missing where the signal is strong, a tenth of the time.
TEST(ShortGapsTest, ErrorIsThatOfTheStrongPart) {
  Vector whole = Sine();
  whole.head(1800) *= 0.01;
  Vector values = whole;
  for (Eigen::Index i = 1870; i < 1990; i += 17) values[i] = kNaN;
  const ShortGaps filled = FillShortGaps(&values);
  const double truth = (values - whole).norm() / whole.norm();
  EXPECT_GT(filled.error, 0.5 * truth);
  EXPECT_LT(filled.error, 2.0 * truth);
}

TEST(ShortGapsTest, ConstantSignal) {
  Vector values = Vector::Constant(100, 2.0);
  values[50] = kNaN;
  const ShortGaps filled = FillShortGaps(&values);
  EXPECT_EQ(filled.num_samples, 1);
  EXPECT_LT(filled.error, 1e-3);
  EXPECT_NEAR(values[50], 2.0, 1e-14);
}

TEST(ShortGapsTest, NothingToTryItOn) {
  Vector values = Vector::Zero(5);
  values[2] = kNaN;
  const ShortGaps filled = FillShortGaps(&values);
  EXPECT_EQ(filled.num_samples, 1);
  EXPECT_TRUE(std::isnan(filled.error));
  Vector empty;
  EXPECT_EQ(FillShortGaps(&empty).num_samples, 0);
}

}  // namespace
}  // namespace pinode
