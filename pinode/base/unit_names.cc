#include "pinode/base/unit_names.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Alias = std::pair<const char*, const char*>;

// Other names of units: ASCII in lower case, other letters as they are written.
// A name whose meaning depends on the case (mN and MN) is not here.
constexpr Alias kAliases[] = {{"sec", "s"},
                              {"secs", "s"},
                              {"second", "s"},
                              {"seconds", "s"},
                              {"sekunden", "s"},
                              {"sek", "s"},
                              {"sek.", "s"},
                              {"sec.", "s"},
                              {"msec", "ms"},
                              {"msecs", "ms"},
                              {"millisecond", "ms"},
                              {"milliseconds", "ms"},
                              {"millis", "ms"},
                              {"usec", "us"},
                              {"usecs", "us"},
                              {"microsecond", "us"},
                              {"microseconds", "us"},
                              {"micros", "us"},
                              {"minute", "min"},
                              {"minutes", "min"},
                              {"hr", "h"},
                              {"hour", "h"},
                              {"hours", "h"},
                              {"days", "day"},
                              {"meter", "m"},
                              {"metre", "m"},
                              {"inch", "in"},
                              {"inches", "in"},
                              {"in.", "in"},
                              {"feet", "ft"},
                              {"micron", "um"},
                              {"gn", "g"},
                              {"g_n", "g"},
                              {"g's", "g"},
                              {"milli-g", "mg"},
                              {"milligal", "mgal"},
                              {"ms-2", "m/s^2"},
                              {"ms^-2", "m/s^2"},
                              {"ips", "in/s"},
                              {"newton", "N"},
                              {"newtons", "N"},
                              {"lb", "lbf"},
                              {"lbs", "lbf"},
                              {"kips", "kip"},
                              {"volt", "V"},
                              {"volts", "V"},
                              {"millivolt", "mV"},
                              {"millivolts", "mV"},
                              {"ue", "microstrain"},
                              {"ustrain", "microstrain"},
                              {"microstrains", "microstrain"},
                              {"strain", "1"},
                              {"m/m", "1"},
                              {"mm/mm", "1"},
                              {"in/in", "1"},
                              {"percent", "%"},
                              // Russian symbols (GOST 8.417).
                              {"м", "m"},
                              {"см", "cm"},
                              {"мм", "mm"},
                              {"мкм", "um"},
                              {"с", "s"},
                              {"сек", "s"},
                              {"мс", "ms"},
                              {"мкс", "us"},
                              {"мин", "min"},
                              {"ч", "h"},
                              {"Гал", "gal"},
                              {"гал", "gal"},
                              {"мГал", "mgal"},
                              {"Н", "N"},
                              {"кН", "kN"},
                              {"МН", "MN"},
                              {"кгс", "kgf"},
                              {"В", "V"},
                              {"мВ", "mV"},
                              {"мкВ", "uV"},
                              // Chinese, Japanese and Korean.
                              {"秒", "s"},
                              {"毫秒", "ms"},
                              {"ミリ秒", "ms"},
                              {"초", "s"},
                              {"米", "m"},
                              {"毫米", "mm"},
                              {"ガル", "gal"},
                              {"㎜", "mm"},
                              {"㎝", "cm"},
                              {"㎨", "m/s^2"},
                              {"㎧", "m/s"}};

std::string ByAlias(const std::string& text) {
  const std::string lower = LowerCase(text);
  for (const Alias& alias : kAliases) {
    if (lower == alias.first) return alias.second;
  }
  return "";
}

// Replaces signs beyond ASCII, and drops blanks.
std::string Plain(std::string_view text) {
  std::string plain(text);
  ReplaceAll("\xC2\xB5", "u", &plain);       // micro sign
  ReplaceAll("\xCE\xBC", "u", &plain);       // Greek mu
  ReplaceAll("\xCE\xB5", "e", &plain);       // Greek epsilon
  ReplaceAll("\xC2\xB2", "^2", &plain);      // superscript two
  ReplaceAll("\xE2\x81\xBB", "^-", &plain);  // superscript minus
  ReplaceAll("^-^2", "^-2", &plain);
  ReplaceAll("\xC2\xB7", "*", &plain);  // middle dot
  ReplaceAll("**", "^", &plain);
  ReplaceAll(" ", "", &plain);
  return plain;
}

// Returns the word of the table for one word of a unit.
std::string Word(const std::string& word) {
  if (!word.empty() && word.size() < 3 && LowerCase(word) == "s") return "s";
  const std::string alias = ByAlias(word);
  return alias.empty() ? word : alias;
}

// Takes an exponent of two off a unit's end: "s^2", "s2".
bool TakeSquare(std::string* unit) {
  for (const char* end : {"^2", "2"}) {
    const std::string suffix = end;
    if (unit->size() > suffix.size() &&
        unit->compare(unit->size() - suffix.size(), suffix.size(), suffix) ==
            0) {
      unit->resize(unit->size() - suffix.size());
      return true;
    }
  }
  return false;
}

// Brings "mm/sec/sec", "mm/(s^2)" or "m*s^-2" to "mm/s^2".
std::string Quotient(std::string text) {
  const size_t minus = text.find("^-");
  const size_t times = text.find('*');
  if (minus != std::string::npos && times != std::string::npos &&
      times < minus) {
    text[times] = '/';
    text.erase(minus + 1, 1);
    ReplaceAll("^1", "", &text);
  }
  const size_t slash = text.find('/');
  if (slash == std::string::npos) return Word(text);
  const std::string above = Word(text.substr(0, slash));
  std::string below = text.substr(slash + 1);
  if (below.size() > 2 && below.front() == '(' && below.back() == ')') {
    below = below.substr(1, below.size() - 2);
  }
  const size_t second = below.find_first_of("/*");
  bool square = false;
  if (second != std::string::npos) {
    if (Word(below.substr(0, second)) != Word(below.substr(second + 1))) {
      return "";
    }
    below.resize(second);
    square = true;
  } else {
    square = TakeSquare(&below);
  }
  return above + "/" + Word(below) + (square ? "^2" : "");
}

bool IsBeyondAscii(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x80;
  });
}

bool EndsWith(std::string_view text, char c) {
  return !text.empty() && text.back() == c;
}

// Splits at the last opening bracket of "name [unit]".
bool SplitBrackets(std::string_view text, char open, char close,
                   std::string_view* name, std::string_view* unit) {
  if (!EndsWith(text, close)) return false;
  // "a / (m/s^2)" and "a [m/(s^2)]": the bracket that the last one closes.
  int depth = 0;
  for (size_t i = text.size(); i-- > 0;) {
    if (text[i] == close) ++depth;
    if (text[i] == open && --depth == 0) {
      *name = StripBlanks(text.substr(0, i));
      *unit = text.substr(i + 1, text.size() - i - 2);
      return true;
    }
  }
  return false;
}

}  // namespace

std::string CanonicalUnit(std::string_view text) {
  text = StripBlanks(text);
  Dimension dimension;
  if (FindDimension(std::string(text), &dimension)) return std::string(text);
  if (text.empty() || text.size() > 24) return "";
  const std::string plain = Plain(text);
  if (plain.empty()) return "";
  const std::string alias = ByAlias(plain);
  for (const std::string& candidate : {plain, alias, Quotient(plain)}) {
    if (!candidate.empty() && candidate != "1" &&
        FindDimension(candidate, &dimension)) {
      return candidate;
    }
  }
  if (alias == "1") return alias;
  // Units that nobody confuses with others by their case.
  const std::string lower = LowerCase(plain);
  if (lower == "g" || lower == "gal" || lower == "mgal" || lower == "kip" ||
      lower == "lbf" || lower == "s" || lower == "ms" || lower == "mv" ||
      lower == "v" || lower == "mm" || lower == "microstrain") {
    return lower == "v"    ? "V"
           : lower == "mv" ? (plain[0] == 'm' ? "mV" : "")
                           : lower;
  }
  if (lower == "kn") return "kN";
  return "";
}

void SplitUnitOfName(std::string_view text, std::string* name,
                     std::string* unit) {
  CHECK(name != nullptr);
  CHECK(unit != nullptr);
  text = StripBlanks(text);
  *name = std::string(text);
  unit->clear();
  std::string_view before;
  std::string_view found;
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    if (!SplitBrackets(text, open, close, &before, &found)) continue;
    const std::string known = CanonicalUnit(found);
    // "acc (1)" is the first one.
    if (known.empty() || (known == "1" && found == "1")) return;
    *unit = known;
    // "a / (m/s^2)"
    if (EndsWith(before, '/')) before.remove_suffix(1);
    before = StripBlanks(before);
    if (!before.empty()) *name = std::string(before);
    return;
  }
  for (const std::string_view joint : {" / ", " in ", ", "}) {
    const size_t at = text.rfind(joint);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view end = text.substr(at + joint.size());
    const std::string known = CanonicalUnit(end);
    if (known.empty() || known == "1") continue;
    // "Время, с" is usual in Russian; "acc, N" is a direction.
    if (joint == ", " && !IsBeyondAscii(end) &&
        end.find('/') == std::string_view::npos) {
      continue;
    }
    // "Ускорение, В" is the one to the east (восток) or upwards (вверх).
    const std::string_view word = StripBlanks(end);
    if (joint == ", " && (word == "В" || word == "Н")) continue;
    *unit = known;
    *name = std::string(StripBlanks(text.substr(0, at)));
    return;
  }
}

}  // namespace pinode
