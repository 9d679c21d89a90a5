#include "pinode/case/results/grown_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/reduction/reduced_structure.h"
#include "pinode/study/terms/discovered_problem.h"
#include "tests/support/case_testing.h"
#include "tests/support/rod_case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The unknowns, bounds and priors of both, one by one.
void ExpectSameUnknowns(const IdentificationProblem& a,
                        const IdentificationProblem& b) {
  const ParameterLayout first(a);
  const ParameterLayout second(b);
  ASSERT_EQ(first.num_parameters(), second.num_parameters());
  for (int i = 0; i < first.num_parameters(); ++i) {
    const Parameter& p = first.parameter(i);
    const Parameter& q = second.parameter(i);
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.unit, q.unit) << p.name;
    EXPECT_EQ(p.value, q.value) << p.name;
    EXPECT_EQ(p.lower, q.lower) << p.name;
    EXPECT_EQ(p.upper, q.upper) << p.name;
    EXPECT_EQ(p.prior_mean, q.prior_mean) << p.name;
    EXPECT_EQ(p.prior_sigma, q.prior_sigma) << p.name;
    EXPECT_EQ(p.free, q.free) << p.name;
  }
}

constexpr char kOscillator[] = R"([units]
force = "N"
length = "m"
[model]
dofs = ["u"]
mass = [[1.0]]
stiffness = [[9.0]]
damping = [[0.4]]
[[network]]
name = "nn"
inputs = ["x[u]", "v[u]"]
outputs = ["u"]
layers = [2]
[[record]]
name = "free"
file = "free.csv"
time = "t"
start = "free"
  [[record.channel]]
  column = "x"
  quantity = "displacement"
  dof = "u"
  unit = "m"
  [[record.channel]]
  column = "v"
  quantity = "velocity"
  dof = "u"
  unit = "m/s"
[options]
threads = 1
)";

// A slope and a table, held elsewhere than where the case has them: the tree
// says so too.
TEST(HoldInCaseTest, CaseThatIsWrittenHoldsThemThere) {
  const TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  const std::string text = Replaced(
      SmallCase() + "  [[record.covariate]]\n  name = \"T\"\n  value = 3\n",
      "[[record]]",
      "[[group]]\nname = \"line\"\nadds_to = \"stiffness\"\nbetween = "
      "[\"u1\", \"u2\"]\nfollows = {covariate = \"T\"}\n"
      "[[group]]\nname = \"table\"\nadds_to = \"stiffness\"\nbetween = "
      "[\"u1\", \"u2\"]\nfollows = {covariate = \"T\", knots = [0, 5, 9], "
      "reference = 5}\n[[record]]");
  Case c = ReadOrFail(folder.Write("case.toml", text));
  HoldInCase({{"line", 0.25}, {"table.T[0]", -0.5}, {"table.T[9]", 0.75}}, &c);
  Case again;
  std::string error;
  ASSERT_TRUE(ReadCaseTree(*c.source, c.path, c.data, CasePurpose::kFit, &again,
                           &error))
      << error;
  EXPECT_EQ(again.problem.dynamics->Parameters(),
            c.problem.dynamics->Parameters());
  const ParameterLayout layout(again.problem);
  EXPECT_EQ(layout.FreeIndex("line"), -1);
  EXPECT_EQ(layout.FreeIndex("table.T[9]"), -1);
  EXPECT_GE(layout.FreeIndex("table"), 0);
  EXPECT_EQ(again.problem.dynamics->Parameters(),
            (Vector(5) << 0.0, 0.25, 0.0, -0.5, 0.75).finished());
}

class GrownCaseTest : public ::testing::Test {
 protected:
  Case ReadOscillator() {
    std::string text = "t,x,v\n";
    for (int i = 0; i <= 80; ++i) {
      text += FormatNumber(0.05 * i, 6) + "," +
              FormatNumber(1.5 * std::cos(0.15 * i)) + "," +
              FormatNumber(-4.5 * std::sin(0.15 * i)) + "\n";
    }
    folder_.Write("free.csv", text);
    return ReadOrFail(folder_.Write("case.toml", kOscillator));
  }

  TemporaryFolder folder_;
  std::string error_;
};

// A case read of what is written has the terms that were put in in memory.
TEST_F(GrownCaseTest, EquationsAreReadAsTheyWereFound) {
  Case c = ReadOscillator();
  c.problem.records[0].channels[0].values[3] = 7.0;
  DiscoveredEquation equation;
  equation.network = "nn";
  equation.output = "u";
  equation.features = {Feature::Displacement(0), Feature::Velocity(0)};
  equation.feature_names = {"x[u]", "v[u]"};
  equation.terms.resize(3);
  equation.terms[0].basis = "x[u]^3";
  equation.terms[0].coefficient = -1.8;
  equation.terms[1].basis = "x[u]^2";
  equation.terms[1].coefficient = 0.25;
  equation.terms[1].given = true;
  equation.terms[2].basis = "v[u]";
  equation.terms[2].sign = -1;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  IdentificationProblem found;
  IdentifiedModel initial;
  ASSERT_TRUE(MakeDiscoveredProblem(c.problem, model, {equation}, {7}, &found,
                                    &initial, &error_))
      << error_;
  Case grown;
  ASSERT_TRUE(CaseWithEquations(c, {equation}, found, true, &grown, &error_))
      << error_;
  EXPECT_EQ(grown.problem.records[0].channels[0].values[3], 7.0);
  Case read;
  ASSERT_TRUE(ReadCaseTree(*grown.source, c.path, nullptr, CasePurpose::kFit,
                           &read, &error_))
      << error_;
  ExpectSameUnknowns(read.problem, found);
  EXPECT_TRUE(read.problem.dynamics->networks().empty());
  EXPECT_EQ(read.problem.dynamics->laws()[0].name, "nn_u");
  EXPECT_EQ(read.problem.records[0].substeps, 7);
  EXPECT_EQ(found.records[0].substeps, 7);

  // One that has other terms is not taken for it.
  equation.terms.pop_back();
  EXPECT_FALSE(CaseWithEquations(c, {equation}, found, true, &grown, &error_));
  EXPECT_THAT(error_, HasSubstr("other unknowns"));
}

TEST_F(GrownCaseTest, CandidatesAreReadAsTheyWereAdded) {
  folder_.Write("quake.csv", SmallRecord());
  const Case c = ReadOrFail(folder_.Write("case.toml", SmallCase()));
  ChangeCandidate mass;
  mass.subject.name = "mass.u2";
  mass.subject.kind = ChangeKind::kMass;
  mass.masses = Vector{{0.0, 1.0}};
  mass.unit = 0.5;
  ChangeCandidate force;
  force.subject.name = "gap.drag.abs(w[u1,u2])*w[u1,u2]";
  force.subject.kind = ChangeKind::kNonlinear;
  force.subject.dof = "u2-u1";
  force.from = 0;
  force.to = 1;
  force.basis = "abs(w[u1,u2])*w[u1,u2]";
  force.library = "gap.drag";
  force.unit = 3.0;
  IdentificationProblem extended;
  ASSERT_TRUE(AddCandidates(c.problem, {mass, force}, &extended, &error_))
      << error_;
  Case grown;
  ASSERT_TRUE(CaseWithCandidates(c, {mass, force}, extended, &grown, &error_))
      << error_;
  Case read;
  ASSERT_TRUE(ReadCaseTree(*grown.source, c.path, nullptr, CasePurpose::kFit,
                           &read, &error_))
      << error_;
  ExpectSameUnknowns(read.problem, extended);
  const LawTerm& law = read.problem.dynamics->laws()[0];
  const LawTerm& added = extended.dynamics->laws()[0];
  EXPECT_EQ(law.outputs, added.outputs);
  EXPECT_EQ(law.acts_as, added.acts_as);
  ASSERT_EQ(law.features.size(), added.features.size());
  EXPECT_EQ(law.features[0].kind, added.features[0].kind);
}

class RenewedCaseTest : public RodCaseTest {
 protected:
  Case RodOrFail() {
    return ReadOrFail(Replaced(kRodCase, "method = \"guyan\"",
                               "method = \"guyan\"\nrenew = true"));
  }
};

// What a renewal makes in memory is what a case read with that basis is.
TEST_F(RenewedCaseTest, IsReadAsItWasRenewed) {
  const Case c = RodOrFail();
  ASSERT_TRUE(RenewsBasis(c));
  IdentifiedModel found;
  found.parameters = Vector{{-0.5, 0.0, 2.0}};
  Case renewed;
  IdentifiedModel begin;
  std::string error;
  ASSERT_TRUE(RenewCase(c, found, &renewed, &begin, &error)) << error;
  EXPECT_EQ(begin.parameters, found.parameters);
  EXPECT_NE(ProblemHash(renewed.problem), ProblemHash(c.problem));
  EXPECT_EQ(ProblemIdentity(renewed.problem), ProblemIdentity(c.problem));
  Case read;
  ASSERT_TRUE(ReadCaseTree(*renewed.source, c.path, nullptr, CasePurpose::kFit,
                           &read, &error))
      << error;
  const StructuralModel& a = renewed.problem.dynamics->model();
  const StructuralModel& b = read.problem.dynamics->model();
  EXPECT_LT((a.stiffness - b.stiffness).norm(), 1e-12 * a.stiffness.norm());
  EXPECT_LT((a.damping - b.damping).norm(), 1e-9 * a.damping.norm());
  EXPECT_LT((a.mass - b.mass).norm(), 1e-12 * a.mass.norm());
  EXPECT_LT((a.support_mass_coupling - b.support_mass_coupling).norm(), 1e-9);
  for (size_t j = 0; j < 3; ++j) {
    const Matrix& group = renewed.problem.dynamics->groups()[j].group.matrix;
    EXPECT_LT((group - read.problem.dynamics->groups()[j].group.matrix).norm(),
              1e-12 * group.norm());
  }
  // And once more from there.
  Case again;
  ASSERT_TRUE(RenewCase(renewed, found, &again, &begin, &error)) << error;
  EXPECT_EQ(ProblemIdentity(again.problem), ProblemIdentity(c.problem));
}

TEST_F(RenewedCaseTest, FittedModelIsReadInItsBasis) {
  const Case c = RodOrFail();
  Checkpoint checkpoint;
  checkpoint.model.parameters = Vector{{-0.5, 0.0, 2.0}};
  const TemporaryFolder folder;
  std::string error;
  ASSERT_TRUE(WriteCheckpoint(folder.Path("checkpoint.json"),
                              ProblemIdentity(c.problem), checkpoint, &error))
      << error;
  Case renewed;
  IdentifiedModel begin;
  ASSERT_TRUE(RenewCase(c, checkpoint.model, &renewed, &begin, &error))
      << error;
  Case read = c;
  IdentifiedModel model;
  ASSERT_TRUE(ReadFittedModel(folder.Path(""), &read, &model, &error)) << error;
  EXPECT_EQ(ProblemHash(read.problem), ProblemHash(renewed.problem));
  EXPECT_EQ(model.parameters, checkpoint.model.parameters);

  EXPECT_FALSE(ReadFittedModel(folder.Path("nowhere"), &read, &model, &error));
  EXPECT_THAT(error, HasSubstr("nowhere/checkpoint.json"));
}

TEST_F(RenewedCaseTest, RefusesWhatHasNoModes) {
  const Case c = RodOrFail();
  IdentifiedModel found;
  found.parameters = Vector{{-0.5, -1.5, 0.0}};
  Case renewed;
  IdentifiedModel begin;
  std::string error;
  // Springs that push.
  EXPECT_FALSE(RenewCase(c, found, &renewed, &begin, &error));
  EXPECT_THAT(error, HasSubstr("[model.reduction]"));
}

TEST_F(RenewedCaseTest, RefusesPointsThatAreNone) {
  const auto refusal = [this](const std::string& at) {
    return Refusal("method = \"guyan\"",
                   "method = \"guyan\"\nbasis_at = {" + at + "}");
  };
  EXPECT_THAT(refusal("lowest = 0.1"),
              AllOf(HasSubstr(":12: "), HasSubstr("'lowest' is not a group")));
  EXPECT_THAT(refusal("lower = \"low\""), HasSubstr("expected a"));
}

}  // namespace
}  // namespace pinode
