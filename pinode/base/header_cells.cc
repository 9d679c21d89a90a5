#include "pinode/base/header_cells.h"

#include <algorithm>
#include <functional>
#include <string_view>

#include "pinode/base/unit_names.h"

namespace pinode {
namespace {

// Bytes at the beginning of a text that its encoding is guessed from.
constexpr size_t kGuessBytes = size_t{1} << 18;
// Most bytes of lines beyond ASCII that are looked at.
constexpr size_t kMostLetters = size_t{1} << 13;

bool IsAscii(char c) { return static_cast<unsigned char>(c) < 0x80; }

// Appends the unit of a piece of a header, or "" if it is none that is known. A
// piece of ASCII is the same in all encodings: it is left out.
void AppendUnit(std::string_view piece, std::vector<std::string>* units) {
  if (std::all_of(piece.begin(), piece.end(), IsAscii)) return;
  units->push_back(CanonicalUnit(piece));
}

// Appends the units of one cell of a header: in brackets or behind ", ".
void AppendUnitsOfCell(std::string_view cell, bool is_behind_comma,
                       std::vector<std::string>* units) {
  const size_t size = units->size();
  size_t open = cell.find_first_of("[(");
  while (open != std::string_view::npos) {
    const size_t close = cell.find(cell[open] == '[' ? ']' : ')', open);
    if (close == std::string_view::npos) break;
    AppendUnit(cell.substr(open + 1, close - open - 1), units);
    open = cell.find_first_of("[(", close);
  }
  if (units->size() == size && is_behind_comma) AppendUnit(cell, units);
}

bool BeginsWithBlank(std::string_view text) {
  return !text.empty() && text.front() == ' ';
}

// Appends the cells of a line that have bytes beyond ASCII, each with its
// delimiter, to at most kMostLetters. A cut inside a cell could halve a
// character: a cell that does not fit ends at a blank. "|" is no delimiter
// here: it may be the second byte of a character.
void AppendCellsBeyondAscii(std::string_view line, std::string* cells) {
  size_t begin = 0;
  while (begin < line.size()) {
    const size_t end =
        std::min(line.find_first_of(",;\t", begin), line.size() - 1) + 1;
    const std::string_view cell = line.substr(begin, end - begin);
    // "Время, с" and "Channel, с" are one piece: the unit needs its comma.
    if (!std::all_of(cell.begin(), cell.end(), IsAscii) ||
        (cell.back() == ',' && end < line.size() && line[end] == ' ')) {
      const size_t room = kMostLetters - std::min(cells->size(), kMostLetters);
      if (cell.size() > room) {
        cells->append(cell.substr(0, cell.substr(0, room).rfind(' ') + 1));
        return;
      }
      cells->append(cell);
    }
    begin = end;
  }
}

}  // namespace

std::string CellsBeyondAscii(const std::string& text) {
  std::string lines;
  const size_t size = std::min(text.size(), kGuessBytes);
  size_t at = 0;
  while (at < size && lines.size() < kMostLetters) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(at);
    const auto last = text.begin() + static_cast<std::ptrdiff_t>(size);
    const auto found =
        std::find_if(begin, last, [](char c) { return !IsAscii(c); });
    if (found == last) break;
    const size_t place = static_cast<size_t>(found - text.begin());
    const size_t before = text.find_last_of("\r\n", place);
    const size_t first = before == std::string::npos ? 0 : before + 1;
    const size_t end = std::min(text.find_first_of("\r\n", place), text.size());
    const std::string_view line(text);
    AppendCellsBeyondAscii(line.substr(first, end - first), &lines);
    lines += '\n';
    at = end + 1;
  }
  return lines;
}

std::vector<std::string> UnitsOfCells(std::string_view text) {
  std::vector<std::string> units;
  std::vector<std::string> cells;  // of a line of nothing but units
  bool is_behind_comma = false;
  size_t begin = 0;
  while (begin < text.size()) {
    const size_t end =
        std::min(text.find_first_of(",;\t\n", begin), text.size());
    const std::string_view cell = text.substr(begin, end - begin);
    AppendUnitsOfCell(cell, is_behind_comma && BeginsWithBlank(cell), &units);
    AppendUnit(cell, &cells);
    const bool is_end = end == text.size() || text[end] == '\n';
    if (is_end) {
      const bool is_row =
          cells.size() > 1 && std::none_of(cells.begin(), cells.end(),
                                           std::mem_fn(&std::string::empty));
      if (is_row) units.insert(units.end(), cells.begin(), cells.end());
      cells.clear();
    }
    is_behind_comma = !is_end && text[end] == ',';
    begin = end + 1;
  }
  return units;
}

}  // namespace pinode
