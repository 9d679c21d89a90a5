#include "pinode/case/results/baseline_folder.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/case/results/same_structure.h"
#include "pinode/case/results/verdict_json.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/record/table.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;
using Target = MatrixGroup::Target;

// Returns the index of a name; -1 if it is missing.
Eigen::Index IndexOf(const std::vector<std::string>& names,
                     const std::string& name) {
  const auto position = std::find(names.begin(), names.end(), name);
  return position == names.end() ? -1 : position - names.begin();
}

void AppendTo(Vector* values, double value) {
  values->conservativeResize(values->size() + 1);
  values->tail(1)[0] = value;
}

// Part of result.json that baselines need.
struct Result {
  std::vector<std::string> names;  // of all parameters
  Vector values;
  std::vector<std::string> free;  // the free ones, in the covariance's order
  // Unknown that another one follows, and the factor.
  std::map<std::string, std::pair<std::string, double>> ties;
  std::vector<std::string> undetermined;
  Doubts doubts;  // as in Baseline
  std::vector<MotionLevel> levels;
  bool has_records = true;
};

double NumberOr(const Json& object, const char* key, double otherwise) {
  const Json value = object.value(key, Json());
  return value.is_number() ? value.get<double>() : otherwise;
}

// Reads what DoubtsOf asks of a result. Results of earlier versions have less.
IdentificationSummary DoubtsIn(const Json& json) {
  IdentificationSummary summary;
  std::vector<Finding> findings;
  for (const Json& finding : json.value("findings", Json::array())) {
    if (!finding.is_object()) continue;
    Finding read;
    const Json check = finding.value("check", Json());
    if (check.is_string()) read.check = check;
    if (finding.value("grade", Json()) == GradeName(Grade::kWithCare)) {
      read.grade = Grade::kWithCare;
    }
    findings.push_back(std::move(read));
  }
  summary.verdict = Verdict(std::move(findings));
  for (const Json& parameter : json["parameters"]) {
    ParameterEstimate estimate;
    estimate.name = parameter["name"];
    estimate.value = parameter["value"];
    estimate.lower95 = NumberOr(parameter, "lower95", estimate.value);
    estimate.upper95 = NumberOr(parameter, "upper95", estimate.value);
    estimate.half_width95 = NumberOr(parameter, "half_width95", 0.0);
    summary.parameters.push_back(std::move(estimate));
  }
  for (const Json& explanation : json.value("explanations", Json::array())) {
    if (!explanation.is_object()) continue;
    Explanation read;
    read.log_odds = NumberOr(explanation, "log_odds", 0.0);
    read.leaves = NumberOr(explanation, "leaves", kNaN);
    const Json kind = explanation.value("kind", Json());
    const Json place = explanation.value("place", Json());
    if (kind.is_string() && place.is_string()) {
      read.kind = kind;
      read.place = place;
    }
    for (const Json& value : explanation.value("values", Json::array())) {
      if (!value.is_object() || !value.value("name", Json()).is_string()) {
        continue;
      }
      read.values.push_back({value["name"], NumberOr(value, "value", kNaN),
                             NumberOr(value, "lower95", kNaN),
                             NumberOr(value, "upper95", kNaN)});
    }
    summary.explanations.push_back(std::move(read));
  }
  return summary;
}

// Reads the levels of motion. Results of earlier versions have none.
std::vector<MotionLevel> LevelsIn(const Json& json) {
  std::vector<MotionLevel> levels;
  for (const Json& level : json.value("levels_of_motion", Json::array())) {
    if (!level.is_object()) continue;
    MotionLevel read;
    const Json dof = level.value("dof", Json());
    const Json quantity = level.value("quantity", Json());
    const Json unit = level.value("unit", Json());
    if (!dof.is_string() || !quantity.is_string() || !unit.is_string()) {
      continue;
    }
    read.dof = dof;
    read.quantity = quantity;
    read.unit = unit;
    read.lowest = NumberOr(level, "lowest", 0.0);
    read.mean = NumberOr(level, "mean", 0.0);
    read.highest = NumberOr(level, "highest", 0.0);
    levels.push_back(std::move(read));
  }
  return levels;
}

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
  bool usable = false;
  if (!ReadUsable(json, &usable, error)) {
    *error = path + ": " + *error;
    return false;
  }
  if (!usable) {
    *error = path + ": the result is not usable (" +
             json.value("message", std::string()) +
             "), expected the usable result of a baseline record";
    return false;
  }
  std::vector<double> values;
  for (const Json& parameter : json["parameters"]) {
    if (!parameter.is_object() ||
        !parameter.value("name", Json()).is_string() ||
        !parameter.value("value", Json()).is_number() ||
        !parameter.value("free", Json()).is_boolean()) {
      *error =
          path +
          ": a parameter has no name, value or 'free'; run pinode_update again";
      return false;
    }
    result->names.push_back(parameter["name"]);
    values.push_back(parameter["value"]);
    if (parameter["free"] == true) result->free.push_back(parameter["name"]);
    const Json tie = parameter.value("tie", Json());
    if (tie.is_string() && !tie.get<std::string>().empty()) {
      result->ties[parameter["name"]] = {
          tie, NumberOr(parameter, "tie_factor", 1.0)};
    }
  }
  const Json undetermined = json.value("undetermined", Json::array());
  for (const Json& direction : undetermined) {
    if (direction.is_string()) result->undetermined.push_back(direction);
  }
  result->values = Eigen::Map<const Vector>(
      values.data(), static_cast<Eigen::Index>(values.size()));
  result->doubts = DoubtsOf(DoubtsIn(json));
  result->levels = LevelsIn(json);
  result->has_records =
      !json.value("records", Json()).empty() || json.contains("ambient");
  return true;
}

// Returns the file with the updated matrix of a case, which depends on a
// renewed basis.
std::string MatrixFile(const std::string& folder, Target target,
                       bool renews_basis) {
  const char* letter = target == Target::kMass      ? "M"
                       : target == Target::kDamping ? "C"
                                                    : "K";
  return (std::filesystem::path(folder) /
          (std::string(letter) + (renews_basis ? "_full.mtx" : ".mtx")))
      .string();
}

// Reads offsets from the updated matrices of the folder, see FindOffsets.
bool ReadOffsets(const std::string& folder, const Case& c, const Result& result,
                 const std::vector<std::string>& names, Vector* offsets,
                 std::string* error) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  for (const ComparedMatrix& compared : ComparedMatrices(c)) {
    const std::string path =
        MatrixFile(folder, compared.target, RenewsBasis(c));
    SparseMatrix own;
    if (!ReadMatrixMarket(path, &own, error)) return false;
    for (size_t j = 0; j < compared.groups.size(); ++j) {
      const SparseMatrix& group = compared.groups[j];
      const Eigen::Index value =
          IndexOf(result.names, dynamics.groups()[j].group.name);
      // The matrix excludes groups that follow time or a covariate. If the case
      // does not free a group, its value has to be the same.
      if (dynamics.groups()[j].follows == GroupTerm::Follows::kNothing &&
          value >= 0 && group.rows() == own.rows() &&
          group.cols() == own.cols()) {
        own = SparseMatrix(own - result.values[value] * group);
      }
    }
    if (!FindOffsets(path, own, dynamics, compared, names, offsets, error)) {
      return false;
    }
  }
  return true;
}

// Reads the [[group]] tables of a model.toml by name.
bool ReadGroupTables(const std::string& path,
                     std::map<std::string, TomlValue>* groups,
                     std::string* error) {
  std::string text;
  TomlValue root;
  if (!ReadTextFile(path, &text, error) ||
      !ParseToml(text, path, &root, error)) {
    return false;
  }
  const TomlValue* tables = root.Find("group");
  if (tables == nullptr || !tables->IsArrayOfTables()) return true;
  for (const TomlValue& table : tables->elements) {
    const TomlValue* name = table.Find("name");
    if (name != nullptr) groups->emplace(name->text, table);
  }
  return true;
}

// Checks that the baseline's matrices have the DOFs of the case in the same
// order. A text without a list of DOFs passes.
bool HasSameOrder(const std::string& path, const StructuralModel& model,
                  std::string* error) {
  std::string text;
  TomlValue root;
  if (!ReadTextFile(path, &text, error) ||
      !ParseToml(text, path, &root, error)) {
    return false;
  }
  const TomlValue* table = root.Find("model");
  const TomlValue* dofs = table != nullptr ? table->Find("dofs") : nullptr;
  if (dofs == nullptr || dofs->type != TomlValue::Type::kArray) return true;
  std::vector<std::string> names;
  for (const TomlValue& dof : dofs->elements) names.push_back(dof.text);
  if (names == model.dof_names || names.size() != model.dof_names.size() ||
      !std::is_permutation(names.begin(), names.end(),
                           model.dof_names.begin())) {
    return true;
  }
  *error = path +
           ": has the DOFs of the case in another order. Name them in the same "
           "order in both cases, then run pinode_update on the baseline's case "
           "again";
  return false;
}

// Returns the shares of the groups in the matrices of the baseline's own case,
// minus one. In its model.toml, whose groups begin at zero again, these include
// `values`.
Vector PresentOf(const std::map<std::string, TomlValue>& groups,
                 const std::vector<std::string>& names, const Vector& values) {
  Vector present = Vector::Zero(values.size());
  for (size_t i = 0; i < names.size(); ++i) {
    const auto table = groups.find(names[i]);
    if (table == groups.end()) continue;
    const TomlValue* now = table->second.Find("present");
    if (now == nullptr || !now->IsNumber()) continue;
    const auto row = static_cast<Eigen::Index>(i);
    present[row] = now->number - values[row] - 1.0;
  }
  return present;
}

// Returns how the group of a table follows a covariate (FollowingText);
// "nothing" if it does not.
std::string FollowingOf(const TomlValue& table) {
  const TomlValue* follows = table.Find("follows");
  const TomlValue* covariate =
      follows != nullptr ? follows->Find("covariate") : nullptr;
  if (covariate == nullptr) return "nothing";
  const TomlValue* reference = follows->Find("reference");
  const TomlValue* knots = follows->Find("knots");
  std::vector<double> places;
  if (knots != nullptr) {
    for (const TomlValue& knot : knots->elements) {
      places.push_back(knot.number);
    }
  }
  return FollowingText(covariate->text,
                       reference != nullptr ? reference->number : 0.0, places);
}

// True if the group's matrix in the folder is that of the case.
bool SameGroup(const std::string& folder, const Case& c,
               const std::string& name, std::string* error) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  for (size_t j = 0; j < dynamics.groups().size(); ++j) {
    const GroupTerm& term = dynamics.groups()[j];
    if (term.group.name != name ||
        (RenewsBasis(c) && (c.finite_element->groups[j].matrix.rows() > 0 ||
                            c.finite_element->groups[j].in_basis !=
                                ReducedStructure::Group::InBasis::kSame))) {
      continue;
    }
    const std::string file =
        (std::filesystem::path(folder) / ("group_" + name + ".mtx")).string();
    Matrix matrix;
    if (!ReadMatrix(file, &matrix, error)) return false;
    if (matrix.rows() != term.group.matrix.rows() ||
        !matrix.isApprox(term.group.matrix, 1e-9)) {
      *error = file +
               ": differs from the matrix of this group in the case, expected "
               "a baseline of the same structure in the same units";
      return false;
    }
  }
  return true;
}

// Reads the parameters by which groups follow covariates, if both cases have
// them for the same matrix and in the same way.
bool ReadFollowers(const std::string& folder, const Case& c,
                   const std::map<std::string, TomlValue>& groups,
                   const Result& result, Baseline* read, std::string* error) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  std::map<std::string, std::string> group_of;
  for (const GroupCurve& curve : dynamics.group_curves()) {
    for (const Parameter& knot : curve.parameters.parameters) {
      group_of[knot.name] = curve.name;
    }
  }
  for (const auto& [name, following] : FollowingTexts(dynamics)) {
    if (IndexOf(result.names, name) < 0) continue;
    const std::string group =
        group_of.count(name) > 0 ? group_of.at(name) : name;
    const auto table = groups.find(group);
    const std::string found =
        table == groups.end() ? "nothing" : FollowingOf(table->second);
    if (found != following) {
      *error = (std::filesystem::path(folder) / "model.toml").string() +
               ": group '" + group + "' follows " + found + ", expected " +
               following + " as in the case";
      return false;
    }
    if (!SameGroup(folder, c, group, error)) return false;
    if (IndexOf(result.free, name) < 0) continue;
    read->followers.push_back(name);
    read->following.push_back(following);
  }
  return true;
}

// A change of a group means another one where other groups follow it.
bool HasSameTies(const std::string& path, const StructuralDynamics& dynamics,
                 const Result& result, std::string* error) {
  for (const GroupTerm& group : dynamics.groups()) {
    const Parameter& present = group.alpha;
    const auto found = result.ties.find(present.name);
    const std::pair<std::string, double> before =
        found == result.ties.end() ? std::pair<std::string, double>()
                                   : found->second;
    if (present.tie == before.first &&
        (!present.IsTied() || present.tie_factor == before.second)) {
      continue;
    }
    const auto follows = [](const std::string& source, double factor) {
      return source.empty() ? std::string("follows no other")
                            : "follows " + FormatNumber(factor) + " times '" +
                                  source + "'";
    };
    *error = path + ": group '" + present.name + "' " +
             follows(before.first, before.second) + " there and " +
             follows(present.tie, present.tie_factor) +
             " in the case; make both alike";
    return false;
  }
  return true;
}

// Reads the records of the baseline with the identified model.
void ReadFit(const std::string& path, Baseline* baseline) {
  Case healthy;
  std::string error;
  if (!ReadCase(path, &healthy, &error)) {
    baseline->why_no_fit = error;
    return;
  }
  HealthyFit fit;
  fit.problem = std::move(healthy.problem);
  fit.options = healthy.options;
  baseline->fit = std::make_shared<const HealthyFit>(std::move(fit));
}

}  // namespace

bool ReadBaseline(const std::string& folder, const Case& c, Baseline* baseline,
                  std::string* error) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  const std::vector<std::string> names = FreeGroups(dynamics);
  const auto path = [&folder](const std::string& name) {
    return (std::filesystem::path(folder) / name).string();
  };
  std::error_code unused;
  if (!std::filesystem::exists(path("result.json"), unused)) {
    *error = folder +
             (std::filesystem::is_directory(folder, unused)
                  ? ": has no result.json"
                  : ": there is no such folder") +
             ", expected the result folder of a fit by pinode_update";
    return false;
  }
  Result result;
  if (!ReadResult(path("result.json"), &result, error)) return false;

  // The same groups of the same structure.
  if (!RenewsBasis(c) &&
      !HasSameOrder(path("model.toml"), dynamics.model(), error)) {
    return false;
  }
  std::vector<int> rows;
  Vector values(static_cast<Eigen::Index>(names.size()));
  for (size_t i = 0; i < names.size(); ++i) {
    const Eigen::Index row = IndexOf(result.free, names[i]);
    if (row < 0) {
      *error = path("result.json") + ": group '" + names[i] +
               "' of the case is not free there, expected a baseline with the "
               "same free groups";
      return false;
    }
    rows.push_back(static_cast<int>(row));
    values[static_cast<Eigen::Index>(i)] =
        result.values[IndexOf(result.names, names[i])];
    if (!SameGroup(folder, c, names[i], error)) return false;
  }

  if (!HasSameTies(path("result.json"), dynamics, result, error)) return false;

  Vector offsets = Vector::Zero(values.size());
  if (!ReadOffsets(folder, c, result, names, &offsets, error)) return false;

  std::map<std::string, TomlValue> groups;
  if (!ReadGroupTables(path("model.toml"), &groups, error)) return false;
  const Vector present = PresentOf(groups, names, values);
  if (!IsAsPresent(path("model.toml"), dynamics, names, present, offsets,
                   error)) {
    return false;
  }
  Table table;
  std::vector<std::string> columns;
  for (const std::string& name : result.free) columns.push_back(CsvText(name));
  if (!ReadCsvTable(path("covariance.csv"), columns, &table, error)) {
    return false;
  }
  const Eigen::Index size = static_cast<Eigen::Index>(result.free.size());
  if (table.values.rows() != size || !table.values.allFinite() ||
      !table.values.isApprox(table.values.transpose(), 1e-9)) {
    *error = path("covariance.csv") +
             ": is not the covariance of the free parameters in result.json";
    return false;
  }
  Baseline read;
  read.name = folder;
  read.group_names = names;
  read.groups = {values + present, table.values(rows, rows)};
  read.with_followers.values = read.groups.values;
  if (!ReadFollowers(folder, c, groups, result, &read, error)) return false;
  for (const std::string& follower : read.followers) {
    rows.push_back(static_cast<int>(IndexOf(result.free, follower)));
    AppendTo(&read.with_followers.values,
             result.values[IndexOf(result.names, follower)]);
  }
  read.with_followers.covariance = table.values(rows, rows);
  read.undetermined = result.undetermined;
  read.doubts = std::move(result.doubts);
  read.levels = std::move(result.levels);
  read.has_records = result.has_records;
  read.offsets = std::move(offsets);
  read.parameter_names = result.names;
  read.parameter_values = result.values;
  const bool modes_alone =
      c.problem.num_train_records() == 0 && !c.problem.HasSpectra();
  if (!c.damage.masses.empty() || !c.damage.springs.empty() ||
      c.damage.damping || c.damage.stiffness || modes_alone) {
    ReadFit(path("model.toml"), &read);
  }
  *baseline = std::move(read);
  return true;
}

}  // namespace pinode
