#include "pinode/base/encoding_guess.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#ifdef PINODE_WITH_UCHARDET
#include <uchardet/uchardet.h>
#endif

#include "pinode/base/header_cells.h"
#include "pinode/base/logging.h"
#include "pinode/base/unit_names.h"

namespace pinode {
namespace {

// Names of channels are few words; the detector wants more. It sees them this
// many times if once is not enough: "加速度" in GB18030 then is no Greek.
constexpr int kRepetitions = 4;

enum class Script { kNone, kAscii, kLatin, kCyrillic, kGreek, kAsian };

bool IsAscii(char c) { return static_cast<unsigned char>(c) < 0x80; }

bool IsIn(char32_t c, char32_t first, char32_t last) {
  return c >= first && c <= last;
}

// True for letters of Katakana that Japanese loggers write in one byte.
bool IsHalfWidthKana(char32_t c) { return IsIn(c, 0xFF66, 0xFF9F); }

Script ScriptOf(char32_t c) {
  if (IsIn(c, 'A', 'Z') || IsIn(c, 'a', 'z')) return Script::kAscii;
  if (IsIn(c, 0xC0, 0x24F) && c != 0xD7 && c != 0xF7) return Script::kLatin;
  if (IsIn(c, 0x1EA0, 0x1EF9)) return Script::kLatin;
  if (IsIn(c, 0x400, 0x52F)) return Script::kCyrillic;
  // Epsilon and mu of units stand beside Latin letters.
  if (c == 0x3B5 || c == 0x3BC) return Script::kNone;
  if (IsIn(c, 0x386, 0x3CE)) return Script::kGreek;
  if (IsIn(c, 0x3040, 0x30FF) || IsIn(c, 0x4E00, 0x9FFF) ||
      IsIn(c, 0xAC00, 0xD7A3) || IsHalfWidthKana(c)) {
    return Script::kAsian;
  }
  return Script::kNone;
}

bool IsAccentedGreekCapital(char32_t c) {
  return c == 0x386 || IsIn(c, 0x388, 0x38F);
}

bool IsCapital(char32_t c) {
  return IsIn(c, 'A', 'Z') || (IsIn(c, 0xC0, 0xDE) && c != 0xD7) ||
         (IsIn(c, 0x100, 0x137) && c % 2 == 0) || IsIn(c, 0x400, 0x42F) ||
         IsIn(c, 0x386, 0x3AB);
}

bool IsSmall(char32_t c) {
  return IsIn(c, 'a', 'z') || (IsIn(c, 0xDF, 0xFF) && c != 0xF7) ||
         (IsIn(c, 0x100, 0x137) && c % 2 == 1) || IsIn(c, 0x430, 0x45F) ||
         IsIn(c, 0x3AC, 0x3CE);
}

// True for signs that stand in no word: quotes, currencies, accents.
bool IsOddInWords(char32_t c) {
  // Degree, superscripts, mu and the middle dot are those of units.
  const bool is_of_units = c == 0xB0 || c == 0xB2 || c == 0xB3 || c == 0xB5 ||
                           c == 0xB7 || c == 0xB9;
  return (IsIn(c, 0xA0, 0xBF) && !is_of_units) || c == 0xD7 || c == 0xF7 ||
         IsIn(c, 0x2B0, 0x2FF) || IsIn(c, 0x2010, 0x2044) ||
         IsIn(c, 0x20A0, 0x20CF) || c == 0x2122;
}

// True for those of these that may stand before a word.
bool MayBeginWord(char32_t c) {
  return c == 0xA0 || c == 0xA1 || c == 0xA7 || c == 0xAB || c == 0xB1 ||
         c == 0xBF || c == 0xD7 || IsIn(c, 0x2010, 0x2044);
}

// Oddness of a letter beyond ASCII between c[-1] and c[1], which are none. It
// may be a word or a number's sign, but "ì/ñ" is no unit, and "м/с" is.
int OddnessOfLoneLetter(const char32_t* c) {
  if (c[0] > 0xFF) return IsIn(c[0], 0x391, 0x44F) ? 0 : 1;
  return c[-1] == '/' || c[1] == '/' ? 1 : 0;
}

// True for characters that no text of a logger has: controls, boxes, private
// ones, accents without a letter.
bool IsOddAnywhere(char32_t c) {
  return IsIn(c, 0x80, 0x9F) || IsIn(c, 0x2500, 0x259F) ||
         IsIn(c, 0x384, 0x385) || IsIn(c, 0xE000, 0xF8FF) ||
         IsIn(c, 0xFF61, 0xFF65) || c >= 0x10000;
}

// Characters of a valid text of UTF-8.
std::vector<char32_t> Characters(const std::string& text) {
  std::vector<char32_t> characters;
  characters.reserve(text.size());
  for (const char byte : text) {
    const auto c = static_cast<unsigned char>(byte);
    if (c < 0x80) {
      characters.push_back(c);
    } else if (c >= 0xC0) {
      characters.push_back(c >= 0xF0   ? c & 0x07u
                           : c >= 0xE0 ? c & 0x0Fu
                                       : c & 0x1Fu);
    } else if (!characters.empty()) {
      characters.back() = (characters.back() << 6) | (c & 0x3Fu);
    }
  }
  return characters;
}

// True if letters of two scripts side by side are no word.
bool AreMixed(Script one, Script other) {
  if (one == Script::kNone || other == Script::kNone || one == other) {
    return false;
  }
  // "X加速度" is usual.
  if (one == Script::kAsian || other == Script::kAsian) return false;
  const auto is_latin = [](Script script) {
    return script == Script::kAscii || script == Script::kLatin;
  };
  return !is_latin(one) || !is_latin(other);
}

// Oddness of a Latin letter beyond ASCII: Latin words have letters of ASCII.
int OddnessOfLatin(const char32_t* c) {
  const Script left = ScriptOf(c[-1]);
  const Script right = ScriptOf(c[1]);
  if (left != Script::kLatin) return 0;
  const Script before = ScriptOf(c[-2]);
  const bool is_whole = before == Script::kNone && right == Script::kNone;
  return before == Script::kLatin || is_whole ? 1 : 0;
}

// Oddness of Katakana of half the width: one alone, or beside a letter of
// another script, is an accent of Western Europe.
int OddnessOfHalfWidthKana(const char32_t* c) {
  const bool is_alone = !IsHalfWidthKana(c[-1]) && !IsHalfWidthKana(c[1]);
  const auto is_of_other_script = [](char32_t neighbour) {
    const Script script = ScriptOf(neighbour);
    return script != Script::kNone && script != Script::kAsian;
  };
  return is_alone || is_of_other_script(c[-1]) || is_of_other_script(c[1]) ? 1
                                                                           : 0;
}

// Oddness of the character c[0] beyond ASCII. It has two neighbours on the left
// and one on the right.
int OddnessOf(const char32_t* c) {
  const Script script = ScriptOf(c[0]);
  const Script left = ScriptOf(c[-1]);
  const Script right = ScriptOf(c[1]);
  int odd = IsOddAnywhere(c[0]) ? 2 : 0;
  if (IsOddInWords(c[0])) {
    if (left != Script::kNone) ++odd;
    if (right != Script::kNone && !MayBeginWord(c[0])) ++odd;
  }
  // "œ" of French stands before "u"; else it is "ś" of Polish.
  if ((c[0] == 0x152 || c[0] == 0x153) && c[1] != 'u' && c[1] != 'U') ++odd;
  // Powers end a unit.
  if ((c[0] == 0xB2 || c[0] == 0xB3 || c[0] == 0xB9) && left != Script::kNone &&
      right != Script::kNone) {
    ++odd;
  }
  // "μm" is a unit, and "μμ" is "мм" of Windows-1251.
  if (c[0] == 0x3BC && c[-1] == 0x3BC) ++odd;
  if (script == Script::kNone) return odd;
  if (script == Script::kAsian) {
    if (IsHalfWidthKana(c[0])) return odd + OddnessOfHalfWidthKana(c);
    // "W臠ung" is no word.
    return odd + (left == Script::kAscii && right == Script::kAscii ? 1 : 0);
  }
  if (left == Script::kNone && right == Script::kNone) {
    return odd + OddnessOfLoneLetter(c);
  }
  if (AreMixed(script, left)) ++odd;
  if (AreMixed(script, right)) ++odd;
  if (script == Script::kLatin) odd += OddnessOfLatin(c);
  if (IsSmall(c[-1]) && IsCapital(c[0])) ++odd;
  if (script != Script::kLatin && ScriptOf(c[-2]) == script &&
      IsCapital(c[-2]) && IsCapital(c[-1]) && IsSmall(c[0])) {
    ++odd;
  }
  if (left == script && IsAccentedGreekCapital(c[0])) ++odd;
  return odd;
}

// Returns the answer of uchardet, or "".
std::string AnswerOfUchardet(const std::string& text, int repetitions) {
#ifdef PINODE_WITH_UCHARDET
  const uchardet_t detector = uchardet_new();
  std::string name;
  int status = 0;
  for (int i = 0; i < repetitions && status == 0; ++i) {
    status = uchardet_handle_data(detector, text.data(), text.size());
  }
  if (status == 0) {
    uchardet_data_end(detector);
    name = uchardet_get_charset(detector);
  }
  uchardet_delete(detector);
  return name;
#else
  (void)text;
  (void)repetitions;
  return "";
#endif
}

// Encodings that share most letters with the answer. Those of Windows come
// first: loggers run on it.
std::vector<std::string> Relatives(const std::string& answer) {
  using Names = std::vector<std::string>;
  static const auto& kFamilies = *new std::vector<Names>{
      {"WINDOWS-1252", "ISO-8859-1", "ISO-8859-15"},
      {"WINDOWS-1250", "ISO-8859-2"},
      {"WINDOWS-1251", "KOI8-R", "IBM866", "ISO-8859-5"},
      {"WINDOWS-1253", "ISO-8859-7"},
      {"WINDOWS-1254", "ISO-8859-9"},
      {"WINDOWS-1257", "ISO-8859-13"},
      {"CP932", "SHIFT_JIS"},
      {"UHC", "EUC-KR"}};
  for (const Names& family : kFamilies) {
    if (std::find(family.begin(), family.end(), answer) != family.end()) {
      return family;
    }
  }
  // The detector takes "²" for a letter of Northern Europe.
  for (const char* name :
       {"GB18030", "BIG5", "EUC-JP", "EUC-TW", "KOI8-U", "MAC-CYRILLIC",
        "IBM855", "IBM852", "TIS-620", "WINDOWS-1255", "WINDOWS-1256"}) {
    if (answer == name) return {answer};
  }
  return {};
}

// Units that are known, as a user reads them: "N, mm".
std::string Joined(const std::vector<std::string>& units) {
  std::string joined;
  for (const std::string& unit : units) {
    if (!unit.empty()) joined += (joined.empty() ? "" : ", ") + unit;
  }
  return joined;
}

// Replaces words that are units by blanks: "кН" is no odd word.
std::string WithoutUnits(const std::string& text) {
  // No unit in one word is longer.
  constexpr size_t kLongest = 16;
  const auto is_of_word = [](char c) {
    return !IsAscii(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  std::string rest = text;
  size_t begin = 0;
  while (begin < rest.size()) {
    size_t end = begin;
    while (end < rest.size() && is_of_word(rest[end])) ++end;
    const std::string word = rest.substr(begin, end - begin);
    if (word.size() <= kLongest &&
        !std::all_of(word.begin(), word.end(), IsAscii) &&
        !CanonicalUnit(word).empty()) {
      rest.replace(begin, word.size(), word.size(), ' ');
    }
    begin = end + 1;
  }
  return rest;
}

struct Candidate {
  std::string name;
  std::string text;
  // Units as UnitsOfCells() returns them, how many of them are known, and how
  // many of those have more than one letter.
  std::vector<std::string> units;
  int num_units = 0;
  int num_words = 0;
  int odd = 0;
  // True if it competes with the best one: an answer of the detector, or
  // Windows-1252.
  bool is_rival = false;

  // A unit such as "кН" weighs as much as one odd letter. A unit of one letter
  // is a weak hint: "ч" (hours) of Windows-1251 is "В" (volts) in KOI8-R, so
  // the words come before it.
  int Score() const { return odd - num_words; }
  std::tuple<int, int, int> Rank() const { return {Score(), odd, -num_units}; }
};

// Candidates for the encoding of some lines, the likeliest first.
class Candidates {
 public:
  explicit Candidates(const std::string& lines) : lines_(lines) {}

  void Add(const std::string& name, bool is_rival) {
    for (Candidate& other : all_) {
      if (other.name != name) continue;
      other.is_rival = other.is_rival || is_rival;
      return;
    }
    Candidate candidate;
    int64_t place = 0;
    if (!ConvertByIconv(name, lines_, &candidate.text, &place)) return;
    candidate.name = name;
    candidate.units = UnitsOfCells(candidate.text);
    for (const std::string& unit : candidate.units) {
      if (!unit.empty()) ++candidate.num_units;
      if (unit.size() > 1) ++candidate.num_words;
    }
    candidate.odd = Oddness(candidate.text);
    candidate.is_rival = is_rival;
    all_.push_back(std::move(candidate));
  }

  // Returns the first of those that nothing is better than.
  const Candidate& Best() const {
    const auto best = std::min_element(
        all_.begin(), all_.end(), [](const Candidate& a, const Candidate& b) {
          return a.Rank() < b.Rank();
        });
    CHECK(best != all_.end());  // each byte is a letter of ISO-8859-1
    return *best;
  }

  const std::vector<Candidate>& all() const { return all_; }

 private:
  const std::string& lines_;
  std::vector<Candidate> all_;
};

// Returns the encoding that has more frequent letters in place of those that
// Windows-1252 has for Icelandic alone; "" for a text without them. Turkish has
// \u0131, \u0130 and \u011F there, Romanian has \u0163. Of 51 headers in 5
// encodings (names of channels in 15 languages) the detector took 7 for
// Windows-1252 wrongly, all of them Turkish or Romanian with such letters.
std::string RivalOfIcelandic(const std::string& text) {
  for (const char* letter : {"\u00FD", "\u00DD", "\u00F0", "\u00D0"}) {
    if (text.find(letter) != std::string::npos) return "WINDOWS-1254";
  }
  for (const char* letter : {"\u00FE", "\u00DE"}) {
    if (text.find(letter) != std::string::npos) return "WINDOWS-1250";
  }
  return "";
}

// True if all bytes beyond ASCII are in pairs, as in the encodings of Chinese,
// Korean and Japanese.
bool ArePairs(const std::string& text) {
  size_t run = 0;
  for (const char c : text + " ") {
    if (!IsAscii(c)) {
      // A byte of 0x80 to 0xA0 is the first or second one elsewhere.
      if (static_cast<unsigned char>(c) <= 0xA0) return false;
      ++run;
    } else if (run % 2 == 1) {
      return false;
    } else {
      run = 0;
    }
  }
  return true;
}

bool IsOfPairs(const std::string& name) {
  return name == "GB18030" || name == "UHC" || name == "EUC-KR" ||
         name == "EUC-JP" || name == "BIG5" || name == "EUC-TW";
}

// Names the best candidate, and another one that is about as likely.
void NameBest(const Candidates& candidates, EncodingGuess* guess) {
  const Candidate& best = candidates.Best();
  guess->name = best.name;
  guess->fits = best.odd == 0;
  for (const Candidate& other : candidates.all()) {
    const bool is_same = other.text == best.text;
    // Names of Windows are the usual ones, and above all that of the West.
    if (is_same && (other.name == "WINDOWS-1252" ||
                    (other.name.rfind("WINDOWS-", 0) == 0 &&
                     guess->name.rfind("WINDOWS-", 0) != 0))) {
      guess->name = other.name;
    }
    const bool is_equal = other.Rank() == best.Rank();
    const bool has_other_units =
        other.num_units > 0 && other.units != best.units &&
        (other.odd == best.odd || other.Score() == best.Score());
    if (is_same || (!is_equal && !has_other_units)) continue;
    if (guess->other.empty() && (has_other_units || other.is_rival)) {
      guess->other = other.name;
    }
    if (has_other_units && is_equal && guess->conflict.empty()) {
      guess->other = other.name;
      guess->conflict = "its units are " + Joined(best.units) + " in " +
                        guess->name + ", but " + Joined(other.units) + " in " +
                        other.name;
    }
  }
}

// Converts a text. With `replaces`, U+FFFD stands for each byte that is none of
// the encoding; else the first one ends the conversion.
bool RunIconv(const std::string& encoding, const std::string& text,
              bool replaces, std::string* converted, int64_t* place) {
  CHECK(converted != nullptr);
  CHECK(place != nullptr);
  converted->clear();
  *place = -1;
  const iconv_t converter = iconv_open("UTF-8", encoding.c_str());
  // iconv_open returns this value on failure.
  if (converter == reinterpret_cast<iconv_t>(-1)) return false;
  converted->reserve(text.size() + text.size() / 8);
  char* from = const_cast<char*>(text.data());
  size_t left = text.size();
  bool ok = true;
  std::array<char, 1 << 14> buffer;
  const auto step = [&](char** source, size_t* size) {
    char* to = buffer.data();
    size_t room = buffer.size();
    const size_t status = iconv(converter, source, size, &to, &room);
    // Appending may change errno.
    const int reason = errno;
    converted->append(buffer.data(), buffer.size() - room);
    return status != static_cast<size_t>(-1) || reason == E2BIG;
  };
  while (ok && left > 0) {
    if (step(&from, &left)) continue;
    if (*place < 0) *place = static_cast<int64_t>(text.size() - left);
    ok = replaces;
    if (!ok) break;
    converted->append("\xEF\xBF\xBD");
    ++from;
    --left;
  }
  // Some encodings hold back a character that an accent may follow.
  if (ok) step(nullptr, nullptr);
  iconv_close(converter);
  if (*place < 0) *place = static_cast<int64_t>(text.size());
  return ok;
}

}  // namespace

bool ConvertByIconv(const std::string& encoding, const std::string& text,
                    std::string* converted, int64_t* place) {
  return RunIconv(encoding, text, /*replaces=*/false, converted, place);
}

bool ConvertWithReplacements(const std::string& encoding,
                             const std::string& text, std::string* converted,
                             int64_t* place) {
  return RunIconv(encoding, text, /*replaces=*/true, converted, place);
}

int Oddness(const std::string& text) {
  const std::vector<char32_t> characters =
      Characters("  " + WithoutUnits(text) + " ");
  int odd = 0;
  for (size_t i = 2; i + 1 < characters.size(); ++i) {
    if (characters[i] >= 0x80) odd += OddnessOf(&characters[i]);
  }
  return odd;
}

EncodingGuess GuessEncoding(const std::string& text) {
  const std::string lines = CellsBeyondAscii(text);
  Candidates candidates(lines);
  bool is_answered = false;
  for (const int repetitions : {1, kRepetitions}) {
    const std::string answer = AnswerOfUchardet(lines, repetitions);
    const std::vector<std::string> relatives = Relatives(answer);
    if (relatives.empty()) continue;
    is_answered = true;
    candidates.Add(answer, true);
    for (const std::string& name : relatives) {
      // Words without capitals in the one are capitals in the other.
      candidates.Add(name, name == "WINDOWS-1251" || name == "KOI8-R");
    }
  }
  candidates.Add("WINDOWS-1252", true);
  candidates.Add("ISO-8859-1", false);
  EncodingGuess guess;
  guess.is_unsure = candidates.Best().odd > 0;
  // Units of few letters tell these, which the detector takes for others.
  candidates.Add("WINDOWS-1251", false);
  candidates.Add("KOI8-R", false);
  if (candidates.Best().num_units > 0 && candidates.Best().odd == 0) {
    guess.is_unsure = !is_answered && candidates.Best().name != "WINDOWS-1252";
  }
  if (guess.is_unsure) {
    // One or two words in letters that the detector takes for others.
    for (const char* name :
         {"WINDOWS-1251", "KOI8-R", "WINDOWS-1253", "WINDOWS-1250",
          "ISO-8859-2", "IBM866", "CP437", "CP932"}) {
      candidates.Add(name, true);
    }
  }
  NameBest(candidates, &guess);
  if (guess.other.empty() && guess.name == "WINDOWS-1252") {
    guess.other = RivalOfIcelandic(candidates.Best().text);
  }
  if (guess.other.empty() && is_answered && guess.name != "WINDOWS-1252" &&
      !IsOfPairs(guess.name) && ArePairs(lines)) {
    guess.other = "GB18030";
  }
  return guess;
}

}  // namespace pinode
