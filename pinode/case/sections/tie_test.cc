#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A second group and a cubic spring that follow the first group "k1".
const char kTied[] = R"toml([[group]]
name = "k2"
adds_to = "stiffness"
between = ["u1", "u2"]
scale = 100.0
tie = "k1"
tie_factor = -0.5
[[element]]
name = "s"
type = "cubic"
between = ["ground", "u1"]
parameters.k3 = {tie = "k1", tie_factor = 3.0}
)toml";

class Tie : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  bool Read(const std::string& terms, Case* c) {
    const std::string with_value =
        Replaced(SmallCase(), "lower = -0.9", "lower = -0.9\ninitial = 0.2");
    path_ = folder_.Write("case.toml", Replaced(with_value, "[[record]]\n",
                                                terms + "[[record]]\n"));
    error_.clear();
    return ReadCase(path_, c, &error_);
  }
  std::string Refusal(const std::string& from, const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(kTied, from, to), &c)) << to;
    EXPECT_THAT(error_, Not(HasSubstr("\n")));
    return error_;
  }

  TemporaryFolder folder_;
  std::string path_;
  std::string error_;
};

TEST_F(Tie, OneUnknownServesAll) {
  Case c;
  ASSERT_TRUE(Read(kTied, &c)) << error_;
  const ParameterLayout layout(c.problem);
  ASSERT_EQ(layout.num_parameters(), 3);
  ASSERT_EQ(layout.num_free(), 1);
  const Vector initial = layout.InitialValues();
  EXPECT_EQ(initial[0], 0.2);
  EXPECT_EQ(initial[1], -0.1);
  EXPECT_NEAR(initial[2], 0.6, 1e-15);
  Vector all = initial;
  layout.SetFree(Vector::Constant(1, 2.0), &all);
  EXPECT_EQ(all[1], -1.0);
  EXPECT_EQ(all[2], 6.0);
  EXPECT_EQ(layout.DependenceOf(2).free, 0);
  EXPECT_EQ(layout.DependenceOf(2).factor, 3.0);
  // The matrices follow, too.
  EXPECT_NEAR(
      c.problem.dynamics->CorrectedModel(initial.head(3)).stiffness(0, 1),
      -100.0 + 0.1 * 100.0, 1e-12);
}

TEST_F(Tie, RefusalsNameLineAndRemedy) {
  EXPECT_THAT(Refusal("tie = \"k1\"\n", "tie = \"k9\"\n"),
              HasSubstr("case.toml:22: unknown 'k2': no unknown is named 'k9', "
                        "expected one of k1"));
  EXPECT_THAT(Refusal("tie = \"k1\"\n", "tie = \"s.k3\"\n"),
              HasSubstr("case.toml:22: unknown 'k2': 's.k3' is tied itself; "
                        "tie to 'k1'"));
  EXPECT_THAT(Refusal("tie = \"k1\"\n", "tie = \"k1\"\ninitial = 1.0\n"),
              HasSubstr("'k2' has 'tie', so remove one"));
  EXPECT_THAT(Refusal("tie = \"k1\"\n", ""),
              HasSubstr("'tie_factor' needs 'tie'"));
  EXPECT_THAT(Refusal("tie_factor = -0.5", "tie_factor = 0"),
              HasSubstr("'tie_factor' is 0"));
  EXPECT_THAT(
      Refusal("parameters.k3 = {tie = \"k1\", tie_factor = 3.0}",
              "parameters.k3 = 5.0\n[[element]]\nname = \"t\"\ntype = "
              "\"cubic\"\nbetween = [\"u1\", \"u2\"]\nparameters.k3 = "
              "{tie = \"s.k3\"}"),
      HasSubstr("unknown 't.k3': it is tied to 's.k3', which is fixed"));
}

TEST_F(Tie, TheModelFollowsNoSensor) {
  path_ = folder_.Write(
      "case.toml", Replaced(Replaced(SmallCase(), "unit = \"g\"",
                                     "unit = \"g\"\n  gain = {free = true}"),
                            "[[record]]\n",
                            Replaced(kTied, "parameters.k3 = {tie = \"k1\"",
                                     "parameters.k3 = {tie = \"gain.a1\"") +
                                "[[record]]\n"));
  Case c;
  EXPECT_FALSE(ReadCase(path_, &c, &error_));
  EXPECT_THAT(error_, HasSubstr("unknown 's.k3': it is tied to 'gain.a1' of a "
                                "sensor; let the sensor's unknown follow"));
}

// Matrices of the model's case contain the groups, so that the spring cannot
// follow "k1" any longer, which begins at 0 again.
TEST_F(Tie, TheModelCaseCountsNothingTwice) {
  Case c;
  ASSERT_TRUE(Read(kTied, &c)) << error_;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  const StructuralDynamics& before = *c.problem.dynamics;
  const StructuralDynamics& after = *again.problem.dynamics;
  EXPECT_LT((after.CorrectedModel(after.Parameters()).stiffness -
             before.CorrectedModel(before.Parameters()).stiffness)
                .norm(),
            1e-12);
  EXPECT_EQ(after.Parameters()[0], 0.0);
  EXPECT_NEAR(after.Parameters()[2], 0.6, 1e-15);
  ASSERT_EQ(after.ties().size(), 1u);
  EXPECT_EQ(after.ties()[0].parameter, 1);
}

}  // namespace
}  // namespace pinode
