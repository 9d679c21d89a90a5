#include <algorithm>
#include <array>
#include <limits>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/text_layout.h"
#include "pinode/record/files/text_thousands.h"
#include "pinode/record/number_rows.h"

namespace pinode {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// Takes the quoted cell at `*at` (that of the opening quote) and moves *at
// behind the closing one.
bool TakeQuoted(std::string_view line, size_t* at, std::string_view* cell,
                std::vector<std::string>* storage) {
  const size_t begin = *at + 1;
  size_t end = begin;
  bool doubled = false;
  while (true) {
    end = line.find('"', end);
    if (end == std::string_view::npos) return false;
    if (end + 1 >= line.size() || line[end + 1] != '"') break;
    doubled = true;
    end += 2;
  }
  *cell = StripBlanks(line.substr(begin, end - begin));
  *at = end + 1;
  if (doubled) {
    storage->emplace_back(*cell);
    ReplaceAll("\"\"", "\"", &storage->back());
    *cell = storage->back();
  }
  return true;
}

// Parses a number without separators of thousands.
bool ParsePlainCell(std::string_view cell, char decimal, double* value) {
  std::array<char, 64> buffer;
  if (cell.empty() || cell.size() >= buffer.size()) return false;
  bool changed = false;
  size_t size = 0;
  for (size_t i = 0; i < cell.size(); ++i) {
    char c = cell[i];
    if (c == ' ' && size == 1 && (buffer[0] == '+' || buffer[0] == '-')) {
      changed = true;
      continue;
    }
    if (decimal == ',') {
      if (c == '.') return false;
      if (c == ',') {
        // In "0, 5" the comma is no decimal sign.
        if (i + 1 == cell.size() || cell[i + 1] < '0' || cell[i + 1] > '9') {
          return false;
        }
        c = '.';
        changed = true;
      }
    }
    buffer[size++] = c;
  }
  return changed ? ParseDouble({buffer.data(), size}, value)
                 : ParseDouble(cell, value);
}

}  // namespace

bool SplitCells(std::string_view line, char delimiter,
                std::vector<std::string_view>* cells,
                std::vector<std::string>* storage) {
  cells->clear();
  storage->clear();
  // Cells refer to their texts, which must not move.
  storage->reserve(
      static_cast<size_t>(std::count(line.begin(), line.end(), '"')));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  size_t at = 0;
  while (true) {
    while (at < line.size() && IsBlank(line[at]) && line[at] != delimiter) ++at;
    if (delimiter == ' ') {
      while (at < line.size() && IsBlank(line[at])) ++at;
      if (at == line.size()) return true;
    }
    if (at < line.size() && line[at] == '"') {
      std::string_view cell;
      if (!TakeQuoted(line, &at, &cell, storage)) return false;
      cells->push_back(cell);
      while (at < line.size() && IsBlank(line[at]) && line[at] != delimiter) {
        ++at;
      }
      if (at == line.size()) return true;
      if (delimiter == ' ' && IsBlank(line[at])) continue;
      if (line[at] != delimiter || delimiter == 0) return false;
      ++at;
      continue;
    }
    const size_t end = delimiter == 0     ? std::string_view::npos
                       : delimiter == ' ' ? line.find_first_of(" \t", at)
                                          : line.find(delimiter, at);
    if (end == std::string_view::npos) {
      cells->push_back(StripBlanks(line.substr(std::min(at, line.size()))));
      return true;
    }
    cells->push_back(StripBlanks(line.substr(at, end - at)));
    at = end + 1;
  }
}

bool ParseCell(std::string_view cell, char decimal, double* value) {
  cell = StripBlanks(cell);
  // Digits first: the tests of rare forms are for the rest.
  if (ParsePlainCell(cell, decimal, value)) return true;
  std::string joined;
  if (JoinThousands(cell, decimal, false, &joined)) {
    return ParseDouble(joined, value);
  }
  if (!IsMissing(cell)) return false;
  *value = std::numeric_limits<double>::quiet_NaN();
  return true;
}

bool IsNoRow(std::string_view line) {
  const std::string_view stripped = StripBlanks(line);
  return stripped.empty() || stripped.front() == '#';
}

}  // namespace pinode
