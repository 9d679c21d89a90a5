#include "pinode/estimate/shooting/start_search.h"

#include <gtest/gtest.h>

#include <vector>

namespace pinode {
namespace {

constexpr double kLinearized = 100.0;

// After a first sweep that promises so much of a cost of 120, and after a
// second one.
std::vector<StartProgress> Promising(double promise) {
  StartProgress progress;
  progress.cost = 120.0;
  progress.is_at_trial = true;
  progress.promise = promise;
  progress.last_promise = 1e-4;
  return {progress};
}
std::vector<StartProgress> Ended(double promise) {
  std::vector<StartProgress> searches = Promising(promise);
  searches[0].cost = 80.0;
  searches[0].done = true;
  return searches;
}

// Has seen a search whose second promise was 1e-8 times the first's square.
LookAhead Experienced() {
  LookAhead look_ahead(false);
  look_ahead.Learn(1, Promising(30.0));
  look_ahead.Learn(2, Ended(9e-6));
  return look_ahead;
}

TEST(LookAhead, GoesWithFirstSweepsWhereTold) {
  for (const bool first : {false, true}) {
    const LookAhead look_ahead(first);
    EXPECT_EQ(look_ahead.GoesAlong(0, {StartProgress()}, kLinearized), first);
    EXPECT_FALSE(look_ahead.GoesAlong(1, Promising(30.0), kLinearized))
        << "nothing was learned";
  }
}

// 3e-8 times the square of the first promise is to be less than 1e-4.
TEST(LookAhead, GoesWithSecondSweepsThatAreLikelyTheLast) {
  LookAhead look_ahead = Experienced();
  for (const double promise : {30.0, 57.0, 58.0}) {
    look_ahead.Learn(1, Promising(promise));
    EXPECT_EQ(look_ahead.GoesAlong(1, Promising(promise), kLinearized),
              promise < 57.5)
        << promise;
    EXPECT_FALSE(look_ahead.GoesAlong(2, Promising(promise), kLinearized));
  }
}

// 120 less what is promised is above the last linearisation's cost.
TEST(LookAhead, StaysWherePointsAreLikelyRejected) {
  LookAhead look_ahead = Experienced();
  look_ahead.Learn(1, Promising(19.0));
  EXPECT_FALSE(look_ahead.GoesAlong(1, Promising(19.0), kLinearized));
  EXPECT_TRUE(look_ahead.GoesAlong(1, Promising(19.0), 102.0));
}

TEST(LookAhead, StaysWhereASearchIsDoneOrLedAstray) {
  std::vector<StartProgress> astray = Promising(30.0);
  astray[0].is_at_trial = false;
  for (const auto& searches : {Ended(30.0), astray}) {
    LookAhead look_ahead = Experienced();
    look_ahead.Learn(1, searches);
    EXPECT_FALSE(look_ahead.GoesAlong(1, searches, kLinearized));
  }
}

TEST(LookAhead, OfOtherSegmentsNothingIsKnown) {
  LookAhead look_ahead = Experienced();
  look_ahead.Forget();
  look_ahead.Learn(1, Promising(30.0));
  EXPECT_FALSE(look_ahead.GoesAlong(1, Promising(30.0), kLinearized));
}

}  // namespace
}  // namespace pinode
