#include "pinode/study/explanations/refit_odds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

constexpr Eigen::Index kSamplesOfFit = 200;

// A record with two fitted channels and one that is predicted only. The values
// alternate, so that residuals that are a share of them have no memory.
IdentificationProblem TwoFittedChannels() {
  IdentificationProblem problem;
  IdentificationRecord record;
  record.excitation.emplace(0.0, 0.1, Matrix::Zero(1, kSamplesOfFit),
                            Interpolation::kLinear);
  for (int c = 0; c < 3; ++c) {
    MeasuredChannel channel;
    channel.values.resize(kSamplesOfFit);
    for (Eigen::Index i = 0; i < kSamplesOfFit; ++i) {
      channel.values[i] = i % 2 == 0 ? 1.0 : -1.0;
    }
    channel.fit = c < 2;
    record.channels.push_back(channel);
  }
  // A missing sample counts for nothing.
  record.channels[0].values[7] = kNaN;
  problem.records.push_back(record);
  return problem;
}

// A fit that leaves this share of each value.
FitSummary FitThatLeaves(const IdentificationProblem& problem, double share) {
  FitSummary fit;
  RecordScore score;
  score.finite = true;
  const std::vector<MeasuredChannel>& channels = problem.records[0].channels;
  score.prediction.resize(static_cast<Eigen::Index>(channels.size()),
                          kSamplesOfFit);
  for (size_t c = 0; c < channels.size(); ++c) {
    score.prediction.row(static_cast<Eigen::Index>(c)) =
        (1.0 - share) * channels[c].values.transpose();
    ChannelScore channel;
    channel.rmse = share;
    score.channels.push_back(channel);
  }
  fit.records.push_back(score);
  return fit;
}

// A suspect of two factors.
Suspect FactorsOf(Suspect::Kind kind) {
  Suspect suspect;
  suspect.kind = kind;
  suspect.groups.resize(2);
  suspect.groups[0].alpha.name = "stiffness";
  suspect.groups[1].alpha.name = "damping";
  return suspect;
}

void SetFactors(double stiffness, double damping, FitSummary* fit) {
  fit->parameters.resize(2);
  fit->parameters[0].name = "stiffness";
  fit->parameters[0].value = stiffness;
  fit->parameters[1].name = "damping";
  fit->parameters[1].value = damping;
  for (ParameterEstimate& one : fit->parameters) one.sigma = 0.001;
}

class RefitOddsTest : public ::testing::Test {
 protected:
  // Log odds of a refit that leaves a tenth, with the last of three suspects.
  double LogOddsWith(Suspect::Kind kind, double stiffness, double damping) {
    Refit refit;
    refit.suspects = {2};
    refit.problem = problem_;
    refit.fit = FitThatLeaves(problem_, 0.1);
    SetFactors(stiffness, damping, &refit.fit);
    return odds_.LogOddsOf(refit, {Suspect(), Suspect(), FactorsOf(kind)});
  }

  const IdentificationProblem problem_ = TwoFittedChannels();
  const FitSummary fit_ = FitThatLeaves(problem_, 0.2);
  const RefitOdds odds_{problem_, fit_};
};

TEST_F(RefitOddsTest, FittedSamplesThatAreThereCount) {
  EXPECT_EQ(odds_.num_samples(), 2.0 * kSamplesOfFit - 1.0);
  EXPECT_NEAR(odds_.Penalty(3, 5), 1.5 * std::log(399.0) + std::log(5.0),
              1e-12);
}

// Half the error of N samples: N log 2, less the price of two unknowns and of
// the choice among three suspects.
TEST_F(RefitOddsTest, AreThoseOfSchwarz) {
  EXPECT_EQ(ResidualMemory(problem_, fit_), 1.0);
  EXPECT_NEAR(LogOddsWith(Suspect::Kind::kDamping, 0.0, 0.0),
              399.0 * std::log(2.0) - odds_.Penalty(2, 3), 1e-9);
}

TEST_F(RefitOddsTest, ResidualsWithAMemoryCountAsFewer) {
  Refit refit;
  refit.problem = problem_;
  refit.fit = FitThatLeaves(problem_, 0.1);
  const double white = odds_.LogOddsOf(refit, {});
  refit.fit.records[0].prediction.row(0).setZero();
  refit.fit.records[0].prediction.row(1) =
      problem_.records[0].channels[1].values.transpose() -
      Vector::LinSpaced(kSamplesOfFit, -1.0, 1.0).transpose();
  const double memory = ResidualMemory(refit.problem, refit.fit);
  EXPECT_GT(memory, 5.0);
  EXPECT_NEAR(odds_.LogOddsOf(refit, {}), white / memory, 1e-9);
}

// A clock gives the damping a factor, and the stiffness its square.
TEST_F(RefitOddsTest, AClockHasOneRate) {
  const Suspect::Kind clock = Suspect::Kind::kClockRate;
  EXPECT_TRUE(std::isfinite(LogOddsWith(clock, 0.2, std::sqrt(1.2) - 1.0)));
  EXPECT_EQ(LogOddsWith(clock, 0.2, 0.0), -kInfinity);
  EXPECT_TRUE(std::isfinite(LogOddsWith(Suspect::Kind::kStiffness, 0.2, 0.0)));
}

TEST_F(RefitOddsTest, AMassOfManyTimesStandsForSomethingElse) {
  EXPECT_TRUE(std::isfinite(LogOddsWith(Suspect::Kind::kMass, 2.5, 0.0)));
  EXPECT_EQ(LogOddsWith(Suspect::Kind::kMass, 3.5, 0.0), -kInfinity);
  EXPECT_TRUE(std::isfinite(LogOddsWith(Suspect::Kind::kDamping, 3.5, 0.0)));
}

TEST_F(RefitOddsTest, ASimulationThatDivergesHasNone) {
  Refit refit;
  refit.problem = problem_;
  refit.fit = FitThatLeaves(problem_, 0.1);
  refit.fit.records[0].finite = false;
  EXPECT_EQ(odds_.LogOddsOf(refit, {}), -kInfinity);
}

}  // namespace
}  // namespace pinode
