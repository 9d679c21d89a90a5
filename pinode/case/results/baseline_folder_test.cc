#include "pinode/case/results/baseline_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/results/case_result.h"
#include "pinode/problem/motion_levels.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/fitted_case_testing.h"

namespace pinode {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;
using Json = nlohmann::json;

// Gives the result a value and a variance of each group to be compared.
void GiveAllGroups(FittedCase* fitted) {
  FittedCase& f = *fitted;
  const std::vector<std::string> groups = FreeGroups(*f.c.problem.dynamics);
  const ParameterLayout layout(f.c.problem);
  f.summary.parameters.clear();
  for (const int index : layout.free()) {
    const Parameter& parameter = layout.parameter(index);
    if (!layout.IsNamed(index) || std::find(groups.begin(), groups.end(),
                                            parameter.name) == groups.end()) {
      continue;
    }
    ParameterEstimate estimate;
    estimate.name = parameter.name;
    estimate.unit = "1";
    estimate.value = f.model.parameters[index];
    estimate.sigma = 0.01;
    estimate.free = true;
    f.summary.parameters.push_back(estimate);
  }
  f.summary.covariance_names = groups;
  const auto size = static_cast<Eigen::Index>(groups.size());
  f.summary.covariance = 1e-4 * Matrix::Identity(size, size);
}

// The baseline in a folder of `f` with this result.json.
Baseline BaselineIn(const FittedCase& f, const std::string& result) {
  f.folder.Write("out/result.json", result);
  Baseline baseline;
  std::string error;
  EXPECT_TRUE(ReadBaseline(f.folder.Path("out"), f.c, &baseline, &error))
      << error;
  return baseline;
}

TEST(ReadBaseline, HasTheLevelsOfMotion) {
  FittedCase f;
  GiveAllGroups(&f);
  ResultFolder out;
  std::string error;
  ASSERT_TRUE(out.Open(f.folder.Path("out"), false, false, &error)) << error;
  ASSERT_TRUE(WriteCaseResult(f.c, f.summary, f.model, out, &error)) << error;
  ASSERT_TRUE(out.Commit(&error)) << error;
  const std::string text = f.folder.Read("out/result.json");
  const Baseline baseline = BaselineIn(f, text);
  const std::vector<MotionLevel> wanted = MotionLevels(f.c.problem);
  ASSERT_THAT(wanted, SizeIs(2));
  ASSERT_THAT(baseline.levels, SizeIs(2));
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(baseline.levels[i].dof, wanted[i].dof);
    EXPECT_EQ(baseline.levels[i].quantity, wanted[i].quantity);
    EXPECT_EQ(baseline.levels[i].unit, wanted[i].unit);
    EXPECT_NEAR(baseline.levels[i].lowest, wanted[i].lowest, 1e-9);
    EXPECT_NEAR(baseline.levels[i].mean, wanted[i].mean, 1e-9);
    EXPECT_NEAR(baseline.levels[i].highest, wanted[i].highest, 1e-9);
  }
  EXPECT_EQ(CompareLevels(baseline.levels, wanted), LevelComparison::kSame);
  EXPECT_TRUE(baseline.has_records);

  // A result of an earlier version, and one of modes alone.
  Json json = Json::parse(text);
  json.erase("levels_of_motion");
  const Baseline earlier = BaselineIn(f, json.dump());
  EXPECT_THAT(earlier.levels, IsEmpty());
  EXPECT_TRUE(earlier.has_records);
  json["records"] = Json::array();
  EXPECT_FALSE(BaselineIn(f, json.dump()).has_records);
  // Entries that are no levels are left out.
  json["levels_of_motion"] = {{{"dof", "u1"}, {"quantity", "displacement"}}, 3};
  EXPECT_THAT(BaselineIn(f, json.dump()).levels, IsEmpty());
}

}  // namespace
}  // namespace pinode
