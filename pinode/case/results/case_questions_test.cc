#include "pinode/case/results/case_questions.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/case/results/case_check.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Returns a record at 50 Hz of two storeys with these modes under a white
// ground motion.
std::string RecordOfModes(const std::vector<double>& modes_hz) {
  std::mt19937 random(7);
  std::string text = "t,ag,a1,d2\n";
  const double step = 0.02;
  std::vector<double> now(modes_hz.size(), 0.0);
  std::vector<double> before(modes_hz.size(), 0.0);
  for (int i = 0; i < 6000; ++i) {
    const double load = static_cast<double>(random()) / 4294967296.0 - 0.5;
    double sum = 0.0;
    for (size_t m = 0; m < modes_hz.size(); ++m) {
      // A resonator with 2 % damping.
      const double omega = 2.0 * kPi * modes_hz[m];
      const double radius = std::exp(-0.02 * omega * step);
      const double next = 2.0 * radius * std::cos(omega * step) * now[m] -
                          radius * radius * before[m] + load;
      before[m] = now[m];
      now[m] = next;
      sum += next;
    }
    text += FormatNumber(step * i, 6) + "," + FormatNumber(load, 9) + "," +
            FormatNumber(sum, 9) + "," + FormatNumber(sum - load, 9) + "\n";
  }
  return text;
}

class CaseQuestionsTest : public ::testing::Test {
 protected:
  CaseCheck Check(const std::string& text, const std::vector<double>& hz) {
    folder_.Write("quake.csv", RecordOfModes(hz));
    Case c;
    std::string error;
    EXPECT_TRUE(ReadCaseForCheck(folder_.Write("case.toml", text), &c, &error))
        << error;
    return CheckCase(c);
  }

  TemporaryFolder folder_;
};

// SmallCase has modes at 1.125 and 2.251 Hz.
TEST_F(CaseQuestionsTest, PeaksStandBesideTheModes) {
  const CaseCheck check = Check(SmallCase(), {1.125, 2.251});
  ASSERT_EQ(check.record_peaks.size(), 1u);
  EXPECT_EQ(check.record_peaks[0].record, "quake");
  ASSERT_GE(check.record_peaks[0].hz.size(), 2u);
  EXPECT_NEAR(check.record_peaks[0].hz[0], 1.125, 0.06);
  EXPECT_NEAR(check.record_peaks[0].hz[1], 2.251, 0.06);
  EXPECT_THAT(check.questions, IsEmpty());
}

TEST_F(CaseQuestionsTest, WeightsLookLikeMasses) {
  const std::string weights =
      Replaced(SmallCase(), "[2.0, 1.0]", "[19.62, 9.81]");
  const CaseCheck check = Check(weights, {1.125, 2.251});
  ASSERT_EQ(check.questions.size(), 1u);
  EXPECT_THAT(
      check.questions[0],
      AllOf(HasSubstr("Record 'quake'"), HasSubstr("times lower"),
            HasSubstr("weights instead of masses"), HasSubstr("9.8066 m/s^2")));
}

TEST_F(CaseQuestionsTest, AThousandIsNamed) {
  const std::string newtons =
      Replaced(SmallCase(), "[[300.0, -100.0], [-100.0, 100.0]]",
               "[[3e5, -1e5], [-1e5, 1e5]]");
  const CaseCheck check = Check(newtons, {1.125, 2.251});
  ASSERT_EQ(check.questions.size(), 1u);
  EXPECT_THAT(check.questions[0],
              AllOf(HasSubstr("times higher"), HasSubstr("an error of 1000")));
}

// A stiffness that is off by a third is what a fit is for.
TEST_F(CaseQuestionsTest, OrdinaryErrorsAreNotAskedAbout) {
  const CaseCheck check =
      Check(Replaced(SmallCase(), "[[300.0, -100.0], [-100.0, 100.0]]",
                     "[[450.0, -150.0], [-150.0, 150.0]]"),
            {1.125, 2.251});
  EXPECT_THAT(check.questions, IsEmpty());
}

TEST_F(CaseQuestionsTest, LargeDamping) {
  const CaseCheck check = Check(
      Replaced(SmallCase(), "{ratios = [0.02]}", "{rayleigh = [20.0, 0.0]}"),
      {1.125, 2.251});
  ASSERT_FALSE(check.questions.empty());
  EXPECT_THAT(check.questions[0], HasSubstr("% of critical"));
}

}  // namespace
}  // namespace pinode
