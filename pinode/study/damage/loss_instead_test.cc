#include "pinode/study/damage/loss_instead.h"

#include <gtest/gtest.h>

#include <string>

#include "pinode/study/damage/damage_analysis.h"
#include "tests/support/decay_testing.h"

namespace pinode {
namespace {

// Changes of k, c and a mass group m between decays in which k and c have
// lost the same 17 %. `mass_sigma`: prior deviation of m; 0: no such group.
DamageResult ResultOf(double mass_sigma) {
  const TestFit healthy = FitOfDecay(Vector{{1.0}}, 1.0, 1, mass_sigma);
  const TestFit fit = FitOfDecay(Vector{{0.83}}, 0.83, 2, mass_sigma);
  Baseline baseline;
  std::string error;
  EXPECT_TRUE(BaselineFrom("before", healthy.problem, healthy.summary,
                           healthy.model, &baseline, &error))
      << error;
  DamageAnalysisOptions options;
  options.search = LookEverywhere(fit.problem);
  options.search.masses.clear();
  DamageResult result;
  EXPECT_TRUE(AnalyseDamage(fit.problem, fit.summary, fit.model, {baseline},
                            options, &result, &error))
      << error;
  return result;
}

// The group is found as one change, for k and c are two. A loss of k with less
// damping explains the decay as well.
TEST(FindLossesInstead, ExchangesAMassGroup) {
  const DamageResult result = ResultOf(0.3);
  ASSERT_GE(result.subjects.size(), 3u);
  ASSERT_EQ(result.subjects[2].kind, ChangeKind::kMass);
  EXPECT_TRUE(result.estimate.groups[2].changed);
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kCannotTell)
      << result.judgement.sentence;
  EXPECT_EQ(result.judgement.reasons[0], Reason::kAmbiguous);
  // The change of k is that without the mass.
  EXPECT_NEAR(result.estimate.groups[0].change, -0.17, 0.01);
  bool is_rival = false;
  for (const RivalChange& rival : result.estimate.rivals) {
    is_rival = is_rival || (rival.found == 2 && rival.other == 0);
  }
  EXPECT_TRUE(is_rival);
}

// A mass that cannot change is no group, and the loss stands.
TEST(FindLossesInstead, NeedsAMass) {
  const DamageResult result = ResultOf(0.0);
  ASSERT_GE(result.subjects.size(), 2u);
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kDamage)
      << result.judgement.sentence;
  EXPECT_NEAR(result.estimate.groups[0].change, -0.17, 0.01);
  EXPECT_NEAR(result.estimate.groups[1].change, -0.17, 0.03);
}

}  // namespace
}  // namespace pinode
