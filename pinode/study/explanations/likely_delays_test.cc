#include "pinode/study/explanations/likely_delays.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/parameter_layout.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

constexpr double kStep = 0.05;

// Three storeys up to a fifth off their model, first mode 0.7 Hz. Measured
// values of `channels` come `samples` too late, those before the record are
// missing.
IdentificationProblem LateBy(Eigen::Index samples,
                             const std::vector<size_t>& channels) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.15, -0.2, 0.1}}), 7);
  for (const size_t c : channels) {
    Vector& values = problem.records[0].channels[c].values;
    const Vector own = values;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const Eigen::Index from = i - samples;
      const bool is_inside = from >= 0 && from < own.size();
      values[i] = is_inside ? own[from] : kNaN;
    }
  }
  return problem;
}

std::vector<LikelyDelay> DelaysOf(const IdentificationProblem& problem,
                                  std::vector<Suspect>* suspects) {
  IdentifiedModel model;
  model.parameters = ParameterLayout(problem).InitialValues();
  *suspects = MakeSuspects(problem, model);
  // A fit of which nothing is known: the initial model remains.
  return FindLikelyDelays(problem, FitSummary(), *suspects);
}

TEST(FindLikelyDelays, FindsTheDelayOfAllSensors) {
  for (const Eigen::Index late : {-12, 9, 20}) {
    std::vector<Suspect> suspects;
    const std::vector<LikelyDelay> found =
        DelaysOf(LateBy(late, {0, 1, 2}), &suspects);
    ASSERT_EQ(found.size(), 1u) << late;
    EXPECT_EQ(suspects[found[0].suspect].kind, Suspect::Kind::kExcitationDelay);
    EXPECT_NEAR(found[0].delay, kStep * static_cast<double>(late), 1.5 * kStep);
    EXPECT_GT(found[0].correlation, found[0].without + 0.1);
    EXPECT_GE(found[0].widest, std::abs(found[0].delay));
  }
}

TEST(FindLikelyDelays, FindsTheDelayOfOneSensor) {
  std::vector<Suspect> suspects;
  const std::vector<LikelyDelay> found = DelaysOf(LateBy(9, {1}), &suspects);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(suspects[found[0].suspect].kind, Suspect::Kind::kSensorDelay);
  EXPECT_EQ(suspects[found[0].suspect].place, "a2");
  EXPECT_NEAR(found[0].delay, 9 * kStep, 1.5 * kStep);
}

TEST(FindLikelyDelays, FindsNoneWhereNothingIsLate) {
  std::vector<Suspect> suspects;
  EXPECT_TRUE(DelaysOf(LateBy(0, {}), &suspects).empty());
  // Records of different steps have no common lag.
  IdentificationProblem problem = LateBy(9, {0, 1, 2});
  problem.records.push_back(problem.records[0]);
  IdentificationRecord& other = problem.records.back();
  const Excitation old = *other.excitation;
  other.excitation.emplace(old.start_time(), 2.0 * old.step(), old.samples(),
                           old.interpolation());
  EXPECT_TRUE(DelaysOf(problem, &suspects).empty());
}

// The fit without the delay is lost: a step from there leads nowhere.
TEST(Explain, NamesADelayBeyondAQuarterOfAPeriod) {
  for (const Eigen::Index late : {-12, 9}) {
    const Identification found =
        Identify(LateBy(late, {0, 1, 2}), IdentificationOptions(), {}, nullptr);
    EXPECT_EQ(found.summary.verdict.grade(), Grade::kNotUsable);
    ASSERT_FALSE(found.summary.explanations.empty()) << late;
    const Explanation& first = found.summary.explanations[0];
    EXPECT_EQ(first.kind, "excitation_delay") << first.what;
    EXPECT_NEAR(first.value, kStep * static_cast<double>(late), 0.01 * kStep);
    const double truth[] = {0.15, -0.2, 0.1};
    ASSERT_EQ(first.values.size(), 3u);
    for (size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(first.values[j].value, truth[j], 0.01);
    }
    // The refits of one set of suspects are one explanation.
    for (size_t i = 1; i < found.summary.explanations.size(); ++i) {
      EXPECT_NE(found.summary.explanations[i].kind, "excitation_delay");
    }
  }
}

}  // namespace
}  // namespace pinode
