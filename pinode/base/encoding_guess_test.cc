#include "pinode/base/encoding_guess.h"

#include <iconv.h>

#include <cstdint>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/text_encoding.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Bytes of a text of UTF-8 in another encoding.
std::string In(const std::string& encoding, std::string text) {
  const iconv_t converter = iconv_open(encoding.c_str(), "UTF-8");
  std::string bytes(4 * text.size() + 8, ' ');
  char* from = text.data();
  char* to = bytes.data();
  size_t left = text.size();
  size_t room = bytes.size();
  EXPECT_EQ(iconv(converter, &from, &left, &to, &room), 0u) << encoding;
  iconv_close(converter);
  bytes.resize(bytes.size() - room);
  return bytes;
}

// Text of a logger: a header and rows.
std::string Logger(const std::string& header) {
  std::string text = header + "\r\n";
  for (int i = 0; i < 50; ++i) text += std::to_string(i) + ",1.23,4.56\r\n";
  return text;
}

// Name and text that come out of a header in an encoding.
TextEncoding Found(const std::string& encoding, const std::string& header) {
  std::string text = In(encoding, Logger(header));
  std::string error;
  TextEncoding found;
  EXPECT_TRUE(ConvertToUtf8("", &text, &found, &error)) << error;
  EXPECT_EQ(text, Logger(header)) << found.name;
  return found;
}

// True if the library was built with uchardet.
bool HasDetector() {
  const EncodingGuess guess =
      GuessEncoding(In("WINDOWS-1251", "Время [с];Ускорение"));
  return guess.name == "WINDOWS-1251" && !guess.is_unsure;
}

class EncodingGuessTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasDetector()) GTEST_SKIP() << "built without uchardet";
  }
};

TEST_F(EncodingGuessTest, FindsCyrillic) {
  for (const char* encoding :
       {"WINDOWS-1251", "KOI8-R", "IBM866", "ISO-8859-5"}) {
    for (const char* header :
         {"Время [с];Ускорение X [м/с^2];Ускорение Y [м/с^2]",
          "Ускорение [м/с^2]"}) {
      const TextEncoding found = Found(encoding, header);
      EXPECT_EQ(found.name, encoding);
      EXPECT_EQ(found.AsText(), std::string(encoding) + " (a guess)");
    }
  }
  EXPECT_EQ(Found("KOI8-R", "Ускорение [м/с²]").name, "KOI8-R");
  // A word beside Latin letters, which the detector takes for Greek.
  EXPECT_EQ(Found("KOI8-R", "t;Канал 1;Канал 2").name, "KOI8-R");
  EXPECT_EQ(Found("WINDOWS-1251", "t;Канал 1;Канал 2").name, "WINDOWS-1251");
}

TEST_F(EncodingGuessTest, FindsChineseJapaneseAndKorean) {
  EXPECT_EQ(Found("GB18030", "时间,加速度(gal),位移(mm)").name, "GB18030");
  EXPECT_EQ(Found("GBK", "加速度(gal)").name, "GB18030");
  EXPECT_EQ(Found("BIG5", "時間,加速度,位移,速度").name, "BIG5");
  EXPECT_EQ(Found("SHIFT_JIS", "時刻,加速度(gal)").name, "SHIFT_JIS");
  EXPECT_EQ(Found("EUC-JP", "時刻,加速度(gal)").name, "EUC-JP");
  EXPECT_EQ(Found("EUC-KR", "시간(초),가속도 X,가속도 Y,변위").name, "UHC");
  EXPECT_EQ(Found("EUC-KR", "가속도").name, "UHC");
}

TEST_F(EncodingGuessTest, FindsKatakanaOfHalfTheWidth) {
  for (const char* header : {"時刻,ﾁｬﾝﾈﾙ1(gal)", "時刻,ﾁｬﾝﾈﾙ1,ﾁｬﾝﾈﾙ2"}) {
    const std::string name = Found("CP932", header).name;
    EXPECT_TRUE(name == "SHIFT_JIS" || name == "CP932") << header << name;
  }
}

TEST_F(EncodingGuessTest, FindsCentralEuropeAndGreece) {
  EXPECT_EQ(
      Found("WINDOWS-1250", "Czas [s];Przyspieszenie środek;Ugięcie").name,
      "WINDOWS-1250");
  EXPECT_EQ(Found("ISO-8859-2", "Łata;Ścieżka;Przyśpieszenie").name,
            "ISO-8859-2");
  EXPECT_EQ(Found("WINDOWS-1253", "Χρόνος [s];Επιτάχυνση [m/s²]").name,
            "WINDOWS-1253");
  EXPECT_EQ(Found("WINDOWS-1254", "Zaman;İvme [m/s²];Işık şiddeti").name,
            "WINDOWS-1254");
}

TEST_F(EncodingGuessTest, SeesNamesBehindManyOthers) {
  std::string ascii = "t";
  for (int i = 0; i < 2000; ++i) ascii += ",channel";
  EXPECT_EQ(Found("WINDOWS-1251", ascii + ",Ускорение,Время").name,
            "WINDOWS-1251");
  std::string names = "t";
  for (int i = 0; i < 2000; ++i) names += ",加速度" + std::to_string(i);
  EXPECT_EQ(Found("GB18030", names).name, "GB18030");
}

// Files of Western Europe are by far the most frequent ones. A detector alone
// takes "²" for a letter of Lappland.
TEST(EncodingGuessWestTest, WesternEuropeStaysItself) {
  for (const char* header :
       {"Zeit [s];a [m/s²]", "m/s²", "T [°C];Dehnung [µm/m]", "Wägung",
        "Zeit;Beschleunigung längs [m/s²]", "Tiempo;Aceleración [m/s²]",
        "Temps (s);Accélération;Déplacement", "Velocità;Intensità",
        "Fréquence;à zéro;Éclairement;Vérin arrière", "Måling;Bølge",
        "Aceleração;Posição;Vibração", "Versnelling één", "Läge;Mätning",
        "Siirtymä;Värähtely;Jännitys", "t;Beschl. ü1 Acc;Beschl. ü2 Acc",
        "Ø 20;Ä;Ö"}) {
    const TextEncoding found = Found("WINDOWS-1252", header);
    EXPECT_EQ(found.AsText(), "WINDOWS-1252 (a guess)") << header;
  }
}

TEST_F(EncodingGuessTest, SaysWhatItCannotTell) {
  // Polish or Icelandic: every letter is one in both.
  std::string text =
      In("WINDOWS-1250", "Vrijeme;Ubrzanje;Pomak čvora;Točka\n1;2;3;4\n");
  TextEncoding found;
  std::string error;
  ASSERT_TRUE(ConvertToUtf8("", &text, &found, &error));
  EXPECT_EQ(found.AsText(),
            "WINDOWS-1250 or WINDOWS-1252, read as the first: set `encoding` "
            "if names look wrong");
  // Capitals in KOI8-R are small letters in Windows-1251.
  text = In("KOI8-R", "ВРЕМЯ;УСКОРЕНИЕ\n1;2\n");
  ASSERT_TRUE(ConvertToUtf8("", &text, &found, &error));
  EXPECT_THAT(found.AsText(), HasSubstr("KOI8-R"));
  EXPECT_THAT(found.AsText(), HasSubstr("WINDOWS-1251"));
  // Two signs are too few.
  text = In("SHIFT_JIS", "時刻\n1\n2\n");
  ASSERT_TRUE(ConvertToUtf8("", &text, &found, &error));
  EXPECT_TRUE(found.is_unsure);
  EXPECT_THAT(found.AsText(), HasSubstr("set `encoding`"));
}

// Letters of Icelandic are more often those of Romanian and Turkish.
TEST_F(EncodingGuessTest, LettersOfIcelandicAreDoubtful) {
  const auto said = [](const std::string& encoding, const std::string& header) {
    std::string text = In(encoding, Logger(header));
    std::string error;
    TextEncoding found;
    EXPECT_TRUE(ConvertToUtf8("", &text, &found, &error)) << error;
    return found.AsText();
  };
  const std::string key =
      ", read as the first: set `encoding` if names look wrong";
  for (const char* header :
       {"Accelera\u0163ie", "For\u0163\u0103;Vitez\u0103", "\u0162int\u0103"}) {
    EXPECT_EQ(said("WINDOWS-1250", header),
              "WINDOWS-1252 or WINDOWS-1250" + key)
        << header;
  }
  for (const char* header : {"\u0130vme", "H\u0131z"}) {
    EXPECT_EQ(said("WINDOWS-1254", header),
              "WINDOWS-1252 or WINDOWS-1254" + key)
        << header;
  }
  EXPECT_EQ(said("WINDOWS-1252", "T\u00EDmi;Hr\u00F6\u00F0un;F\u00E6rsla"),
            "WINDOWS-1252 or WINDOWS-1254" + key);
}

TEST_F(EncodingGuessTest, SaysThatNoEncodingFits) {
  std::string text =
      "t;a\xA4z\xD7q\xF7"
      "A\xAEw;\xB4z\xD8\xA9\xBF"
      "x\n1;2;3\n";
  TextEncoding found;
  std::string error;
  ASSERT_TRUE(ConvertToUtf8("", &text, &found, &error));
  EXPECT_FALSE(found.fits);
  EXPECT_THAT(found.AsText(), HasSubstr("no known encoding fits"));
}

// Units of one or two letters are letters of other encodings as well.
TEST(EncodingGuessUnitTest, KnownUnitsDecide) {
  for (const char* header : {"t;F [Н];X [мм]", "t;U1 [мВ];U2 [мВ]",
                             "t;F1 [кН];F2 [кН]", "t;ax [мГал];ay [мГал]"}) {
    EXPECT_EQ(Found("WINDOWS-1251", header).name, "WINDOWS-1251") << header;
  }
  const TextEncoding found = Found("KOI8-R", "t;X [м];V [м/с]");
  EXPECT_EQ(found.name, "KOI8-R");
  // Newtons in this one: a user must look.
  EXPECT_EQ(found.other, "WINDOWS-1251");
  EXPECT_EQ(Found("KOI8-R", "t, с;X, м;V, м/с").name, "KOI8-R");
  // A row of units below the names.
  EXPECT_EQ(Found("WINDOWS-1251", "t;F;X\r\nс;кН;мм").name, "WINDOWS-1251");
}

// "ч" (hours) is "В" (volts) in KOI8-R, "о" is "Н", and "НН" is "мм".
TEST(EncodingGuessUnitTest, NamesDecideBeforeLettersInBrackets) {
  for (const char* header :
       {"Время (ч)", "Время;Канал (о)", "t;Канал (НН)", "t;Ускорение, Н"}) {
    EXPECT_EQ(Found("WINDOWS-1251", header).name, "WINDOWS-1251") << header;
  }
}

TEST(EncodingGuessUnitTest, RefusesUnitsThatMayBeOthers) {
  for (const char* encoding : {"WINDOWS-1251", "KOI8-R"}) {
    const std::string unit = encoding == std::string("KOI8-R") ? "м" : "Н";
    std::string text = In(encoding, Logger("t;X [" + unit + "]"));
    std::string error;
    TextEncoding found;
    EXPECT_FALSE(ConvertToUtf8("", &text, &found, &error)) << encoding;
    EXPECT_THAT(error, HasSubstr("N in WINDOWS-1251")) << encoding;
    EXPECT_THAT(error, HasSubstr("m in KOI8-R")) << encoding;
    EXPECT_THAT(error, HasSubstr("set `encoding`")) << encoding;
    // The letters of the name decide.
    EXPECT_EQ(Found(encoding, "t;Датчик [" + unit + "]").name, encoding);
  }
}

TEST(OddnessTest, KatakanaOfHalfTheWidthIsInRuns) {
  EXPECT_EQ(Oddness("ﾁｬﾝﾈﾙ1;加速度ｾﾝｻ"), 0);
  EXPECT_GT(Oddness("a ﾁ"), 0);
  EXPECT_GT(Oddness("Wﾁｬng"), 0);
}

TEST(OddnessTest, UnitsAreNotOdd) {
  EXPECT_EQ(Oddness("Сила кН;U мВ;a мГал"), 0);
  EXPECT_GT(Oddness("X [μμ]"), 0);
  EXPECT_GT(Oddness("кКанал"), 0);
}

TEST(OddnessTest, WordsThatMixScriptsAreOdd) {
  EXPECT_EQ(Oddness("Wägung;Ускорение X;加速度(gal);a [m/s²];µm;°C"), 0);
  EXPECT_GT(Oddness("Wдgung"), 0);
  EXPECT_GT(Oddness("m/sІ"), 0);
  EXPECT_GT(Oddness("Óñêîðåíèå"), 0);
  EXPECT_GT(Oddness("хУЙПТЕОЙЕ"), 0);
  EXPECT_GT(Oddness("¼ÓËÙ¶È"), 0);
}

TEST(ConvertByIconvTest, NamesThePlace) {
  std::string converted;
  int64_t place = 0;
  EXPECT_TRUE(ConvertByIconv("WINDOWS-1251", "a\xE0", &converted, &place));
  EXPECT_EQ(converted, "aа");
  EXPECT_FALSE(ConvertByIconv("UTF-8", "ab\xFF", &converted, &place));
  EXPECT_EQ(place, 2);
  EXPECT_TRUE(
      ConvertWithReplacements("UTF-8", "a\xFF\xC3", &converted, &place));
  EXPECT_EQ(converted, "a\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(place, 1);
  // It holds back a letter that an accent may follow.
  EXPECT_TRUE(ConvertByIconv("BIG5-HKSCS", "\x88\x66", &converted, &place));
  EXPECT_EQ(converted, "Ê");
  EXPECT_FALSE(ConvertByIconv("no such", "a", &converted, &place));
  EXPECT_EQ(place, -1);
}

}  // namespace
}  // namespace pinode
