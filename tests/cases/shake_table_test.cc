// The frame on a shake table: walls that were exchanged.

#include "gtest/gtest.h"
#include "tests/cases/shake_table_testing.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

TEST_F(ShakeTable, OtherWallsAreDamageAndTheOtherHalfOfATestIsNot) {
  const CaseRun first = RunText("first", StoreysText(kStiff, false));
  const CaseRun second = RunText("second", StoreysText(kStiff, true));
  const CaseRun walls = RunText("walls", StoreysText(kFlexible, false));

  const ChangeRun halves = CompareRuns(first, second);
  EXPECT_EQ(halves.judgement.verdict, DamageVerdict::kNoDamage)
      << halves.judgement.sentence;

  const ChangeRun others = CompareRuns(first, walls);
  EXPECT_EQ(others.judgement.verdict, DamageVerdict::kDamage);
  for (const char* name : {"k1", "k2", "k3"}) {
    EXPECT_LT(others.Of(name).upper95, -0.5) << name;
  }
  // The source gives the periods 0.274 s and 0.127 s.
  constexpr double kPublished = 0.274 / 0.127;
  const double ratio =
      ModesOf(first).frequency_hz[0] / ModesOf(walls).frequency_hz[0];
  ReportFigure("shake table, damage: ratio of first frequencies",
               Between(0.97 * kPublished, 1.03 * kPublished), ratio);
  EXPECT_NEAR(ratio, kPublished, 0.03 * kPublished);
}

}  // namespace
}  // namespace testing
}  // namespace pinode
