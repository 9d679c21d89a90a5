#include "pinode/record/files/clock.h"

#include <cstdint>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Seconds since 1970 of 2024-03-01 12:00:00 (date -u -d ... +%s).
constexpr double kNoon = 1709294400.0;

// Returns the column of these cells; `format` is one of strptime, or empty.
ClockColumn Resolved(const std::vector<std::string>& texts,
                     const std::string& format = "") {
  std::vector<ClockCell> cells(texts.size());
  for (size_t i = 0; i < texts.size(); ++i) {
    EXPECT_TRUE(format.empty() ? ParseClock(texts[i], &cells[i])
                               : ParseClockBy(format, texts[i], &cells[i]))
        << texts[i];
  }
  ClockColumn column;
  int64_t bad_row = 0;
  std::string error;
  EXPECT_TRUE(ResolveClock(cells, &column, &bad_row, &error)) << error;
  return column;
}

TEST(ClockTest, ReadsTheFormsOfLoggers) {
  for (const char* text :
       {"2024-03-01 12:00:00.005", "2024-03-01T12:00:00.005Z",
        "2024-03-01 12:00:00,005", "2024/03/01 12:00:00.005 PM",
        "2024-03-01 13:00:00.005+01:00", "2024-03-01 07:00:00.005-0500",
        "01.03.2024 12:00:00,005", "1.3.2024 12:00:00.005",
        "1.3.2024 12:00:00:005", "01-Mar-2024 12:00:00.005",
        "01-M\xC3\xA4r-2024 12:00:00.005", "2024-03-01_12:00:00.005",
        "12:00:00.005 2024-03-01"}) {
    const ClockColumn column = Resolved({text});
    EXPECT_NEAR(column.origin, kNoon + 0.005, 1e-6) << text;
    EXPECT_TRUE(column.is_dated) << text;
    EXPECT_TRUE(column.is_order_certain) << text;
  }
  // Day or year first; a day later tells.
  const ClockColumn open = Resolved({"01.03.24 12:00:00"});
  EXPECT_FALSE(open.is_order_certain);
  const ClockColumn days = Resolved(
      {"01.03.24 23:59:59.5", "02.03.24 00:00:00", "02.03.24 00:00:01"});
  EXPECT_NEAR(days.origin, kNoon + 43199.5, 1e-6);
  EXPECT_TRUE(days.is_order_certain);
  EXPECT_NEAR(Resolved({"24.03.01 23:59:59.5", "24.03.02 00:00:00",
                        "24.03.02 00:00:01"})
                  .origin,
              kNoon + 43199.5, 1e-6);
  EXPECT_NEAR(Resolved({"12:00:00.25"}).origin, 43200.25, 1e-9);
  EXPECT_FALSE(Resolved({"12:00:00.25"}).is_dated);
}

TEST(ClockTest, TakesNoOtherTextForATime) {
  ClockCell cell;
  for (const char* text :
       {"", "12:30", "1.5", "-12:00:00", "12:61:00", "12:00:99", "2024-03",
        "2024-03-01 x", "1 2 2024", "12:00:00 XM", "13:00:00 PM", "1.2.3.4",
        "12:00:00:05", "2024-Foo-01"}) {
    EXPECT_FALSE(ParseClock(text, &cell)) << text;
  }
}

TEST(ClockTest, FindsTheOrderOfDates) {
  // 25 is no month.
  EXPECT_EQ(Resolved({"02/25/2024 12:00:00", "02/26/2024 12:00:00"}).seconds[1],
            86400.0);
  // A record over midnight goes on with the same step.
  const ClockColumn column =
      Resolved({"31/01/2024 23:59:59", "01/02/2024 00:00:00"});
  EXPECT_EQ(column.seconds[1], 1.0);
  const ClockColumn even = Resolved(
      {"03/04/2024 23:59:58", "03/04/2024 23:59:59", "04/04/2024 00:00:00"});
  EXPECT_EQ(even.seconds[2], 2.0);
  EXPECT_TRUE(even.is_order_certain);
  // A pause of ten minutes over midnight, in each form.
  for (const char* date : {"0%.03.24", "24.03.0%", "0%/03/2024", "0%/03/24"}) {
    std::vector<std::string> texts;
    for (const char* time : {"1 23:55:00.0", "1 23:55:00.5", "1 23:55:01.0",
                             "2 00:05:01.0", "2 00:05:01.5"}) {
      std::string text = std::string(date) + (time + 1);
      text.replace(text.find('%'), 1, 1, time[0]);
      texts.push_back(text);
    }
    const ClockColumn pause = Resolved(texts);
    ASSERT_EQ(pause.seconds.size(), 5u);
    EXPECT_EQ(pause.seconds[4], 601.5) << date;
    EXPECT_NEAR(pause.origin, kNoon + 42900.0, 1e-6) << date;
    EXPECT_TRUE(pause.is_order_certain) << date;
  }
  // One day: the order makes no difference.
  EXPECT_FALSE(Resolved({"03/04/2024 10:00:00", "03/04/2024 10:00:01"})
                   .is_order_certain);
}

TEST(ClockTest, RefusesWhatIsOpen) {
  ClockColumn column;
  int64_t bad_row = -1;
  std::string error;
  const auto resolve = [&](const std::vector<std::string>& texts) {
    std::vector<ClockCell> cells(texts.size());
    for (size_t i = 0; i < texts.size(); ++i) {
      EXPECT_TRUE(ParseClock(texts[i], &cells[i])) << texts[i];
    }
    return ResolveClock(cells, &column, &bad_row, &error);
  };
  EXPECT_FALSE(resolve({"01/02/2024", "02/02/2024", "03/02/2024"}));
  EXPECT_THAT(error, HasSubstr("`time_format`"));
  EXPECT_FALSE(resolve({"2024-02-28", "2024-02-30"}));
  EXPECT_EQ(bad_row, 1);
  EXPECT_FALSE(resolve({"2024-02-28 12:00:00", "12:00:01"}));
  EXPECT_EQ(bad_row, 1);
}

TEST(ClockTest, FormatsOfStrptime) {
  EXPECT_EQ(Resolved({"01/02/2024 12:00:00.25", "02/02/2024 12:00:00.5"},
                     "%d/%m/%Y %H:%M:%S")
                .seconds[1],
            86400.25);
  EXPECT_NEAR(Resolved({"20240301120000.005"}, "%Y%m%d%H%M%S").origin,
              kNoon + 0.005, 1e-6);
  EXPECT_NEAR(Resolved({"12-00-00_250000"}, "%H-%M-%S_%f").origin, 43200.25,
              1e-9);
  ClockCell cell;
  EXPECT_FALSE(ParseClockBy("%d/%m/%Y", "2024-03-01", &cell));
  EXPECT_FALSE(ParseClockBy("%H:%M:%S", "12:00:00 x", &cell));
  EXPECT_FALSE(ParseClockBy("text", "text", &cell));
}

TEST(ClockTest, WritesTimes) {
  EXPECT_EQ(ClockText(kNoon + 0.005, true), "2024-03-01 12:00:00.005");
  EXPECT_EQ(ClockText(43200.0, false), "12:00:00");
  EXPECT_EQ(ClockText(kNoon + 0.0005, true), "2024-03-01 12:00:00.0005");
  // Rounded to the next second, and to the next day.
  EXPECT_EQ(ClockText(kNoon + 0.9999999, true), "2024-03-01 12:00:01");
  EXPECT_EQ(ClockText(kNoon + 43199.9999999, true), "2024-03-02 00:00:00");
  EXPECT_EQ(ClockText(-0.5, true), "1969-12-31 23:59:59.5");
}

}  // namespace
}  // namespace pinode
