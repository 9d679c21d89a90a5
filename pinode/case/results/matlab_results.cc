#include "pinode/case/results/matlab_results.h"

#include <csv.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "pinode/base/arrays/matlab_writer.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_market.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

constexpr char kMatlabResults[] = "results.mat";
// Largest number of rows of a full matrix; larger ones are sparse in MATLAB
// too.
constexpr Eigen::Index kLargestFullMatrix = 100;

// Cells of a CSV file written by pinode.
struct WrittenCsv {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;

  static void OnCell(void* cell, size_t size, void* self) {
    static_cast<WrittenCsv*>(self)->row.emplace_back(
        static_cast<const char*>(cell), size);
  }
  static void OnRow(int, void* self) {
    auto* csv = static_cast<WrittenCsv*>(self);
    csv->rows.push_back(std::move(csv->row));
    csv->row.clear();
  }
};

bool ReadWrittenCsv(const std::string& path, WrittenCsv* csv,
                    std::string* error) {
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  csv_parser parser;
  if (csv_init(&parser, CSV_STRICT) != 0) {
    *error = path + ": cannot be read";
    return false;
  }
  const bool whole =
      csv_parse(&parser, text.data(), text.size(), &WrittenCsv::OnCell,
                &WrittenCsv::OnRow, csv) == text.size();
  csv_fini(&parser, &WrittenCsv::OnCell, &WrittenCsv::OnRow, csv);
  csv_free(&parser);
  if (!whole || csv->rows.empty()) {
    *error = path + ": is not a table, expected a header and rows";
    return false;
  }
  const size_t count = csv->rows[0].size();
  for (const std::vector<std::string>& row : csv->rows) {
    if (row.size() != count) {
      *error = path + ": has rows of different lengths";
      return false;
    }
  }
  return true;
}

// Returns numbers, unless a cell is a text. Units, which may all be 1, are
// always texts.
MatlabField ColumnOf(const WrittenCsv& csv, size_t column) {
  MatlabField field;
  field.name = csv.rows[0][column];
  const size_t count = csv.rows.size() - 1;
  field.numbers.resize(static_cast<Eigen::Index>(count));
  bool numbers = field.name != "unit";
  for (size_t i = 0; i < count && numbers; ++i) {
    const std::string& cell = csv.rows[i + 1][column];
    double value = std::nan("");
    numbers = StripBlanks(cell).empty() || ParseDouble(cell, &value);
    field.numbers[static_cast<Eigen::Index>(i)] = value;
  }
  if (numbers) return field;
  for (size_t i = 0; i < count; ++i) {
    field.texts.push_back(csv.rows[i + 1][column]);
  }
  return field;
}

bool AddTable(const std::string& path, const std::string& name,
              MatlabWriter* writer, std::string* error) {
  WrittenCsv csv;
  if (!ReadWrittenCsv(path, &csv, error)) return false;
  std::vector<MatlabField> fields;
  for (size_t j = 0; j < csv.rows[0].size(); ++j) {
    fields.push_back(ColumnOf(csv, j));
  }
  writer->AddStructure(name, fields);
  return true;
}

bool AddMarketMatrix(const std::string& path, const std::string& name,
                     MatlabWriter* writer, std::string* error) {
  SparseMatrix matrix;
  if (!ReadMatrixMarket(path, &matrix, error)) return false;
  if (matrix.rows() <= kLargestFullMatrix) {
    writer->AddMatrix(name, Matrix(matrix));
  } else {
    writer->AddSparse(name, matrix);
  }
  return true;
}

bool AddLines(const std::string& path, const std::string& name,
              MatlabWriter* writer, std::string* error) {
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  MatlabField lines;
  lines.name = "lines";
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.texts.push_back(line);
  }
  writer->AddStructure(name, {lines});
  return true;
}

// Adds a JSON text in plain characters; not all readers of MATLAB's files
// understand others.
bool AddJson(const std::string& path, const std::string& name,
             MatlabWriter* writer, std::string* error) {
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  const auto json = nlohmann::ordered_json::parse(text, nullptr,
                                                  /*allow_exceptions=*/false);
  if (json.is_discarded()) {
    *error = path + ": is not JSON";
    return false;
  }
  writer->AddText(name, json.dump(1, ' ', /*ensure_ascii=*/true));
  return true;
}

}  // namespace

bool WriteMatlabResults(const std::string& folder, std::string* error) {
  std::vector<fs::path> files;
  std::error_code status;
  for (fs::directory_iterator entry(folder, status);
       !status && entry != fs::directory_iterator(); entry.increment(status)) {
    files.push_back(entry->path());
  }
  if (status) {
    *error = folder + ": cannot be listed: " + status.message();
    return false;
  }
  std::sort(files.begin(), files.end());
  MatlabWriter writer(folder + "/" + kMatlabResults);
  for (const fs::path& file : files) {
    const std::string name = file.stem().string();
    const std::string extension = file.extension().string();
    bool ok = true;
    if (extension == ".csv") {
      ok = AddTable(file.string(), name, &writer, error);
    } else if (extension == ".mtx") {
      ok = AddMarketMatrix(file.string(), name, &writer, error);
    } else if (extension == ".txt") {
      ok = AddLines(file.string(), name, &writer, error);
    } else if (extension == ".json" && name != "checkpoint") {
      ok = AddJson(file.string(), name + "_json", &writer, error);
    }
    if (!ok) return false;
  }
  return writer.Close(error);
}

}  // namespace pinode
