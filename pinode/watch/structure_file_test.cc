#include "pinode/watch/structure_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "pinode/watch/structure_keys.h"

namespace pinode {
namespace {

constexpr char kLeast[] = "name = \"b\"\n[reference]\nrecords = 50\n";

std::string ErrorOf(const std::string& text) {
  WatchedStructure structure;
  std::string error;
  EXPECT_FALSE(ParseStructureFile(text, "b.toml", &structure, &error)) << text;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

TEST(StructureFile, ReadsEveryKey) {
  const std::string text = R"toml(
name = "bridge"
[records]
folder = "r"
pattern = "*.gz"
columns = ["a", "b"]
quantities = ["velocity"]
time = "t"
time_format = "%d.%m.%y"
time_in_name = "%Y"
[[covariate]]
name = "T"
kink = 0
[[covariate]]
name = "wind"
column = "w"
file = "w.csv"
time = "when"
largest_gap_hours = 2
[modes]
lowest_hz = 1
highest_hz = 9
[reference]
from = "2024-03-01"
to = "2025-03-01 12:30"
[tracking]
largest_step = 0.2
least_mac = 0.7
least_presence = 0.4
[alarm]
false_alarms_per_year = 2
memory_days = 5
clear_days = 3
)toml";
  WatchedStructure s;
  std::string error;
  ASSERT_TRUE(ParseStructureFile(text, "x/b.toml", &s, &error)) << error;
  EXPECT_EQ(s.name, "bridge");
  EXPECT_EQ(s.records.folder, "x/r");
  EXPECT_EQ(s.records.pattern, "*.gz");
  EXPECT_EQ(s.records.columns, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(s.records.quantities, (std::vector<std::string>{"velocity"}));
  EXPECT_EQ(s.records.time_column, "t");
  EXPECT_EQ(s.records.time_format, "%d.%m.%y");
  EXPECT_EQ(s.records.time_in_name, "%Y");
  ASSERT_EQ(s.covariates.size(), 2u);
  EXPECT_EQ(s.covariates[0].column, "T");
  EXPECT_EQ(s.covariates[0].kink, 0.0);
  EXPECT_EQ(s.covariates[1].column, "w");
  EXPECT_TRUE(std::isnan(s.covariates[1].kink));
  EXPECT_EQ(s.covariates[1].file, "x/w.csv");
  EXPECT_EQ(s.covariates[1].time_column, "when");
  EXPECT_EQ(s.covariates[1].largest_gap_hours, 2.0);
  EXPECT_EQ(s.modes.lowest_hz, 1.0);
  EXPECT_EQ(s.modes.highest_hz, 9.0);
  // 2024-03-01 is day 19783 since 1970.
  EXPECT_EQ(s.reference.from, 19783.0 * 86400.0);
  EXPECT_EQ(s.reference.to, (19783.0 + 365.0) * 86400.0 + 45000.0);
  EXPECT_EQ(s.tracking.largest_step, 0.2);
  EXPECT_EQ(s.tracking.least_mac, 0.7);
  EXPECT_EQ(s.tracking.least_presence, 0.4);
  EXPECT_EQ(s.chart.false_alarms_per_year, 2.0);
  EXPECT_EQ(s.notify.kinds, (std::vector<std::string>{"alarm", "all-clear"}));
  EXPECT_EQ(s.chart.memory_days, 5.0);
  EXPECT_EQ(s.chart.clear_days, 3.0);
}

TEST(StructureFile, RefusesInOneLine) {
  const std::string least = kLeast;
  EXPECT_NE(ErrorOf("[reference]\nrecords = 50\n").find("name"),
            std::string::npos);
  EXPECT_NE(ErrorOf("nane = 1\n" + least).find("did you mean 'name'"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[records]\ncolumn = [\"a\"]\n")
                .find("b.toml:5: [records]: unknown key 'column'"),
            std::string::npos);
  EXPECT_NE(ErrorOf("name = \"b\"\n").find("reference has no end"),
            std::string::npos);
  EXPECT_NE(ErrorOf("name = \"b\"\n[reference]\nrecords = 5\n").find("30"),
            std::string::npos);
  EXPECT_NE(ErrorOf("name = \"b\"\n[reference]\nto = \"soon\"\n")
                .find("expected a date"),
            std::string::npos);
  // The order of day and month is not known.
  EXPECT_NE(ErrorOf("name = \"b\"\n[reference]\nto = \"03/04/2024\"\n")
                .find("expected a date"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[records]\nsampling_rate_hz = 10\n")
                .find("time_in_name"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[records]\nsampling_rate_hz = 10\n"
                            "time_in_name = \"%Y\"\ntime_format = \"%H\"\n")
                .find("time_format and sampling_rate_hz are both given"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[records]\npattern = \"a/*.csv\"\n")
                .find("expected names of files"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[tracking]\nleast_mac = 1.5\n").find("0 and 1"),
            std::string::npos);
  EXPECT_NE(
      ErrorOf(least + "[alarm]\nfalse_alarms_per_year = 0\n").find("[alarm]"),
      std::string::npos);
  const std::string mail =
      least + "[notify]\nmail = \"smtps://mail.example.org\"\n";
  const std::string to = "to = [\"a@example.org\"]\n";
  const std::string from = "from = \"b@example.org\"\n";
  EXPECT_NE(ErrorOf(mail + to).find("from is missing"), std::string::npos);
  EXPECT_NE(ErrorOf(mail + from).find("to is missing"), std::string::npos);
  EXPECT_NE(ErrorOf(mail + from + "to = []\n").find("to is missing or empty"),
            std::string::npos);
  EXPECT_NE(ErrorOf(mail + from + to + "kinds = []\n").find("kinds is empty"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[notify]\nkinds = [\"alarm\"]\n")
                .find("neither `webhook` nor `mail`"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[notify]\nmail = \"smtp://localhost\"\n" + from +
                    to + "mail_tls = false\nuser = \"bridge\"\n")
                .find("needs an encrypted server"),
            std::string::npos);
  EXPECT_NE(ErrorOf(mail + from + "to = [\"a\\r\\nb@example.org\"]\n")
                .find("not a mail address"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[notify]\nwebhook = \"http://a.b\"\n" + to)
                .find("needs `mail`"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[notify]\nwebhook = \"file:///etc/passwd\"\n")
                .find("begins with http://"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[notify]\nkinds = [\"alert\"]\n")
                .find("the kind 'alert' is not known"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[alarm]\nfalse_alarms_per_year = 20\n")
                .find("times clear_days = 140, expected at most 90"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[[covariate]]\nname = \"T\"\nfile = \"x.csv\"\n")
                .find("time is missing"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[[covariate]]\nname = \"T\"\n[[covariate]]\n"
                            "name = \"T\"\n")
                .find("twice"),
            std::string::npos);
  for (const char* name :
       {"time", "record", "light", "t2", "average", "mode_1_hz", "mode_12_"}) {
    EXPECT_NE(ErrorOf(least + "[[covariate]]\nname = \"" + name + "\"\n")
                  .find("the name '" + std::string(name) +
                        "' is that of a column of histories.csv, expected "
                        "another name"),
              std::string::npos)
        << name;
  }
  for (const char* name : {"duration_s", "refusal", "rejected"}) {
    EXPECT_NE(ErrorOf(least + "[[covariate]]\nname = \"" + name + "\"\n")
                  .find("column of Store.records()"),
              std::string::npos)
        << name;
  }
  for (const char* name : {"Time", "mode_1", "mode_x_hz", "mode__hz"}) {
    WatchedStructure structure;
    std::string error;
    EXPECT_TRUE(
        ParseStructureFile(least + "[[covariate]]\nname = \"" + name + "\"\n",
                           "b.toml", &structure, &error))
        << error;
  }
  EXPECT_NE(ErrorOf(least + "[modes]\nmax_ordr = 4\n").find("max_order"),
            std::string::npos);
  EXPECT_EQ(ErrorOf(least + "[modes]\nmax_order = 5\n").find("b.toml:5: "), 0u);
  EXPECT_NE(ErrorOf(least + "[records]\nquantities = [\"speed\"]\n")
                .find("'speed' is not known"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[records]\ncolumns = [\"a\", \"b\", \"c\"]\n"
                            "quantities = [\"strain\", \"strain\"]\n")
                .find("each of the 3 columns"),
            std::string::npos);
  EXPECT_NE(ErrorOf(least + "[modes]\nreferences = [\"a\"]\n")
                .find("not for pinode_watch"),
            std::string::npos);
}

TEST(StructureFile, SettingsNoticeAChangeOfReading) {
  WatchedStructure a, b;
  std::string error;
  const std::string least = kLeast;
  ASSERT_TRUE(ParseStructureFile(least, "b.toml", &a, &error)) << error;
  ASSERT_TRUE(ParseStructureFile(least + "[alarm]\nmemory_days = 9\n", "b.toml",
                                 &b, &error));
  EXPECT_EQ(ReadingSettings(a), ReadingSettings(b));
  ASSERT_TRUE(ParseStructureFile(least + "[modes]\nmax_order = 20\n", "b.toml",
                                 &b, &error));
  EXPECT_NE(ReadingSettings(a), ReadingSettings(b));
  ASSERT_TRUE(ParseStructureFile(least + "[records]\ncolumns = [\"a\"]\n",
                                 "b.toml", &b, &error));
  EXPECT_NE(ReadingSettings(a), ReadingSettings(b));
  ASSERT_TRUE(ParseStructureFile(
      least + "[records]\ntime_format = \"%d.%m.%y %H:%M:%S\"\n", "b.toml", &b,
      &error))
      << error;
  EXPECT_NE(ReadingSettings(a), ReadingSettings(b));
  ASSERT_TRUE(ParseStructureFile(least + "[modes]\n", "b.toml", &a, &error));
  ASSERT_TRUE(ParseStructureFile(least + "[modes]\nthreads = 3\n", "b.toml", &b,
                                 &error));
  EXPECT_EQ(ReadingSettings(a), ReadingSettings(b));
  EXPECT_EQ(b.modes.num_threads, 3);
}

TEST(StructureFile, ReferencePageHasItsKeys) {
  std::ifstream file(PINODE_SOURCE_DIR "/pinode/watch/README.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(StructureKeyReference()), std::string::npos)
      << "pinode_watch --keys prints the tables for the page:\n"
      << StructureKeyReference();
}

}  // namespace
}  // namespace pinode
