// The same records in other units: the same results in these units.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

// Old units in terms of new ones.
struct UnitFactors {
  const char* name;
  double force;
  double length;
  double time;
};

// A ring-down of 10 Hz with a damping of 1 % and a cubic spring that makes up a
// fifth of the force at 1 mm, measured with 1 % noise, in units of which these
// many make a newton, a metre and a second. k, c, the cubic spring and a
// damping that grows with amplitude are unknown.
IdentificationProblem MakeRingDown(const UnitFactors& unit) {
  const double omega = 2.0 * kPi * 10.0;
  const double mass = 2.0;
  const double stiffness = mass * omega * omega;
  const double damping = 2.0 * 0.01 * mass * omega;
  const double velocity_unit = unit.length / unit.time;
  const double stiffness_unit = unit.force / unit.length;
  const double damping_unit = unit.force / velocity_unit;
  const StructuralModel model = MakeStructuralModel(
      Matrix::Constant(1, 1, mass * stiffness_unit * unit.time * unit.time),
      Matrix::Constant(1, 1, damping * damping_unit),
      Matrix::Constant(1, 1, stiffness * stiffness_unit));
  const auto make = [&](double k3, double c2, double k, double c) {
    auto dynamics =
        std::make_shared<StructuralDynamics>(model, std::vector<InputSpec>{});
    std::string error;
    GroupTerm group;
    group.group.name = "k";
    group.group.target = MatrixGroup::Target::kStiffness;
    group.group.matrix = model.stiffness;
    group.alpha.value = k;
    group.alpha.free = true;
    EXPECT_TRUE(dynamics->AddGroup(group, &error)) << error;
    group.group.name = "c";
    group.group.target = MatrixGroup::Target::kDamping;
    group.group.matrix = model.damping;
    group.alpha.value = c;
    EXPECT_TRUE(dynamics->AddGroup(group, &error)) << error;
    for (const bool cubic : {true, false}) {
      LawTerm term = testing::MakeElement(
          cubic ? "cubic" : "amplitude", cubic ? "cubic" : "amplitude_damping",
          1, Feature::kGround, 0,
          {cubic ? k3 * stiffness_unit / (unit.length * unit.length)
                 : c2 * damping_unit / unit.length});
      EXPECT_TRUE(dynamics->AddLaw(std::move(term), &error)) << error;
    }
    return dynamics;
  };
  const auto truth = make(0.2 * stiffness / 1e-6, 0.5 * damping / 1e-3, 0, 0);
  IdentificationRecord record = testing::MakeExcitedRecord(
      *truth, 1200, 0.002 * unit.time, Interpolation::kLinear);
  record.substeps = 2;
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  testing::Simulate(*truth, truth->Parameters(),
                    Eigen::Vector2d(1e-3 * unit.length, 0.0), 0.01, 5, &record);
  record.start = IdentificationRecord::Start::kFree;
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = make(0.0, 0.0, 0.08, 0.5);
  return problem;
}

class Units : public ::testing::TestWithParam<UnitFactors> {};

TEST_P(Units, ChangeNoResult) {
  IdentificationSummary here, there;
  IdentifiedModel model;
  testing::FitAndJudge(MakeRingDown({"SI", 1.0, 1.0, 1.0}), {}, nullptr, &here,
                       &model);
  testing::FitAndJudge(MakeRingDown(GetParam()), {}, nullptr, &there, &model);
  ASSERT_TRUE(here.usable()) << here.message;
  EXPECT_LT(here.records[0].nrmse, 0.05);
  EXPECT_TRUE(there.usable()) << there.message;
  const bool exact = std::string(GetParam().name).find("2^") == 0;
  const double tolerance = exact ? 1e-12 : 1e-6;
  EXPECT_NEAR(there.records[0].nrmse / here.records[0].nrmse, 1.0, tolerance);
  ASSERT_EQ(there.parameters.size(), here.parameters.size());
  for (size_t p = 0; p < here.parameters.size(); ++p) {
    const ParameterEstimate& a = here.parameters[p];
    const ParameterEstimate& b = there.parameters[p];
    if (a.name == "k" || a.name == "c") {
      EXPECT_NEAR(b.value, a.value, tolerance) << a.name;
    }
    // In deviations, which carry the unit. The roots that they are made of are
    // rounded differently.
    const double ratio = a.value / a.sigma;
    EXPECT_NEAR(b.value / b.sigma, ratio,
                std::max(tolerance, 1e-10) * std::max(1.0, std::abs(ratio)))
        << a.name;
  }
  EXPECT_EQ(there.num_iterations, here.num_iterations);
}

INSTANTIATE_TEST_SUITE_P(Factors, Units,
                         ::testing::ValuesIn(std::vector<UnitFactors>{
                             UnitFactors{"2^13 lengths", 1.0, 8192.0, 1.0},
                             UnitFactors{"2^-13 lengths", 1.0, 1.0 / 8192.0,
                                         1.0},
                             UnitFactors{"2^13 forces", 8192.0, 1.0, 1.0},
                             UnitFactors{"2^13 times", 1.0, 1.0, 8192.0},
                             UnitFactors{"2^-13 times", 1.0, 1.0, 1.0 / 8192.0},
                             UnitFactors{"1e4 lengths", 1.0, 1e4, 1.0},
                             UnitFactors{"1e-4 lengths", 1.0, 1e-4, 1.0},
                             UnitFactors{"1e-4 forces", 1e-4, 1.0, 1.0},
                             UnitFactors{"1e4 times", 1.0, 1.0, 1e4}}));

}  // namespace
}  // namespace pinode
