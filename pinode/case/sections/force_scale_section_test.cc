#include "pinode/case/sections/force_scale_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pinode/case/results/model_case.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Two storeys with a force at the top instead of a ground motion.
std::string ForceCase() {
  return Replaced(SmallCase(),
                  "  [[record.ground]]\n  direction = \"x\"\n"
                  "  column = \"ag\"\n  unit = \"gal\"\n",
                  "  [[record.force]]\n  dof = \"u2\"\n  column = \"ag\"\n"
                  "  unit = \"N\"\n  scale = {}\n");
}

// Fine enough steps for a twin to be found to a millionth: forces whose scale
// is unknown are not integrated exactly, those whose scale is known are.
std::string FineForceCase() {
  return Replaced(ForceCase(), "start = \"rest\"",
                  "start = \"rest\"\nsubsteps = 8");
}

class ForceScaleSection : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  bool Read(const std::string& text, Case* c) {
    error_.clear();
    return ReadCase(folder_.Write("case.toml", text), c, &error_);
  }
  std::string Refusal(const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(ForceCase(), "scale = {}", to), &c)) << to;
    return error_;
  }
  // A second record, "again", with `scale` in place of the first one's.
  std::string WithAgain(const std::string& text, const std::string& scale) {
    return text +
           Replaced(Replaced(ForceCase().substr(ForceCase().find("[[record]]")),
                             "\"quake\"", "\"again\""),
                    "  scale = {}\n", scale);
  }

  TemporaryFolder folder_;
  std::string error_;
};

TEST_F(ForceScaleSection, IsAnUnknownOfTheModel) {
  Case c;
  ASSERT_TRUE(Read(Replaced(ForceCase(), "scale = {}",
                            "scale = {initial = -2.0, lower = -5, upper = 5, "
                            "prior_mean = -1.5, prior_sigma = 0.5}"),
                   &c))
      << error_;
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  ASSERT_EQ(dynamics.force_scales().size(), 1u);
  const ForceScaleTerm& term = dynamics.force_scales()[0];
  ASSERT_EQ(term.forces.size(), 1u);
  EXPECT_EQ(term.forces[0].input, 0);
  EXPECT_EQ(term.forces[0].record_switch, -1);
  const Parameter& scale = term.parameters.parameters[0];
  EXPECT_EQ(scale.name, "scale.force_u2");
  EXPECT_EQ(scale.unit, "1");
  EXPECT_EQ(scale.value, -2.0);
  EXPECT_EQ(scale.lower, -5.0);
  EXPECT_EQ(scale.upper, 5.0);
  EXPECT_EQ(scale.prior_mean, -1.5);
  EXPECT_EQ(scale.prior_sigma, 0.5);
  EXPECT_TRUE(scale.free);
  // The column itself is as it was measured, in kN.
  EXPECT_NEAR(c.problem.records[0].excitation->samples()(0, 10),
              0.08 * std::sin(0.9), 1e-8);

  ASSERT_TRUE(Read(Replaced(ForceCase(), "scale = {}", "scale = -2.0"), &c))
      << error_;
  EXPECT_TRUE(c.problem.dynamics->force_scales().empty());
  EXPECT_NEAR(c.problem.records[0].excitation->samples()(0, 10),
              -0.16 * std::sin(0.9), 1e-8);
}

TEST_F(ForceScaleSection, IsSharedBetweenRecords) {
  Case c;
  // Said nothing: as in the other record. Said alike: the same.
  for (const char* scale : {"", "  scale = {}\n"}) {
    ASSERT_TRUE(Read(WithAgain(ForceCase(), scale), &c)) << error_;
    ASSERT_EQ(c.problem.dynamics->force_scales().size(), 1u);
    const ForceScaleTerm& term = c.problem.dynamics->force_scales()[0];
    ASSERT_EQ(term.forces.size(), 1u);
    EXPECT_EQ(term.forces[0].record_switch, -1);
    const auto remark = Contains(
        "Record again: the scale of force u2 is 'scale.force_u2', the same as "
        "in other records.");
    if (scale[0] == '\0') {
      EXPECT_THAT(c.problem.description.remarks, remark);
    } else {
      EXPECT_THAT(c.problem.description.remarks, Not(remark));
    }
  }
  // A number is known; another name is another unknown.
  for (const char* scale : {"  scale = 1.0\n", "  scale = {name = \"b\"}\n"}) {
    ASSERT_TRUE(Read(WithAgain(ForceCase(), scale), &c)) << error_;
    const auto scales = c.problem.dynamics->force_scales();
    ASSERT_EQ(scales.size(), scale[10] == '1' ? 1u : 2u);
    const int on = scales[0].forces[0].record_switch;
    ASSERT_GE(on, 0);
    EXPECT_EQ(c.problem.records[0].excitation->samples()(on, 5), 1.0);
    EXPECT_EQ(c.problem.records[1].excitation->samples()(on, 5), 0.0);
    if (scales.size() < 2) continue;
    EXPECT_EQ(scales[1].name, "scale.b");
    const int other = scales[1].forces[0].record_switch;
    EXPECT_EQ(c.problem.records[0].excitation->samples()(other, 5), 0.0);
    EXPECT_EQ(c.problem.records[1].excitation->samples()(other, 5), 1.0);
  }
  // One load cell at two places.
  const std::string cell = "scale = {name = \"cell\"}";
  const std::string moved = Replaced(
      WithAgain(Replaced(ForceCase(), "scale = {}", cell), "  " + cell + "\n"),
      "name = \"again\"", "name = \"moved\"");
  std::string text = moved;
  text.replace(text.rfind("  dof = \"u2\"\n  column = \"ag\""), 12,
               "  dof = \"u1\"\n");
  ASSERT_TRUE(Read(text, &c)) << error_;
  ASSERT_EQ(c.problem.dynamics->force_scales().size(), 1u);
  EXPECT_EQ(c.problem.dynamics->force_scales()[0].name, "scale.cell");
  EXPECT_EQ(c.problem.dynamics->force_scales()[0].forces.size(), 2u);
}

TEST_F(ForceScaleSection, Volts) {
  Case c;
  std::string text =
      Replaced(Replaced(ForceCase(), "unit = \"N\"\n  scale = {}",
                        "unit = \"mV\"\n  scale = {initial = 1.0}"),
               "unit = \"g\"",
               "unit = \"mV\"\n  gain = {initial = 0.1, free = true}\n"
               "  offset = {initial = 3.0}");
  ASSERT_TRUE(Read(text, &c)) << error_;
  const Parameter& scale =
      c.problem.dynamics->force_scales()[0].parameters.parameters[0];
  EXPECT_EQ(scale.unit, "kN/V");
  EXPECT_EQ(scale.value, 1.0);
  EXPECT_NEAR(c.problem.records[0].excitation->samples()(0, 10),
              0.08 * std::sin(0.9), 1e-8);
  const MeasuredChannel& channel = c.problem.records[0].channels[0];
  const Parameter& gain =
      c.problem.sensors.parameters[static_cast<size_t>(channel.gain)];
  EXPECT_EQ(gain.unit, "V/(m/s^2)");
  EXPECT_EQ(gain.value, 0.1);
  const Parameter& offset =
      c.problem.sensors.parameters[static_cast<size_t>(channel.offset)];
  EXPECT_EQ(offset.unit, "V");
  EXPECT_EQ(offset.value, 3e-3);
  EXPECT_EQ(c.problem.UnitOf(channel), "mV");
  EXPECT_EQ(channel.description.factor, 1e-3);
  // A millivolt is 1 N, and 1 gal: steps are those of the same case in these.
  Case plain;
  ASSERT_TRUE(
      Read(Replaced(ForceCase(), "unit = \"g\"", "unit = \"gal\""), &plain))
      << error_;
  EXPECT_EQ(c.problem.records[0].substeps, plain.problem.records[0].substeps);
  EXPECT_EQ(c.substeps[0].channel, plain.substeps[0].channel);
  EXPECT_NEAR(c.substeps[0].error / c.substeps[0].error_limit,
              plain.substeps[0].error / plain.substeps[0].error_limit, 1e-9);
  EXPECT_NEAR(channel.values[10],
              0.1 * plain.problem.records[0].channels[0].values[10], 1e-12);
}

TEST_F(ForceScaleSection, RefusesWhatIsWrong) {
  EXPECT_THAT(Refusal("scale = {inital = 1}"),
              AllOf(HasSubstr("case.toml:26:"), HasSubstr("'initial'")));
  EXPECT_THAT(Refusal("scale = \"x\""), HasSubstr("expected a finite number"));
  EXPECT_THAT(Refusal("scale = {initial = 1, upper = 0}"),
              HasSubstr("outside its bounds"));
  EXPECT_THAT(Refusal("scale = {name = \"a b\"}"),
              HasSubstr("cannot be a name"));
  EXPECT_THAT(Refusal("scale = {name = 3}"), HasSubstr("expected a text"));
  EXPECT_THAT(Refusal("scale = {}\n[[record.force]]\ndof = \"u1\"\n"
                      "column = \"ag\"\nunit = \"V\""),
              HasSubstr("the sensitivity of a force in volts, in kN/V"));
  Case c;
  EXPECT_FALSE(Read(Replaced(ForceCase(), "unit = \"N\"", "unit = \"V\""), &c));
  EXPECT_THAT(error_, HasSubstr("the nominal sensitivity, in kN/V"));
  EXPECT_FALSE(Read(WithAgain(ForceCase(), "  scale = {initial = 2}\n"), &c));
  EXPECT_THAT(error_, HasSubstr("differs from that of 'scale.force_u2'"));
  EXPECT_FALSE(Read(
      Replaced(WithAgain(Replaced(ForceCase(), "unit = \"N\"\n  scale = {}",
                                  "unit = \"V\"\n  scale = {initial = 1}"),
                         ""),
               "unit = \"N\"", "unit = \"kN\""),
      &c));
  EXPECT_THAT(error_, HasSubstr("'scale.force_u2', is in kN/V"));
  // The scale of a ground motion is known.
  EXPECT_FALSE(Read(
      Replaced(SmallCase(), "unit = \"gal\"", "unit = \"gal\"\n  scale = {}"),
      &c));
  EXPECT_THAT(error_,
              HasSubstr("'scale' of a ground motion cannot be unknown"));
  // Volts of channels.
  EXPECT_FALSE(Read(Replaced(ForceCase(), "unit = \"g\"", "unit = \"V\""), &c));
  EXPECT_THAT(error_, HasSubstr("a channel in volts needs its sensitivity"));
  EXPECT_FALSE(Read(Replaced(ForceCase(), "unit = \"g\"",
                             "unit = \"V\"\n  gain = {free = true}"),
                    &c));
  EXPECT_THAT(error_, HasSubstr("the nominal sensitivity, in V/(m/s^2)"));
  const std::string volts = Replaced(ForceCase(), "unit = \"g\"",
                                     "unit = \"V\"\n  gain = {initial = 0.1}");
  EXPECT_FALSE(Read(WithAgain(volts, "  scale = {}\n"), &c));
  EXPECT_THAT(error_, HasSubstr("in volts in one record but not in another"));
}

// A hammer of unknown sensitivity and sign, and a sensor upside down: the
// column was multiplied, and the channel, by whoever simulated.
TEST_F(ForceScaleSection, IsFoundAndWrittenBack) {
  Case simulated;
  ASSERT_TRUE(
      Read(Replaced(Replaced(FineForceCase(), "scale = {}", "scale = -2.5"),
                    "lower = -0.9", "lower = -0.9\ninitial = 0.1"),
           &simulated))
      << error_;
  RecordScore truth;
  ScoreRecord(simulated.problem, 0,
              ParameterLayout(simulated.problem).InitialValues(),
              Vector::Zero(4), 0, &truth);
  ASSERT_TRUE(truth.finite);
  std::string csv = "t,ag,a1,d2\n";
  for (int i = 0; i < 200; ++i) {
    csv += FormatNumber(0.01 * i, 6) + "," +
           FormatNumber(80.0 * std::sin(0.09 * i), 9) + "," +
           FormatNumber(-1.3 * truth.prediction(0, i) / 9.80665, 17) + "," +
           FormatNumber(1e3 * truth.prediction(1, i), 17) + "\n";
  }
  folder_.Write("quake.csv", csv);
  const std::string text = Replaced(FineForceCase(), "unit = \"g\"",
                                    "unit = \"g\"\n  gain = {free = true}");
  Case c;
  ASSERT_TRUE(Read(text, &c)) << error_;
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(c.problem, c.options, nullptr, &summary, &model);
  ASSERT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 3u);
  EXPECT_NEAR(summary.parameters[0].value, 0.1, 1e-6);
  EXPECT_NEAR(summary.parameters[1].value, -2.5, 1e-6);
  EXPECT_NEAR(summary.parameters[2].value, -1.3, 1e-6);

  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  const Case again = ReadOrFail(out.Path("model.toml"));
  EXPECT_EQ(
      again.problem.dynamics->force_scales()[0].parameters.parameters[0].value,
      model.parameters[1]);
  EXPECT_EQ(again.problem.sensors.parameters[0].value, model.parameters[2]);
}

}  // namespace
}  // namespace pinode
