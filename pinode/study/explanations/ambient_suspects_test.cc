#include "pinode/study/explanations/ambient_suspects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pinode/problem/parameter_layout.h"
#include "pinode/study/explanations/explain.h"
#include "tests/support/ambient_testing.h"

namespace pinode {
namespace {

constexpr double kSpring = 900.0;

// Five minutes of a chain of four masses under wind.
IdentificationProblem Wind() {
  const TestChain chain(4, kSpring, 0.01);
  return ProblemOfChain(chain, kSpring, 0.0,
                        RecordOfChain(chain, 300.0, 7, 0.0));
}

// The true values of the problem.
IdentifiedModel Truth(const IdentificationProblem& problem) {
  IdentifiedModel model;
  model.parameters = ParameterLayout(problem).InitialValues();
  return model;
}

bool NamesATurn(const std::vector<Suspect>& suspects, int channel) {
  for (const Suspect& suspect : suspects) {
    for (const Suspect::AmbientScale& at : suspect.ambient_scales) {
      if (at.channel == channel && at.factor == -1.0) return true;
    }
  }
  return false;
}

TEST(AmbientSuspects, AreNotFoundAmongGoodSensors) {
  const IdentificationProblem problem = Wind();
  EXPECT_TRUE(
      MakeAmbientSuspects(problem, Truth(problem), {false}, 1, 2).empty());
}

TEST(AmbientSuspects, SwappedTurnedAndScaledSensorsComeFirst) {
  const IdentificationProblem problem = Wind();
  const IdentifiedModel truth = Truth(problem);
  IdentificationProblem swapped = problem;
  Matrix& samples = swapped.ambient[0].samples;
  samples.row(1).swap(samples.row(3));
  std::vector<Suspect> found =
      MakeAmbientSuspects(swapped, truth, {false}, 1, 1);
  ASSERT_FALSE(found.empty());
  ASSERT_EQ(found[0].ambient_exchanged.size(), 1u);
  EXPECT_EQ(found[0].ambient_exchanged[0].one, 1);
  EXPECT_EQ(found[0].ambient_exchanged[0].two, 3);

  IdentificationProblem turned = problem;
  turned.ambient[0].samples.row(2) *= -1.0;
  EXPECT_TRUE(NamesATurn(MakeAmbientSuspects(turned, truth, {false}, 1, 1), 2));

  IdentificationProblem scaled = problem;
  scaled.ambient[0].samples.row(2) *= 0.7;
  EXPECT_NEAR(AmbientScale(scaled, truth, 0, 2, 1), 1.0 / 0.7, 0.15);
}

// A wrong sensor drives a fit far from the structure, where the lines tell
// nothing of it. Those at the initial model do.
TEST(AmbientSuspects, AreFoundWhereTheFitIsLost) {
  IdentificationProblem turned = Wind();
  turned.ambient[0].samples.row(2) *= -1.0;
  IdentifiedModel lost = Truth(turned);
  lost.parameters.setConstant(20.0);
  EXPECT_TRUE(NamesATurn(MakeAmbientSuspects(turned, lost, {false}, 1, 1), 2));
  // Neither model knows it.
  auto dynamics = std::make_shared<StructuralDynamics>(*turned.dynamics);
  dynamics->SetParameters(lost.parameters);
  turned.dynamics = dynamics;
  EXPECT_FALSE(NamesATurn(MakeAmbientSuspects(turned, lost, {false}, 1, 1), 2));
}

// The loads of wrong samples take over their spectra, so that no change of the
// sensors gains anything beside them.
TEST(AmbientSuspects, AreFoundWithLoadsOfTheirOwn) {
  const TestChain chain(3, kSpring, 0.01);
  IdentificationProblem swapped =
      ProblemOfChain(chain, kSpring, 0.1, RecordOfChain(chain, 50.0, 7, 0.0));
  const IdentifiedModel initial = Truth(swapped);
  EXPECT_TRUE(MakeAmbientSuspects(swapped, initial, {true}, 1, 1).empty());
  Matrix& samples = swapped.ambient[0].samples;
  samples.row(0).swap(samples.row(2));
  EXPECT_TRUE(MakeAmbientSuspects(swapped, initial, {false}, 1, 1).empty());
  const std::vector<Suspect> found =
      MakeAmbientSuspects(swapped, initial, {true}, 1, 1);
  ASSERT_FALSE(found.empty());
  ASSERT_EQ(found[0].ambient_exchanged.size(), 1u);
  EXPECT_EQ(found[0].ambient_exchanged[0].one, 0);
  EXPECT_EQ(found[0].ambient_exchanged[0].two, 2);
}

TEST(AmbientSuspectsDeathTest, NeedAFlagPerRecord) {
  const IdentificationProblem problem = Wind();
  EXPECT_DEATH(MakeAmbientSuspects(problem, Truth(problem), {}, 1, 2), "");
}

// The suspects undo what was done to the samples.
TEST(AmbientSuspects, AreAddedToTheSamples) {
  const IdentificationProblem problem = Wind();
  Suspect suspect;
  suspect.kind = Suspect::Kind::kExchange;
  suspect.ambient_exchanged = {{0, 1, 3}};
  suspect.ambient_scales = {{0, 2, -2.0}};
  EXPECT_TRUE(suspect.IsDiscrete());
  IdentificationProblem changed = problem;
  std::string error;
  ASSERT_TRUE(AddSuspects({suspect}, &changed, &error)) << error;
  EXPECT_EQ(changed.ambient[0].samples.row(1),
            problem.ambient[0].samples.row(3));
  EXPECT_EQ(changed.ambient[0].samples.row(2),
            -2.0 * problem.ambient[0].samples.row(2));
}

}  // namespace
}  // namespace pinode
