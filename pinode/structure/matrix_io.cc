#include "pinode/structure/matrix_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// The lines of a text, without blanks around them.
class LineReader {
 public:
  LineReader(const std::string& path, std::string_view text)
      : path_(path), rest_(text) {
    // Windows programs like to begin with a byte order mark.
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
      rest_.remove_prefix(kByteOrderMark.size());
    }
  }

  // The next line of any kind; false behind the last one.
  bool Next(std::string_view* line) {
    if (rest_.empty()) return false;
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    *line = StripBlanks(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }

  // The next line that is neither blank nor a comment.
  bool NextContent(char comment, std::string_view* line) {
    while (Next(line)) {
      if (!line->empty() && line->front() != comment) return true;
    }
    return false;
  }

  // Line number of the last line read, from 1.
  int number() const { return number_; }

  // Sets *error to a message about the last line read; returns false.
  bool Fail(const std::string& message, std::string* error) const {
    *error =
        path_ + ":" + std::to_string(std::max(number_, 1)) + ": " + message;
    return false;
  }

 private:
  const std::string& path_;
  std::string_view rest_;
  int number_ = 0;
};

std::string Lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

// For messages: what the file says, in quotes, without control characters and
// not too long.
std::string Quote(std::string_view text) {
  constexpr size_t kLongest = 40;
  std::string quoted(text.substr(0, kLongest));
  for (char& c : quoted) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return "'" + quoted + (text.size() > kLongest ? "...'" : "'");
}

std::string EntryText(Eigen::Index row, Eigen::Index column) {
  return "(" + std::to_string(row + 1) + ", " + std::to_string(column + 1) +
         ")";
}

std::string SizeText(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

// The words of a line; runs of blanks separate them.
std::vector<std::string_view> SplitBlanks(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  std::vector<std::string_view> tokens;
  size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const size_t end =
        std::min(line.find_first_of(kBlanks, begin), line.size());
    tokens.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return tokens;
}

// The fields of a line, as they are between separators: possibly empty.
std::vector<std::string_view> Split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const size_t end = line.find(separator);
    fields.push_back(StripBlanks(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

// Parses one matrix entry; false with *error set if it is no finite number.
bool ParseEntry(const LineReader& lines, std::string_view text,
                Eigen::Index row, Eigen::Index column, double* value,
                std::string* error) {
  if (!ParseDouble(text, value)) {
    return lines.Fail("entry " + EntryText(row, column) + " is " + Quote(text) +
                          ", and a number was expected",
                      error);
  }
  if (!std::isfinite(*value)) {
    return lines.Fail("entry " + EntryText(row, column) + " is " + Quote(text) +
                          ", and a finite number was expected",
                      error);
  }
  return true;
}

bool ReadCsv(LineReader lines, Matrix* matrix, std::string* error) {
  std::vector<double> values;  // row by row
  size_t columns = 0;
  size_t rows = 0;
  int first_line = 0;
  std::string_view line;
  while (lines.NextContent('#', &line)) {
    const bool has_semicolon = line.find(';') != std::string_view::npos;
    const bool has_comma = line.find(',') != std::string_view::npos;
    if (has_semicolon && has_comma) {
      return lines.Fail(
          "the line has both ',' and ';', and one kind of separator was "
          "expected; numbers need a decimal point, not a comma",
          error);
    }
    const std::vector<std::string_view> fields =
        has_semicolon ? Split(line, ';')
                      : (has_comma ? Split(line, ',') : SplitBlanks(line));
    if (rows == 0) {
      columns = fields.size();
      first_line = lines.number();
    }
    if (fields.size() != columns) {
      return lines.Fail(std::to_string(fields.size()) + " entries, and " +
                            std::to_string(columns) +
                            " were expected, as in line " +
                            std::to_string(first_line),
                        error);
    }
    if (columns > kMaxMatrixDimension || rows == kMaxMatrixDimension) {
      return lines.Fail("the matrix has more than " +
                            std::to_string(kMaxMatrixDimension) +
                            " rows or columns, and a condensed model was "
                            "expected",
                        error);
    }
    for (size_t j = 0; j < columns; ++j) {
      double value = 0.0;
      if (!ParseEntry(lines, fields[j], static_cast<Eigen::Index>(rows),
                      static_cast<Eigen::Index>(j), &value, error)) {
        return false;
      }
      values.push_back(value);
    }
    ++rows;
  }
  if (rows == 0) {
    return lines.Fail("the file has no entries, and a matrix was expected",
                      error);
  }
  using RowMajor =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  *matrix =
      Eigen::Map<const RowMajor>(values.data(), static_cast<Eigen::Index>(rows),
                                 static_cast<Eigen::Index>(columns));
  return true;
}

// What the first lines of a Matrix Market file say.
struct MatrixMarketHeader {
  bool coordinate = false;
  bool integer = false;
  bool symmetric = false;
  int rows = 0;
  int columns = 0;
  // Lines of entries that follow (coordinate) or values (array).
  int num_entries = 0;
  int size_line = 0;
};

bool ReadBanner(LineReader* lines, MatrixMarketHeader* header,
                std::string* error) {
  std::string_view line;
  std::vector<std::string> words;
  if (lines->Next(&line)) {
    for (const std::string_view word : SplitBlanks(line)) {
      words.push_back(Lower(std::string(word)));
    }
  }
  if (words.size() != 5 || words[0] != "%%matrixmarket" ||
      words[1] != "matrix") {
    return lines->Fail(
        "no Matrix Market banner, and '%%MatrixMarket matrix "
        "coordinate|array real|integer general|symmetric' was expected",
        error);
  }
  const std::string& format = words[2];
  if (format != "coordinate" && format != "array") {
    return lines->Fail("the format is " + Quote(format) +
                           ", and coordinate or array was expected",
                       error);
  }
  const std::string& field = words[3];
  if (field == "pattern") {
    return lines->Fail(
        "the field is 'pattern', which says where entries are but not what "
        "they are, and real or integer was expected",
        error);
  }
  if (field == "complex") {
    return lines->Fail(
        "the field is 'complex', and real or integer was expected: mass, "
        "damping and stiffness are real",
        error);
  }
  if (field != "real" && field != "double" && field != "integer") {
    return lines->Fail(
        "the field is " + Quote(field) + ", and real or integer was expected",
        error);
  }
  const std::string& symmetry = words[4];
  if (symmetry == "skew-symmetric" || symmetry == "hermitian") {
    return lines->Fail("the matrix is " + symmetry +
                           ", and general or symmetric was expected: mass, "
                           "damping and stiffness are symmetric",
                       error);
  }
  if (symmetry != "general" && symmetry != "symmetric") {
    return lines->Fail("the symmetry is " + Quote(symmetry) +
                           ", and general or symmetric was expected",
                       error);
  }
  header->coordinate = format == "coordinate";
  header->integer = field == "integer";
  header->symmetric = symmetry == "symmetric";
  return true;
}

bool ReadSizes(LineReader* lines, MatrixMarketHeader* header,
               std::string* error) {
  const char* expected =
      header->coordinate ? "'rows columns entries'" : "'rows columns'";
  std::string_view line;
  if (!lines->NextContent('%', &line)) {
    return lines->Fail(std::string("the file ends before its size line, and ") +
                           expected + " was expected",
                       error);
  }
  const std::vector<std::string_view> words = SplitBlanks(line);
  int entries = 0;
  if (words.size() != (header->coordinate ? 3u : 2u) ||
      !ParseInt(words[0], &header->rows) ||
      !ParseInt(words[1], &header->columns) ||
      (header->coordinate && !ParseInt(words[2], &entries))) {
    return lines->Fail("the size line is " + Quote(line) + ", and " + expected +
                           " was expected, in integers",
                       error);
  }
  if (header->rows < 1 || header->columns < 1 || entries < 0) {
    return lines->Fail("the size line is " + Quote(line) +
                           ", and a matrix with at least one row and column "
                           "was expected",
                       error);
  }
  if (header->rows > kMaxMatrixDimension ||
      header->columns > kMaxMatrixDimension) {
    return lines->Fail("the matrix is " +
                           SizeText(header->rows, header->columns) +
                           ", and a condensed model of at most " +
                           std::to_string(kMaxMatrixDimension) +
                           " rows and columns was expected",
                       error);
  }
  if (header->symmetric && header->rows != header->columns) {
    return lines->Fail("the matrix is " +
                           SizeText(header->rows, header->columns) +
                           " and called symmetric, and as many rows as columns "
                           "were expected",
                       error);
  }
  const int places = header->symmetric ? header->rows * (header->rows + 1) / 2
                                       : header->rows * header->columns;
  if (entries > places) {
    return lines->Fail(std::to_string(entries) +
                           " entries are announced, and at most " +
                           std::to_string(places) + " were expected in a " +
                           SizeText(header->rows, header->columns) +
                           (header->symmetric ? " symmetric" : "") + " matrix",
                       error);
  }
  header->num_entries = header->coordinate ? entries : places;
  header->size_line = lines->number();
  return true;
}

bool ParseMarketEntry(const LineReader& lines, const MatrixMarketHeader& header,
                      std::string_view text, int row, int column, double* value,
                      std::string* error) {
  if (!ParseEntry(lines, text, row, column, value, error)) return false;
  if (header.integer && *value != std::trunc(*value)) {
    return lines.Fail("entry " + EntryText(row, column) + " is " + Quote(text) +
                          ", and an integer was expected, as the first line "
                          "says",
                      error);
  }
  return true;
}

bool FailTruncated(const LineReader& lines, const MatrixMarketHeader& header,
                   int found, std::string* error) {
  return lines.Fail("the file ends after " + std::to_string(found) +
                        " entries, and " + std::to_string(header.num_entries) +
                        " were expected by line " +
                        std::to_string(header.size_line),
                    error);
}

bool FailOversized(const LineReader& lines, const MatrixMarketHeader& header,
                   std::string* error) {
  return lines.Fail(
      "more entries than the " + std::to_string(header.num_entries) +
          " that were expected by line " + std::to_string(header.size_line),
      error);
}

bool ReadCoordinateEntries(LineReader* lines, const MatrixMarketHeader& header,
                           Matrix* matrix, std::string* error) {
  std::vector<bool> seen(static_cast<size_t>(header.rows) *
                         static_cast<size_t>(header.columns));
  std::string_view line;
  for (int k = 0; k < header.num_entries; ++k) {
    if (!lines->NextContent('%', &line)) {
      return FailTruncated(*lines, header, k, error);
    }
    const std::vector<std::string_view> words = SplitBlanks(line);
    int row = 0;
    int column = 0;
    if (words.size() != 3 || !ParseInt(words[0], &row) ||
        !ParseInt(words[1], &column)) {
      return lines->Fail("the line is " + Quote(line) +
                             ", and 'row column value' was expected",
                         error);
    }
    if (row < 1 || row > header.rows || column < 1 || column > header.columns) {
      return lines->Fail("entry (" + std::to_string(row) + ", " +
                             std::to_string(column) +
                             ") lies outside, and indices from 1 to " +
                             std::to_string(header.rows) + " and 1 to " +
                             std::to_string(header.columns) + " were expected",
                         error);
    }
    --row;
    --column;
    double value = 0.0;
    if (!ParseMarketEntry(*lines, header, words[2], row, column, &value,
                          error)) {
      return false;
    }
    const auto place = [&header](int i, int j) {
      return static_cast<size_t>(i) * static_cast<size_t>(header.columns) +
             static_cast<size_t>(j);
    };
    if (seen[place(row, column)]) {
      return lines->Fail(
          "entry " + EntryText(row, column) +
              (header.symmetric ? " or its mirror image" : "") +
              " was given before, and each entry was expected once",
          error);
    }
    seen[place(row, column)] = true;
    (*matrix)(row, column) = value;
    if (header.symmetric) {
      seen[place(column, row)] = true;
      (*matrix)(column, row) = value;
    }
  }
  if (lines->NextContent('%', &line)) {
    return FailOversized(*lines, header, error);
  }
  return true;
}

// Column by column; of a symmetric matrix the lower triangle.
bool ReadArrayEntries(LineReader* lines, const MatrixMarketHeader& header,
                      Matrix* matrix, std::string* error) {
  int found = 0;
  int row = 0;
  int column = 0;
  std::string_view line;
  while (lines->NextContent('%', &line)) {
    for (const std::string_view word : SplitBlanks(line)) {
      if (found == header.num_entries) {
        return FailOversized(*lines, header, error);
      }
      double value = 0.0;
      if (!ParseMarketEntry(*lines, header, word, row, column, &value, error)) {
        return false;
      }
      (*matrix)(row, column) = value;
      if (header.symmetric) (*matrix)(column, row) = value;
      ++found;
      if (++row == header.rows) {
        ++column;
        row = header.symmetric ? column : 0;
      }
    }
  }
  if (found < header.num_entries) {
    return FailTruncated(*lines, header, found, error);
  }
  return true;
}

bool ReadMatrixMarket(LineReader lines, Matrix* matrix, std::string* error) {
  MatrixMarketHeader header;
  if (!ReadBanner(&lines, &header, error)) return false;
  if (!ReadSizes(&lines, &header, error)) return false;
  Matrix result = Matrix::Zero(header.rows, header.columns);
  if (!(header.coordinate
            ? ReadCoordinateEntries(&lines, header, &result, error)
            : ReadArrayEntries(&lines, header, &result, error))) {
    return false;
  }
  *matrix = std::move(result);
  return true;
}

}  // namespace

bool ReadMatrix(const std::string& path, Matrix* matrix, std::string* error) {
  CHECK(matrix != nullptr);
  CHECK(error != nullptr);
  const std::string extension =
      Lower(std::filesystem::path(path).extension().string());
  if (extension != ".csv" && extension != ".mtx") {
    *error = path +
             ": a matrix file ends in .csv or .mtx (Matrix Market), and one of "
             "these was expected";
    return false;
  }
  std::string content;
  if (!ReadTextFile(path, &content, error)) return false;
  const LineReader lines(path, content);
  return extension == ".csv" ? ReadCsv(lines, matrix, error)
                             : ReadMatrixMarket(lines, matrix, error);
}

bool WriteMatrixMarket(const std::string& path, const Matrix& matrix,
                       std::string* error) {
  CHECK(error != nullptr);
  CHECK_GT(matrix.size(), 0) << "an empty matrix cannot be written";
  const Eigen::Index rows = matrix.rows();
  const Eigen::Index columns = matrix.cols();
  const bool symmetric = rows == columns && matrix == matrix.transpose();
  std::string entries;
  int num_entries = 0;
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (!std::isfinite(matrix(i, j))) {
        *error = path + ": entry " + EntryText(i, j) + " is " +
                 FormatNumber(matrix(i, j)) +
                 ", and finite numbers were expected; nothing was written";
        return false;
      }
      if (matrix(i, j) == 0.0 || (symmetric && i < j)) continue;
      entries += std::to_string(i + 1) + " " + std::to_string(j + 1) + " " +
                 FormatNumber(matrix(i, j), 17) + "\n";
      ++num_entries;
    }
  }
  return WriteFileAtomically(
      path,
      std::string("%%MatrixMarket matrix coordinate real ") +
          (symmetric ? "symmetric" : "general") + "\n" + std::to_string(rows) +
          " " + std::to_string(columns) + " " + std::to_string(num_entries) +
          "\n" + entries,
      error);
}

}  // namespace pinode
