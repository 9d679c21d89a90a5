#include "pinode/structure/deck_keyword.h"

#include <filesystem>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {

const std::string* DeckKeyword::Find(const std::string& key) const {
  for (const auto& [own, value] : parameters) {
    if (own == key) return &value;
  }
  return nullptr;
}

DeckKeyword ParseDeckKeyword(const std::string& line) {
  DeckKeyword keyword;
  bool first = true;
  for (const std::string_view part : Split(line, ',')) {
    const std::string_view text = StripBlanks(part);
    if (first) {
      keyword.name = DeckUpperCase(text);
      first = false;
      continue;
    }
    const size_t equals = text.find('=');
    const std::string_view value = equals == std::string_view::npos
                                       ? std::string_view()
                                       : StripBlanks(text.substr(equals + 1));
    keyword.parameters.emplace_back(
        DeckUpperCase(StripBlanks(text.substr(0, equals))), std::string(value));
  }
  return keyword;
}

std::string DeckUpperCase(std::string_view text) {
  std::string upper(text);
  for (char& letter : upper) {
    if (letter >= 'a' && letter <= 'z') letter -= 'a' - 'A';
  }
  return upper;
}

std::string DeckIncludePath(const std::string& deck, const std::string& input) {
  namespace fs = std::filesystem;
  return (fs::path(deck).parent_path() / fs::path(input)).string();
}

}  // namespace pinode
