#include "pinode/study/damage/scale_instead.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "pinode/study/damage/damage_analysis.h"
#include "tests/support/decay_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
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

// Differences of states that know all entries over the first mass alone, and of
// that mass a prior of deviation 1. Candidates follow the groups.
class ScaleInsteadTest : public ::testing::Test {
 protected:
  static constexpr double kDeviation = 0.002;

  void Add(const std::string& name, ChangeKind kind, double difference,
           bool is_group, const std::string& place = "") {
    ChangeSubject subject;
    subject.name = name;
    subject.kind = kind;
    subject.place = place;
    if (is_group) {
      subjects_.push_back(subject);
      estimate_.groups.emplace_back();
    } else {
      candidates_.emplace_back();
      candidates_.back().subject = subject;
    }
    kinds_.push_back(subject);
    differences_.push_back(difference);
    is_logarithm_.push_back(is_group || kind != ChangeKind::kDamping);
  }
  void AddGroups(const std::vector<std::string>& names,
                 const std::vector<double>& differences) {
    for (size_t j = 0; j < names.size(); ++j) {
      Add(names[j],
          names[j][0] == 'k'   ? ChangeKind::kStiffness
          : names[j][0] == 'c' ? ChangeKind::kDamping
                               : ChangeKind::kMass,
          differences[j], true);
    }
    all_.emplace(names.size(), &candidates_, &subjects_, &estimate_);
  }
  void AddMasses(int count) {
    for (int i = 1; i <= count; ++i) {
      const std::string place = "w" + std::to_string(i);
      Add("mass." + place, ChangeKind::kMass, 0.0, false, place);
    }
  }

  // Marks an entry as found; `change` is a fraction.
  void Found(int entry, double change) {
    const auto j = static_cast<size_t>(all_->SubjectOf(entry));
    GroupChange& found = estimate_.groups[j];
    found.changed = true;
    found.change = change;
    found.sigma = kDeviation;
    found.lower95 = change - 2.0 * kDeviation;
    found.upper95 = change + 2.0 * kDeviation;
    found.probability = change < -0.05 ? 1.0 : 0.0;
  }

  Matrix Covariance() const {
    const auto size = static_cast<Eigen::Index>(kinds_.size());
    Vector first_mass = Vector::Zero(size);
    Vector own = Vector::Zero(size);
    bool has_mass = false;
    for (Eigen::Index j = 0; j < size; ++j) {
      const ChangeSubject& subject = kinds_[static_cast<size_t>(j)];
      // A mass group is all masses, and a candidate at w1 the first.
      if (subject.kind == ChangeKind::kMass &&
          (subject.place.empty() || subject.place == "w1")) {
        first_mass[j] = 1.0;
      } else {
        own[j] = 1.0;
      }
      has_mass = has_mass || first_mass[j] > 0.0;
    }
    EXPECT_TRUE(has_mass);
    Matrix information = Matrix::Identity(size, size);
    for (Eigen::Index j = 0; j < size; ++j) {
      if (!(own[j] > 0.0)) continue;
      Vector row = Vector::Unit(size, j) - first_mass;
      for (Eigen::Index m = 0; m < size; ++m) {
        const ChangeSubject& mass = kinds_[static_cast<size_t>(m)];
        // Both masses are multiples of the group.
        if (kinds_[static_cast<size_t>(j)].kind == ChangeKind::kMass &&
            mass.kind == ChangeKind::kMass && mass.place.empty()) {
          row[m] = 0.0;
        }
      }
      information += row * row.transpose() / (kDeviation * kDeviation);
    }
    return information.llt().solve(Matrix::Identity(size, size));
  }

  // Runs the search; baselines differ by `between` in the first damping.
  void Run(double between = 0.0) {
    const Matrix half = 0.5 * Covariance();
    GroupState expected, current;
    expected.values = Vector::Zero(half.rows());
    expected.covariance = current.covariance = half;
    current.values = Eigen::Map<const Vector>(
        differences_.data(), static_cast<Eigen::Index>(differences_.size()));
    std::vector<GroupState> healthy = {expected};
    if (between > 0.0) {
      healthy.push_back(expected);
      for (size_t j = 0; j < kinds_.size(); ++j) {
        if (kinds_[j].kind != ChangeKind::kDamping) continue;
        healthy[0].values[static_cast<Eigen::Index>(j)] = between;
        healthy[1].values[static_cast<Eigen::Index>(j)] = -between;
        break;
      }
    }
    std::string error;
    ASSERT_TRUE(FindScaleInstead({healthy, current, is_logarithm_}, {}, &*all_,
                                 &is_loss_, &masses_, &error))
        << error;
  }

  std::vector<ChangeSubject> kinds_, subjects_;
  std::vector<ChangeCandidate> candidates_;
  std::vector<double> differences_;
  std::vector<bool> is_logarithm_, is_loss_;
  ChangeEstimate estimate_;
  std::optional<ResultSubjects> all_;
  std::vector<MassesInstead> masses_;
};

// One of two springs is lost with the two masses that were found and without
// them.
TEST_F(ScaleInsteadTest, ALossEitherWayStaysALoss) {
  AddGroups({"k1", "k2", "c"}, {std::log(0.7), 0.0, 0.0});
  AddMasses(2);
  differences_[3] = differences_[4] = std::log(1.2);
  Found(0, -0.3);
  Found(3, 0.2);
  Found(4, 0.2);
  Run();
  ASSERT_GE(is_loss_.size(), 2u);
  EXPECT_FALSE(is_loss_[0]);
  EXPECT_TRUE(is_loss_[1]);
  EXPECT_EQ(estimate_.groups[0].change, -0.3);
  EXPECT_LT(estimate_.groups[0].lower95, 0.7 / 1.2 - 1.0);
  EXPECT_GT(estimate_.groups[0].upper95, -0.3);
  EXPECT_NEAR(estimate_.groups[1].change, 1.0 / 1.2 - 1.0, 0.005);
}

// Two baselines do not show well how much records differ.
TEST_F(ScaleInsteadTest, IntervalsAllowForFewBaselines) {
  AddGroups({"k1", "k2", "c"}, {0.0, 0.0, 0.0});
  AddMasses(2);
  differences_[3] = differences_[4] = std::log(1.2);
  const auto quantile = [this](double between) {
    Found(3, 0.2);
    Found(4, 0.2);
    Run(between);
    const GroupChange& k1 = estimate_.groups[0];
    EXPECT_TRUE(is_loss_[0]);
    return (std::log1p(k1.upper95) - std::log1p(k1.change)) *
           (1.0 + k1.change) / k1.sigma;
  };
  EXPECT_NEAR(quantile(0.0), 1.96, 0.01);
  EXPECT_GT(quantile(0.3), 2.3);
}

// All masses grew by 20 %, and k1 lost 28 %: two changes in place of four.
TEST_F(ScaleInsteadTest, OneLossMayStayBesideAllMasses) {
  const double grown = std::log(1.2);
  AddGroups({"k1", "k2", "k3", "c"},
            {std::log(0.72) - grown, -grown, -grown, -grown});
  AddMasses(3);
  Found(0, 0.72 / 1.2 - 1.0);
  for (const int j : {1, 2, 3}) Found(j, 1.0 / 1.2 - 1.0);
  Run();
  EXPECT_THAT(is_loss_, ElementsAre(false, true, true, false));
  ASSERT_FALSE(masses_.empty());
  EXPECT_THAT(masses_[0].losses, ElementsAre(1u, 2u));
  EXPECT_GT(masses_[0].log_odds, 0.0);
  EXPECT_THAT(masses_[0].what,
              AllOf(HasSubstr("all masses that were looked at (+2"),
                    HasSubstr("and 'k1' (-2")));
  // The loss beside them may be as small as that.
  EXPECT_LT(estimate_.groups[0].lower95, 0.72 / 1.2 - 1.0);
  EXPECT_GT(estimate_.groups[0].upper95, -0.28);
}

// The spring that stays beside all masses is stiffer than before.
TEST_F(ScaleInsteadTest, WhatStaysBesideAllMassesMayBeNoLoss) {
  const double grown = std::log(1.2);
  AddGroups({"k1", "k2", "k3", "c"},
            {std::log(1.06) - grown, -grown, -grown, -grown});
  AddMasses(3);
  Found(0, 1.06 / 1.2 - 1.0);
  for (const int j : {1, 2, 3}) Found(j, 1.0 / 1.2 - 1.0);
  Run();
  EXPECT_THAT(is_loss_, ElementsAre(true, true, true, false));
}

// A mass may stay as well.
TEST_F(ScaleInsteadTest, OneMassMayStayBesideAllMasses) {
  const double grown = std::log(1.2);
  AddGroups({"k1", "k2", "k3", "c"}, {-grown, -grown, -grown, -grown});
  AddMasses(3);
  differences_[5] = std::log(1.3);
  for (const int j : {0, 1, 2, 3}) Found(j, 1.0 / 1.2 - 1.0);
  Found(5, 0.3);
  Run();
  ASSERT_GE(is_loss_.size(), 3u);
  EXPECT_TRUE(is_loss_[0] && is_loss_[1] && is_loss_[2]);
  ASSERT_FALSE(masses_.empty());
  EXPECT_THAT(masses_[0].what, HasSubstr("and the mass at w2 (+"));
}

TEST_F(ScaleInsteadTest, SpringsInNoGroupAreLostToo) {
  const double grown = std::log(1.2);
  AddGroups({"k1"}, {-grown});
  AddMasses(3);
  Add("damping.all", ChangeKind::kDamping, 0.0, false, "all modes");
  Add("stiffness.w1-w2", ChangeKind::kStiffness, -grown, false, "w1-w2");
  Add("stiffness.w2-w3", ChangeKind::kStiffness, -grown, false, "w2-w3");
  for (const int j : {0, 5, 6}) Found(j, 1.0 / 1.2 - 1.0);
  Run();
  EXPECT_THAT(is_loss_, ElementsAre(true, true, true));
  ASSERT_FALSE(masses_.empty());
  std::vector<std::string> remarks;
  RemarkMassesInstead(masses_, *all_, &remarks);
  // A factor on damping that is no logarithm is printed as it is.
  EXPECT_THAT(remarks[0],
              AllOf(HasSubstr("with the damping of all modes (+18.2 %)"),
                    HasSubstr("'k1' (-16.7 %), spring w1-w2 (-16.7 %), spring "
                              "w2-w3 (-16.7 %)"),
                    HasSubstr("fix mass groups")));
}

// Three masses were found where springs in no group were lost.
TEST_F(ScaleInsteadTest, SpringsInNoGroupStandForMasses) {
  const double grown = std::log(1.2);
  AddGroups({"k1", "c"}, {0.0, 0.0});
  AddMasses(3);
  for (const size_t j : {2, 3, 4}) differences_[j] = grown;
  Add("stiffness.w1-w2", ChangeKind::kStiffness, 0.0, false, "w1-w2");
  Add("stiffness.w2-w3", ChangeKind::kStiffness, 0.0, false, "w2-w3");
  for (const int j : {2, 3, 4}) Found(j, 0.2);
  Run();
  ASSERT_EQ(subjects_.size(), 7u);
  ASSERT_EQ(is_loss_.size(), 7u);
  EXPECT_TRUE(is_loss_[0] && is_loss_[5] && is_loss_[6]);
  EXPECT_NEAR(estimate_.groups[6].change, 1.0 / 1.2 - 1.0, 0.005);
}

// A group of all masses beside each mass takes no part of their growth.
TEST_F(ScaleInsteadTest, AMassIsCountedOnce) {
  const double grown = std::log(1.2);
  AddGroups({"k1", "k2", "c", "m"}, {-grown, -grown, 0.0, 0.0});
  AddMasses(2);
  for (const int j : {0, 1}) Found(j, 1.0 / 1.2 - 1.0);
  Run();
  ASSERT_FALSE(masses_.empty());
  EXPECT_EQ(masses_[0].losses.size(), 2u);
  EXPECT_THAT(masses_[0].what,
              AllOf(HasSubstr("all masses that were looked at (+20 %)"),
                    HasSubstr("with 'c' (+20 %)")));
}

// One group may be all springs.
TEST_F(ScaleInsteadTest, AllMassesStandForOneGroup) {
  const double grown = std::log(1.2);
  AddGroups({"k", "c"}, {-grown, 0.0});
  AddMasses(3);
  Found(0, 1.0 / 1.2 - 1.0);
  Run();
  ASSERT_EQ(masses_.size(), 1u);
  EXPECT_LT(masses_[0].log_odds, -3.0);
  EXPECT_THAT(is_loss_, ElementsAre(false, false));
  std::vector<std::string> remarks;
  RemarkMassesInstead(masses_, *all_, &remarks);
  EXPECT_THAT(
      remarks[0],
      AllOf(HasSubstr("Or, with the same motion: all masses that were looked "
                      "at (+20 %) with 'c' (+20 %) in place of 'k'"),
            HasSubstr("the loss is "),
            HasSubstr("If the masses have changed, this is no damage.")));
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
              Contains(AllOf(
                  HasSubstr("Or, with the same motion: the mass at w (+20"),
                  HasSubstr("with 'c' (+"), HasSubstr("in place of 'k' (-16."),
                  HasSubstr("times as likely"))));
  // Who knows the masses is not asked.
  const DamageResult known = AnalyseOrFail(healthy, fit, false);
  EXPECT_EQ(known.judgement.verdict, DamageVerdict::kDamage);
  EXPECT_THAT(known.remarks, Not(Contains(HasSubstr("with the same motion"))));
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
  EXPECT_THAT(result.remarks, Not(Contains(HasSubstr("with the same motion"))));
}

}  // namespace
}  // namespace pinode
