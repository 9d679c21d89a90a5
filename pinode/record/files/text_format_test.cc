#include "pinode/record/files/text_format.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

TEST(TextFormatTest, KeysAreReadBack) {
  TextFormat format;
  format.encoding = "ISO-8859-1";
  format.header_lines = 0;
  format.delimiter = '\t';
  format.decimal = ',';
  format.time_format = "%H-%M-%S";
  TextFormat read;
  std::string key;
  std::string error;
  ASSERT_TRUE(ParseTextFormat(format.Keys(), &read, &key, &error)) << error;
  EXPECT_EQ(read.AsText(), format.AsText());
  format.delimiter = ' ';
  ASSERT_TRUE(ParseTextFormat(format.Keys(), &read, &key, &error)) << error;
  EXPECT_EQ(read.delimiter, ' ');
}

TEST(TextFormatTest, EmptyValuesAreNotGiven) {
  TextFormat format;
  format.header_lines = 7;
  std::string key;
  std::string error;
  ASSERT_TRUE(ParseTextFormat({{"header_lines", ""}, {"decimal", ""}}, &format,
                              &key, &error));
  EXPECT_EQ(format.header_lines, 7);
  EXPECT_EQ(format.decimal, 0);
}

TEST(TextFormatTest, NamesTheBadKey) {
  struct BadKey {
    const char* key;
    const char* value;
    const char* message;
  };
  for (const BadKey& bad :
       {BadKey{"header_lines", "-3", "expected a number of lines"},
        {"header_lines", "two", "'two', expected"},
        {"delimiter", "x", "expected one of , ; | tab blank"},
        {"delimiter", ",,", "expected one of"},
        {"decimal", ";", "expected . or ,"},
        {"time_unit", "parsec", "unit 'parsec' is not known"},
        {"time_unit", "kg", "kg"}}) {
    TextFormat format;
    std::string key;
    std::string error;
    EXPECT_FALSE(ParseTextFormat({{"encoding", "UTF-8"}, {bad.key, bad.value}},
                                 &format, &key, &error));
    EXPECT_EQ(key, bad.key);
    EXPECT_THAT(error, HasSubstr(bad.message));
  }
}

TEST(TextFormatTest, OneSignIsNotTwo) {
  TextFormat format;
  std::string key;
  std::string error;
  EXPECT_FALSE(ParseTextFormat({{"delimiter", ","}, {"decimal", ","}}, &format,
                               &key, &error));
  EXPECT_EQ(key, "delimiter");
  EXPECT_THAT(error, HasSubstr("`decimal`"));
}

}  // namespace
}  // namespace pinode
