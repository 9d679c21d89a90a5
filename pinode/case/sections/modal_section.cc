#include "pinode/case/sections/modal_section.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pinode/case/sections/model_section.h"
#include "pinode/record/table.h"

namespace pinode {
namespace {

class ModeReader {
 public:
  // `hz`: cycles per unit of the model's time in one Hz.
  ModeReader(const TomlTable& table, const StructuralModel& model,
             ModalForm form, double hz, bool beside_records, MeasuredMode* mode)
      : table_(table),
        model_(model),
        form_(form),
        hz_(hz),
        beside_records_(beside_records),
        mode_(mode) {}

  bool Read() {
    if (!table_.RequireKey("frequency", "the measured frequency in Hz")) {
      return false;
    }
    mode_->frequency = hz_ * table_.PositiveNumber("frequency", 1.0);
    if (!ReadShape() ||
        !(form_ == ModalForm::kDynamicResidual ? ReadResidualWeight()
                                               : ReadWeights())) {
      return false;
    }
    ModalData alone;
    alone.form = form_;
    alone.modes = {*mode_};
    std::string error;
    return alone.IsValid(model_.num_dofs(), &error) ||
           table_.Fail(table_.Has("shape") ? "shape" : "frequency", error);
  }

 private:
  bool AddEntry(const TomlTable& table, const std::string& key,
                const std::string& name, double value) {
    int dof = -1;
    if (!FindDof(model_, table, key, name, false, &dof)) return false;
    mode_->dofs.push_back(dof);
    mode_->shape.conservativeResize(mode_->shape.size() + 1);
    mode_->shape[mode_->shape.size() - 1] = value;
    return true;
  }

  bool ReadShape() {
    const TomlValue* value = table_.Find("shape");
    if (value == nullptr) {
      return !table_.Has("shape_row") ||
             table_.Fail("shape_row", "'shape_row' needs 'shape'");
    }
    if (value->IsTable()) {
      if (table_.Has("shape_row")) {
        return table_.Fail("shape_row",
                           "'shape_row' needs a 'shape' in a file");
      }
      const TomlTable shape = table_.Table("shape", table_.name() + " shape");
      for (const auto& entry : shape.entries()) {
        const double number = shape.Number(entry.first, 0.0);
        if (!table_.errors()->ok() ||
            !AddEntry(shape, entry.first, entry.first, number)) {
          return false;
        }
      }
      return !mode_->dofs.empty() ||
             table_.Fail("shape", "'shape' is empty, expected {dof = value}");
    }
    if (value->type != TomlValue::Type::kString) {
      return table_.Fail("shape", "'shape' is " + value->Describe() +
                                      ", expected {dof = value, ...} or a CSV "
                                      "file with a column per DOF and a row "
                                      "per mode");
    }
    return ReadShapeFile();
  }

  bool ReadShapeFile() {
    const std::string file = table_.String("shape");
    const int row = table_.Integer("shape_row", 1, 1, 1000000000);
    if (!table_.errors()->ok()) return false;
    Table shapes;
    std::string error;
    if (!ReadCsvTable(ResolvePath(table_.errors()->path(), file), {}, &shapes,
                      &error)) {
      return table_.errors()->FailAsIs(error);
    }
    if (row > shapes.num_rows()) {
      return table_.Fail("shape_row", "'" + file + "' has " +
                                          std::to_string(shapes.num_rows()) +
                                          " rows, expected at least " +
                                          std::to_string(row));
    }
    for (size_t j = 0; j < shapes.columns.size(); ++j) {
      const double entry = shapes.values(row - 1, static_cast<int>(j));
      if (std::isnan(entry)) continue;  // not measured
      if (!AddEntry(table_, "shape", shapes.columns[j], entry)) return false;
    }
    return !mode_->dofs.empty() ||
           table_.Fail("shape", "row " + std::to_string(row) + " of '" + file +
                                    "' is empty, expected a shape");
  }

  // Reads one of <what>_sigma, <what>_weight.
  bool ReadWeight(const std::string& what, double unit, double* sigma,
                  double* weight) {
    const std::string sigma_key = what + "_sigma";
    const std::string weight_key = what + "_weight";
    if (table_.Has(sigma_key) && table_.Has(weight_key)) {
      return table_.Fail(weight_key, "expected one of '" + sigma_key +
                                         "' and '" + weight_key + "'");
    }
    if (beside_records_ && !table_.Has(sigma_key) && !table_.Has(weight_key)) {
      return table_.Fail(
          "frequency",
          "its errors must be known because the case has records, expected '" +
              sigma_key + "'");
    }
    if (table_.Has(sigma_key)) {
      *sigma = unit * table_.PositiveNumber(sigma_key, 1.0);
    }
    *weight = table_.PositiveNumber(weight_key, *weight);
    return table_.errors()->ok();
  }

  bool RefuseKeys(const std::vector<std::string>& keys,
                  const std::string& expected) {
    for (const std::string& key : keys) {
      if (!table_.Has(key)) continue;
      return table_.Fail(key, "'" + key + "' is not used in form '" +
                                  ModalFormName(form_) + "', expected " +
                                  expected);
    }
    return true;
  }

  bool ReadWeights() {
    if (!RefuseKeys({"residual_weight"},
                    "'frequency_weight' and 'shape_weight'") ||
        (form_ == ModalForm::kMac &&
         !RefuseKeys(
             {"shape_sigma", "shape_covariance", "frequency_shape_covariance"},
             "'shape_weight'")) ||
        !ReadWeight("frequency", hz_, &mode_->frequency_sigma,
                    &mode_->frequency_weight)) {
      return false;
    }
    if (mode_->HasShape() && table_.Has("shape_covariance")) {
      return ReadCovariance();
    }
    if (table_.Has("frequency_shape_covariance")) {
      return table_.Fail(
          "frequency_shape_covariance",
          "'frequency_shape_covariance' needs 'shape_covariance'");
    }
    const TomlValue* sigma = table_.Find("shape_sigma");
    if (mode_->HasShape() && sigma != nullptr && sigma->IsTable()) {
      return ReadEntrySigmas();
    }
    if (mode_->HasShape()) {
      return ReadWeight("shape", 1.0, &mode_->shape_sigma,
                        &mode_->shape_weight);
    }
    for (const char* key :
         {"shape_sigma", "shape_weight", "shape_covariance"}) {
      if (table_.Has(key)) {
        return table_.Fail(key, std::string("'") + key +
                                    "' without 'shape'. Give the shape, or "
                                    "remove '" +
                                    key + "'");
      }
    }
    return true;
  }

  // Reads a standard deviation for each entry: a covariance without
  // correlation.
  bool ReadEntrySigmas() {
    if (table_.Has("shape_weight")) {
      return table_.Fail("shape_weight",
                         "expected one of 'shape_sigma' and 'shape_weight'");
    }
    const TomlTable sigmas =
        table_.Table("shape_sigma", table_.name() + " shape_sigma");
    const std::vector<int>& dofs = mode_->dofs;
    Vector squares = Vector::Zero(static_cast<Eigen::Index>(dofs.size()));
    for (const auto& entry : sigmas.entries()) {
      int dof = -1;
      if (!FindDof(model_, sigmas, entry.first, entry.first, false, &dof)) {
        return false;
      }
      const auto place = std::find(dofs.begin(), dofs.end(), dof);
      if (place == dofs.end()) {
        return sigmas.Fail(entry.first, "'" + entry.first +
                                            "' is not in 'shape', expected "
                                            "its DOFs");
      }
      const double own = sigmas.PositiveNumber(entry.first, 1.0);
      squares[place - dofs.begin()] = own * own;
    }
    if (!table_.errors()->ok()) return false;
    for (size_t i = 0; i < dofs.size(); ++i) {
      if (squares[static_cast<Eigen::Index>(i)] > 0.0) continue;
      return table_.Fail("shape_sigma",
                         "'shape_sigma' has no deviation of '" +
                             model_.dof_names[static_cast<size_t>(dofs[i])] +
                             "', expected one for each DOF of 'shape'");
    }
    mode_->shape_covariance = squares.asDiagonal();
    return true;
  }

  // Reads rows of the covariance, in the order of the shape's entries.
  bool ReadCovariance() {
    if (!RefuseKeys({"shape_sigma", "shape_weight"}, "'shape_covariance'")) {
      return false;
    }
    const int count = static_cast<int>(mode_->shape.size());
    return ReadMatrixKey(table_, "shape_covariance",
                         "the covariance of the shape", count,
                         &mode_->shape_covariance) &&
           ReadFrequencyShapeCovariance(count);
  }

  // Reads the covariance of the frequency in Hz with the entries, in their
  // order.
  bool ReadFrequencyShapeCovariance(int count) {
    const char* key = "frequency_shape_covariance";
    if (!table_.Has(key)) return true;
    if (!table_.Has("frequency_sigma")) {
      return table_.Fail(key,
                         std::string("'") + key + "' needs 'frequency_sigma'");
    }
    mode_->frequency_shape_covariance =
        hz_ * ToVector(table_.Numbers(key, count, "entry of the shape"));
    return table_.errors()->ok();
  }

  bool ReadResidualWeight() {
    if (!RefuseKeys(
            {"frequency_sigma", "frequency_weight", "shape_sigma",
             "shape_weight", "shape_covariance", "frequency_shape_covariance"},
            "'residual_weight'")) {
      return false;
    }
    if (beside_records_ && !table_.Has("residual_weight")) {
      return table_.Fail("frequency",
                         "its errors must be known because the case has "
                         "records, expected 'residual_weight'");
    }
    mode_->residual_weight =
        table_.PositiveNumber("residual_weight", mode_->residual_weight);
    return table_.errors()->ok();
  }

  const TomlTable& table_;
  const StructuralModel& model_;
  const ModalForm form_;
  const double hz_;
  const bool beside_records_;
  MeasuredMode* mode_;
};

// Reads the values of covariates during the measurement of the modes.
bool ReadCovariates(const TomlTable& options,
                    const std::vector<InputSpec>& inputs, ModalData* modal) {
  const TomlTable covariates =
      options.Table("covariates", "[modal] covariates");
  modal->inputs = Vector::Zero(static_cast<Eigen::Index>(inputs.size()));
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].kind != InputSpec::Kind::kCovariate) continue;
    if (!covariates.RequireKey(inputs[i].name,
                               "its value while the modes were measured")) {
      return false;
    }
    modal->inputs[static_cast<Eigen::Index>(i)] =
        covariates.Number(inputs[i].name, 0.0);
  }
  return options.errors()->ok();
}

}  // namespace

bool AddModalCovariates(const TomlTable& root, std::vector<InputSpec>* inputs) {
  const TomlTable options = root.Table("modal", "[modal]");
  if (!root.errors()->ok() || !options.Has("covariates")) {
    return root.errors()->ok();
  }
  const TomlTable covariates =
      options.Table("covariates", "[modal] covariates");
  if (!root.errors()->ok()) return false;
  for (const auto& [name, value] : covariates.entries()) {
    const auto known =
        std::find_if(inputs->begin(), inputs->end(),
                     [n = name](const InputSpec& i) { return i.name == n; });
    if (known == inputs->end()) {
      inputs->push_back({InputSpec::Kind::kCovariate, 0, name});
    } else if (known->kind != InputSpec::Kind::kCovariate) {
      return covariates.Fail(name, "'" + name +
                                       "' is the name of an excitation, "
                                       "expected the name of a covariate");
    }
  }
  return true;
}

bool ReadModes(const TomlTable& root, const UnitSystem& units,
               const StructuralModel& model,
               const std::vector<InputSpec>& inputs, bool beside_records,
               ModalData* modal) {
  const TomlTable options = root.Table("modal", "[modal]");
  if (!options.AllowKeys()) return false;
  if (root.Has("modal") && !root.Has("mode")) {
    return root.Fail("modal", "[modal] needs at least one [[mode]]");
  }
  const std::string form = options.Choice(
      "form", {"mac", "eigenvector_difference", "dynamic_residual"},
      ModalFormName(modal->form));
  modal->form = form == "mac" ? ModalForm::kMac
                : form == "dynamic_residual"
                    ? ModalForm::kDynamicResidual
                    : ModalForm::kEigenvectorDifference;
  if (options.Has("covariates") && !ReadCovariates(options, inputs, modal)) {
    return false;
  }
  double seconds = 1.0;
  std::string error;
  if (!UnitFactor("s", Dimension::kTime, units, &seconds, &error)) {
    return root.errors()->Fail(0, error);
  }
  std::set<std::string> seen;
  for (TomlTable& table : root.Tables("mode")) {
    if (!table.AllowKeys()) {
      return false;
    }
    MeasuredMode mode;
    mode.name = table.String("name", std::to_string(modal->modes.size() + 1));
    table.set_name("mode '" + mode.name + "'");
    if (!seen.insert(mode.name).second) {
      return table.Fail("name",
                        "this name is used twice, expected different names");
    }
    if (!ModeReader(table, model, modal->form, 1.0 / seconds, beside_records,
                    &mode)
             .Read()) {
      return false;
    }
    modal->modes.push_back(std::move(mode));
  }
  if (!root.errors()->ok()) return false;
  return modal->IsValid(model.num_dofs(), &error) || root.Fail("mode", error);
}

}  // namespace pinode
