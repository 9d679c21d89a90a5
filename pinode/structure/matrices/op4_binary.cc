#include "pinode/structure/matrices/op4_binary.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_text.h"
#include "pinode/structure/matrices/op4_matrix.h"

namespace pinode {
namespace {

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

class Op4BinaryReader {
 public:
  // `marker`, `word`: bytes of a record's length and of an integer.
  Op4BinaryReader(const std::string& path, Bytes bytes, size_t marker,
                  size_t word)
      : path_(path), bytes_(bytes), marker_(marker), word_(word) {}

  bool Read(MatrixContainer* container, std::string* error) {
    while (position_ < bytes_.size()) {
      Bytes record("", false);
      std::string what;
      Op4Matrix matrix;
      int no_line = 0;
      if (!(NextRecord(&record, &what) && ReadHeader(record, &matrix, &what) &&
            ReadColumns(&matrix, &what) &&
            matrix.Finish(container, &no_line, &what))) {
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

  int64_t LengthAt(size_t position) const {
    return marker_ == 4 ? bytes_.At<int32_t>(position)
                        : bytes_.At<int64_t>(position);
  }

  // A Fortran record: its length in bytes before and behind it.
  bool NextRecord(Bytes* record, std::string* what) {
    const size_t left = bytes_.size() - position_;
    if (left < 2 * marker_) {
      *what = "the file ends at byte " + std::to_string(bytes_.size()) +
              ", expected a record";
      return false;
    }
    const int64_t length = LengthAt(position_);
    if (length < 0 || length > static_cast<int64_t>(left - 2 * marker_)) {
      *what = "a record of " + std::to_string(length) +
              " bytes begins at byte " + std::to_string(position_) +
              ", and at most " + std::to_string(left - 2 * marker_) +
              " were expected; check that the file is complete";
      return false;
    }
    const auto size = static_cast<size_t>(length);
    *record = bytes_.Part(position_ + marker_, size);
    position_ += marker_ + size;
    if (LengthAt(position_) != length) {
      *what = "the record that ends at byte " + std::to_string(position_) +
              " says " + std::to_string(LengthAt(position_)) +
              " bytes behind, expected " + std::to_string(length) +
              " as before it";
      return false;
    }
    position_ += marker_;
    return true;
  }

  bool ReadHeader(const Bytes& record, Op4Matrix* matrix, std::string* what) {
    if (record.size() != 6 * word_) {
      *what = "a record of " + std::to_string(record.size()) +
              " bytes is in the place of the header of a matrix, expected " +
              std::to_string(6 * word_) + " bytes";
      return false;
    }
    matrix->name = CleanOp4Name(record.Text(4 * word_, 2 * word_));
    matrix->form = IntegerAt(record, 2);
    matrix->type = IntegerAt(record, 3);
    const int64_t rows = IntegerAt(record, 1);
    // Checked before the number is negated, which could overflow.
    if (rows < -kMaxFiniteElementDofs) {
      *what = "matrix " + Quote(matrix->name) + " has " + std::to_string(rows) +
              " rows, expected at most " +
              std::to_string(kMaxFiniteElementDofs);
      return false;
    }
    return matrix->SetSize(IntegerAt(record, 0), rows, what);
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
                ", expected column, first row and number of words";
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
                ", expected a column with at most " +
                std::to_string(available) + " words";
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
    if (data.size() % size != 0 || !matrix->Fits(row, numbers)) {
      *what = matrix->PlaceText(row, column, numbers);
      return false;
    }
    const auto value_at = [&data, size](int64_t i) {
      const size_t offset = static_cast<size_t>(i) * size;
      return size == 4 ? static_cast<double>(data.At<float>(offset))
                       : data.At<double>(offset);
    };
    return matrix->TakeNumbers(row, column, numbers, dense, /*line=*/0,
                               value_at, what);
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
        length = matrix->big ? first - 1 : first / kOp4StringUnit - 1;
        row = (matrix->big ? IntegerAt(data, static_cast<size_t>(done) + 1)
                           : first % kOp4StringUnit) -
              1;
      }
      if (length < 1 || length > left - header) {
        *what = "column " + std::to_string(column + 1) + " of " +
                Quote(matrix->name) +
                " holds no header of a string where one was expected";
        return false;
      }
      if (row < 0) {
        *what = matrix->PlaceText(row, column, length);
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
  const size_t marker_;
  const size_t word_;
  size_t position_ = 0;
};

// Format of the integers in a file.
struct Form {
  bool swapped = false;
  size_t marker = 0;  // bytes of a record's length
  size_t word = 0;    // bytes of an integer
};

// Finds the format. A binary file begins with the length of its first record:
// in 4 bytes, or in 8 with some compiler options of Fortran (gfortran's
// -frecord-marker=8). No matrix has 0 columns, so zeros behind a length of 4
// bytes are the rest of 8 bytes.
bool FindForm(const std::string& content, Form* form) {
  constexpr int64_t kShortHeader = 24;
  constexpr int64_t kLongHeader = 48;
  for (const size_t marker : {size_t{8}, size_t{4}}) {
    if (content.size() < marker) continue;
    for (const bool swapped : {false, true}) {
      const Bytes bytes(content, swapped);
      const int64_t length =
          marker == 8 ? bytes.At<int64_t>(0) : bytes.At<int32_t>(0);
      if (length != kShortHeader && length != kLongHeader) continue;
      form->swapped = swapped;
      form->marker = marker;
      form->word = length == kShortHeader ? 4 : 8;
      return true;
    }
  }
  return false;
}

}  // namespace

bool IsOp4Binary(const std::string& content) {
  Form form;
  return FindForm(content, &form);
}

bool ReadOp4Binary(const std::string& path, const std::string& content,
                   MatrixContainer* container, std::string* error) {
  Form form;
  CHECK(FindForm(content, &form)) << path;
  return Op4BinaryReader(path, Bytes(content, form.swapped), form.marker,
                         form.word)
      .Read(container, error);
}

}  // namespace pinode
