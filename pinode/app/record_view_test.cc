#include "pinode/app/record_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

LogFile Sine(Eigen::Index samples, double hz) {
  LogFile log;
  log.path = "a.csv";
  log.time_column = "t";
  log.step = 0.01;
  LogColumn column;
  column.name = "a1";
  column.unit = "mg";
  column.samples.resize(samples);
  for (Eigen::Index i = 0; i < samples; ++i) {
    column.samples[i] =
        3.0 * std::sin(kTwoPi * hz * log.step * static_cast<double>(i));
  }
  log.columns.push_back(column);
  return log;
}

TEST(LogOverview, HasTheFactsOfColumns) {
  LogFile log = Sine(10000, 2.0);
  log.columns[0].samples[7] = std::nan("");
  const Json json = LogOverview(log);
  EXPECT_EQ(json["samples"], 10000);
  EXPECT_DOUBLE_EQ(json["rate_hz"].get<double>(), 100.0);
  EXPECT_DOUBLE_EQ(json["seconds"].get<double>(), 100.0);
  const Json& column = json["columns"][0];
  EXPECT_EQ(column["name"], "a1");
  EXPECT_EQ(column["quantity"], "acceleration");
  EXPECT_EQ(column["missing"], 1);
  EXPECT_NEAR(column["rms"].get<double>(), 3.0 / std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(column["max"].get<double>(), 3.0, 1e-2);

  log.columns[0].unit = "";
  log.columns[0].samples.setConstant(std::nan(""));
  const Json empty = LogOverview(log)["columns"][0];
  EXPECT_EQ(empty["quantity"], "");
  EXPECT_TRUE(empty["rms"].is_null());
  EXPECT_TRUE(empty["max"].is_null());
}

TEST(ColumnView, HasTwoPointsPerPixelAndKeepsPeaks) {
  LogFile log = Sine(360000, 2.0);
  log.columns[0].samples[123456] = 77.0;
  const Json json = ColumnView(log, log.columns[0], 300);
  for (const char* line : {"history", "spectrum"}) {
    EXPECT_EQ(json[line]["x"].size(), json[line]["y"].size());
    EXPECT_LE(json[line]["x"].size(), 602u) << line;
    EXPECT_GE(json[line]["x"].size(), 100u) << line;
  }
  const auto history = json["history"]["y"].get<std::vector<double>>();
  EXPECT_EQ(*std::max_element(history.begin(), history.end()), 77.0);
  const auto hz = json["spectrum"]["x"].get<std::vector<double>>();
  const auto power = json["spectrum"]["y"].get<std::vector<double>>();
  const auto peak = std::max_element(power.begin(), power.end());
  EXPECT_NEAR(hz[static_cast<size_t>(peak - power.begin())], 2.0, 0.05);
  EXPECT_EQ(json["samples"], 360000);
}

TEST(ColumnView, WidthsAndEmptyColumnsAreHarmless) {
  LogFile log = Sine(1000, 2.0);
  EXPECT_LE(ColumnView(log, log.columns[0], -5)["history"]["x"].size(), 4u);
  EXPECT_EQ(ColumnView(log, log.columns[0], 1 << 30)["history"]["x"].size(),
            1000u);
  log.columns[0].samples.setConstant(4.0);
  EXPECT_TRUE(ColumnView(log, log.columns[0], 100)["spectrum"]["x"].empty());
  log.columns[0].samples.setConstant(std::nan(""));
  EXPECT_NO_FATAL_FAILURE(ColumnView(log, log.columns[0], 100));
}

}  // namespace
}  // namespace pinode
