// Candidates of a choice: optional elements, libraries with select = true.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/results/choice_json.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kCandidates[] = R"toml([[element]]
name = "slip"
type = "bouc_wen"
between = ["ground", "u1"]
optional = true
parameters = {k = {initial = 20}, b = {initial = 1}, g = 0.0}
[[element]]
name = "oil"
type = "linear"
between = ["u1", "u2"]
parameters = {c = {initial = 1}}
[[library]]
name = "nl"
inputs = ["x[u1]", "v[u1]"]
output = "u1"
select = true
terms = ["x[u1] ^ 3", {basis = "v[u1]^3", initial = 0.5}, {basis = "x[u1]", initial = 2, free = false}]
[profiles]
parameters = ["slip.k", "k1"]
)toml";

class CandidatesTest : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  bool Read(const std::string& terms, Case* c) {
    const std::string path = folder_.Write(
        "case.toml",
        Replaced(SmallCase(), "[[record]]\n", terms + "[[record]]\n"));
    return ReadCase(path, c, &error_);
  }
  std::string Refusal(const std::string& from, const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(kCandidates, from, to), &c)) << to;
    return error_;
  }

  static std::vector<std::string> Names(const Case& c) {
    std::vector<std::string> names;
    for (const ModelCandidate& candidate : c.candidates) {
      names.push_back(candidate.name);
    }
    return names;
  }

  TemporaryFolder folder_;
  std::string error_;
};

TEST_F(CandidatesTest, AreReadFromElementsAndLibraries) {
  Case c;
  ASSERT_TRUE(Read(kCandidates, &c)) << error_;
  EXPECT_THAT(Names(c), ElementsAre("slip", "nl.x[u1]^3", "nl.v[u1]^3"));
  EXPECT_THAT(c.candidates[0].parameters,
              ElementsAre("slip.k", "slip.a", "slip.b", "slip.g", "slip.n",
                          "slip.beta"));
  EXPECT_THAT(c.candidates[0].amplitudes, ElementsAre("slip.k"));
}

TEST_F(CandidatesTest, RefusesWhatCannotBeChosen) {
  EXPECT_THAT(Refusal("k = {initial = 20}", "k = 20"),
              AllOf(HasSubstr("case.toml:"), HasSubstr("element 'slip'"),
                    HasSubstr("none of slip.k is free")));
  EXPECT_THAT(Refusal("optional = true", "optional = 1"),
              HasSubstr("optional"));
  EXPECT_THAT(Refusal("select = true", "selct = true"), HasSubstr("select"));
  EXPECT_THAT(
      Refusal("[\"x[u1] ^ 3\", {basis = \"v[u1]^3\", initial = 0.5}, ", "["),
      AllOf(HasSubstr("library 'nl'"), HasSubstr("none of its terms is free")));
  EXPECT_THAT(Refusal("[profiles]",
                      "[[network]]\nname = \"nn\"\ninputs = [\"x[u1]\"]\n"
                      "outputs = [\"u1\"]\n[profiles]"),
              HasSubstr("'slip' is optional, but a network"));
}

TEST_F(CandidatesTest, WhatIsLeftOutIsNotInTheModelCase) {
  Case c;
  ASSERT_TRUE(Read(kCandidates, &c)) << error_;
  const int before = ParameterLayout(c.problem).num_parameters();
  ASSERT_TRUE(LeaveOutOfCase({"slip", "nl.x[u1]^3"}, &c, &error_)) << error_;
  EXPECT_TRUE(c.candidates.empty());
  EXPECT_THAT(*c.profiles, ElementsAre("k1"));
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  EXPECT_EQ(model.parameters.size(), before - 7);
  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  std::string text;
  ASSERT_TRUE(ReadTextFile(out.Path("model.toml"), &text, &error_)) << error_;
  EXPECT_THAT(text, AllOf(Not(HasSubstr("slip")), Not(HasSubstr("select")),
                          HasSubstr("oil"), HasSubstr("v[u1]^3")));
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  EXPECT_TRUE(again.candidates.empty());
  ASSERT_EQ(again.problem.dynamics->laws().size(), 2u);
  EXPECT_EQ(again.problem.dynamics->num_states(), 4);
  EXPECT_EQ(again.problem.dynamics->laws()[1].parameters.size(), 2);
}

TEST_F(CandidatesTest, ALibraryOfWhichNothingIsLeftIsGone) {
  Case c;
  ASSERT_TRUE(
      Read(Replaced(kCandidates,
                    ", {basis = \"x[u1]\", initial = 2, free = false}", ""),
           &c))
      << error_;
  ASSERT_TRUE(LeaveOutOfCase(Names(c), &c, &error_)) << error_;
  EXPECT_EQ(c.source->Find("library"), nullptr);
  ASSERT_NE(c.source->Find("element"), nullptr);
  EXPECT_EQ(c.source->Find("element")->elements.size(), 1u);
  EXPECT_FALSE(LeaveOutOfCase({"oil"}, &c, &error_));
  EXPECT_THAT(error_, HasSubstr("'oil' is not a candidate"));
}

TEST_F(CandidatesTest, CheckpointsKnowWhatIsLeftOut) {
  Case c;
  ASSERT_TRUE(Read(kCandidates, &c)) << error_;
  Checkpoint written;
  written.choice.candidates = Names(c);
  written.choice.left_out = {"slip"};
  written.choice.left_out_parameters = c.candidates[0].parameters;
  written.choice.memory = 2.5;
  ModelChoice::Step step;
  step.left_out = {"slip"};
  step.fitted = step.accepted = true;
  step.deviance = 1.0 / 3.0;
  step.price = -7.0;
  written.choice.steps = {step};
  Case rest = c;
  ASSERT_TRUE(LeaveOutOfCase({"slip"}, &rest, &error_)) << error_;
  written.model.parameters = ParameterLayout(rest.problem).InitialValues();
  const std::string path = folder_.Path("checkpoint.json");
  // The result of a choice belongs to the whole case.
  ASSERT_TRUE(
      WriteCheckpoint(path, ProblemIdentity(rest.problem), written, &error_))
      << error_;
  Checkpoint read;
  ASSERT_TRUE(ReadCheckpoint(path, c.problem, &read, &error_)) << error_;
  EXPECT_EQ(read.model.parameters, written.model.parameters);
  EXPECT_EQ(read.choice.left_out, written.choice.left_out);
  EXPECT_EQ(read.choice.memory, 2.5);
  EXPECT_FALSE(read.choice.complete);
  ASSERT_EQ(read.choice.steps.size(), 1u);
  EXPECT_TRUE(read.choice.steps[0].accepted);
  EXPECT_EQ(read.choice.steps[0].criterion(), 1.0 / 3.0 - 7.0);
  EXPECT_EQ(read.choice.Sentence(),
            "Model choice (interrupted): 3 candidates, 2 kept (nl.x[u1]^3, "
            "nl.v[u1]^3). Left out: slip. Change of the criterion by each "
            "step: without slip -6.67.");
  // Without what it has left out its parameters are too few.
  written.choice = ModelChoice();
  ASSERT_TRUE(
      WriteCheckpoint(path, ProblemIdentity(c.problem), written, &error_));
  EXPECT_FALSE(ReadCheckpoint(path, c.problem, &read, &error_));
  nlohmann::ordered_json json = ChoiceToJson(read.choice);
  json.erase("steps");
  EXPECT_FALSE(ChoiceFromJson(json, &read.choice));
}

}  // namespace
}  // namespace pinode
