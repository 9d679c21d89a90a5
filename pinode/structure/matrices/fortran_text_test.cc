#include "pinode/structure/matrices/fortran_text.h"

#include "gtest/gtest.h"

namespace pinode {
namespace {

TEST(FortranFormat, HasLetterCountAndWidth) {
  struct Example {
    const char* text;
    char letter;
    int count;
    int width;
  };
  for (const Example& example :
       {Example{"(10I8)", 'I', 10, 8}, Example{"(1I14)", 'I', 1, 14},
        Example{"(3E25.16)", 'E', 3, 25}, Example{"1P,5E16.9", 'E', 5, 16},
        Example{"(1P4D25.16E3)", 'D', 4, 25}, Example{"(F20.0)", 'F', 1, 20},
        Example{"(4(1PE20.13))", 'E', 4, 20}, Example{"(0P,2F9.3)", 'F', 2, 9},
        Example{" ( 2 g 12.4 ) ", 'G', 2, 12}}) {
    FortranFormat format;
    ASSERT_TRUE(ParseFortranFormat(example.text, &format)) << example.text;
    EXPECT_EQ(format.letter, example.letter) << example.text;
    EXPECT_EQ(format.count, example.count) << example.text;
    EXPECT_EQ(format.width, example.width) << example.text;
  }
}

TEST(FortranFormat, RefusesWhatItCannotFollow) {
  FortranFormat format;
  // The last: a scale factor changes numbers without an exponent.
  for (const char* text :
       {"", "(", "10", "(10I8", "10I8)", "(10A8)", "(I0)", "(0I8)", "(2I8,I4)",
        "(99999I8)", "(1000(1000I8))", "(((I8)))", "(E12.4E)", "(1P,F12.4)"}) {
    EXPECT_FALSE(ParseFortranFormat(text, &format)) << text;
  }
}

TEST(FortranNumber, NeedsNoLetterBeforeTheExponent) {
  double value = 0.0;
  ASSERT_TRUE(ParseFortranDouble("1.5-101", &value));
  EXPECT_EQ(value, 1.5e-101);
  ASSERT_TRUE(ParseFortranDouble(" -3.+5 ", &value));
  EXPECT_EQ(value, -3e5);
  ASSERT_TRUE(ParseFortranDouble("2.5D+03", &value));
  EXPECT_EQ(value, 2500.0);
  for (const char* text : {"", "-", "1.5e-", "1..5-3", "a-3", "1.5--3"}) {
    EXPECT_FALSE(ParseFortranDouble(text, &value)) << text;
  }
}

TEST(FixedFields, MayTouchOrBeMissing) {
  EXPECT_EQ(FixedField("  12-3.5", 0, 4), "12");
  EXPECT_EQ(FixedField("  12-3.5", 1, 4), "-3.5");
  EXPECT_EQ(FixedField("  12-3.5", 2, 4), "");
}

}  // namespace
}  // namespace pinode
