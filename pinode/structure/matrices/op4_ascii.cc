#include "pinode/structure/matrices/op4_ascii.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/structure/matrices/fortran_text.h"
#include "pinode/structure/matrices/matrix_text.h"
#include "pinode/structure/matrices/op4_matrix.h"

namespace pinode {
namespace {

// Returns a field of fixed columns, as Fortran writes them: numbers may touch
// each other.
std::string_view Field(std::string_view line, size_t begin, size_t width) {
  return begin < line.size() ? line.substr(begin, width) : std::string_view();
}

class Op4AsciiReader {
 public:
  Op4AsciiReader(const std::string& path, const std::string& content)
      : lines_(path, content) {}

  bool Read(MatrixContainer* container, std::string* error) {
    std::string_view line;
    while (lines_.NextRaw(&line)) {
      if (StripBlanks(line).empty()) continue;
      Op4Matrix matrix;
      int failed_line = 0;
      std::string what;
      if (!ReadHeader(line, &matrix, error) || !ReadColumns(&matrix, error)) {
        return false;
      }
      if (!matrix.Finish(container, &failed_line, &what)) {
        return lines_.FailAt(failed_line, what, error);
      }
    }
    return true;
  }

 private:
  bool ReadHeader(std::string_view line, Op4Matrix* matrix,
                  std::string* error) {
    int fields[4] = {};
    for (size_t i = 0; i < 4; ++i) {
      if (!ParseInt(Field(line, 8 * i, 8), &fields[i])) {
        return lines_.Fail(
            "the line is " + Quote(line) +
                ", expected the header of a matrix: columns, rows, form and "
                "type in 8 places each, name, format",
            error);
      }
    }
    matrix->name = CleanOp4Name(Field(line, 32, 8));
    matrix->form = fields[2];
    matrix->type = fields[3];
    matrix->line = lines_.number();
    std::string what;
    if (!matrix->SetSize(fields[0], fields[1], &what)) {
      return lines_.Fail(what, error);
    }
    return ReadFormat(LowerCase(StripBlanks(Field(line, 40, line.size()))),
                      error);
  }

  // Reads "1p,5e16.9": five numbers per line, 16 places each.
  bool ReadFormat(const std::string& format, std::string* error) {
    FortranFormat numbers;
    numbers.count = 5;
    numbers.width = 16;
    if (!format.empty() && (!ParseFortranFormat(format, &numbers) ||
                            numbers.letter == 'I' || numbers.letter == 'F')) {
      return lines_.Fail("the format is " + Quote(format) +
                             ", expected one such as '1P,5E16.9'",
                         error);
    }
    per_line_ = numbers.count;
    width_ = numbers.width;
    return true;
  }

  bool NextLine(const Op4Matrix& matrix, std::string_view* line,
                std::string* error) {
    if (lines_.NextRaw(line)) return true;
    return lines_.Fail("the file ends inside matrix " + Quote(matrix.name) +
                           ", expected its last column (" +
                           std::to_string(matrix.columns + 1) + ")",
                       error);
  }

  // Reads column headers up to the one behind the last column. That header ends
  // a matrix, with one number that has no meaning.
  bool ReadColumns(Op4Matrix* matrix, std::string* error) {
    for (;;) {
      std::string_view line;
      if (!NextLine(*matrix, &line, error)) return false;
      int column = 0;
      int row = 0;
      int words = 0;
      if (!ParseInt(Field(line, 0, 8), &column) ||
          !ParseInt(Field(line, 8, 8), &row) ||
          !ParseInt(Field(line, 16, 8), &words) || column < 1 || row < 0 ||
          words < 0) {
        return lines_.Fail("the line is " + Quote(line) +
                               ", expected column, first row and number of "
                               "words, in 8 places each",
                           error);
      }
      if (column > matrix->columns) {
        (void)lines_.NextRaw(&line);  // some programs leave it out
        return true;
      }
      if (row > 0 ? !ReadDense(row - 1, column - 1, words, matrix, error)
                  : !ReadStrings(column - 1, words, matrix, error)) {
        return false;
      }
    }
  }

  bool ReadDense(int64_t row, int64_t column, int64_t numbers,
                 Op4Matrix* matrix, std::string* error) {
    // Some programs count two words per number in double precision.
    if (matrix->type % 2 == 0 && numbers % 2 == 0 &&
        !matrix->Fits(row, numbers) && matrix->Fits(row, numbers / 2)) {
      numbers /= 2;
    }
    if (!matrix->Fits(row, numbers)) {
      return lines_.Fail(matrix->PlaceText(row, column, numbers), error);
    }
    return ReadNumbers(row, column, numbers, /*dense=*/true, matrix, error);
  }

  bool ReadStrings(int64_t column, int64_t words, Op4Matrix* matrix,
                   std::string* error) {
    const int64_t words_per_number = matrix->type % 2 == 0 ? 2 : 1;
    while (words > 0) {
      std::string_view line;
      if (!NextLine(*matrix, &line, error)) return false;
      int first = 0;
      int second = 0;
      const bool parsed = matrix->big ? ParseInt(Field(line, 0, 8), &first) &&
                                            ParseInt(Field(line, 8, 8), &second)
                                      : ParseInt(line, &first);
      const int64_t length =
          matrix->big ? int64_t{first} - 1 : first / kOp4StringUnit - 1;
      const int64_t row =
          (matrix->big ? int64_t{second} : first % kOp4StringUnit) - 1;
      const int64_t numbers = length / words_per_number;
      if (!parsed || length < 1 || length % words_per_number != 0 ||
          length + (matrix->big ? 2 : 1) > words) {
        return lines_.Fail("the line is " + Quote(line) +
                               ", expected the header of a string of at most " +
                               std::to_string(words) + " words",
                           error);
      }
      if (!matrix->Fits(row, numbers)) {
        return lines_.Fail(matrix->PlaceText(row, column, numbers), error);
      }
      words -= length + (matrix->big ? 2 : 1);
      if (!ReadNumbers(row, column, numbers, /*dense=*/false, matrix, error)) {
        return false;
      }
    }
    return true;
  }

  bool ReadNumbers(int64_t row, int64_t column, int64_t numbers, bool dense,
                   Op4Matrix* matrix, std::string* error) {
    std::vector<double> values;
    for (int64_t done = 0; done < numbers;) {
      std::string_view line;
      if (!NextLine(*matrix, &line, error)) return false;
      const int64_t here = std::min<int64_t>(per_line_, numbers - done);
      values.clear();
      for (int64_t i = 0; i < here; ++i) {
        const std::string_view field = Field(
            line, static_cast<size_t>(i * width_), static_cast<size_t>(width_));
        double value = 0.0;
        if (!ParseEntry(lines_, field, row + (done + i) / matrix->parts(),
                        column, &value, error)) {
          return false;
        }
        values.push_back(value);
      }
      std::string what;
      const auto value_at = [&values](int64_t i) {
        return values[static_cast<size_t>(i)];
      };
      if (!matrix->TakeNumbers(row + done / matrix->parts(), column, here,
                               dense, lines_.number(), value_at, &what)) {
        return lines_.Fail(what, error);
      }
      done += here;
    }
    return true;
  }

  LineReader lines_;
  int per_line_ = 5;
  int width_ = 16;
};

}  // namespace

bool ReadOp4Ascii(const std::string& path, const std::string& content,
                  MatrixContainer* container, std::string* error) {
  return Op4AsciiReader(path, content).Read(container, error);
}

}  // namespace pinode
