#include "pinode/structure/matrices/matrix_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/harwell_boeing.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

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
      return lines.Fail(std::to_string(fields.size()) + " entries, expected " +
                            std::to_string(columns) + ", as in line " +
                            std::to_string(first_line),
                        error);
    }
    if (columns > kMaxMatrixDimension || rows == kMaxMatrixDimension) {
      return lines.Fail("the matrix has more than " +
                            std::to_string(kMaxMatrixDimension) +
                            " rows or columns, expected a condensed model",
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
    return lines.Fail("the file has no entries, expected a matrix", error);
  }
  using RowMajor =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  *matrix =
      Eigen::Map<const RowMajor>(values.data(), static_cast<Eigen::Index>(rows),
                                 static_cast<Eigen::Index>(columns));
  return true;
}

}  // namespace

bool ReadMatrix(const std::string& path, Matrix* matrix, std::string* error) {
  CHECK(matrix != nullptr);
  CHECK(error != nullptr);
  const std::string extension =
      LowerCase(std::filesystem::path(WithoutGz(path)).extension().string());
  if (IsHarwellBoeing(path)) {
    SparseMatrix sparse;
    if (!ReadHarwellBoeing(path, kMaxMatrixDimension, &sparse, error)) {
      return false;
    }
    *matrix = Matrix(sparse);
    return true;
  }
  if (extension != ".csv" && extension != ".mtx") {
    *error = path +
             ": a matrix file ends in .csv, .mtx (Matrix Market), .matrix, .hb "
             "or .rsa (Harwell-Boeing), expected one of these";
    return false;
  }
  std::string content;
  if (!ReadTextFile(path, &content, error)) return false;
  if (extension == ".csv") {
    return ReadCsv(LineReader(path, content), matrix, error);
  }
  SparseMatrix sparse;
  if (!ReadMatrixMarketText(path, content, kMaxMatrixDimension, &sparse,
                            error)) {
    return false;
  }
  *matrix = Matrix(sparse);
  return true;
}

bool WriteMatrixMarket(const std::string& path, const Matrix& matrix,
                       std::string* error) {
  // Without the zeros: a dense matrix has no sparsity to keep.
  return WriteMatrixMarket(path, SparseMatrix(matrix.sparseView(0.0, 0.0)),
                           error);
}

}  // namespace pinode
