#include "pinode/record/files/text_thousands.h"

#include <algorithm>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

constexpr std::string_view kMinusSign = "\u2212";
// Apostrophes, and blanks that do not break a line.
constexpr std::string_view kSureSeparators[] = {"'", "\u2019", "\u00A0",
                                                "\u202F", "\u2009"};
constexpr std::string_view kOtherSeparators[] = {".", ",", " "};

size_t NumDigits(std::string_view text) {
  return std::min(text.find_first_not_of("0123456789"), text.size());
}

bool BeginsWith(std::string_view text, std::string_view beginning) {
  return text.substr(0, beginning.size()) == beginning;
}

// Removes a sign from the beginning of a number and returns it.
std::string TakeSign(std::string_view* number) {
  if (BeginsWith(*number, kMinusSign)) {
    number->remove_prefix(kMinusSign.size());
    return "-";
  }
  if (number->empty() || (number->front() != '-' && number->front() != '+')) {
    return "";
  }
  const std::string sign(1, number->front());
  number->remove_prefix(1);
  return sign;
}

// Returns the separator behind the first digits of a number; empty: none.
// *is_sure stays true if nothing else looks like it.
std::string_view SeparatorAt(std::string_view text, char decimal,
                             bool* is_sure) {
  for (const std::string_view separator : kSureSeparators) {
    if (!BeginsWith(text, separator)) continue;
    *is_sure = true;
    return separator;
  }
  for (const std::string_view separator : kOtherSeparators) {
    if (separator[0] != decimal && BeginsWith(text, separator)) {
      return separator;
    }
  }
  return {};
}

}  // namespace

bool JoinThousands(std::string_view cell, char decimal, bool is_sure,
                   std::string* joined) {
  CHECK(joined != nullptr);
  const bool has_minus_sign = BeginsWith(cell, kMinusSign);
  *joined = TakeSign(&cell);
  const size_t first = NumDigits(cell);
  if (first == 0) return false;
  joined->append(cell.substr(0, first));
  const bool may_be_parted = first <= 3 && cell[0] != '0';
  cell.remove_prefix(first);
  int groups = 0;
  const std::string_view separator =
      may_be_parted ? SeparatorAt(cell, decimal, &is_sure) : std::string_view();
  while (!separator.empty() && BeginsWith(cell, separator) &&
         NumDigits(cell.substr(separator.size())) == 3) {
    joined->append(cell.substr(separator.size(), 3));
    cell.remove_prefix(separator.size() + 3);
    ++groups;
  }
  const bool has_fraction = !cell.empty();
  if (has_fraction) {
    if (cell[0] != decimal || cell.size() == 1 ||
        NumDigits(cell.substr(1)) + 1 != cell.size()) {
      return false;
    }
    *joined += '.';
    joined->append(cell.substr(1));
  }
  if (groups == 0) return has_minus_sign;
  return is_sure || has_fraction || groups > 1;
}

bool MayHaveThousands(std::string_view rows) {
  const auto has = [rows](std::string_view mark) {
    return rows.find(mark) != std::string_view::npos;
  };
  if (has(kMinusSign) || std::any_of(std::begin(kSureSeparators),
                                     std::end(kSureSeparators), has)) {
    return true;
  }
  // Commas and blanks are in quotes.
  for (size_t at = rows.find('"'); at != std::string_view::npos;
       at = rows.find('"', at + 1)) {
    std::string_view cell = rows.substr(at + 1, 8);
    TakeSign(&cell);
    const size_t digits = NumDigits(cell);
    if (digits > 0 && digits <= 3 && digits < cell.size() &&
        (cell[digits] == ',' || cell[digits] == ' ')) {
      return true;
    }
  }
  return false;
}

std::string DoubtfulThousands(const std::vector<TextLine>& lines,
                              const RowRun& run) {
  struct Column {
    bool has_whole = false;
    bool has_long = false;
    std::string parted;
  };
  if (run.decimal != '.') return "";
  std::vector<Column> columns(run.kinds.size());
  std::vector<std::string_view> cells;
  std::vector<std::string> storage;
  for (size_t i = run.first; i < lines.size(); ++i) {
    if (IsNoRow(lines[i].text) ||
        !SplitCells(lines[i].text, run.delimiter, &cells, &storage)) {
      continue;
    }
    for (size_t c = 0; c < std::min(cells.size(), columns.size()); ++c) {
      std::string_view number = cells[c];
      TakeSign(&number);
      if (run.kinds[c] != CellKind::kNumber || number.empty()) continue;
      const size_t digits = NumDigits(number);
      if (digits == number.size()) {
        columns[c].has_long = columns[c].has_long || digits > 3;
        columns[c].has_whole = columns[c].has_whole || number != "0";
        continue;
      }
      if (number[digits] != '.') continue;
      const bool may_be_parted = digits > 0 && digits <= 3 &&
                                 number[0] != '0' &&
                                 NumDigits(number.substr(digits + 1)) == 3 &&
                                 digits + 4 == number.size();
      if (!may_be_parted) return "";
      columns[c].parted = std::string(cells[c]);
    }
  }
  for (const Column& column : columns) {
    if (column.has_whole && !column.has_long && !column.parted.empty()) {
      return column.parted;
    }
  }
  return "";
}

}  // namespace pinode
