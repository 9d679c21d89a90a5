#include "pinode/study/damage/scale_instead.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/study/damage/damage_analysis.h"
#include "tests/support/decay_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Differences of log stiffness, log damping and log mass, of which stiffness
// over mass has the deviation 0.001, damping over mass 0.01. Nothing but a
// prior of deviation 1 is known of the mass.
ChangeSets SetsOf(double stiffness, double damping) {
  PooledBaselines expected;
  expected.state.values = Vector::Zero(3);
  expected.state.covariance = 0.5 * Matrix::Ones(3, 3);
  expected.state.covariance(0, 0) += 0.5e-6;
  expected.state.covariance(1, 1) += 0.5e-4;
  GroupState current = expected.state;
  current.values = Vector{{stiffness, damping, 0.0}};
  return ChangeSets(expected, current);
}

TEST(ChangeSets, AMassWithADamperIsTheSameAsALoss) {
  const double loss = std::log(1.0 / 1.2);
  const ChangeSets sets = SetsOf(loss, 0.0);
  const Matrix unit = Matrix::Identity(3, 3);
  const ChangeSets::Fit one = sets.FitOf(unit.col(0));
  const ChangeSets::Fit two = sets.FitOf(unit.rightCols(2));
  EXPECT_NEAR(one.sizes[0], loss, 1e-6);
  EXPECT_NEAR(two.sizes[0], -loss, 1e-3);
  EXPECT_NEAR(two.sizes[1], -loss, 1e-3);
  EXPECT_NEAR(std::sqrt(one.covariance(0, 0)), 0.001, 1e-5);
  // The gains are the same but for the prior of the mass, that of 0.18 / 1.4.
  EXPECT_NEAR(one.gain - two.gain, 0.0, 0.05);
  EXPECT_GT(one.gain, 3e4);
  // A damper of a size that must match to 0.01 has 100 times less prior
  // probability, and is one more of three entries: log(300) = 5.7.
  EXPECT_NEAR(one.log_evidence - two.log_evidence, 5.7, 1.0);
}

// If the sizes do not match, the one change leaves something.
TEST(ChangeSets, ChangesThatDoNotMatchAreNoLossAlone) {
  const ChangeSets sets = SetsOf(std::log(1.0 / 1.2), 0.1);
  const Matrix unit = Matrix::Identity(3, 3);
  const ChangeSets::Fit one = sets.FitOf(unit.col(0));
  const ChangeSets::Fit two = sets.FitOf(unit.rightCols(2));
  EXPECT_NEAR(two.gain - one.gain, 100.0, 2.0);
  EXPECT_GT(two.log_evidence, one.log_evidence + 30.0);
}

TEST(ChangeSets, EvidenceIsThatOfNormalDifferences) {
  GroupState current;
  current.values = Vector{{0.3, -0.2, 0.5}};
  current.covariance =
      Matrix{{0.04, 0.01, 0.0}, {0.01, 0.09, 0.02}, {0.0, 0.02, 0.05}};
  PooledBaselines expected;
  expected.state.values = Vector{{0.1, 0.0, 0.1}};
  expected.state.covariance = 0.02 * Matrix::Identity(3, 3);
  const Matrix directions{{1.0, 0.0}, {0.0, 1.0}, {0.0, 1.0}};
  const Vector d = current.values - expected.state.values;
  const Matrix without = current.covariance + expected.state.covariance;
  const Matrix with = without + directions * directions.transpose();
  const auto log_density = [&](const Matrix& covariance) {
    return -0.5 * d.dot(covariance.inverse() * d) -
           0.5 * std::log(covariance.determinant());
  };
  EXPECT_NEAR(ChangeSets(expected, current).FitOf(directions).log_evidence,
              log_density(with) - log_density(without) - 2.0 * std::log(3.0),
              1e-10);
}

DamageResult AnalyseOrFail(const TestFit& healthy, const TestFit& fit,
                           bool masses) {
  Baseline baseline;
  std::string error;
  EXPECT_TRUE(BaselineFrom("before", healthy.problem, healthy.summary,
                           healthy.model, &baseline, &error))
      << error;
  DamageAnalysisOptions options;
  options.search = LookEverywhere(fit.problem);
  if (!masses) options.search.masses.clear();
  DamageResult result;
  EXPECT_TRUE(AnalyseDamage(fit.problem, fit.summary, fit.model, {baseline},
                            options, &result, &error))
      << error;
  return result;
}

// The same decay has k -16.7 %, or a mass and a damper of +20 %. One loss is
// likelier than two changes that match by chance.
TEST(FindScaleInstead, NamesAMassWithADamperBesideALoss) {
  const TestFit healthy = FitOfDecay(Vector{{1.0}}, 1.0, 1);
  const TestFit fit = FitOfDecay(Vector{{1.0 / 1.2}}, 1.0, 2);
  const DamageResult result = AnalyseOrFail(healthy, fit, true);
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kDamage)
      << result.judgement.sentence;
  EXPECT_THAT(result.remarks,
              Contains(AllOf(HasSubstr("Or, equally: the mass at w (+20"),
                             HasSubstr("with 'c' (+"),
                             HasSubstr("in place of 'k' (-16."),
                             HasSubstr("times as likely"))));
  // Who knows the masses is not asked.
  const DamageResult known = AnalyseOrFail(healthy, fit, false);
  EXPECT_EQ(known.judgement.verdict, DamageVerdict::kDamage);
  EXPECT_THAT(known.remarks, Not(Contains(HasSubstr("Or, equally"))));
}

// All springs lost the same, or all masses and all damping have grown: neither
// needs fewer changes. Three masses and a damper were "no loss of stiffness".
TEST(FindScaleInstead, CannotTellALossOfAllFromMassesEverywhere) {
  for (const int n : {2, 3}) {
    const Vector all = Vector::Ones(n);
    const TestFit healthy = FitOfDecay(all, 1.0, 1);
    const TestFit fit = FitOfDecay(all / 1.2, 1.0, 2);
    const DamageResult result = AnalyseOrFail(healthy, fit, true);
    EXPECT_EQ(result.judgement.verdict, DamageVerdict::kCannotTell)
        << n << ": " << result.judgement.sentence;
    const DamageResult known = AnalyseOrFail(healthy, fit, false);
    EXPECT_EQ(known.judgement.verdict, DamageVerdict::kDamage)
        << n << ": " << known.judgement.sentence;
  }
}

TEST(FindScaleInstead, LeavesALossOfOneSpring) {
  const TestFit healthy = FitOfDecay(Vector::Ones(3), 1.0, 1);
  const TestFit fit = FitOfDecay(Vector{{1.0, 1.0 / 1.2, 1.0}}, 1.0, 2);
  const DamageResult result = AnalyseOrFail(healthy, fit, true);
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kDamage)
      << result.judgement.sentence;
  EXPECT_NEAR(result.estimate.groups[1].change, 1.0 / 1.2 - 1.0, 0.01);
  EXPECT_THAT(result.remarks, Not(Contains(HasSubstr("Or, equally"))));
}

}  // namespace
}  // namespace pinode
