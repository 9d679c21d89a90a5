#include "pinode/estimate/fit/fit_once.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A chain of `n` masses whose true groups are all zero, with accelerations of
// every mass, and its groups as `adjust` leaves them.
struct ChainProblem {
  ChainProblem(int n, double k, double c, int samples, double noise,
               uint64_t seed,
               const std::function<void(std::vector<GroupTerm>*)>& adjust) {
    auto truth = testing::MakeGroupedChain(n, k, c);
    std::vector<GroupTerm> groups = truth->groups();
    adjust(&groups);
    auto dynamics = std::make_shared<StructuralDynamics>(
        testing::MakeChain(n, k, c), truth->inputs());
    std::string error;
    for (const GroupTerm& group : groups) {
      EXPECT_TRUE(dynamics->AddGroup(group, &error)) << error;
    }
    IdentificationRecord record =
        testing::MakeExcitedRecord(*truth, samples, 0.02);
    for (int i = 0; i < n; ++i) {
      record.channels.push_back(testing::MakeChannel(
          "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, n, i));
    }
    testing::Simulate(*truth, Vector::Zero(n), Vector::Zero(2 * n), noise, seed,
                      &record);
    problem.dynamics = dynamics;
    problem.records.push_back(record);
    problem.sensors.name = "sensors";
  }

  void Run(const IdentificationOptions& options = {}) {
    testing::FitAndJudge(problem, options, nullptr, &summary, &model);
  }

  const ParameterEstimate& Find(const std::string& name) const {
    static const ParameterEstimate kNone;
    for (const ParameterEstimate& estimate : summary.parameters) {
      if (estimate.name == name) return estimate;
    }
    ADD_FAILURE() << "no parameter '" << name << "'";
    return kNone;
  }

  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
};

void StartTwentyPercentOff(std::vector<GroupTerm>* groups) {
  for (size_t i = 0; i < groups->size(); ++i) {
    (*groups)[i].alpha.value = i % 2 == 0 ? -0.2 : 0.2;
  }
}

TEST(Identify, FindsAStiffnessFromAccelerationsAlone) {
  double squares = 0.0;
  const int trials = 12;
  for (uint64_t seed = 1; seed <= trials; ++seed) {
    ChainProblem chain(1, 40.0, 0.5, 500, 0.05, seed, StartTwentyPercentOff);
    chain.Run();
    ASSERT_EQ(chain.summary.termination, Termination::kConverged)
        << chain.summary.message;
    EXPECT_TRUE(chain.summary.usable()) << chain.summary.message;
    const ParameterEstimate& k1 = chain.Find("k1");
    EXPECT_EQ(k1.initial, -0.2);
    EXPECT_GT(k1.sigma, 0.0);
    EXPECT_LT(k1.sigma, 0.01);
    EXPECT_LT(std::abs(k1.value), 3.5 * k1.sigma) << seed;
    EXPECT_EQ(chain.model.parameters[0], k1.value);
    EXPECT_FALSE(k1.at_bound);
    // The noise that was put in.
    const RecordScore& score = chain.summary.records[0];
    EXPECT_NEAR(score.channels[0].nrmse, 0.05, 0.01);
    EXPECT_GT(score.prior_nrmse, 0.2);
    EXPECT_NEAR(score.channels[0].sigma, score.channels[0].rmse,
                0.02 * score.channels[0].rmse);
    EXPECT_LT(chain.summary.largest_gap, 1e-6);
    squares += (k1.value / k1.sigma) * (k1.value / k1.sigma);
  }
  // The intervals mean what they say: chi-square of twelve.
  EXPECT_GT(squares / trials, 0.25);
  EXPECT_LT(squares / trials, 2.4);
}

TEST(Identify, NamesAnOffsetThatNobodyLooksFor) {
  ChainProblem chain(1, 40.0, 0.5, 500, 0.01, 1, StartTwentyPercentOff);
  chain.Run();
  EXPECT_THAT(chain.summary.remarks, ::testing::IsEmpty());
  Vector& values = chain.problem.records[0].channels[0].values;
  values.array() += 0.1 * std::sqrt(values.squaredNorm() / 500.0);
  chain.Run();
  ASSERT_EQ(chain.summary.remarks.size(), 1u);
  EXPECT_THAT(chain.summary.remarks[0],
              HasSubstr("the difference between sensor 'a1' and the model is "
                        "mostly a constant"));
}

TEST(Identify, SingleShootingAndJetsAgreeWithTheDefault) {
  Vector values[3];
  for (int i = 0; i < 3; ++i) {
    ChainProblem chain(2, 40.0, 0.5, 300, 0.05, 3, StartTwentyPercentOff);
    IdentificationOptions options;
    if (i == 1) options.shooting = IdentificationOptions::Shooting::kSingle;
    if (i == 2) options.derivatives = DerivativeMethod::kJets;
    chain.Run(options);
    ASSERT_EQ(chain.summary.termination, Termination::kConverged)
        << chain.summary.message;
    values[i] = chain.model.parameters;
  }
  EXPECT_LT((values[1] - values[0]).norm(), 1e-4);
  EXPECT_LT((values[2] - values[0]).norm(), 1e-6);
}

TEST(Identify, RefusesWhatIsNotAProblem) {
  const auto fails = [](const ChainProblem& chain, const std::string& message,
                        const IdentificationOptions& options = {}) {
    IdentificationSummary summary;
    IdentifiedModel model;
    testing::FitAndJudge(chain.problem, options, nullptr, &summary, &model);
    EXPECT_EQ(summary.termination, Termination::kFailure);
    EXPECT_FALSE(summary.usable());
    EXPECT_THAT(summary.message, HasSubstr(message));
    EXPECT_EQ(summary.num_iterations, 0);
  };
  const ChainProblem good(1, 40.0, 0.5, 50, 0.0, 1, StartTwentyPercentOff);

  fails(ChainProblem(1, 40.0, 0.5, 50, 0.0, 1,
                     [](std::vector<GroupTerm>* groups) {
                       (*groups)[0].alpha.free = false;
                     }),
        "no parameter is free");
  ChainProblem chain = good;
  chain.problem.records.clear();
  fails(chain, "no training record");
  chain = good;
  chain.problem.records[0].channels[0].fit = false;
  fails(chain, "no training record has a fitted channel");
  chain = good;
  chain.problem.records[0].channels.clear();
  fails(chain, "'shake'");
  chain = good;
  chain.problem.records[0].channels[0].values.setConstant(
      std::numeric_limits<double>::quiet_NaN());
  fails(chain, "channel 'a1': it holds no value");
  chain = good;
  chain.problem.records[0].channels[0].values.conservativeResize(20);
  fails(chain, "length");
  chain = good;
  chain.problem.records[0].channels[0].sigma = -1.0;
  fails(chain, "negative");
  chain = good;
  chain.problem.records[0].start = IdentificationRecord::Start::kKnown;
  fails(chain, "start needs 2 finite values");
  chain = good;
  chain.problem.dynamics = nullptr;
  fails(chain, "no model");
  chain = good;
  chain.problem.records[0].excitation.emplace(0.0, 0.02, Matrix::Zero(2, 50),
                                              Interpolation::kLinear);
  fails(chain, "2 inputs, the model has 1");

  IdentificationOptions options;
  options.max_num_iterations = 0;
  fails(good, "max_iterations is 0", options);
  options = IdentificationOptions();
  options.num_threads = 0;
  fails(good, "threads is 0", options);
  options = IdentificationOptions();
  options.loss_scale = 0.0;
  fails(good, "robust_scale is 0", options);
}

// An infinite measurement is neither present nor missing.
TEST(Identify, SurvivesValuesThatAreNotFinite) {
  ChainProblem chain(1, 40.0, 0.5, 300, 0.02, 1, StartTwentyPercentOff);
  Vector& values = chain.problem.records[0].channels[0].values;
  values[20] = std::numeric_limits<double>::quiet_NaN();
  values.segment(100, 30).setConstant(std::numeric_limits<double>::quiet_NaN());
  chain.Run();
  EXPECT_EQ(chain.summary.termination, Termination::kConverged)
      << chain.summary.message;
  EXPECT_NEAR(chain.Find("k1").value, 0.0, 0.01);
  values[30] = std::numeric_limits<double>::infinity();
  chain.Run();
  EXPECT_EQ(chain.summary.termination, Termination::kFailure);
  EXPECT_FALSE(chain.summary.message.empty());
}

TEST(Identify, StopsWhenTheCallbackSaysSo) {
  for (int stop_at : {0, 2}) {
    ChainProblem chain(2, 40.0, 0.5, 300, 0.05, 1, StartTwentyPercentOff);
    int calls = 0;
    IdentificationOptions options;
    options.callback = [&](const IdentificationProgress& progress) {
      EXPECT_EQ(progress.model->parameters.size(), 2);
      EXPECT_TRUE(progress.model->parameters.allFinite());
      EXPECT_GE(progress.stage, 1);
      EXPECT_LE(progress.stage, progress.num_stages);
      EXPECT_TRUE(std::isfinite(progress.cost));
      return calls++ < stop_at;
    };
    chain.Run(options);
    EXPECT_EQ(chain.summary.termination, Termination::kInterrupted);
    EXPECT_FALSE(chain.summary.usable());
    EXPECT_EQ(calls, stop_at + 1);
    ASSERT_EQ(chain.model.parameters.size(), 2);
    EXPECT_TRUE(chain.model.parameters.allFinite());
    ASSERT_EQ(chain.summary.records.size(), 1u);
    EXPECT_TRUE(chain.summary.records[0].finite);
    ASSERT_EQ(chain.model.starts.size(), 1u);
    EXPECT_TRUE(chain.model.starts[0].allFinite());
  }
}

// What was found until then is not lost: the step that was accepted last.
TEST(Identify, KeepsTheBestSoFarWhenItIsStopped) {
  ChainProblem chain(2, 40.0, 0.5, 300, 0.05, 1, StartTwentyPercentOff);
  std::vector<double> costs;
  Vector first, best;
  IdentificationOptions options;
  options.callback = [&](const IdentificationProgress& progress) {
    if (costs.empty()) first = progress.model->parameters;
    if (costs.empty() || progress.cost < costs.back()) {
      costs.push_back(progress.cost);
      best = progress.model->parameters;
    }
    return costs.size() < 4;
  };
  chain.Run(options);
  EXPECT_EQ(chain.summary.termination, Termination::kInterrupted);
  ASSERT_EQ(costs.size(), 4u);
  EXPECT_LT(costs.back(), 0.1 * costs.front());
  EXPECT_GT((best - first).norm(), 1e-3);
  EXPECT_LT((chain.model.parameters - best).norm(), 1e-9 * best.norm());
  EXPECT_LT(chain.summary.final_cost, 1.001 * costs.back());
  // Intervals are those of a minimum.
  EXPECT_EQ(chain.summary.covariance_method, "");
  EXPECT_EQ(chain.summary.covariance.size(), 0);
  for (const ParameterEstimate& parameter : chain.summary.parameters) {
    EXPECT_TRUE(std::isinf(parameter.sigma)) << parameter.name;
  }
}

// The callback sees the parameters of the iteration, not those of the start.
TEST(Identify, CallbackSeesTheCurrentParameters) {
  ChainProblem chain(1, 40.0, 0.5, 300, 0.05, 1, StartTwentyPercentOff);
  double last = 1.0;
  IdentificationOptions options;
  options.callback = [&](const IdentificationProgress& progress) {
    last = progress.model->parameters[0];
    return true;
  };
  chain.Run(options);
  EXPECT_NEAR(last, chain.model.parameters[0], 1e-3);
}

TEST(Identify, StopsAtTheIterationLimit) {
  ChainProblem chain(2, 40.0, 0.5, 300, 0.05, 1, StartTwentyPercentOff);
  IdentificationOptions options;
  options.max_num_iterations = 2;
  chain.Run(options);
  EXPECT_EQ(chain.summary.termination, Termination::kNoConvergence);
  EXPECT_LE(chain.summary.num_iterations, 2);
  EXPECT_FALSE(chain.summary.usable());
}

TEST(Identify, RespectsBounds) {
  ChainProblem chain(2, 40.0, 0.5, 300, 0.02, 1,
                     [](std::vector<GroupTerm>* groups) {
                       (*groups)[0].alpha.value = -0.2;
                       (*groups)[0].alpha.lower = -0.5;
                       (*groups)[0].alpha.upper = -0.1;
                       (*groups)[1].alpha.lower = -0.3;
                       (*groups)[1].alpha.upper = 0.3;
                     });
  IdentificationOptions options;
  options.callback = [](const IdentificationProgress& progress) {
    EXPECT_LE(progress.model->parameters[0], -0.1);
    EXPECT_GE(progress.model->parameters[0], -0.5);
    return true;
  };
  chain.Run(options);
  EXPECT_NE(chain.summary.termination, Termination::kFailure);
  EXPECT_NEAR(chain.Find("k1").value, -0.1, 1e-6);
  EXPECT_LE(chain.Find("k1").value, -0.1);
  EXPECT_TRUE(chain.Find("k1").at_bound);
  // Since k1 has to be too soft, k2 becomes as stiff as it may: with k1 at its
  // bound the error falls all the way from k2 = -0.3 to 0.3.
  EXPECT_EQ(chain.Find("k2").value, 0.3);
  EXPECT_EQ(chain.summary.termination, Termination::kConverged);
  EXPECT_LT(chain.summary.promised_share, 1e-9);
}

TEST(Identify, SaysWhereTheTrajectoryExplodes) {
  ChainProblem chain(
      2, 4000.0, 0.0, 400, 0.0, 1,
      [](std::vector<GroupTerm>* groups) { (*groups)[1].alpha.value = -3.0; });
  IdentificationOptions options;
  options.shooting = IdentificationOptions::Shooting::kSingle;
  options.num_starts = 1;  // by itself a fit that is lost tries others
  chain.Run(options);
  EXPECT_EQ(chain.summary.termination, Termination::kFailure);
  EXPECT_FALSE(chain.summary.usable());
  EXPECT_THAT(chain.summary.message, HasSubstr("record 'shake'"));
  EXPECT_THAT(chain.summary.message, HasSubstr("segment 1"));
  EXPECT_THAT(chain.summary.message, HasSubstr(" at t = "));
  EXPECT_THAT(chain.summary.message,
              ::testing::AnyOf(HasSubstr("[u1]"), HasSubstr("[u2]")));
  EXPECT_THAT(chain.summary.BriefReport(), HasSubstr("Not usable: "));
}

// Short segments stand what a free run of the whole record does not.
TEST(Identify, MultipleShootingComesBackFromAnUnstableModel) {
  ChainProblem chain(
      1, 40.0, 0.5, 400, 0.02, 1,
      [](std::vector<GroupTerm>* groups) { (*groups)[0].alpha.value = -1.3; });
  chain.Run();
  EXPECT_EQ(chain.summary.termination, Termination::kConverged)
      << chain.summary.message;
  EXPECT_TRUE(chain.summary.usable()) << chain.summary.message;
  EXPECT_NEAR(chain.Find("k1").value, 0.0, 0.01);
}

TEST(Identify, LeavesFixedParametersAlone) {
  ChainProblem chain(2, 40.0, 0.5, 300, 0.02, 1,
                     [](std::vector<GroupTerm>* groups) {
                       (*groups)[0].alpha.value = -0.2;
                       (*groups)[1].alpha.value = 0.0314;
                       (*groups)[1].alpha.free = false;
                     });
  chain.Run();
  EXPECT_EQ(chain.Find("k2").value, 0.0314);
  EXPECT_EQ(chain.Find("k2").sigma, 0.0);
  EXPECT_FALSE(chain.Find("k2").free);
  EXPECT_EQ(chain.model.parameters[1], 0.0314);
  EXPECT_GT(std::abs(chain.Find("k1").value + 0.2), 0.1);
  EXPECT_THAT(chain.summary.covariance_names, ElementsAre("k1"));
}

// Two groups of the same spring: the data see their sum alone.
TEST(Identify, PriorsDecideWhatTheDataDoNot) {
  const auto twins = [](bool prior) {
    return [prior](std::vector<GroupTerm>* groups) {
      GroupTerm twin = (*groups)[0];
      twin.group.name = twin.alpha.name = "twin";
      if (prior) {
        twin.alpha.prior_mean = 0.05;
        twin.alpha.prior_sigma = 0.01;
      }
      (*groups)[0].alpha.value = -0.2;
      groups->push_back(twin);
    };
  };
  ChainProblem without(1, 40.0, 0.5, 300, 0.02, 1, twins(false));
  without.Run();
  EXPECT_EQ(without.summary.undetermined.size(), 1u);
  for (const std::string& direction : without.summary.undetermined) {
    EXPECT_THAT(direction, HasSubstr("k1"));
    EXPECT_THAT(direction, HasSubstr("twin"));
    EXPECT_THAT(direction, HasSubstr(" - "));
  }
  EXPECT_NEAR(without.Find("k1").value + without.Find("twin").value, 0.0, 0.01);
  EXPECT_GT(without.Find("k1").sigma, 1.0);

  ChainProblem with(1, 40.0, 0.5, 300, 0.02, 1, twins(true));
  with.Run();
  EXPECT_EQ(with.summary.termination, Termination::kConverged)
      << with.summary.message;
  EXPECT_THAT(with.summary.undetermined, IsEmpty());
  EXPECT_NEAR(with.Find("twin").value, 0.05, 1e-4);
  EXPECT_NEAR(with.Find("twin").sigma, 0.01, 1e-3);
  EXPECT_NEAR(with.Find("k1").value, -0.05, 0.01);
}

// A gain that no channel uses.
TEST(Identify, NamesAParameterWithoutEffect) {
  Parameter gain;
  gain.name = "gain.unused";
  gain.value = 1.0;
  ChainProblem without(1, 40.0, 0.5, 300, 0.02, 1, StartTwentyPercentOff);
  without.problem.sensors.parameters = {gain};
  without.Run();
  EXPECT_THAT(without.summary.undetermined, ElementsAre("gain.unused"));
  EXPECT_NEAR(without.Find("k1").value, 0.0, 0.01);

  gain.prior_mean = 1.3;
  gain.prior_sigma = 0.2;
  ChainProblem with(1, 40.0, 0.5, 300, 0.02, 1, StartTwentyPercentOff);
  with.problem.sensors.parameters = {gain};
  with.Run();
  EXPECT_THAT(with.summary.undetermined, IsEmpty());
  EXPECT_NEAR(with.Find("gain.unused").value, 1.3, 1e-5);
  EXPECT_NEAR(with.Find("gain.unused").sigma, 0.2, 1e-4);
}

TEST(Identify, MultistartIsReproducible) {
  const auto bounded = [](std::vector<GroupTerm>* groups) {
    for (GroupTerm& group : *groups) {
      group.alpha.value = -0.2;
      group.alpha.lower = -0.6;
      group.alpha.upper = 0.6;
    }
  };
  IdentificationOptions options;
  options.num_starts = 3;
  options.seed = 42;
  Vector values[2];
  size_t iterations[2];
  for (int i = 0; i < 2; ++i) {
    ChainProblem chain(2, 40.0, 0.5, 250, 0.02, 1, bounded);
    chain.Run(options);
    ASSERT_EQ(chain.summary.termination, Termination::kConverged)
        << chain.summary.message;
    values[i] = chain.model.parameters;
    iterations[i] = chain.summary.iterations.size();
    EXPECT_LT(values[i].norm(), 0.02);
  }
  EXPECT_EQ(values[0], values[1]);
  EXPECT_EQ(iterations[0], iterations[1]);
}

// One accelerometer reads 12 % too much, another is 13 ms late.
TEST(Identify, FindsGainAndDelay) {
  ChainProblem chain(2, 40.0, 0.5, 600, 0.0, 1, StartTwentyPercentOff);
  IdentificationRecord& record = chain.problem.records[0];
  record.channels[0].values *= 1.12;
  record.channels[0].gain = 0;
  // The late channel from a run sampled ten times as often.
  auto truth = testing::MakeGroupedChain(2, 40.0, 0.5);
  Matrix fine(1, (record.num_samples() - 1) * 20 + 1);
  for (int i = 0; i + 1 < record.num_samples(); ++i) {
    for (int s = 0; s <= 20; ++s) {
      record.excitation->Evaluate(i, s / 20.0, &fine(0, i * 20 + s));
    }
  }
  IdentificationRecord often = record;
  often.excitation.emplace(0.0, 0.001, fine, Interpolation::kLinear);
  testing::Simulate(*truth, Vector::Zero(2), Vector::Zero(4), 0.0, 1, &often);
  Vector& late = record.channels[1].values;
  late[0] = often.channels[1].values[0];
  for (int i = 1; i < late.size(); ++i) {
    late[i] = often.channels[1].values[i * 20 - 13];
  }
  record.channels[1].delay = 1;
  testing::Gaussian random(5);
  for (MeasuredChannel& channel : record.channels) {
    channel.values += 0.02 * random.Draw(record.num_samples());
  }
  Parameter gain, delay;
  gain.name = "gain.a1";
  gain.value = 1.0;
  delay.name = "delay.a2";
  delay.unit = "s";
  delay.lower = -0.1;
  delay.upper = 0.1;
  chain.problem.sensors.parameters = {gain, delay};
  chain.Run();
  ASSERT_EQ(chain.summary.termination, Termination::kConverged)
      << chain.summary.message;
  EXPECT_NEAR(chain.Find("gain.a1").value, 1.12, 0.01);
  EXPECT_NEAR(chain.Find("delay.a2").value, 0.013, 0.001);
  EXPECT_NEAR(chain.Find("k1").value, 0.0, 0.02);
  EXPECT_NEAR(chain.Find("k2").value, 0.0, 0.02);
  for (const char* name : {"gain.a1", "delay.a2", "k1", "k2"}) {
    const double truth_value = std::string(name) == "gain.a1"    ? 1.12
                               : std::string(name) == "delay.a2" ? 0.013
                                                                 : 0.0;
    EXPECT_LT(std::abs(chain.Find(name).value - truth_value),
              4.0 * chain.Find(name).sigma)
        << name;
  }
}

// Hold-out records are scored, never fitted.
TEST(Identify, HoldoutsDoNotTakePart) {
  ChainProblem alone(1, 40.0, 0.5, 300, 0.05, 1, StartTwentyPercentOff);
  alone.Run();
  ChainProblem chain(1, 40.0, 0.5, 300, 0.05, 1, StartTwentyPercentOff);
  IdentificationRecord holdout = chain.problem.records[0];
  holdout.name = "other";
  holdout.role = IdentificationRecord::Role::kHoldout;
  testing::Simulate(*testing::MakeGroupedChain(1, 60.0, 0.5), Vector::Zero(1),
                    Vector::Zero(2), 0.0, 1, &holdout);
  chain.problem.records.push_back(holdout);
  chain.Run();
  EXPECT_EQ(chain.model.parameters, alone.model.parameters);
  ASSERT_EQ(chain.summary.records.size(), 2u);
  EXPECT_EQ(chain.summary.records[1].name, "other");
  EXPECT_GT(chain.summary.records[1].nrmse, 0.2);
  // Another structure is predicted worse by the better model of this one, or
  // half wrong.
  const RecordScore& other = chain.summary.records[1];
  EXPECT_EQ(chain.summary.usable(),
            other.nrmse <= other.prior_nrmse && other.nrmse <= 0.5);
}

// A fit that is compared by its cost alone ends at the same minimum, without
// intervals and scores that nobody reads.
TEST(Identify, AFitForItsCostAloneHasNoIntervals) {
  ChainProblem chain(2, 40.0, 0.5, 400, 0.05, 1, StartTwentyPercentOff);
  for (MeasuredChannel& channel : chain.problem.records[0].channels) {
    channel.sigma = 0.05;
  }
  IdentificationRecord holdout = chain.problem.records[0];
  holdout.name = "other";
  holdout.role = IdentificationRecord::Role::kHoldout;
  chain.problem.records.push_back(holdout);
  IdentificationOptions options;
  options.shooting = IdentificationOptions::Shooting::kSingle;
  FitSummary full, cost_only;
  IdentifiedModel exact, model;
  FitOnce(chain.problem, options, nullptr, &full, &exact);
  options.covariance = IdentificationOptions::Covariance::kNone;
  options.function_tolerance = 1e-6;
  FitOnce(chain.problem, options, nullptr, &cost_only, &model);
  ASSERT_EQ(full.termination, Termination::kConverged) << full.message;
  ASSERT_EQ(cost_only.termination, Termination::kConverged)
      << cost_only.message;
  EXPECT_NEAR(cost_only.final_cost, full.final_cost, 1e-5 * full.final_cost);
  for (size_t j = 0; j < full.parameters.size(); ++j) {
    EXPECT_NEAR(cost_only.parameters[j].value, full.parameters[j].value,
                0.05 * full.parameters[j].sigma);
  }
  EXPECT_GT(full.covariance.size(), 0);
  EXPECT_EQ(cost_only.covariance.size(), 0);
  ASSERT_EQ(cost_only.records.size(), 2u);
  EXPECT_NEAR(cost_only.records[0].nrmse, full.records[0].nrmse, 1e-5);
  EXPECT_EQ(cost_only.records[0].start.size(), full.records[0].start.size());
  // Errors of what nobody simulated are NaN.
  EXPECT_TRUE(std::isnan(cost_only.records[0].prior_nrmse));
  ASSERT_EQ(cost_only.records[0].channels.size(), 2u);
  EXPECT_TRUE(std::isnan(cost_only.records[0].channels[1].prior_nrmse));
  EXPECT_TRUE(std::isnan(cost_only.records[1].nrmse));
  EXPECT_TRUE(std::isnan(cost_only.records[1].prior_nrmse));
  EXPECT_EQ(full.records[1].channels.size(), 2u);
  ASSERT_EQ(cost_only.records[1].channels.size(), 2u);
  EXPECT_TRUE(std::isnan(cost_only.records[1].channels[0].nrmse));
}

}  // namespace
}  // namespace pinode
