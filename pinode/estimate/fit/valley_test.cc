#include "pinode/estimate/fit/valley.h"

#include <gtest/gtest.h>

namespace pinode {
namespace {

// Number of equal steps to the end of a fit; 1000 if it goes on.
int StepsToEnd(double share, double saving, double cost) {
  Valley valley(share);
  for (int step = 1; step < 1000; ++step) {
    valley.Note(-saving, cost);
    if (valley.IsOne()) return step;
  }
  return 1000;
}

// The steps of two exchanged sensors of data/three_storey_ambient.
TEST(Valley, EndsFitsThatCrawl) {
  EXPECT_EQ(StepsToEnd(Valley::kShare, 5e-6 * 1.25e5, 1.25e5),
            Valley::kMostSteps);
}

TEST(Valley, StepsThatSaveAreNone) {
  // More than the share.
  EXPECT_EQ(StepsToEnd(Valley::kShare, 2e-5 * 2e4, 2e4), 1000);
  // Less than the share of a long record, but a likelihood that counts.
  EXPECT_EQ(StepsToEnd(Valley::kShare, 2.0, 1e6), 1000);
}

TEST(Valley, QuickStepsAreNone) {
  EXPECT_EQ(StepsToEnd(Valley::kShare, 1e-6 * 3.7e3, 3.7e3), 1000);
}

TEST(Valley, OtherFitsHaveNone) {
  EXPECT_EQ(StepsToEnd(0.0, 1e-9, 1.25e5), 1000);
}

TEST(Valley, AStepThatSavesBeginsAgain) {
  Valley valley(Valley::kShare);
  for (int step = 0; step < Valley::kMostSteps - 1; ++step) {
    valley.Note(-0.1, 1.25e5);
  }
  EXPECT_FALSE(valley.IsOne());
  valley.Note(-10.0, 1.25e5);
  for (int step = 0; step < Valley::kMostSteps - 1; ++step) {
    valley.Note(-0.1, 1.25e5);
    EXPECT_FALSE(valley.IsOne());
  }
  valley.Note(-0.1, 1.25e5);
  EXPECT_TRUE(valley.IsOne());
}

}  // namespace
}  // namespace pinode
