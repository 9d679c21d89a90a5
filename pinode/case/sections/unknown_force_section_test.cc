#include "pinode/case/sections/unknown_force_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

const char kSpline[] = R"toml([[unknown_force]]
name = "blow"
dof = "u1"
shape = "cubic"
window = [0.5, 1.5]
knot_spacing = 0.05
scale = 3.0
neighbourhood = 5
relaxation = 0.2
)toml";

const char kPulse[] = R"toml([[unknown_force]]
name = "pulse"
dof = "u2"
shape = "half_sine"
parameters.start = {initial = 0.4, lower = 0.0, upper = 1.0}
parameters.duration = {initial = 0.02}
parameters.amplitude = 7.0
)toml";

// Line 25 on; the record's channels see an acceleration of u1 and a
// displacement of u2.
class UnknownForceSection : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  bool Read(const std::string& force, Case* c) {
    return ReadText(
        Replaced(SmallCase(), "[[record]]\n", force + "[[record]]\n"), c);
  }
  bool ReadText(const std::string& text, Case* c) {
    error_.clear();
    return ReadCase(folder_.Write("case.toml", text), c, &error_);
  }
  std::string Refusal(const std::string& force, const std::string& from,
                      const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(force, from, to), &c)) << to;
    return error_;
  }
  // The case with a second record "again".
  std::string TwoRecords(const std::string& force) {
    const std::string text = SmallCase();
    return Replaced(text, "[[record]]\n", force + "[[record]]\n") +
           Replaced(text.substr(text.find("[[record]]")), "\"quake\"",
                    "\"again\"");
  }

  TemporaryFolder folder_;
  std::string error_;
};

TEST_F(UnknownForceSection, ReadsASpline) {
  Case c;
  ASSERT_TRUE(Read(kSpline, &c)) << error_;
  ASSERT_EQ(c.problem.dynamics->unknown_forces().size(), 1u);
  const UnknownForceTerm& term = c.problem.dynamics->unknown_forces()[0];
  EXPECT_EQ(term.name, "blow");
  EXPECT_EQ(term.outputs, Vector::Unit(2, 0));
  EXPECT_EQ(term.input, -1);
  EXPECT_FALSE(term.parameters.named);
  const auto& spline = dynamic_cast<const SplineForce&>(*term.history);
  EXPECT_EQ(spline.options().degree, 3);
  EXPECT_EQ(spline.options().num_knots, 21);
  EXPECT_EQ(spline.options().start, 0.5);
  EXPECT_EQ(spline.options().spacing, 0.05);
  EXPECT_EQ(spline.options().scale, 3.0);
  EXPECT_EQ(term.prior.num_groups(), 5);
  EXPECT_NEAR(term.prior.combinations[3].weights[1], -2.0625, 1e-15);

  const ParameterLayout layout(c.problem);
  EXPECT_EQ(layout.num_decay_groups(), 5);
  EXPECT_EQ(layout.decay_rows().size(), 21u);
  EXPECT_FALSE(layout.HasNetworkDecay());
}

TEST_F(UnknownForceSection, ReadsAPulse) {
  Case c;
  ASSERT_TRUE(Read(kPulse, &c)) << error_;
  const UnknownForceTerm& term = c.problem.dynamics->unknown_forces()[0];
  const auto& p = term.parameters.parameters;
  ASSERT_EQ(p.size(), 3u);
  EXPECT_EQ(p[0].name, "pulse.start");
  EXPECT_EQ(p[0].unit, "s");
  EXPECT_EQ(p[0].upper, 1.0);
  EXPECT_EQ(p[1].value, 0.02);
  EXPECT_EQ(p[1].lower, 0.0);
  EXPECT_TRUE(p[1].free);
  EXPECT_EQ(p[2].unit, "kN");
  EXPECT_EQ(p[2].value, 7.0);
  EXPECT_FALSE(p[2].free);
}

TEST_F(UnknownForceSection, ActsInItsRecordAlone) {
  Case c;
  ASSERT_TRUE(
      ReadText(TwoRecords(std::string(kSpline) + "record = \"again\"\n"), &c))
      << error_;
  const UnknownForceTerm& term = c.problem.dynamics->unknown_forces()[0];
  ASSERT_GE(term.input, 0);
  for (int r : {0, 1}) {
    const Matrix& inputs =
        c.problem.records[static_cast<size_t>(r)].excitation->samples();
    EXPECT_EQ(inputs.row(term.input),
              RowVector::Constant(inputs.cols(), r == 1 ? 1.0 : 0.0));
  }
  EXPECT_FALSE(ReadText(TwoRecords(kSpline), &c));
  EXPECT_THAT(error_, HasSubstr("record"));
  EXPECT_FALSE(
      ReadText(TwoRecords(std::string(kSpline) + "record = \"agian\"\n"), &c));
  EXPECT_THAT(error_, HasSubstr("'again'"));
}

TEST_F(UnknownForceSection, SaysWhatTheSensorsDoNotSee) {
  const auto is_static = HasSubstr("The static part of the unknown force blow");
  Case c;
  ASSERT_TRUE(Read(kSpline, &c)) << error_;
  EXPECT_THAT(c.problem.description.remarks, Not(Contains(is_static)));

  const std::string with_force = Replaced(
      SmallCase(), "[[record]]\n", std::string(kSpline) + "[[record]]\n");
  // Without the displacement.
  ASSERT_TRUE(ReadText(with_force + "  fit = false\n", &c)) << error_;
  EXPECT_THAT(c.problem.description.remarks,
              Contains(AllOf(is_static, HasSubstr("relaxation"))));
}

// As many knots as samples, and the noise of the sensor beside them unknown.
TEST_F(UnknownForceSection, AsksForTheNoiseThatAForceCanFollow) {
  const std::string fine = Replaced(kSpline, "= 0.05", "= 0.01");
  const std::string text =
      Replaced(SmallCase(), "[[record]]\n", fine + "[[record]]\n");
  Case c;
  EXPECT_FALSE(ReadText(text, &c));
  EXPECT_THAT(error_, AllOf(HasSubstr("'sigma'"), HasSubstr("'blow'")));
  EXPECT_TRUE(ReadText(
      Replaced(text, "unit = \"g\"", "unit = \"g\"\n  sigma = 0.01"), &c))
      << error_;
  // Elsewhere the force reaches the sensor through the structure.
  EXPECT_TRUE(ReadText(
      Replaced(text, "dof = \"u1\"\nshape", "dof = \"u2\"\nshape"), &c))
      << error_;
  // A band leaves unknowns enough to tell the noise by.
  EXPECT_TRUE(ReadText(Replaced(text, "neighbourhood = 5\nrelaxation = 0.2",
                                "band_hz = [2, 30]"),
                       &c))
      << error_;
}

TEST_F(UnknownForceSection, IsFoundBySingleShooting) {
  Case c;
  ASSERT_TRUE(Read(kSpline, &c)) << error_;
  EXPECT_EQ(c.options.shooting, IdentificationOptions::Shooting::kSingle);
  const std::string text = Replaced(SmallCase(), "[[record]]\n",
                                    std::string(kSpline) + "[[record]]\n");
  EXPECT_FALSE(ReadText(text + "[options]\nshooting = \"multiple\"\n", &c));
  EXPECT_THAT(error_, AllOf(HasSubstr("shooting"), HasSubstr("single")));
  EXPECT_FALSE(ReadText(text + "[options]\ncovariance = \"sandwich\"\n", &c));
  EXPECT_THAT(error_, HasSubstr("covariance"));
  // A known force needs no conditions.
  ASSERT_TRUE(Read(Replaced(kSpline, "scale", "free = false\nscale"), &c))
      << error_;
  EXPECT_EQ(c.options.shooting, IdentificationOptions::Shooting::kMultiple);
}

TEST_F(UnknownForceSection, ActsInATrainingRecord) {
  Case c;
  EXPECT_FALSE(ReadText(
      Replaced(TwoRecords(std::string(kSpline) + "record = \"again\"\n"),
               "name = \"again\"", "name = \"again\"\nrole = \"holdout\""),
      &c));
  EXPECT_THAT(error_, AllOf(HasSubstr("role"), HasSubstr("hold-out")));
}

TEST_F(UnknownForceSection, RefusesWhatDoesNotFit) {
  EXPECT_THAT(Refusal(kSpline, "\"u1\"", "\"u3\""),
              AllOf(HasSubstr("case.toml:18:"), HasSubstr("'u3'")));
  EXPECT_THAT(Refusal(kSpline, "window = [0.5, 1.5]\n", ""),
              HasSubstr("window"));
  EXPECT_THAT(Refusal(kSpline, "knot_spacing = 0.05\n", ""),
              HasSubstr("knot_spacing"));
  EXPECT_THAT(Refusal(kSpline, "scale = 3.0\n", ""), HasSubstr("scale"));
  EXPECT_THAT(Refusal(kSpline, "= 0.05", "= 0.0"), HasSubstr("knot_spacing"));
  EXPECT_THAT(Refusal(kSpline, "= 0.05", "= 0.0001"), HasSubstr("10001 knots"));
  EXPECT_THAT(Refusal(kSpline, "1.5]", "0.5]"), HasSubstr("window"));
  EXPECT_THAT(Refusal(kSpline, "1.5]", "0.5, 2]"), HasSubstr("window"));
  EXPECT_THAT(Refusal(kSpline, "\"cubic\"", "\"qubic\""), HasSubstr("qubic"));
  EXPECT_THAT(Refusal(kSpline, "neighbourhood = 5", "neighbourhood = 0"),
              HasSubstr("neighbourhood"));
  EXPECT_THAT(Refusal(kSpline, "relaxation = 0.2", "band_hz = [2, 8]"),
              HasSubstr("neighbourhood"));
  EXPECT_THAT(Refusal(kSpline, "neighbourhood = 5\nrelaxation = 0.2",
                      "band_hz = [2, 11]"),
              HasSubstr("<= 10 Hz"));
  EXPECT_THAT(Refusal(kSpline, "relaxation", "relaxaton"),
              HasSubstr("relaxation"));
  EXPECT_THAT(Refusal(kSpline, "relaxation = 0.2", "values = [1, 2]"),
              HasSubstr("values"));
  EXPECT_THAT(Refusal(kPulse, "parameters.amplitude = 7.0\n", ""),
              HasSubstr("'amplitude'"));
  EXPECT_THAT(Refusal(kPulse, "0.02", "0.0"), HasSubstr("duration"));
  EXPECT_THAT(Refusal(kPulse, "\"half_sine\"", "\"half_sine\"\nscale = 2.0"),
              HasSubstr("scale"));
  EXPECT_THAT(Refusal(kSpline, "scale = 3.0", "scale = 3.0\nparameters.a = 1"),
              HasSubstr("parameters"));
  Case c;
  EXPECT_FALSE(Read(std::string(kSpline) + kSpline, &c));
  EXPECT_THAT(error_, HasSubstr("used twice"));
}

TEST_F(UnknownForceSection, ReadsWhatTheForceWas) {
  folder_.Write("quake.csv",
                Replaced(SmallRecord(), "t,ag,a1,d2\n0,", "t,ag,F,d2\n0,"));
  std::string text = SmallCase();
  text = Replaced(text, "[[record]]\n",
                  std::string(kSpline) + "truth = \"F\"\n[[record]]\n");
  text = Replaced(text, "column = \"a1\"", "column = \"F\"\n  name = \"a1\"");
  Case c;
  ASSERT_TRUE(ReadText(text, &c)) << error_;
  ASSERT_EQ(c.problem.description.force_truths.size(), 1u);
  EXPECT_EQ(c.problem.description.force_truths[0].name, "blow");
  ASSERT_EQ(c.problem.description.force_truths[0].values.size(), 200);
  EXPECT_NEAR(c.problem.description.force_truths[0].times[150], 1.5, 1e-12);
  // As it stands in the file: the model's unit.
  EXPECT_NEAR(c.problem.description.force_truths[0].values[150],
              0.1 * std::sin(13.2), 1e-7);
  EXPECT_FALSE(ReadText(Replaced(text, "truth = \"F\"", "truth = \"G\""), &c));
  EXPECT_THAT(error_, AllOf(HasSubstr("quake.csv"), HasSubstr("'G'")));
}

// Results of an identification are read back from model.toml.
TEST_F(UnknownForceSection, ComesBackWithItsValues) {
  Case c;
  ASSERT_TRUE(Read(std::string(kSpline) + kPulse, &c)) << error_;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  const int spline = dynamics.block_offset(dynamics.unknown_force_block(0));
  const int pulse = dynamics.block_offset(dynamics.unknown_force_block(1));
  for (int k = 0; k < 21; ++k) model.parameters[spline + k] = 0.1 * k - 1.0;
  model.parameters[pulse] = 0.43;
  const std::string folder = folder_.Path("");
  ASSERT_TRUE(WriteModelCase(c, model, folder, folder, &error_)) << error_;
  Case back;
  ASSERT_TRUE(ReadCase(folder_.Path("model.toml"), &back, &error_)) << error_;
  const Vector read = back.problem.dynamics->Parameters();
  EXPECT_LT((read - model.parameters.head(read.size()))
                .tail(24)
                .cwiseAbs()
                .maxCoeff(),
            1e-15);
}

}  // namespace
}  // namespace pinode
