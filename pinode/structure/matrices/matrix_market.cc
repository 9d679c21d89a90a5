#include "pinode/structure/matrices/matrix_market.h"

#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

// Content of the first lines of a Matrix Market file.
struct MatrixMarketHeader {
  bool coordinate = false;
  bool integer = false;
  bool symmetric = false;
  int rows = 0;
  int columns = 0;
  // Lines of entries that follow (coordinate) or values (array).
  int64_t num_entries = 0;
  int size_line = 0;
};

bool ReadBanner(LineReader* lines, MatrixMarketHeader* header,
                std::string* error) {
  std::string_view line;
  std::vector<std::string> words;
  if (lines->Next(&line)) {
    for (const std::string_view word : SplitBlanks(line)) {
      words.push_back(LowerCase(word));
    }
  }
  if (words.size() != 5 || words[0] != "%%matrixmarket" ||
      words[1] != "matrix") {
    return lines->Fail(
        "no Matrix Market banner, expected '%%MatrixMarket matrix "
        "coordinate|array real|integer general|symmetric'",
        error);
  }
  const std::string& format = words[2];
  if (format != "coordinate" && format != "array") {
    return lines->Fail(
        "the format is " + Quote(format) + ", expected coordinate or array",
        error);
  }
  const std::string& field = words[3];
  if (field == "pattern") {
    return lines->Fail(
        "the field is 'pattern', which has no values, expected real or integer",
        error);
  }
  if (field == "complex") {
    return lines->Fail(
        "the field is 'complex', expected real or integer: mass, damping and "
        "stiffness are real",
        error);
  }
  if (field != "real" && field != "double" && field != "integer") {
    return lines->Fail(
        "the field is " + Quote(field) + ", expected real or integer", error);
  }
  const std::string& symmetry = words[4];
  if (symmetry == "skew-symmetric" || symmetry == "hermitian") {
    return lines->Fail("the matrix is " + symmetry +
                           ", expected general or symmetric: mass, damping and "
                           "stiffness are symmetric",
                       error);
  }
  if (symmetry != "general" && symmetry != "symmetric") {
    return lines->Fail("the symmetry is " + Quote(symmetry) +
                           ", expected general or symmetric",
                       error);
  }
  header->coordinate = format == "coordinate";
  header->integer = field == "integer";
  header->symmetric = symmetry == "symmetric";
  return true;
}

bool ReadSizes(LineReader* lines, int max_dimension, MatrixMarketHeader* header,
               std::string* error) {
  const char* expected =
      header->coordinate ? "'rows columns entries'" : "'rows columns'";
  std::string_view line;
  if (!lines->NextContent('%', &line)) {
    return lines->Fail(
        std::string("the file ends before its size line, expected ") + expected,
        error);
  }
  const std::vector<std::string_view> words = SplitBlanks(line);
  int entries = 0;
  if (words.size() != (header->coordinate ? 3u : 2u) ||
      !ParseInt(words[0], &header->rows) ||
      !ParseInt(words[1], &header->columns) ||
      (header->coordinate && !ParseInt(words[2], &entries))) {
    return lines->Fail("the size line is " + Quote(line) + ", expected " +
                           expected + ", in integers",
                       error);
  }
  if (header->rows < 1 || header->columns < 1 || entries < 0) {
    return lines->Fail(
        "the size line is " + Quote(line) +
            ", expected a matrix with at least one row and column",
        error);
  }
  if (header->rows > max_dimension || header->columns > max_dimension) {
    return lines->Fail("the matrix is " +
                           SizeText(header->rows, header->columns) +
                           ", expected at most " +
                           std::to_string(max_dimension) + " rows and columns",
                       error);
  }
  if (header->symmetric && header->rows != header->columns) {
    return lines->Fail(
        "the matrix is " + SizeText(header->rows, header->columns) +
            " and called symmetric, expected as many rows as columns",
        error);
  }
  const int64_t rows = header->rows;
  const int64_t places =
      header->symmetric ? rows * (rows + 1) / 2 : rows * header->columns;
  if (entries > places) {
    return lines->Fail(std::to_string(entries) +
                           " entries are announced, expected at most " +
                           std::to_string(places) + " in a " +
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
                          ", expected an integer, as the first line says",
                      error);
  }
  return true;
}

bool FailTruncated(const LineReader& lines, const MatrixMarketHeader& header,
                   int64_t found, std::string* error) {
  return lines.Fail("the file ends after " + std::to_string(found) +
                        " entries, expected " +
                        std::to_string(header.num_entries) + " by line " +
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
                           std::vector<MatrixEntry>* entries,
                           std::string* error) {
  std::string_view line;
  for (int64_t k = 0; k < header.num_entries; ++k) {
    if (!lines->NextContent('%', &line)) {
      return FailTruncated(*lines, header, k, error);
    }
    const std::vector<std::string_view> words = SplitBlanks(line);
    MatrixEntry entry;
    if (words.size() != 3 || !ParseInt(words[0], &entry.row) ||
        !ParseInt(words[1], &entry.column)) {
      return lines->Fail(
          "the line is " + Quote(line) + ", expected 'row column value'",
          error);
    }
    if (entry.row < 1 || entry.row > header.rows || entry.column < 1 ||
        entry.column > header.columns) {
      return lines->Fail("entry (" + std::to_string(entry.row) + ", " +
                             std::to_string(entry.column) +
                             ") lies outside, expected indices from 1 to " +
                             std::to_string(header.rows) + " and 1 to " +
                             std::to_string(header.columns),
                         error);
    }
    --entry.row;
    --entry.column;
    entry.line = lines->number();
    if (!ParseMarketEntry(*lines, header, words[2], entry.row, entry.column,
                          &entry.value, error)) {
      return false;
    }
    entries->push_back(entry);
  }
  if (lines->NextContent('%', &line)) {
    return FailOversized(*lines, header, error);
  }
  return true;
}

// Column by column; of a symmetric matrix the lower triangle.
bool ReadArrayEntries(LineReader* lines, const MatrixMarketHeader& header,
                      std::vector<MatrixEntry>* entries, std::string* error) {
  int64_t found = 0;
  MatrixEntry entry;
  std::string_view line;
  while (lines->NextContent('%', &line)) {
    for (const std::string_view word : SplitBlanks(line)) {
      if (found == header.num_entries) {
        return FailOversized(*lines, header, error);
      }
      if (!ParseMarketEntry(*lines, header, word, entry.row, entry.column,
                            &entry.value, error)) {
        return false;
      }
      entry.line = lines->number();
      // A full matrix lists all its zeros. They are not part of a sparsity.
      if (entry.value != 0.0) entries->push_back(entry);
      ++found;
      if (++entry.row == header.rows) {
        ++entry.column;
        entry.row = header.symmetric ? entry.column : 0;
      }
    }
  }
  if (found < header.num_entries) {
    return FailTruncated(*lines, header, found, error);
  }
  return true;
}

// Compares values and stored places.
bool IsExactlySymmetric(const SparseMatrix& matrix) {
  if (matrix.rows() != matrix.cols()) return false;
  const SparseMatrix transpose = matrix.transpose();
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    SparseMatrix::InnerIterator a(matrix, j);
    SparseMatrix::InnerIterator b(transpose, j);
    for (; a && b; ++a, ++b) {
      if (a.row() != b.row() || a.value() != b.value()) return false;
    }
    if (a || b) return false;
  }
  return true;
}

}  // namespace

bool ReadMatrixMarketText(const std::string& path, const std::string& content,
                          int max_dimension, SparseMatrix* matrix,
                          std::string* error) {
  CHECK(matrix != nullptr);
  CHECK(error != nullptr);
  LineReader lines(path, content);
  MatrixMarketHeader header;
  if (!ReadBanner(&lines, &header, error)) return false;
  if (!ReadSizes(&lines, max_dimension, &header, error)) return false;
  std::vector<MatrixEntry> entries;
  if (!(header.coordinate
            ? ReadCoordinateEntries(&lines, header, &entries, error)
            : ReadArrayEntries(&lines, header, &entries, error))) {
    return false;
  }
  MatrixEntry twice;
  if (!AssembleMatrix(header.rows, header.columns, header.symmetric, &entries,
                      matrix, &twice)) {
    return lines.FailAt(twice.line,
                        "entry " + EntryText(twice.row, twice.column) +
                            (header.symmetric ? " or its mirror image" : "") +
                            " was given before, expected each entry once",
                        error);
  }
  return true;
}

bool ReadMatrixMarket(const std::string& path, SparseMatrix* matrix,
                      std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadMatrixMarketText(path, content, kMaxFiniteElementDofs, matrix,
                              error);
}

bool WriteMatrixMarket(const std::string& path, const SparseMatrix& matrix,
                       std::string* error) {
  CHECK(error != nullptr);
  CHECK_GT(matrix.rows() * matrix.cols(), 0)
      << "an empty matrix cannot be written";
  const bool symmetric = IsExactlySymmetric(matrix);
  std::string entries;
  int64_t num_entries = 0;
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      if (!std::isfinite(entry.value())) {
        *error = path + ": entry " + EntryText(entry.row(), j) + " is " +
                 FormatNumber(entry.value()) +
                 ", and finite numbers were expected; nothing was written";
        return false;
      }
      if (symmetric && entry.row() < j) continue;
      entries += std::to_string(entry.row() + 1) + " " + std::to_string(j + 1) +
                 " " + FormatNumber(entry.value(), 17) + "\n";
      ++num_entries;
    }
  }
  return WriteFileAtomically(
      path,
      std::string("%%MatrixMarket matrix coordinate real ") +
          (symmetric ? "symmetric" : "general") + "\n" +
          std::to_string(matrix.rows()) + " " + std::to_string(matrix.cols()) +
          " " + std::to_string(num_entries) + "\n" + entries,
      error);
}

}  // namespace pinode
