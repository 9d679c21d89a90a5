#include "pinode/structure/op4.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrix_text.h"

namespace pinode {
namespace {

// Rows above which a string header of 16 bits for the row does not suffice, so
// that Nastran writes BIGMAT on its own.
constexpr int64_t kBigMatrixRows = 65536;
constexpr int64_t kStringUnit = 65536;

// What the header of one matrix says, and its entries so far.
struct Op4Matrix {
  std::string name;
  int64_t rows = 0;
  int64_t columns = 0;
  int64_t form = 0;
  int64_t type = 0;
  bool big = false;
  // Of the header; 0 in binary files.
  int line = 0;
  std::vector<MatrixEntry> entries;

  bool is_complex() const { return type >= 3; }
  // Numbers per entry.
  int64_t parts() const { return is_complex() ? 2 : 1; }
};

// Checks the header; *what says what is wrong.
bool CheckHeader(int64_t columns, int64_t rows, Op4Matrix* matrix,
                 std::string* what) {
  matrix->big = rows < 0 || rows >= kBigMatrixRows;
  matrix->columns = columns;
  matrix->rows = rows < 0 ? -rows : rows;
  if (matrix->columns < 1 || matrix->rows < 1 ||
      matrix->columns > kMaxFiniteElementDofs ||
      matrix->rows > kMaxFiniteElementDofs) {
    *what = "matrix " + Quote(matrix->name) + " is " + std::to_string(rows) +
            " x " + std::to_string(columns) + ", and 1 to " +
            std::to_string(kMaxFiniteElementDofs) +
            " rows and columns were expected";
    return false;
  }
  if (matrix->type < 1 || matrix->type > 4) {
    *what = "matrix " + Quote(matrix->name) + " has type " +
            std::to_string(matrix->type) + ", and 1 to 4 was expected";
    return false;
  }
  return true;
}

// Takes `count` numbers (pairs of them for complex matrices) into rows from
// `row` on, both from 0; `dense`: zeros are filling.
template <typename ValueAt>
bool TakeNumbers(int64_t row, int64_t column, int64_t count, bool dense,
                 int line, const ValueAt& value_at, Op4Matrix* matrix,
                 std::string* what) {
  for (int64_t i = 0; i < count; ++i) {
    const double value = value_at(i);
    if (!std::isfinite(value)) {
      *what = "entry " + EntryText(row + i / matrix->parts(), column) + " of " +
              Quote(matrix->name) + " is no finite number";
      return false;
    }
    if (matrix->is_complex() || (dense && value == 0.0)) continue;
    MatrixEntry entry;
    entry.row = static_cast<int>(row + i);
    entry.column = static_cast<int>(column);
    entry.value = value;
    entry.line = line;
    matrix->entries.push_back(entry);
  }
  return true;
}

// Whether `numbers` from `row` on (from 0) lie in the matrix.
bool Fits(const Op4Matrix& matrix, int64_t row, int64_t numbers) {
  return row >= 0 && numbers >= 1 && numbers % matrix.parts() == 0 &&
         numbers / matrix.parts() <= matrix.rows - row;
}

std::string PlaceText(const Op4Matrix& matrix, int64_t row, int64_t column,
                      int64_t numbers) {
  return std::to_string(numbers) + " numbers from row " +
         std::to_string(row + 1) + " of column " + std::to_string(column + 1) +
         " of " + Quote(matrix.name) + " do not fit, and " +
         SizeText(matrix.rows, matrix.columns) + " was expected";
}

bool Finish(Op4Matrix* matrix, MatrixContainer* container, int* line,
            std::string* what) {
  NamedMatrix result;
  result.name = matrix->name;
  *line = matrix->line;
  for (const NamedMatrix& other : container->matrices) {
    if (other.name == result.name) {
      *what = "a second matrix is called " + Quote(result.name) +
              ", and each name was expected once";
      return false;
    }
  }
  if (matrix->is_complex()) {
    result.problem = "it is complex";
  } else if (matrix->form != 1 && matrix->form != 2 && matrix->form != 6 &&
             matrix->form != 9) {
    result.problem = "its form is " + std::to_string(matrix->form) +
                     ", and 1 (square) or 6 (symmetric) was expected";
  } else {
    MatrixEntry twice;
    if (!AssembleMatrix(static_cast<int>(matrix->rows),
                        static_cast<int>(matrix->columns), /*mirrored=*/false,
                        &matrix->entries, &result.matrix, &twice)) {
      *line = twice.line;
      *what = "entry " + EntryText(twice.row, twice.column) + " of " +
              Quote(matrix->name) +
              " was given before, and each entry was expected once";
      return false;
    }
  }
  container->matrices.push_back(std::move(result));
  return true;
}

// Nastran's names, without the blanks and zero bytes that fill them.
std::string CleanName(std::string_view text) {
  const std::string_view filling(" \0", 2);
  const size_t begin = text.find_first_not_of(filling);
  if (begin == std::string_view::npos) return "";
  const size_t end = text.find_last_not_of(filling);
  return LowerCase(text.substr(begin, end - begin + 1));
}

// Fixed columns, as Fortran writes them: numbers may touch each other.
std::string_view Field(std::string_view line, size_t begin, size_t width) {
  return begin < line.size() ? line.substr(begin, width) : std::string_view();
}

class AsciiReader {
 public:
  AsciiReader(const std::string& path, const std::string& content)
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
      if (!Finish(&matrix, container, &failed_line, &what)) {
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
                ", and the header of a matrix was expected: columns, rows, "
                "form and type in 8 places each, name, format",
            error);
      }
    }
    matrix->name = CleanName(Field(line, 32, 8));
    matrix->form = fields[2];
    matrix->type = fields[3];
    matrix->line = lines_.number();
    std::string what;
    if (!CheckHeader(fields[0], fields[1], matrix, &what)) {
      return lines_.Fail(what, error);
    }
    return ReadFormat(LowerCase(StripBlanks(Field(line, 40, line.size()))),
                      error);
  }

  // "1p,5e16.9": five numbers a line, 16 places each.
  bool ReadFormat(const std::string& format, std::string* error) {
    per_line_ = 5;
    width_ = 16;
    if (format.empty()) return true;
    std::string_view rest = format;
    if (rest.substr(0, 3) == "1p,") rest.remove_prefix(3);
    const size_t letter = rest.find_first_of("ed");
    const size_t point = rest.find('.');
    if (letter == std::string_view::npos || point == std::string_view::npos ||
        point < letter || !ParseInt(rest.substr(0, letter), &per_line_) ||
        !ParseInt(rest.substr(letter + 1, point - letter - 1), &width_) ||
        per_line_ < 1 || per_line_ > 1000 || width_ < 1 || width_ > 1000) {
      return lines_.Fail("the format is " + Quote(format) +
                             ", and one such as '1P,5E16.9' was expected",
                         error);
    }
    return true;
  }

  bool NextLine(const Op4Matrix& matrix, std::string_view* line,
                std::string* error) {
    if (lines_.NextRaw(line)) return true;
    return lines_.Fail("the file ends inside matrix " + Quote(matrix.name) +
                           ", and its last column (" +
                           std::to_string(matrix.columns + 1) +
                           ") was expected",
                       error);
  }

  // Column headers until the one behind the last column, which ends a matrix
  // with one number that means nothing.
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
                               ", and column, first row and number of words "
                               "were expected, in 8 places each",
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
    // Some programs count two words a number in double precision.
    if (matrix->type % 2 == 0 && numbers % 2 == 0 &&
        !Fits(*matrix, row, numbers) && Fits(*matrix, row, numbers / 2)) {
      numbers /= 2;
    }
    if (!Fits(*matrix, row, numbers)) {
      return lines_.Fail(PlaceText(*matrix, row, column, numbers), error);
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
          matrix->big ? int64_t{first} - 1 : first / kStringUnit - 1;
      const int64_t row =
          (matrix->big ? int64_t{second} : first % kStringUnit) - 1;
      const int64_t numbers = length / words_per_number;
      if (!parsed || length < 1 || length % words_per_number != 0 ||
          length + (matrix->big ? 2 : 1) > words) {
        return lines_.Fail("the line is " + Quote(line) +
                               ", and the header of a string of at most " +
                               std::to_string(words) + " words was expected",
                           error);
      }
      if (!Fits(*matrix, row, numbers)) {
        return lines_.Fail(PlaceText(*matrix, row, column, numbers), error);
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
      if (!TakeNumbers(row + done / matrix->parts(), column, here, dense,
                       lines_.number(), value_at, matrix, &what)) {
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

// Bytes in either order.
class Bytes {
 public:
  Bytes(std::string_view bytes, bool swapped)
      : bytes_(bytes), swapped_(swapped) {}

  size_t size() const { return bytes_.size(); }
  std::string_view Text(size_t begin, size_t length) const {
    return bytes_.substr(begin, length);
  }
  Bytes Part(size_t begin, size_t length) const {
    return Bytes(bytes_.substr(begin, length), swapped_);
  }

  template <typename T>
  T At(size_t offset) const {
    CHECK_LE(offset + sizeof(T), bytes_.size()) << "read beyond the file's end";
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + offset, sizeof(T));
    if (swapped_) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }

 private:
  std::string_view bytes_;
  bool swapped_;
};

class BinaryReader {
 public:
  // `word`: bytes of an integer.
  BinaryReader(const std::string& path, Bytes bytes, size_t word)
      : path_(path), bytes_(bytes), word_(word) {}

  bool Read(MatrixContainer* container, std::string* error) {
    while (position_ < bytes_.size()) {
      Bytes record("", false);
      std::string what;
      Op4Matrix matrix;
      int no_line = 0;
      if (!(NextRecord(&record, &what) && ReadHeader(record, &matrix, &what) &&
            ReadColumns(&matrix, &what) &&
            Finish(&matrix, container, &no_line, &what))) {
        *error = path_ + ": " + what;
        return false;
      }
    }
    return true;
  }

 private:
  int64_t IntegerAt(const Bytes& record, size_t index) const {
    return word_ == 4 ? record.At<int32_t>(4 * index)
                      : record.At<int64_t>(8 * index);
  }

  // A Fortran record: its length in bytes before and behind it.
  bool NextRecord(Bytes* record, std::string* what) {
    const size_t left = bytes_.size() - position_;
    if (left < 8) {
      *what = "the file ends at byte " + std::to_string(bytes_.size()) +
              ", and a record was expected";
      return false;
    }
    const int64_t length = bytes_.At<int32_t>(position_);
    if (length < 0 || length > static_cast<int64_t>(left) - 8) {
      *what = "a record of " + std::to_string(length) +
              " bytes begins at byte " + std::to_string(position_) +
              ", and at most " + std::to_string(left - 8) +
              " were expected: is the file whole?";
      return false;
    }
    const auto size = static_cast<size_t>(length);
    *record = bytes_.Part(position_ + 4, size);
    position_ += 4 + size;
    if (bytes_.At<int32_t>(position_) != length) {
      *what = "the record that ends at byte " + std::to_string(position_) +
              " says " + std::to_string(bytes_.At<int32_t>(position_)) +
              " bytes behind, and " + std::to_string(length) +
              " was expected as before it";
      return false;
    }
    position_ += 4;
    return true;
  }

  bool ReadHeader(const Bytes& record, Op4Matrix* matrix, std::string* what) {
    if (record.size() != 6 * word_) {
      *what = "a record of " + std::to_string(record.size()) +
              " bytes stands where the header of a matrix was expected, " +
              std::to_string(6 * word_) + " bytes";
      return false;
    }
    matrix->name = CleanName(record.Text(4 * word_, 2 * word_));
    matrix->form = IntegerAt(record, 2);
    matrix->type = IntegerAt(record, 3);
    const int64_t rows = IntegerAt(record, 1);
    // Its negative exists.
    if (rows < -kMaxFiniteElementDofs) {
      *what = "matrix " + Quote(matrix->name) + " has " + std::to_string(rows) +
              " rows, and at most " + std::to_string(kMaxFiniteElementDofs) +
              " were expected";
      return false;
    }
    return CheckHeader(IntegerAt(record, 0), rows, matrix, what);
  }

  bool ReadColumns(Op4Matrix* matrix, std::string* what) {
    for (;;) {
      Bytes record("", false);
      if (!NextRecord(&record, what)) {
        *what += " (in matrix " + Quote(matrix->name) + ")";
        return false;
      }
      if (record.size() < 3 * word_) {
        *what = "a record of " + std::to_string(record.size()) +
                " bytes stands in matrix " + Quote(matrix->name) +
                ", and column, first row and number of words were expected";
        return false;
      }
      const int64_t column = IntegerAt(record, 0);
      const int64_t row = IntegerAt(record, 1);
      const int64_t words = IntegerAt(record, 2);
      if (column > matrix->columns) return true;
      const auto available =
          static_cast<int64_t>((record.size() - 3 * word_) / word_);
      if (column < 1 || row < 0 || words < 0 || words > available) {
        *what = "column " + std::to_string(column) + ", first row " +
                std::to_string(row) + " and " + std::to_string(words) +
                " words stand in matrix " + Quote(matrix->name) +
                ", and a column with at most " + std::to_string(available) +
                " words was expected";
        return false;
      }
      const Bytes data =
          record.Part(3 * word_, static_cast<size_t>(words) * word_);
      if (row > 0 ? !TakeString(row - 1, column - 1, data, /*dense=*/true,
                                matrix, what)
                  : !TakeStrings(column - 1, data, matrix, what)) {
        return false;
      }
    }
  }

  // Bytes of a number: with 64-bit words, single precision takes a word too.
  size_t NumberSize(const Op4Matrix& matrix) const {
    return matrix.type % 2 == 0 ? 8 : word_;
  }

  bool TakeString(int64_t row, int64_t column, const Bytes& data, bool dense,
                  Op4Matrix* matrix, std::string* what) const {
    const size_t size = NumberSize(*matrix);
    const auto numbers = static_cast<int64_t>(data.size() / size);
    if (data.size() % size != 0 || !Fits(*matrix, row, numbers)) {
      *what = PlaceText(*matrix, row, column, numbers);
      return false;
    }
    const auto value_at = [&data, size](int64_t i) {
      const size_t offset = static_cast<size_t>(i) * size;
      return size == 4 ? static_cast<double>(data.At<float>(offset))
                       : data.At<double>(offset);
    };
    return TakeNumbers(row, column, numbers, dense, /*line=*/0, value_at,
                       matrix, what);
  }

  bool TakeStrings(int64_t column, const Bytes& data, Op4Matrix* matrix,
                   std::string* what) const {
    const auto words = static_cast<int64_t>(data.size() / word_);
    const int64_t header = matrix->big ? 2 : 1;
    for (int64_t done = 0; done < words;) {
      const int64_t left = words - done;
      int64_t length = -1;
      int64_t row = -1;
      if (left > header) {
        const int64_t first = IntegerAt(data, static_cast<size_t>(done));
        length = matrix->big ? first - 1 : first / kStringUnit - 1;
        row = (matrix->big ? IntegerAt(data, static_cast<size_t>(done) + 1)
                           : first % kStringUnit) -
              1;
      }
      if (length < 1 || length > left - header) {
        *what = "column " + std::to_string(column + 1) + " of " +
                Quote(matrix->name) +
                " holds no header of a string where one was expected";
        return false;
      }
      if (row < 0) {
        *what = PlaceText(*matrix, row, column, length);
        return false;
      }
      const Bytes string = data.Part(static_cast<size_t>(done + header) * word_,
                                     static_cast<size_t>(length) * word_);
      if (!TakeString(row, column, string, /*dense=*/false, matrix, what)) {
        return false;
      }
      done += header + length;
    }
    return true;
  }

  const std::string& path_;
  const Bytes bytes_;
  const size_t word_;
  size_t position_ = 0;
};

}  // namespace

bool ReadOp4Content(const std::string& path, const std::string& content,
                    MatrixContainer* container, std::string* error) {
  CHECK(container != nullptr);
  CHECK(error != nullptr);
  MatrixContainer result;
  // A binary file begins with the length of its first record.
  constexpr int32_t kShortHeader = 24;
  constexpr int32_t kLongHeader = 48;
  for (const bool swapped : {false, true}) {
    if (content.size() < 4) break;
    const Bytes bytes(content, swapped);
    const int32_t length = bytes.At<int32_t>(0);
    if (length != kShortHeader && length != kLongHeader) continue;
    BinaryReader reader(path, bytes, length == kShortHeader ? 4 : 8);
    if (!reader.Read(&result, error)) return false;
    *container = std::move(result);
    return true;
  }
  const size_t bad = FirstInvalidUtf8(content);
  if (bad != std::string::npos) {
    *error = path + ": byte " + std::to_string(bad) +
             " is no text and the file begins with no record of 24 or 48 "
             "bytes, and an OP4 file was expected, ASCII or binary";
    return false;
  }
  AsciiReader reader(path, content);
  if (!reader.Read(&result, error)) return false;
  if (result.matrices.empty()) {
    *error = path + ":1: the file is empty, and a matrix was expected";
    return false;
  }
  *container = std::move(result);
  return true;
}

bool ReadOp4(const std::string& path, MatrixContainer* container,
             std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadBinaryFile(path, &content, error) &&
         ReadOp4Content(path, content, container, error);
}

}  // namespace pinode
