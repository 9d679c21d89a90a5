#include "pinode/case/text/toml_depth.h"

#include <vector>

namespace pinode {
namespace {

// Returns the position behind the string that begins at `begin` with a quote.
// Counts its lines. A string on one line ends with the line at the latest.
size_t EndOfString(std::string_view text, size_t begin, int* line) {
  const char quote = text[begin];
  const bool has_escapes = quote == '"';
  const std::string_view three = has_escapes ? "\"\"\"" : "'''";
  const bool is_long = text.substr(begin, 3) == three;
  size_t i = begin + (is_long ? 3 : 1);
  while (i < text.size()) {
    if (text[i] == '\n') {
      if (!is_long) return i;
      ++*line;
    }
    if (has_escapes && text[i] == '\\') {
      // The escaped letter may be the end of a line.
      ++i;
      if (i < text.size() && text[i] == '\n') ++*line;
    } else if (text[i] == quote) {
      if (!is_long) return i + 1;
      if (text.substr(i, 3) == three) {
        // One or two quotes before the end belong to the text.
        i += 3;
        while (i < text.size() && text[i] == quote) ++i;
        return i;
      }
    }
    ++i;
  }
  return text.size();
}

}  // namespace

int LineOfTooDeepToml(std::string_view text) {
  // Levels of the header, of the key on its line, and of each open bracket with
  // the key in it.
  std::vector<int> levels = {0, 1};
  int depth = 1;
  int line = 1;
  bool in_header = false;
  const auto begin_key = [&]() {
    depth -= levels.back() - 1;
    levels.back() = 1;
  };
  size_t i = 0;
  bool at_line_start = true;
  while (i < text.size()) {
    const char c = text[i];
    const bool starts_line = at_line_start;
    if (c != ' ' && c != '\t' && c != '\r') at_line_start = false;
    ++i;
    switch (c) {
      case '"':
      case '\'':
        i = EndOfString(text, i - 1, &line);
        break;
      case '#':
        while (i < text.size() && text[i] != '\n') ++i;
        break;
      case '\n':
        ++line;
        at_line_start = true;
        in_header = false;
        if (levels.size() == 2) begin_key();
        break;
      case '[':
        if (starts_line && levels.size() == 2) {
          // A header replaces the one before it.
          in_header = true;
          levels = {0, 1};
          depth = 1;
          break;
        }
        if (in_header) break;
        levels.push_back(1);
        ++depth;
        break;
      case '{':
        levels.push_back(1);
        ++depth;
        break;
      case ']':
      case '}':
        if (in_header || levels.size() == 2) break;
        depth -= levels.back();
        levels.pop_back();
        break;
      case ',':
        if (levels.size() > 2) begin_key();
        break;
      case '.':
        ++levels[in_header ? 0 : levels.size() - 1];
        ++depth;
        break;
      default:
        break;
    }
    if (depth > kDeepestToml) return line;
  }
  return 0;
}

}  // namespace pinode
