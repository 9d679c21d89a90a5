// Drafted cases, read back by the reader of cases.

#include "pinode/case/draft/case_draft.h"

#include <cmath>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/case/draft/case_draft_text.h"
#include "pinode/structure/model/modal_analysis.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Returns a logger's file of two floors of 1 t on storeys of 400 kN/m, shaken
// by some sines: time in ms, the base, the floors, a temperature. `turned`:
// the sensor on the second floor is upside down.
std::string TwoStoreys(double pitch = 1.0, double offset = 0.0,
                       bool turned = false, double begin = 0.0) {
  std::string text =
      "t [ms];Boden alt [mg];Beschl. D\xC3\xA4mpfer 1. OG [mg];Dach "
      "[mg];Temp\n";
  double u[2] = {0.0, 0.0};
  double v[2] = {0.0, 0.0};
  constexpr int kFine = 20;
  constexpr double kFineStep = 0.01 / kFine;
  const int first = static_cast<int>(begin / kFineStep);
  for (int i = 0; i < first + 1500 * kFine; ++i) {
    const double t = i * kFineStep;
    double ground = 0.0;
    for (int line = 1; line < 40; ++line) {
      ground += 0.1 * std::sin(pitch * kTwoPi * 0.25 * line * t + line * line);
    }
    ground *= t < 2.0 ? t * t / 4.0 : 1.0;
    const double lower = 400.0 * (u[0] + 0.003 * v[0]);
    const double upper = 400.0 * (u[1] - u[0] + 0.003 * (v[1] - v[0]));
    const double total[] = {upper - lower, -upper};
    if (i >= first && i % kFine == 0) {
      const double values[] = {ground + offset, total[0],
                               turned ? -total[1] : total[1]};
      text += std::to_string((i - first) / kFine * 10);
      for (const double value : values) {
        std::string cell = FormatNumber(value * 1000.0 / 9.80665, 7);
        if (cell.find('.') != std::string::npos) cell[cell.find('.')] = ',';
        text += ";" + cell;
      }
      text += ";20,5\n";
    }
    for (int f = 0; f < 2; ++f) v[f] += kFineStep * (total[f] - ground);
    for (int f = 0; f < 2; ++f) u[f] += kFineStep * v[f];
  }
  return text;
}

class CaseDraftTest : public ::testing::Test {
 protected:
  CaseDraftTest() {
    request_.logs = {folder_.Write("log 1.csv", TwoStoreys())};
    request_.case_path = folder_.Path("case.toml");
    request_.later_case_path = folder_.Path("later.toml");
    request_.storeys = "2";
    request_.weights = "9.80665 kN";
    request_.ignore = "Temp";
  }

  std::vector<CaseDraft> DraftOrFail() {
    std::vector<CaseDraft> drafts;
    DraftQuestion question;
    std::string error;
    EXPECT_TRUE(DraftCases(request_, &drafts, &question, &error))
        << error << question.AsError();
    if (drafts.empty()) drafts.resize(1);
    return drafts;
  }

  // The flag that answers what is asked.
  std::string Asked() {
    std::vector<CaseDraft> drafts;
    DraftQuestion question;
    std::string error;
    EXPECT_FALSE(DraftCases(request_, &drafts, &question, &error));
    EXPECT_THAT(error, IsEmpty());
    return question.flag;
  }

  Case ReadBack(const CaseDraft& draft) {
    const std::string text = CaseDraftText(draft, "pinode_new 'a\nb'");
    EXPECT_TRUE(IsCaseDraft(text));
    Case c;
    std::string error;
    EXPECT_TRUE(ReadCaseDraft(text, draft.path, &c, &error)) << error << text;
    return c;
  }

  TemporaryFolder folder_;
  DraftRequest request_;
};

// A factor as the user gave it agrees with the unit of the file.
TEST_F(CaseDraftTest, ScaleKeepsItsDigits) {
  std::string error;
  request_.unit = "ft/s^2";
  ASSERT_TRUE(request_.time.scales.Set(9.80665e-3 / 0.3048, {}, &error));
  const CaseDraft draft = DraftOrFail()[0];
  EXPECT_THAT(CaseDraftText(draft, "pinode_new"),
              HasSubstr("scale     = 0.0321740485564304"));
  EXPECT_THAT(ReadBack(draft).problem.records[0].description.remarks,
              Not(Contains(HasSubstr("the file says"))));
}

TEST_F(CaseDraftTest, CaseSaysWhatTheFilesAndTheUserSay) {
  const CaseDraft draft = DraftOrFail()[0];
  const Case c = ReadBack(draft);
  ASSERT_EQ(c.problem.records.size(), 1u);
  const IdentificationRecord& record = c.problem.records[0];
  EXPECT_EQ(record.name, "log_1");
  EXPECT_NEAR(record.sampling_step(), 0.01, 1e-12);
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(c.problem.description.units.force, "kN");
  EXPECT_NEAR(draft.masses[0], 1.0, 1e-6);  // t
  // Frequencies are sqrt(400) times 0.618 and 1.618, by 2 pi.
  EXPECT_NEAR(draft.first_mode_hz, 0.618 * 20.0 / kTwoPi, 0.15);
  EXPECT_NEAR(draft.stiffnesses[0], 400.0, 60.0);
  EXPECT_EQ(draft.stiffnesses[0], draft.stiffnesses[1]);
  // In the model's units of acceleration.
  EXPECT_NEAR(record.channels[0].description.factor, 9.80665e-3, 1e-12);
  EXPECT_THAT(draft.remarks, IsEmpty());
  // The stiffness and the damping of two storeys, and damping by mass are free.
  EXPECT_EQ(c.problem.dynamics->groups().size(), 5u);
  EXPECT_EQ(record.num_samples(), 1500);
}

TEST_F(CaseDraftTest, LaterStateHasTheSameModel) {
  request_.later_logs = {folder_.Write("later.csv", TwoStoreys(1.1))};
  const std::vector<CaseDraft> drafts = DraftOrFail();
  ASSERT_EQ(drafts.size(), 2u);
  EXPECT_EQ(drafts[0].stiffnesses, drafts[1].stiffnesses);
  EXPECT_GT(drafts[0].rayleigh_mass, 0.0);
  EXPECT_EQ(drafts[0].rayleigh_mass, drafts[1].rayleigh_mass);
  EXPECT_EQ(drafts[0].rayleigh_stiffness, drafts[1].rayleigh_stiffness);
  EXPECT_TRUE(drafts[1].storeys_are_damped);
  request_.damping = "modes";
  const std::vector<CaseDraft> by_modes = DraftOrFail();
  ASSERT_EQ(by_modes.size(), 2u);
  EXPECT_EQ(by_modes[0].rayleigh_mass, 0.0);
  EXPECT_THAT(by_modes[0].damped_modes, ElementsAre(1, 2));
  EXPECT_EQ(by_modes[0].damped_modes, by_modes[1].damped_modes);
  const Case before = ReadBack(drafts[0]);
  const Case after = ReadBack(drafts[1]);
  EXPECT_EQ(before.problem.records[0].name, "log_1");
  EXPECT_EQ(after.problem.records[0].name, "later");
}

TEST_F(CaseDraftTest, LastOfSeveralRecordsIsHeldOut) {
  request_.logs.push_back(folder_.Write("log-2.csv", TwoStoreys(1.1)));
  Case c = ReadBack(DraftOrFail()[0]);
  using Role = IdentificationRecord::Role;
  ASSERT_EQ(c.problem.records.size(), 2u);
  EXPECT_EQ(c.problem.records[0].role, Role::kTrain);
  EXPECT_EQ(c.problem.records[1].role, Role::kHoldout);
  request_.holdout = request_.logs[0];
  c = ReadBack(DraftOrFail()[0]);
  EXPECT_EQ(c.problem.records[0].role, Role::kHoldout);
  EXPECT_EQ(c.problem.records[1].role, Role::kTrain);
  request_.holdout = "none";
  c = ReadBack(DraftOrFail()[0]);
  EXPECT_EQ(c.problem.records[1].role, Role::kTrain);
}

TEST_F(CaseDraftTest, SensorUpsideDownIsSaidAndNotTurned) {
  request_.logs = {folder_.Write("turned.csv", TwoStoreys(1.0, 0.0, true))};
  // Neither of two sensors is in the majority.
  EXPECT_THAT(DraftOrFail()[0].remarks, IsEmpty());
  EXPECT_EQ(CaseDraftText(DraftOrFail()[0], "").find("# sign"),
            std::string::npos);
  request_.sensors = "Beschl. D\xC3\xA4mpfer 1. OG=1,Dach=-2";
  const CaseDraft draft = DraftOrFail()[0];
  EXPECT_THAT(draft.remarks, IsEmpty());
  const Case c = ReadBack(draft);
  EXPECT_NEAR(c.problem.records[0].channels[1].description.factor, -9.80665e-3,
              1e-12);
  // Both turned: the base is against all.
  request_.sensors = "Beschl. D\xC3\xA4mpfer 1. OG=-1,Dach=2";
  const CaseDraft turned = DraftOrFail()[0];
  EXPECT_THAT(turned.remarks,
              Contains(HasSubstr("opposite to the sensor of the base")));
  EXPECT_THAT(CaseDraftText(turned, ""),
              HasSubstr("  # sign    = -1                        # moves "
                        "against the others in the first mode: upside down?"));
}

TEST_F(CaseDraftTest, InterpolationFollowsTheLoad) {
  // RMS over the lines w of the load: 1 - cos(w), and that of the cubic.
  EXPECT_THAT(CaseDraftText(DraftOrFail()[0], ""),
              HasSubstr("interpolation = \"cubic\"                 # samples "
                        "left out: cubic misses 1.7 %, linear 8.5 %"));
  // Lines up to nine tenths of half the sampling rate.
  request_.logs = {folder_.Write("fast.csv", TwoStoreys(4.7))};
  EXPECT_THAT(CaseDraftText(DraftOrFail()[0], ""),
              HasSubstr("interpolation = \"linear\""));
}

TEST_F(CaseDraftTest, OffsetsAndRecordsThatBeginInMotion) {
  CaseDraft draft = DraftOrFail()[0];
  EXPECT_FALSE(draft.records[0].base[0].remove_offset);
  EXPECT_TRUE(draft.records[0].starts_at_rest);
  request_.logs = {
      folder_.Write("moving.csv", TwoStoreys(1.0, 0.2, false, 4.0))};
  draft = DraftOrFail()[0];
  EXPECT_TRUE(draft.records[0].base[0].remove_offset);
  EXPECT_FALSE(draft.records[0].floors[0].remove_offset);
  EXPECT_FALSE(draft.records[0].starts_at_rest);
  const Case c = ReadBack(draft);
  EXPECT_NEAR(c.problem.records[0].excitation->samples().row(0).mean(), 0.0,
              1e-9);
}

TEST_F(CaseDraftTest, AmbientRecordOfAnUnmeasuredBase) {
  request_.base = "none";
  request_.sensors = "Dach=2";
  const Case c = ReadBack(DraftOrFail()[0]);
  EXPECT_EQ(c.problem.records.size(), 0u);
  EXPECT_EQ(c.problem.ambient.size(), 1u);
}

TEST_F(CaseDraftTest, AsksForWhatIsMissing) {
  request_.ignore = "";
  EXPECT_EQ(Asked(), "sensors");  // the temperature
  request_.ignore = "Temp,Boden alt";
  EXPECT_EQ(Asked(), "base");
  request_.ignore = "Temp";
  request_.storeys = "";
  EXPECT_EQ(Asked(), "storeys");
  request_.storeys = "2";
  request_.weights = "";
  EXPECT_EQ(Asked(), "weights");
}

TEST_F(CaseDraftTest, DampingOfAnotherKindIsRefused) {
  request_.damping = "viscous";
  std::vector<CaseDraft> drafts;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(DraftCases(request_, &drafts, &question, &error));
  EXPECT_EQ(error,
            "--damping is 'viscous', expected storeys, rayleigh or modes");
}

// The damping C = a0 M + a1 K of the draft, with factors c_mass and c1, c2.
TEST_F(CaseDraftTest, DampingOfStoreysIsFree) {
  const CaseDraft draft = DraftOrFail()[0];
  EXPECT_TRUE(draft.storeys_are_damped);
  const Case c = ReadBack(draft);
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  ASSERT_EQ(dynamics.groups().size(), 5u);
  const StructuralModel model =
      dynamics.CorrectedModel(Vector{{0.0, 0.0, -1.0, 0.5, 2.0}});
  const double c1 = 1.5 * draft.rayleigh_stiffness * draft.stiffnesses[0];
  const double c2 = 3.0 * draft.rayleigh_stiffness * draft.stiffnesses[1];
  const Matrix expected = (Matrix(2, 2) << c1 + c2, -c2, -c2, c2).finished();
  EXPECT_LT((model.damping - expected).norm(), 1e-6 * expected.norm());
}

// Storeys without sensors: factors for each would not be determined.
TEST_F(CaseDraftTest, DampingOfStoreysThatTheRecordsDoNotShow) {
  request_.storeys = "7";
  request_.sensors = "Beschl. D\xC3\xA4mpfer 1. OG=3,Dach=7";
  const CaseDraft draft = DraftOrFail()[0];
  EXPECT_FALSE(draft.storeys_are_damped);
  EXPECT_THAT(CaseDraftText(draft, ""),
              HasSubstr("# The records do not show the damping of each "
                        "storey.\n"));
  EXPECT_EQ(ReadBack(draft).problem.dynamics->groups().size(), 9u);
  request_.damping = "storeys";
  std::vector<CaseDraft> drafts;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(DraftCases(request_, &drafts, &question, &error));
  EXPECT_THAT(error, HasSubstr("Give --damping=rayleigh or --damping=modes"));
}

TEST_F(CaseDraftTest, GivenStiffnesses) {
  request_.stiffness = "0.5 kN/mm, 300 kN/m";
  const CaseDraft draft = DraftOrFail()[0];
  EXPECT_NEAR(draft.stiffnesses[0], 500.0, 1e-9);
  EXPECT_NEAR(draft.stiffnesses[1], 300.0, 1e-9);
  ReadBack(draft);
  request_.stiffness = "";
  request_.first_mode_hz = "2.5";
  EXPECT_NEAR(DraftOrFail()[0].stiffnesses[0],
              std::pow(2.5 * kTwoPi / 0.618034, 2), 0.01);
}

TEST_F(CaseDraftTest, OneStorey) {
  request_.storeys = "1";
  request_.sensors = "Dach=1";
  const CaseDraft draft = DraftOrFail()[0];
  // Damping of one mode has one part.
  EXPECT_EQ(draft.rayleigh_stiffness, 0.0);
  EXPECT_EQ(ReadBack(draft).problem.dynamics->groups().size(), 2u);
}

// Each ratio is that of its mode: a factor of 1.5 and none of it.
TEST_F(CaseDraftTest, DampingOfModesIsFree) {
  request_.damping_ratio = "0.04";
  request_.damping = "modes";
  const Case c = ReadBack(DraftOrFail()[0]);
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  const StructuralModel model =
      dynamics.CorrectedModel(Vector{{0.0, 0.0, 0.5, -1.0}});
  ModalProperties modes;
  std::string error;
  ASSERT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  EXPECT_NEAR(modes.damping_ratio[0], 0.06, 1e-9);
  EXPECT_NEAR(modes.damping_ratio[1], 0.0, 1e-9);
}

// The load ends at 9.75 Hz, between modes 3 and 4 of seven storeys.
TEST_F(CaseDraftTest, DampingThatTheRecordsDoNotShowIsFixed) {
  request_.storeys = "7";
  request_.damping = "modes";
  request_.sensors = "Beschl. D\xC3\xA4mpfer 1. OG=3,Dach=7";
  const CaseDraft draft = DraftOrFail()[0];
  EXPECT_THAT(draft.damped_modes, ElementsAre(1, 2, 3));
  EXPECT_EQ(draft.damped_from, 0);
  EXPECT_THAT(CaseDraftText(draft, ""),
              HasSubstr("# The records do not show the damping of other modes: "
                        "it stays at 2 %."));
  EXPECT_EQ(ReadBack(draft).problem.dynamics->groups().size(), 10u);
  // All modes are below 7.5 Hz.
  request_.first_mode_hz = "0.8";
  const CaseDraft slow = DraftOrFail()[0];
  EXPECT_THAT(slow.damped_modes, ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(slow.damped_from, 6);
  EXPECT_THAT(CaseDraftText(slow, ""), HasSubstr("name    = \"zeta_rest\""));
  EXPECT_EQ(ReadBack(slow).problem.dynamics->groups().size(), 13u);
}

}  // namespace
}  // namespace pinode
