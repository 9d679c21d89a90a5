#include "pinode/report/text_table.h"

#include <algorithm>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/printable.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

bool IsNumber(const std::string& text) {
  double value;
  return ParseDouble(text, &value);
}

// Returns the length of the part left of the decimal point.
int IntegerWidth(const std::string& number) {
  return static_cast<int>(std::min(number.find_first_of(".eE"), number.size()));
}

std::string Blanks(int count) {
  return std::string(static_cast<size_t>(std::max(count, 0)), ' ');
}

}  // namespace

int DisplayWidth(const std::string& text) {
  // Bytes 10xxxxxx continue a character.
  return static_cast<int>(
      std::count_if(text.begin(), text.end(), [](char byte) {
        return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;
      }));
}

TextTable::TextTable(std::vector<Column> columns)
    : columns_(std::move(columns)) {}

void TextTable::AddRow(std::vector<std::string> cells) {
  CHECK_EQ(cells.size(), columns_.size()) << "a row has one cell per column";
  // Names of strangers may hold line ends, or thousands of letters.
  for (std::string& cell : cells) cell = PrintableLine(cell);
  rows_.push_back(std::move(cells));
}

std::vector<std::vector<std::string>> TextTable::AlignedRows() const {
  std::vector<std::vector<std::string>> rows = rows_;
  for (size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].align != Align::kDecimal) continue;
    int left = 0, right = 0, width = 0;
    for (const std::vector<std::string>& row : rows_) {
      if (IsNumber(row[c])) {
        const int integer = IntegerWidth(row[c]);
        left = std::max(left, integer);
        right = std::max(right, DisplayWidth(row[c]) - integer);
      }
      width = std::max(width, DisplayWidth(row[c]));
    }
    width = std::max(width, left + right);
    for (std::vector<std::string>& row : rows) {
      std::string& cell = row[c];
      if (IsNumber(cell)) {
        cell += Blanks(right - DisplayWidth(cell) + IntegerWidth(cell));
      }
      cell = Blanks(width - DisplayWidth(cell)) + cell;
    }
  }
  return rows;
}

std::string TextTable::ToText(int indent) const {
  const std::vector<std::vector<std::string>> rows = AlignedRows();
  std::vector<int> widths;
  for (size_t c = 0; c < columns_.size(); ++c) {
    int width = DisplayWidth(columns_[c].header);
    for (const std::vector<std::string>& row : rows) {
      width = std::max(width, DisplayWidth(row[c]));
    }
    widths.push_back(width);
  }
  std::string text;
  const auto add_line = [&](const std::vector<std::string>& cells) {
    std::string line = Blanks(indent);
    for (size_t c = 0; c < cells.size(); ++c) {
      const std::string padding = Blanks(widths[c] - DisplayWidth(cells[c]));
      if (c > 0) line += "  ";
      line += columns_[c].align == Align::kLeft ? cells[c] + padding
                                                : padding + cells[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  std::vector<std::string> headers, rules;
  for (size_t c = 0; c < columns_.size(); ++c) {
    headers.push_back(columns_[c].header);
    const bool named = !columns_[c].header.empty();
    rules.push_back(
        std::string(static_cast<size_t>(widths[c]), named ? '-' : ' '));
  }
  add_line(headers);
  add_line(rules);
  for (const std::vector<std::string>& row : rows) add_line(row);
  return text;
}

}  // namespace pinode
