#include "pinode/record/record.h"

#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Record FiveSamples() {
  Record record;
  record.name = "r";
  record.start_time = 2.0;
  record.sampling_step = 0.5;
  record.channels = {{"a", "m", Vector::Zero(5)}, {"b", "g", Vector::Ones(5)}};
  return record;
}

TEST(RecordTest, Grid) {
  const Record record = FiveSamples();
  EXPECT_EQ(record.num_samples(), 5);
  EXPECT_DOUBLE_EQ(record.time(4), 4.0);
  EXPECT_DOUBLE_EQ(record.duration(), 2.0);
  EXPECT_EQ(record.FindChannel("b"), &record.channels[1]);
  EXPECT_EQ(record.FindChannel("c"), nullptr);
  EXPECT_EQ(Record().num_samples(), 0);
  EXPECT_EQ(Record().duration(), 0.0);
}

TEST(RecordTest, SaysWhatIsWrong) {
  std::string error;
  EXPECT_TRUE(FiveSamples().IsValid(&error)) << error;
  auto expect_error = [](const Record& record, const char* expected) {
    std::string message;
    EXPECT_FALSE(record.IsValid(&message));
    EXPECT_THAT(message, HasSubstr(expected));
  };
  Record record = FiveSamples();
  record.sampling_step = 0.0;
  expect_error(record, "record 'r': its sampling step 0 is not positive");
  record = FiveSamples();
  record.start_time = std::numeric_limits<double>::infinity();
  expect_error(record, "start time");
  record = FiveSamples();
  record.channels.clear();
  expect_error(record, "0 samples");
  record = FiveSamples();
  record.channels[1].values = Vector::Zero(4);
  expect_error(record, "channel 'b' has 4 samples, channel 'a' has 5");
  record = FiveSamples();
  record.channels[1].name = "a";
  expect_error(record, "two channels are named 'a'");
  record = FiveSamples();
  record.channels[0].name = "";
  expect_error(record, "has no name");
}

}  // namespace
}  // namespace pinode
