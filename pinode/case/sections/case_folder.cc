#include "pinode/case/sections/case_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/matrices/matrix_market.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

// Returns "<record[0].file>" as part of a file's name, record_0_.file.
std::string FileStem(const std::string& name) {
  std::string stem;
  for (const char c : name) {
    if (c == '<' || c == '>') continue;
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       c == '.' || c == '-' || c == '_';
    stem += plain ? c : '_';
  }
  return stem;
}

bool WriteTable(const Table& table, const std::string& path,
                std::string* error) {
  std::vector<CsvColumn> columns;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    columns.emplace_back(table.columns[i],
                         table.values.col(static_cast<Eigen::Index>(i)));
  }
  return WriteCsv(path, columns, error);
}

class DataWriter {
 public:
  DataWriter(const CaseData& data, const std::string& folder,
             std::string* error)
      : data_(data), folder_(folder), error_(error) {}

  bool Write(TomlValue* value) {
    for (TomlValue& element : value->elements) {
      if (!Write(&element)) return false;
    }
    for (auto& [key, entry] : value->entries) {
      if (!Write(&entry)) return false;
    }
    return value->type != TomlValue::Type::kString || WriteArray(&value->text);
  }

 private:
  std::string Path(const std::string& file) const {
    return (fs::path(folder_) / file).string();
  }

  bool WriteArray(std::string* name) {
    const auto table = data_.tables.find(*name);
    const auto matrix = data_.matrices.find(*name);
    const auto sparse = data_.sparse_matrices.find(*name);
    const std::string stem = FileStem(*name);
    if (table != data_.tables.end()) {
      *name = stem + ".csv";
      return WriteTable(table->second, Path(*name), error_);
    }
    if (matrix != data_.matrices.end()) {
      *name = stem + ".mtx";
      return WriteMatrixMarket(Path(*name), matrix->second, error_);
    }
    if (sparse != data_.sparse_matrices.end()) {
      *name = stem + ".mtx";
      return WriteMatrixMarket(Path(*name), *sparse->second, error_);
    }
    return true;
  }

  const CaseData& data_;
  const std::string folder_;
  std::string* error_;
};

// True for keys whose text is the name of a file, and those that may have
// another text.
bool NamesFile(const std::string& key) {
  return key == "file" || key == "weights" || key == "changed_export" ||
         key == "set_export";
}

bool MayNameFile(const std::string& key) {
  return key == "mass" || key == "stiffness" || key == "damping" ||
         key == "matrix" || key == "dofs" || key == "shape" ||
         key == "shape_covariance";
}

void MoveFileNames(const CaseData& data, const std::string& path,
                   const fs::path& folder, const std::string& key,
                   TomlValue* value) {
  for (TomlValue& element : value->elements) {
    MoveFileNames(data, path, folder, "", &element);
  }
  for (auto& [name, entry] : value->entries) {
    MoveFileNames(data, path, folder, name, &entry);
  }
  if (value->type != TomlValue::Type::kString || data.Has(value->text)) return;
  std::error_code status;
  const fs::path from = ResolvePath(path, value->text);
  if (!NamesFile(key) &&
      !(MayNameFile(key) && fs::is_regular_file(from, status))) {
    return;
  }
  const fs::path whole =
      fs::weakly_canonical(fs::absolute(from, status), status);
  const fs::path to = whole.lexically_proximate(folder);
  value->text = (to.empty() ? whole : to).string();
}

}  // namespace

bool WriteCaseData(const CaseData& data, const std::string& folder,
                   TomlValue* tree, std::string* error) {
  return DataWriter(data, folder, error).Write(tree);
}

bool WriteCaseFolder(const TomlValue& tree, const CaseData& data,
                     const std::string& path, const std::string& folder,
                     std::string* error) {
  std::error_code status;
  const std::string file = (fs::path(folder) / "case.toml").string();
  if (!path.empty() && fs::equivalent(path, file, status)) {
    *error = file + ": would overwrite the case itself; give another folder";
    return false;
  }
  fs::create_directories(folder, status);
  if (status) {
    *error = folder + ": cannot be created: " + status.message();
    return false;
  }
  TomlValue named = tree;
  MoveFileNames(data, path,
                fs::weakly_canonical(fs::absolute(folder, status), status), "",
                &named);
  return WriteCaseData(data, folder, &named, error) &&
         WriteFileAtomically(file, FormatToml(named), error);
}

}  // namespace pinode
