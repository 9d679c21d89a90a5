// Rows of plain numbers, read fast.

#ifndef PINODE_RECORD_NUMBER_ROWS_H_
#define PINODE_RECORD_NUMBER_ROWS_H_

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace pinode {

// True for the ways in which a missing value is written: an empty cell, nan,
// NA, null, 1.#QNAN, hyphens. The cell has no blanks around it.
bool IsMissing(std::string_view cell);

// Parses a number such as -12.345 at the beginning of [at, end): sign, digits
// and decimal sign, at most 19 digits and no exponent. Returns the end of the
// number. Returns null for any other text, and for the few numbers whose
// nearest double takes more than one division: these are for ParseDouble().
//
// Method: W. D. Clinger, "How to read floating point numbers accurately", PLDI
// 1990. A mantissa below 2^53 and a power of ten up to 10^22 are exact as
// doubles, so that their quotient is the nearest one.
const char* ParseSimpleNumber(const char* at, const char* end, char decimal,
                              double* value);

// Parses lines that hold nothing but simple numbers. Whatever else a line may
// hold, such as quotes, missing values and comments, is for the slower reader.
class NumberRow {
 public:
  // `columns[i]` is the column of cell i, or -1 for a cell that is passed over.
  // A delimiter of ' ' means blanks.
  NumberRow(char delimiter, char decimal, std::vector<int> columns)
      : delimiter_(delimiter),
        decimal_(decimal),
        columns_(std::move(columns)) {}

  // Parses a line, without its '\n'. values[column * stride] are set. Returns
  // false if the line holds anything else; some values may be set then.
  [[nodiscard]] bool Parse(std::string_view line, double* values,
                           std::ptrdiff_t stride) const;

 private:
  char delimiter_;
  char decimal_;
  std::vector<int> columns_;
};

}  // namespace pinode

#endif  // PINODE_RECORD_NUMBER_ROWS_H_
