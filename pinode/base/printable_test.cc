#include "pinode/base/printable.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"

namespace pinode {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

TEST(Printable, EscapesWhatTerminalsActUpon) {
  EXPECT_EQ(Printable("a\x1b[2Jb"), "a\\x1B[2Jb");
  EXPECT_EQ(Printable("a\x07\x7f\r"), "a\\x07\\x7F\\r");
  // The 8-bit form of the same control sequence, marks of the writing
  // direction, a separator of lines, a tag.
  EXPECT_EQ(Printable("\u009b2J"), "\\u{9B}2J");
  EXPECT_EQ(Printable("a\u202egpj.exe"), "a\\u{202E}gpj.exe");
  EXPECT_EQ(Printable("a\u2067b\u2069\u200f\u061c"),
            "a\\u{2067}b\\u{2069}\\u{200F}\\u{61C}");
  EXPECT_EQ(Printable("a\u2028b"), "a\\u{2028}b");
  EXPECT_EQ(Printable("\U000e0041"), "\\u{E0041}");
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(Printable("\xff\xc3(\xe2\x82"), "\\xFF\\xC3(\\xE2\\x82");
}

TEST(Printable, KeepsTextOfAllLanguages) {
  const std::string text =
      "Decke 2: \u00dcbergang, \u30bb\u30f3\u30b5\u30fc 1, "
      "\u062d\u0633\u0627\u0633, \u0645\u06cc\u200c\u062e, \U0001f3e2\n\t3 mm";
  EXPECT_EQ(Printable(text), text);
  EXPECT_EQ(Printable(""), "");
}

TEST(Printable, LinesHaveNoLineEnds) {
  EXPECT_EQ(PrintableLine("a\nb\tc\r\n"), "a\\nb\\tc\\r\\n");
  EXPECT_EQ(Printable("a\nb\tc"), "a\nb\tc");
}

TEST(Printable, LongWordsAndLinesAreClipped) {
  const std::string line =
      PrintableLine("group '" + std::string(10000, 'a') + "' is unknown");
  EXPECT_LT(line.size(), 350u);
  EXPECT_THAT(line, StartsWith("group 'aaaa"));
  EXPECT_THAT(line, EndsWith("a' is unknown"));
  std::string umlauts;
  for (int i = 0; i < 5000; ++i) umlauts += "\u00fc";
  const std::string clipped = Printable(umlauts);
  EXPECT_LT(clipped.size(), 350u);
  EXPECT_EQ(FirstInvalidUtf8(clipped), std::string::npos);
  std::string words;
  for (int i = 0; i < 5000; ++i) words += "word ";
  EXPECT_LT(PrintableLine(words).size(), 4100u);
  EXPECT_EQ(Printable(words), words);
}

TEST(Printable, ClippedToAWidth) {
  EXPECT_EQ(Clipped("abcdef", 6), "abcdef");
  EXPECT_EQ(Clipped("abcdefg", 6), "abc...");
  EXPECT_EQ(Clipped("\u00fc\u00fc\u00fc\u00fc\u00fc", 4), "\u00fc...");
}

}  // namespace
}  // namespace pinode
