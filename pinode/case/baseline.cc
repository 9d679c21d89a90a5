#include "pinode/case/baseline.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/record/table.h"
#include "pinode/structure/matrix_io.h"

namespace pinode {
namespace {

using Json = nlohmann::json;

// The part of result.json that is needed here.
struct Result {
  std::vector<std::string> names;  // of all parameters
  Vector values;
  std::vector<std::string> free;  // the free ones, in the covariance's order
};

bool ReadResult(const std::string& path, Result* result, std::string* error) {
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded() || !json.is_object() ||
      json.value("schema", Json()) != "pinode-result-1" ||
      !json.value("parameters", Json()).is_array()) {
    *error = path + ": is not a result of pinode_update";
    return false;
  }
  if (json.value("usable", Json()) != true) {
    *error = path + ": the result is not usable (" +
             json.value("message", std::string()) +
             "), expected one of a healthy record that is";
    return false;
  }
  std::vector<double> values;
  for (const Json& parameter : json["parameters"]) {
    if (!parameter.is_object() ||
        !parameter.value("name", Json()).is_string() ||
        !parameter.value("value", Json()).is_number() ||
        !parameter.value("free", Json()).is_boolean()) {
      *error = path + ": a parameter lacks its name, value or free";
      return false;
    }
    result->names.push_back(parameter["name"]);
    values.push_back(parameter["value"]);
    if (parameter["free"] == true) result->free.push_back(parameter["name"]);
  }
  result->values = Eigen::Map<const Vector>(
      values.data(), static_cast<Eigen::Index>(values.size()));
  return true;
}

}  // namespace

bool ReadBaseline(const std::string& folder, const StructuralDynamics& dynamics,
                  const std::vector<std::string>& names, Baseline* baseline,
                  std::string* error) {
  const auto path = [&folder](const std::string& name) {
    return (std::filesystem::path(folder) / name).string();
  };
  Result result;
  if (!ReadResult(path("result.json"), &result, error)) return false;

  // The same groups of the same structure.
  std::vector<int> rows;
  Vector values(static_cast<Eigen::Index>(names.size()));
  for (size_t i = 0; i < names.size(); ++i) {
    const auto position =
        std::find(result.free.begin(), result.free.end(), names[i]);
    if (position == result.free.end()) {
      *error = path("result.json") + ": group '" + names[i] +
               "' of the case is not among its free parameters, expected a "
               "baseline with the same groups";
      return false;
    }
    rows.push_back(static_cast<int>(position - result.free.begin()));
    const auto value =
        std::find(result.names.begin(), result.names.end(), names[i]);
    values[static_cast<Eigen::Index>(i)] =
        result.values[value - result.names.begin()];
    for (const GroupTerm& term : dynamics.groups()) {
      if (term.group.name != names[i]) continue;
      const std::string file = path("group_" + names[i] + ".mtx");
      Matrix matrix;
      if (!ReadMatrix(file, &matrix, error)) return false;
      if (matrix.rows() != term.group.matrix.rows() ||
          !matrix.isApprox(term.group.matrix, 1e-9)) {
        *error = file +
                 ": differs from the case's matrix of that group, expected a "
                 "baseline of the same structure in the same units";
        return false;
      }
    }
  }

  Table table;
  if (!ReadCsvTable(path("covariance.csv"), result.free, &table, error)) {
    return false;
  }
  const Eigen::Index size = static_cast<Eigen::Index>(result.free.size());
  if (table.values.rows() != size || !table.values.allFinite() ||
      !table.values.isApprox(table.values.transpose(), 1e-9)) {
    *error = path("covariance.csv") +
             ": is not the covariance of the free parameters in result.json";
    return false;
  }
  baseline->folder = folder;
  baseline->groups = {std::move(values), table.values(rows, rows)};
  baseline->parameter_names = result.names;
  baseline->parameter_values = result.values;
  return true;
}

}  // namespace pinode
