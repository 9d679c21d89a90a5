#include "pinode/problem/fit_summary.h"

#include <gtest/gtest.h>

#include <limits>

#include "pinode/problem/identification_summary.h"

namespace pinode {
namespace {

ParameterEstimate Estimate(const std::string& name, double value,
                           double half_width) {
  ParameterEstimate estimate;
  estimate.name = name;
  estimate.value = value;
  estimate.sigma = 0.5 * half_width;
  estimate.half_width95 = half_width;
  estimate.lower95 = value - half_width;
  estimate.upper95 = value + 2.0 * half_width;
  return estimate;
}

TEST(FitSummary, TiedEstimatesFollowTheirSources) {
  std::vector<ParameterEstimate> parameters = {Estimate("c", 0.0, 0.0),
                                               Estimate("k1", 10.0, 1.0),
                                               Estimate("k2", 7.0, 1.0)};
  parameters[0].tie = "k1";
  parameters[0].tie_factor = -2.0;
  parameters[1].at_bound = true;
  FollowSources(&parameters);
  EXPECT_EQ(parameters[0].value, -20.0);
  EXPECT_EQ(parameters[0].sigma, 1.0);
  EXPECT_EQ(parameters[0].half_width95, 2.0);
  // A negative factor exchanges the ends.
  EXPECT_EQ(parameters[0].lower95, -24.0);
  EXPECT_EQ(parameters[0].upper95, -18.0);
  EXPECT_TRUE(parameters[0].at_bound);
  EXPECT_EQ(parameters[2].value, 7.0);
  EXPECT_FALSE(parameters[2].at_bound);
}

TEST(IdentificationSummary, BriefReportSaysVerdictWorkAndErrors) {
  IdentificationSummary summary;
  summary.message = "no step lowers the cost";
  summary.num_iterations = 1;
  summary.seconds = 0.6317;
  RecordScore score;
  score.name = "drive";
  score.role = IdentificationRecord::Role::kTrain;
  score.nrmse = 0.00996639;
  summary.records = {score};
  score.name = "again";
  score.role = IdentificationRecord::Role::kHoldout;
  score.nrmse = 1.25;
  summary.records.push_back(score);
  EXPECT_EQ(summary.BriefReport(),
            "Not usable: no step lowers the cost. 1 iteration, 0.632 s. Error: "
            "'drive' (train) 0.997 %, 'again' (holdout) 125 %.");
  // The sentence of a finding ends with what to do.
  summary.message = "another solution fits as well; add sensors to decide";
  summary.num_iterations = 12;
  summary.records.pop_back();
  summary.records[0].nrmse = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(summary.BriefReport(),
            "Not usable: another solution fits as well; add sensors to decide. "
            "12 iterations, 0.632 s. Error: 'drive' (train) diverges.");
}

}  // namespace
}  // namespace pinode
