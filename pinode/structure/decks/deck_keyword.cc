#include "pinode/structure/decks/deck_keyword.h"

#include <filesystem>
#include <system_error>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Compares keywords and ignores blanks.
bool SameKeyword(std::string_view a, std::string_view b) {
  size_t i = 0, j = 0;
  for (;;) {
    while (i < a.size() && (a[i] == ' ' || a[i] == '\t')) ++i;
    while (j < b.size() && (b[j] == ' ' || b[j] == '\t')) ++j;
    if (i == a.size() || j == b.size()) return i == a.size() && j == b.size();
    if (a[i++] != b[j++]) return false;
  }
}

}  // namespace

bool DeckKeyword::Is(std::string_view other) const {
  return SameKeyword(name, other);
}

const std::string* DeckKeyword::Find(const std::string& key) const {
  for (const auto& [own, value] : parameters) {
    if (SameKeyword(own, key)) return &value;
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

std::string DeckKey(std::string_view name) {
  std::string key;
  for (const char letter : DeckUpperCase(name)) {
    if (letter != '"' && letter != ' ' && letter != '\t') key += letter;
  }
  return key;
}

std::string WithoutDeckQuotes(const std::string& name) {
  const bool quoted =
      name.size() > 1 && name.front() == '"' && name.back() == '"';
  return quoted ? name.substr(1, name.size() - 2) : name;
}

bool DeckIncludes::Read(const LineReader& lines, const DeckKeyword& keyword,
                        const std::string& path, int depth, std::string* file,
                        std::string* content, std::string* error) {
  constexpr int kMostDepth = 10;
  constexpr int kMostFiles = 1000;
  const std::string* input = keyword.Find("INPUT");
  if (input == nullptr || input->empty()) {
    return lines.Fail("*INCLUDE has no INPUT, expected a file", error);
  }
  if (depth >= kMostDepth) {
    return lines.Fail("*INCLUDE is the " + std::to_string(depth + 1) +
                          "th within another, expected at most " +
                          std::to_string(kMostDepth),
                      error);
  }
  if (++count_ > kMostFiles) {
    return lines.Fail("*INCLUDE is one of more than " +
                          std::to_string(kMostFiles) +
                          " of the deck, expected fewer: do files include "
                          "each other?",
                      error);
  }
  namespace fs = std::filesystem;
  const fs::path name(WithoutDeckQuotes(*input));
  *file = (fs::path(path).parent_path() / name).string();
  const fs::path beside_main = fs::path(main_).parent_path() / name;
  std::error_code status;
  if (!fs::exists(*file, status) && fs::exists(beside_main, status)) {
    *file = beside_main.string();
  }
  if (!ReadTextOfAnyEncoding(*file, content, error)) return false;
  std::string what;
  if (!size_.Take(static_cast<double>(content->size()), &what)) {
    return lines.Fail("what *INCLUDE brings " + what, error);
  }
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(main_, status), status).parent_path();
  const fs::path below =
      fs::weakly_canonical(fs::absolute(*file, status), status)
          .lexically_relative(folder);
  if (below.empty() || *below.begin() == "..") outside_.push_back(*file);
  return true;
}

}  // namespace pinode
