#include "pinode/case/results/verdict_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinode {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;

TEST(VerdictJson, HasTheFindings) {
  ordered_json json;
  WriteVerdict(Verdict(std::vector<Finding>{
                   {"open_gaps", "gaps stayed open", 2e-6, 1e-6, "do this"},
                   {"failed", "it failed"}}),
               &json);
  EXPECT_EQ(json["usable"], false);
  EXPECT_EQ(json["verdict"], "not_usable");
  ASSERT_EQ(json["findings"].size(), 2u);
  EXPECT_EQ(json["findings"][0]["check"], "open_gaps");
  EXPECT_EQ(json["findings"][0]["number"], 2e-6);
  EXPECT_EQ(json["findings"][0]["limit"], 1e-6);
  EXPECT_EQ(json["findings"][0]["advice"], "do this");
  EXPECT_TRUE(json["findings"][1]["number"].is_null());
  bool usable = true;
  std::string error;
  ASSERT_TRUE(ReadUsable(json, &usable, &error)) << error;
  EXPECT_FALSE(usable);
}

// Results of versions before verdicts have "usable" alone.
TEST(VerdictJson, ReadsOlderResults) {
  bool usable = false;
  std::string error;
  ASSERT_TRUE(ReadUsable(ordered_json{{"usable", true}}, &usable, &error))
      << error;
  EXPECT_TRUE(usable);
  // A result is usable if both say so.
  ASSERT_TRUE(
      ReadUsable(ordered_json{{"usable", true}, {"verdict", "not_usable"}},
                 &usable, &error))
      << error;
  EXPECT_FALSE(usable);
  ASSERT_TRUE(ReadUsable(ordered_json{{"usable", false}, {"verdict", "good"}},
                         &usable, &error))
      << error;
  EXPECT_FALSE(usable);
}

TEST(VerdictJson, RefusesOtherValues) {
  bool usable = false;
  std::string error;
  EXPECT_FALSE(ReadUsable(ordered_json::object(), &usable, &error));
  EXPECT_THAT(error, HasSubstr("\"usable\" is missing"));
  EXPECT_FALSE(ReadUsable(ordered_json{{"usable", 1}}, &usable, &error));
  EXPECT_FALSE(ReadUsable(ordered_json{{"usable", true}, {"verdict", "fine"}},
                          &usable, &error));
  EXPECT_THAT(error, HasSubstr("\"verdict\" is \"fine\""));
}

}  // namespace
}  // namespace pinode
