#include "pinode/case/text/case_data.h"

#include <utility>

#include "pinode/base/strings.h"

namespace pinode {

bool CaseData::Has(const std::string& name) const {
  return tables.count(name) > 0 || matrices.count(name) > 0 ||
         sparse_matrices.count(name) > 0;
}

bool CheckColumns(const Table& table, const std::vector<std::string>& wanted,
                  std::string* error) {
  for (const std::string& name : wanted.empty() ? table.columns : wanted) {
    const int place = table.FindColumn(name);
    if (place < 0) {
      *error = table.path + ": there is no column '" + name + "'" +
               NameHint(name, table.columns);
      return false;
    }
    if (table.values.col(place).array().isInf().any()) {
      *error = table.path + ": column '" + name +
               "' has an infinite number, expected finite ones, or NaN where "
               "one is missing";
      return false;
    }
  }
  return true;
}

bool SelectColumns(const Table& table, const std::vector<std::string>& wanted,
                   Table* selected, std::string* error) {
  if (!CheckColumns(table, wanted, error)) return false;
  Table result;
  result.path = table.path;
  result.line_numbers = table.line_numbers;
  std::vector<int> places;
  for (const std::string& name : wanted.empty() ? table.columns : wanted) {
    if (result.FindColumn(name) >= 0) continue;
    result.columns.push_back(name);
    places.push_back(table.FindColumn(name));
  }
  result.values.resize(table.values.rows(),
                       static_cast<Eigen::Index>(places.size()));
  for (size_t i = 0; i < places.size(); ++i) {
    result.values.col(static_cast<Eigen::Index>(i)) =
        table.values.col(places[i]);
  }
  *selected = std::move(result);
  return true;
}

bool ReadColumns(const CaseData& data, const std::string& path,
                 const std::vector<std::string>& wanted, Table* selected,
                 std::string* error) {
  const auto array = data.tables.find(path);
  return array != data.tables.end()
             ? SelectColumns(array->second, wanted, selected, error)
             : ReadCsvTable(path, wanted, selected, error);
}

}  // namespace pinode
