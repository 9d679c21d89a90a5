#include "pinode/case/draft/sensor_places.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Words = std::vector<std::string_view>;

// The ground, or what stands on it.
const Words& BaseWords() {
  static const Words words = {"base",    "basis",      "boden",   "ground",
                              "gnd",     "fundament",  "sockel",  "foundation",
                              "footing", "shaketable", "ruettel", "ag"};
  return words;
}
const Words& RoofWords() {
  static const Words words = {"roof", "dach", "toit", "techo", "rooftop"};
  return words;
}
// Counted from the first floor above the ground.
const Words& StoreyWords() {
  static const Words words = {"etage",    "\xC3\xA9tage", "\xC3\x89tage",
                              "stock",    "stockwerk",    "og",
                              "geschoss", "obergeschoss", "gescho\xC3\x9F"};
  return words;
}
// Counted from the ground in some countries.
const Words& FloorWords() {
  static const Words words = {"floor", "fl",     "level", "lvl",  "ebene",
                              "story", "storey", "piano", "piso", "niveau"};
  return words;
}
// Their numbers count something else.
const Words& ChannelWords() {
  static const Words words = {
      "ch",   "chan", "channel", "kanal",  "voie",   "canal",
      "ai",   "ain",  "in",      "input",  "sensor", "sens",
      "nr",   "no",   "sn",      "col",    "column", "spalte",
      "port", "slot", "mod",     "module", "dev",    "messstelle"};
  return words;
}

bool Holds(const Words& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

struct Token {
  std::string text;
  int number = -1;  // -1: letters
};

// Letters and digits apart; other characters separate.
std::vector<Token> TokensOf(const std::string& name) {
  std::vector<Token> tokens;
  std::string text;
  const auto end = [&] {
    if (text.empty()) return;
    Token token;
    token.text = LowerCase(text);
    if (!ParseInt(text, &token.number)) token.number = -1;
    tokens.push_back(token);
    text.clear();
  };
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool digit = std::isdigit(byte) != 0;
    const bool letter = std::isalpha(byte) != 0 || byte >= 0x80;
    if (!digit && !letter) {
      end();
      continue;
    }
    const bool after_digit =
        !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
    if (!text.empty() && digit != after_digit) end();
    text += c;
  }
  end();
  return tokens;
}

enum class Kind { kUnclear, kBase, kRoof, kStorey, kFloor, kNumber };

struct Meaning {
  Kind kind = Kind::kUnclear;
  int number = -1;
};

Meaning MeaningOf(const std::string& name) {
  std::vector<Token> tokens = TokensOf(name);
  // The number of a channel stands behind the word.
  for (size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (Holds(ChannelWords(), tokens[i].text) && tokens[i + 1].number >= 0) {
      tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(i),
                   tokens.begin() + static_cast<std::ptrdiff_t>(i) + 2);
      --i;
    }
  }
  std::vector<Meaning> found;
  std::vector<int> numbers;
  for (size_t i = 0; i < tokens.size(); ++i) {
    const std::string& word = tokens[i].text;
    if (tokens[i].number >= 0) {
      numbers.push_back(tokens[i].number);
    } else if (Holds(BaseWords(), word)) {
      found.push_back({Kind::kBase, 0});
    } else if (Holds(RoofWords(), word)) {
      found.push_back({Kind::kRoof, 0});
    } else if (Holds(StoreyWords(), word) || Holds(FloorWords(), word)) {
      const Kind kind =
          Holds(StoreyWords(), word) ? Kind::kStorey : Kind::kFloor;
      std::set<int> beside;
      if (i > 0 && tokens[i - 1].number >= 0)
        beside.insert(tokens[i - 1].number);
      if (i + 1 < tokens.size() && tokens[i + 1].number >= 0) {
        beside.insert(tokens[i + 1].number);
      }
      // "2nd floor", "2e étage"
      if (beside.empty() && i > 1 && tokens[i - 1].text.size() <= 3 &&
          tokens[i - 2].number >= 0) {
        beside.insert(tokens[i - 2].number);
      }
      if (beside.size() != 1) return {};
      found.push_back({kind, *beside.begin()});
    }
  }
  if (found.size() == 1) return found[0];
  if (found.empty() && numbers.size() == 1) return {Kind::kNumber, numbers[0]};
  return {};
}

// Returns true if the numbers are `first` to `last`, each once.
bool AreCounted(const std::multiset<int>& numbers, int first, int last) {
  int next = first;
  for (const int number : numbers) {
    if (number != next++) return false;
  }
  return next == last + 1;
}

}  // namespace

PlacesByName FindPlacesByName(const std::vector<std::string>& names,
                              int storeys) {
  PlacesByName result;
  std::vector<Meaning> meanings;
  std::multiset<int> plain;
  std::multiset<int> floors;
  bool any_base = false;
  for (const std::string& name : names) {
    meanings.push_back(MeaningOf(name));
    const Meaning& meaning = meanings.back();
    if (meaning.kind == Kind::kNumber) plain.insert(meaning.number);
    if (meaning.kind == Kind::kFloor) floors.insert(meaning.number);
    any_base = any_base || meaning.kind == Kind::kBase;
  }
  const bool plain_with_base = !any_base && AreCounted(plain, 0, storeys);
  const bool plain_clear = plain_with_base || AreCounted(plain, 1, storeys);
  const bool floors_clear = floors.count(1) > 0 && *floors.rbegin() <= storeys;
  const auto doubt = [&](size_t i, const std::string& why) {
    result.places[i] = kPlaceUnclear;
    if (result.doubt.empty()) result.doubt = Quote(names[i]) + why;
  };
  result.places.assign(names.size(), kPlaceUnclear);
  for (size_t i = 0; i < names.size(); ++i) {
    const Meaning& meaning = meanings[i];
    const std::string storeys_text =
        "the building has " + std::to_string(storeys) + " storeys";
    switch (meaning.kind) {
      case Kind::kUnclear:
        doubt(i, " names no place");
        break;
      case Kind::kBase:
        result.places[i] = 0;
        break;
      case Kind::kRoof:
        result.places[i] = storeys;
        break;
      case Kind::kStorey:
        if (meaning.number >= 1 && meaning.number <= storeys) {
          result.places[i] = meaning.number;
        } else {
          doubt(i, ": " + storeys_text);
        }
        break;
      case Kind::kFloor:
        if (floors_clear) {
          result.places[i] = meaning.number;
        } else {
          doubt(i, " may count from the ground floor or from above it; " +
                       storeys_text);
        }
        break;
      case Kind::kNumber:
        if (plain_clear) {
          result.places[i] = meaning.number;
        } else {
          doubt(i, " may be the number of a sensor or of a floor; " +
                       storeys_text);
        }
        break;
    }
  }
  const std::vector<int> places = result.places;
  for (size_t i = 0; i < names.size(); ++i) {
    for (size_t j = 0; j < names.size(); ++j) {
      if (i == j || places[i] == kPlaceUnclear || places[i] != places[j]) {
        continue;
      }
      doubt(i, " and " + Quote(names[j]) + " have names of the same place");
    }
  }
  return result;
}

}  // namespace pinode
