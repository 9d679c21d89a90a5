#include "pinode/base/text_encoding.h"

#include <cstdint>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/encoding_guess.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Returns the text in UTF-8, and the encoding that was found.
std::string Converted(std::string text, std::string* found, bool* is_guess,
                      const std::string& encoding = "") {
  std::string error;
  TextEncoding result;
  EXPECT_TRUE(ConvertToUtf8(encoding, &text, &result, &error)) << error;
  *found = result.name;
  *is_guess = result.is_guess;
  return text;
}

TEST(TextEncodingTest, FindsTheEncoding) {
  const std::string expected = "W\xC3\xA4gung,1\n";
  std::string found;
  bool is_guess = true;
  EXPECT_EQ(Converted(expected, &found, &is_guess), expected);
  EXPECT_EQ(found, "UTF-8");
  EXPECT_FALSE(is_guess);
  EXPECT_EQ(Converted("\xEF\xBB\xBF" + expected, &found, &is_guess), expected);
  EXPECT_FALSE(is_guess);
  EXPECT_EQ(Converted("W\xE4gung,1\n", &found, &is_guess), expected);
  EXPECT_EQ(found, "WINDOWS-1252");
  EXPECT_TRUE(is_guess);
  // 0x81 is no letter there.
  Converted("\x81\n", &found, &is_guess);
  EXPECT_NE(found, "WINDOWS-1252");
  EXPECT_TRUE(is_guess);
  const std::string utf16(
      "W\0\xE4\0g\0u\0n\0g\0,\0"
      "1\0\n\0",
      18);
  EXPECT_EQ(Converted("\xFF\xFE" + utf16, &found, &is_guess), expected);
  EXPECT_EQ(Converted(utf16, &found, &is_guess), expected);
  EXPECT_EQ(found, "UTF-16LE");
  EXPECT_FALSE(is_guess);
  EXPECT_EQ(Converted("W\x84gung,1\n", &found, &is_guess, "CP437"), expected);
  // Names in other letters have no zeros.
  EXPECT_EQ(Converted(std::string("\x12\x04\x40\x04\x35\x04\x3C\x04;\0"
                                  "1\0;\0\n\0",
                                  16),
                      &found, &is_guess),
            "\xD0\x92\xD1\x80\xD0\xB5\xD0\xBC;1;\n");
  EXPECT_EQ(found, "UTF-16LE");
}

// Rows behind the bytes that the guess is from.
std::string ManyRows() {
  std::string rows;
  for (int i = 0; i < 100000; ++i) rows += "1,2\n";
  return rows;
}

TEST(TextEncodingTest, OneForeignByteKeepsTheLetters) {
  // GB18030 of "加速度(gal)", and a byte that is none of it behind 256 KiB.
  const std::string header = "\xBC\xD3\xCB\xD9\xB6\xC8(gal)";
  std::string text = header + ",b\n" + ManyRows() + "# \xFF\n3,4\n";
  TextEncoding found;
  std::string error;
  const std::string guess = GuessEncoding(header + ",b\n").name;
  ASSERT_TRUE(ConvertToUtf8("", &text, &found, &error)) << error;
  EXPECT_EQ(found.name, guess);
  std::string expected;
  int64_t place = 0;
  ASSERT_TRUE(ConvertByIconv(guess, header, &expected, &place));
  EXPECT_EQ(text.substr(0, expected.size()), expected);
  if (guess == "GB18030") {
    EXPECT_EQ(text.substr(text.size() - 10), "# \xEF\xBF\xBD\n3,4\n");
    EXPECT_THAT(found.AsText(),
                HasSubstr("; byte 400017 (line 100002) is not text in"));
  }
}

TEST(TextEncodingTest, TakesTheSupersetThatFits) {
  // "時刻" and a circled one, which Windows adds to Shift-JIS.
  const std::string header = "\x8E\x9E\x8D\x8F,\x89\xC1\x91\xAC\x93\x78\n";
  const std::string one = "# \x87\x40\n";
  for (const char* encoding : {"SHIFT_JIS", "shift_jis", ""}) {
    // Without uchardet the guess is another one.
    const bool is_guess = encoding == std::string();
    if (is_guess && GuessEncoding(header).name != "SHIFT_JIS") continue;
    std::string text = header + ManyRows() + one;
    TextEncoding found;
    std::string error;
    ASSERT_TRUE(ConvertToUtf8(encoding, &text, &found, &error)) << error;
    EXPECT_EQ(text.substr(text.size() - 6), "# \xE2\x91\xA0\n") << encoding;
    EXPECT_EQ(found.name, "CP932") << encoding;
    EXPECT_EQ(found.flaw, "");
  }
  std::string text = header + "\xFF\n";
  TextEncoding found;
  std::string error;
  EXPECT_FALSE(ConvertToUtf8("SHIFT_JIS", &text, &found, &error));
  EXPECT_THAT(error, HasSubstr("byte 13 (line 2) is not text in SHIFT_JIS"));
}

TEST(TextEncodingTest, RefusesWhatIsNoText) {
  TextEncoding found;
  std::string error;
  std::string text("a\0b,c\nd\n", 8);
  EXPECT_FALSE(ConvertToUtf8("", &text, &found, &error));
  EXPECT_THAT(error, HasSubstr("is a binary file"));
  text = std::string("\x01\0\x02\0\x03\0\x04\0", 8);
  EXPECT_FALSE(ConvertToUtf8("", &text, &found, &error));
  EXPECT_THAT(error, HasSubstr("is a binary file"));
  text = "a\n\xFF\n";
  EXPECT_FALSE(ConvertToUtf8("UTF-8", &text, &found, &error));
  EXPECT_THAT(error, HasSubstr("line 2"));
  EXPECT_FALSE(ConvertToUtf8("no such", &text, &found, &error));
  EXPECT_THAT(error, HasSubstr("'no such' is not known"));
}

}  // namespace
}  // namespace pinode
