// [[record.motion]] and channels of quantity "force", from file to fit.

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/case_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A spring, a damper and a mass on a rig: what the load cell reads is a sum.
constexpr double kRigStiffness = 30.0;  // N/mm
constexpr double kDamping = 0.4;        // N s/mm
constexpr double kRigMass = 0.002;      // N s^2/mm

std::string RigRecord() {
  std::string table = "t,stroke,speed,load\n";
  for (int i = 0; i < 400; ++i) {
    const double t = 0.005 * i, w = 12.0;
    const double x = 3.0 * std::sin(w * t), v = 3.0 * w * std::cos(w * t);
    table += FormatNumber(t) + "," + FormatNumber(x, 12) + "," +
             FormatNumber(v, 12) + "," +
             FormatNumber(
                 kRigStiffness * x + kDamping * v - kRigMass * w * w * x, 12) +
             "\n";
  }
  return table;
}

std::string RigMotion(const std::string& keys) {
  return "[[record.motion]]\ndof = \"x\"\n" + keys + "\n";
}

std::string RigCase(const std::string& motions) {
  return R"(
[units]
force = "N"
length = "mm"
time = "s"
[model]
dofs = ["x"]
mass = [[0.002]]
stiffness = [[0]]
damping = [[0]]
[[element]]
name = "device"
type = "linear"
between = ["ground", "x"]
parameters = {k = {initial = 10}, c = {initial = 0.1}}
[[record]]
name = "rig"
file = "rig.csv"
time = "t"
interpolation = "cubic"
substeps = 2
[[record.channel]]
column = "load"
quantity = "force"
dof = "x"
unit = "N"
)" + motions;
}

const char kStroke[] = "column = \"stroke\"\nunit = \"mm\"";
const char kSpeed[] =
    "quantity = \"velocity\"\ncolumn = \"speed\"\nunit = \"mm/s\"";

class PrescribedMotionCase : public ::testing::Test {
 protected:
  PrescribedMotionCase() { folder_.Write("rig.csv", RigRecord()); }

  std::string ErrorOf(const std::string& text) {
    Case c;
    std::string error;
    EXPECT_FALSE(ReadCase(folder_.Write("case.toml", text), &c, &error));
    return error;
  }

  TemporaryFolder folder_;
};

TEST_F(PrescribedMotionCase, FindsTheDeviceOnTheRig) {
  const Case c = ReadOrFail(folder_.Write(
      "case.toml", RigCase(RigMotion(kStroke) + RigMotion(kSpeed))));
  const auto& inputs = c.problem.dynamics->inputs();
  ASSERT_EQ(inputs.size(), 3u);
  EXPECT_EQ(inputs[0].name, "motion_x");
  EXPECT_EQ(inputs[1].name, "motion_velocity_x");
  EXPECT_EQ(inputs[2].name, "motion_acceleration_x");
  ASSERT_EQ(c.problem.dynamics->prescribed().size(), 1u);
  // The acceleration is that of the measured velocity.
  const Matrix& samples = c.problem.records[0].excitation->samples();
  EXPECT_NEAR(samples(2, 100), -144.0 * samples(0, 100), 1e-3);
  EXPECT_THAT(c.problem.records[0].description.remarks,
              ElementsAre(HasSubstr("acceleration of x is the derivative")));
  EXPECT_TRUE(c.problem.IsDriven(c.problem.records[0]));

  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(c.problem, c.options, nullptr, &summary, &model);
  EXPECT_TRUE(summary.usable()) << summary.message;
  // A force that resists is no sensor upside down.
  EXPECT_THAT(summary.remarks, ::testing::IsEmpty());
  EXPECT_NEAR(model.parameters[0], kRigStiffness, 1e-5 * kRigStiffness);
  EXPECT_NEAR(model.parameters[1], kDamping, 1e-5 * kDamping);
}

TEST_F(PrescribedMotionCase, VelocityIsThatOfTheDisplacement) {
  const Case c =
      ReadOrFail(folder_.Write("case.toml", RigCase(RigMotion(kStroke))));
  const Matrix& samples = c.problem.records[0].excitation->samples();
  EXPECT_NEAR(samples(1, 100), 36.0 * std::cos(12.0 * 0.5), 1e-4);
  EXPECT_EQ(c.problem.records[0].description.remarks.size(), 2u);
}

TEST_F(PrescribedMotionCase, SaysWhatDoesNotFit) {
  EXPECT_THAT(ErrorOf(RigCase(RigMotion(kSpeed))),
              HasSubstr("without the displacement"));
  EXPECT_THAT(ErrorOf(RigCase("")),
              HasSubstr("measured where the motion is prescribed"));
  EXPECT_THAT(ErrorOf(RigCase(RigMotion(kStroke) + RigMotion(kStroke))),
              HasSubstr("given twice"));
  EXPECT_THAT(ErrorOf(RigCase(RigMotion("column = \"stroke\"\nunit = \"N\""))),
              HasSubstr("unit"));
  const std::string second = R"(
[[record]]
name = "other"
file = "rig.csv"
time = "t"
[[record.channel]]
column = "load"
quantity = "force"
dof = "x"
unit = "N"
)";
  EXPECT_THAT(ErrorOf(RigCase(RigMotion(kStroke)) + second),
              HasSubstr("which other records prescribe"));
}

}  // namespace
}  // namespace pinode
