#include "pinode/case/results/model_case.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/case/results/model_files.h"
#include "pinode/case/sections/case_folder.h"
#include "pinode/case/sections/force_scale_section.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/structure/matrices/matrix_io.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

class ModelCaseWriter {
 public:
  // Keeps `c`'s dynamics and sensors with the identified values.
  ModelCaseWriter(const Case& c, const IdentifiedModel& model,
                  std::string folder, std::string final_folder,
                  std::string* error)
      : c_(c),
        dynamics_(*c.problem.dynamics),
        folder_(std::move(folder)),
        final_folder_(std::move(final_folder)),
        error_(error),
        root_(*c.source) {
    dynamics_.SetParameters(model.parameters.head(dynamics_.num_parameters()));
    sensors_ = c.problem.sensors;
    sensors_.SetValues(model.parameters.tail(sensors_.size()));
  }

  bool Write() {
    SetMatrices();
    SetNetworks();
    return WriteModelFiles(dynamics_, folder_, error_) && WriteGroups() &&
           SetElements() && SetLibraries() && SetForces() && SetRecords() &&
           SetModes() && SetFrfs() && SetReferenceCurves() && SetGeometry() &&
           WriteArrays() &&
           WriteFileAtomically(Path("model.toml"),
                               "# The model after the identification. The "
                               "original case explains the keys.\n" +
                                   FormatToml(root_),
                               error_);
  }

 private:
  std::string Path(const std::string& name) const {
    return (fs::path(folder_) / name).string();
  }

  void SetMatrices() {
    const StructuralModel updated =
        dynamics_.CorrectedModel(dynamics_.Parameters());
    TomlValue& model = *root_.Find("model");
    model.Set("dofs", TomlValue::Strings(updated.dof_names));
    model.Erase("shear_building");
    if (c_.finite_element != nullptr) SetReducedModel(updated, &model);
    model.Set("mass", TomlValue::String("M.mtx"));
    model.Set("stiffness", TomlValue::String("K.mtx"));
    model.Set("damping", TomlValue::String("C.mtx"));
  }

  // Writes the result of [model.finite_element] and [model.reduction].
  static void SetReducedModel(const StructuralModel& reduced,
                              TomlValue* model) {
    model->Erase("finite_element");
    model->Erase("reduction");
    TomlValue influence = TomlValue::Table();
    TomlValue coupling = TomlValue::Table();
    for (int d = 0; d < reduced.num_directions(); ++d) {
      const std::string& name = reduced.directions[static_cast<size_t>(d)];
      const Vector r = reduced.influence.col(d);
      const Vector m = reduced.support_mass_coupling.col(d);
      influence.Set(name, TomlValue::Numbers({r.begin(), r.end()}));
      coupling.Set(name, TomlValue::Numbers({m.begin(), m.end()}));
    }
    model->Set("influence", influence);
    model->Set("support_mass_coupling", coupling);
  }

  bool WriteGroups() {
    for (size_t j = 0; j < dynamics_.groups().size(); ++j) {
      const GroupTerm& term = dynamics_.groups()[j];
      const std::string file = "group_" + term.group.name + ".mtx";
      TomlValue& table = root_.Find("group")->elements[j];
      for (const char* key :
           {"between", "storey", "scale", "proportional_to", "mode",
            "modes_from", "ratio", "changed_export", "set_export", "factor"}) {
        table.Erase(key);
      }
      table.Set("matrix", TomlValue::String(file));
      if (!WriteMatrixMarket(Path(file), term.group.matrix, error_)) {
        return false;
      }
      SetCurve(term.group.name, table.Find("follows"));
      const double taken =
          term.follows == GroupTerm::Follows::kNothing ? term.alpha.value : 0.0;
      table.Set("present", TomlValue::Float(term.present + taken));
      if (term.alpha.IsTied()) {
        const bool is_taken = term.follows == GroupTerm::Follows::kNothing;
        if (IsTaken(term.alpha.tie) == is_taken) continue;
        Untie(&table);
      }
      table.Set("initial", TomlValue::Float(term.alpha.value - taken));
      if (std::isfinite(term.alpha.lower)) {
        table.Set("lower", TomlValue::Float(term.alpha.lower - taken));
      }
      if (std::isfinite(term.alpha.upper)) {
        table.Set("upper", TomlValue::Float(term.alpha.upper - taken));
      }
      if (term.alpha.HasPrior()) {
        table.Set("prior_mean",
                  TomlValue::Float(term.alpha.prior_mean - taken));
      }
    }
    return true;
  }

  // Writes changes of alpha at the knots, including the reference.
  void SetCurve(const std::string& group, TomlValue* follows) const {
    for (const GroupCurve& curve : dynamics_.group_curves()) {
      if (curve.name != group) continue;
      const Vector found = curve.parameters.Values();
      std::vector<double> values(found.begin(), found.end());
      values.insert(values.begin() + curve.reference, 0.0);
      follows->Set("values", TomlValue::Numbers(values));
    }
  }

  // True if this is a group whose identified alpha the matrices contain. Its
  // alpha begins at 0 again.
  bool IsTaken(const std::string& name) const {
    const auto& groups = dynamics_.groups();
    return std::any_of(groups.begin(), groups.end(), [&](const GroupTerm& g) {
      return g.group.name == name && g.follows == GroupTerm::Follows::kNothing;
    });
  }

  // Fixes an unknown that is tied, because its source begins anew and it does
  // not, or the other way round.
  static void Untie(TomlValue* keys) {
    keys->Erase("tie");
    keys->Erase("tie_factor");
    keys->Set("free", TomlValue::Boolean(false));
  }

  // Writes the identified value, divided by `factor`, in a table of parameter
  // keys.
  void SetParameter(const Parameter& parameter, double factor,
                    TomlValue* keys) const {
    if (parameter.IsTied()) {
      if (!IsTaken(parameter.tie)) return;
      Untie(keys);
    }
    keys->Set("initial", TomlValue::Float(parameter.value / factor));
    // The default would be the initial value, which is no longer that of the
    // prior.
    if (parameter.HasPrior()) {
      keys->Set("prior_mean", TomlValue::Float(parameter.prior_mean / factor));
    }
  }

  bool SetElements() {
    for (size_t j = 0; j < dynamics_.laws().size(); ++j) {
      const LawTerm& term = dynamics_.laws()[j];
      // These follow the elements.
      if (term.type == "library" || term.type == kMemoryNetworkType) break;
      TomlValue& table = root_.Find("element")->elements[j];
      MovePath(&table);
      TomlValue* parameters = table.Find("parameters");
      if (parameters == nullptr) continue;
      for (const Parameter& parameter : term.parameters.parameters) {
        TomlValue* keys =
            parameters->Find(parameter.name.substr(term.name.size() + 1));
        // A bare number is fixed.
        if (keys != nullptr && keys->IsTable()) {
          SetParameter(parameter, 1.0, keys);
        }
      }
    }
    return true;
  }

  bool SetLibraries() {
    size_t index = 0;
    for (const LawTerm& term : dynamics_.laws()) {
      if (term.type != "library") continue;
      TomlValue* terms = root_.Find("library")->elements[index++].Find("terms");
      CHECK(terms != nullptr);
      for (size_t k = 0; k < terms->elements.size(); ++k) {
        TomlValue& value = terms->elements[k];
        if (!value.IsTable()) {
          TomlValue table = TomlValue::Table();
          table.Set("basis", value);
          value = table;
        }
        SetParameter(term.parameters.parameters[k], 1.0, &value);
      }
    }
    return true;
  }

  bool SetForces() {
    for (size_t j = 0; j < dynamics_.unknown_forces().size(); ++j) {
      const UnknownForceTerm& term = dynamics_.unknown_forces()[j];
      TomlValue& table = root_.Find("unknown_force")->elements[j];
      const auto* spline = dynamic_cast<const SplineForce*>(term.history.get());
      if (spline != nullptr) {
        const Vector values =
            spline->options().scale * term.parameters.Values();
        table.Set("values", TomlValue::Numbers(std::vector<double>(
                                values.begin(), values.end())));
        continue;
      }
      for (const Parameter& parameter : term.parameters.parameters) {
        const std::string key = parameter.name.substr(term.name.size() + 1);
        TomlValue* keys = table.Find("parameters")->Find(key);
        if (keys == nullptr || !keys->IsTable()) continue;
        SetParameter(parameter,
                     key == "amplitude"
                         ? 1.0
                         : c_.problem.description.HzPerModelFrequency(),
                     keys);
      }
    }
    return true;
  }

  // The files describe the networks; those with memory hold their weights.
  void SetNetworks() {
    if (root_.Find("network") == nullptr) return;
    size_t j = 0;
    for (TomlValue& table : root_.Find("network")->elements) {
      if (table.Find("memory") != nullptr) {
        SetMemory(&table);
        continue;
      }
      for (const char* key : {"layers", "activation", "bias", "skip", "gauge",
                              "input_scale", "output_scale"}) {
        table.Erase(key);
      }
      table.Set("weights",
                TomlValue::String(NetworkFileName(dynamics_.networks()[j])));
      ++j;
    }
  }

  void SetMemory(TomlValue* table) const {
    for (const LawTerm& term : dynamics_.laws()) {
      const MemoryNetwork* network = AsMemoryNetwork(term);
      if (network == nullptr || term.name != table->Find("name")->text) {
        continue;
      }
      // Without training records no scale was set, and 1 is in use.
      const MemoryNetworkShape& shape = network->scaled_shape();
      const Vector values = term.parameters.Values();
      table->Erase("seed");
      table->Set("input_scale",
                 TomlValue::Numbers({shape.deformation, shape.rate}));
      table->Set("output_scale", TomlValue::Numbers({shape.force}));
      table->Set("values", TomlValue::Numbers({values.begin(), values.end()}));
    }
  }

  void MovePath(TomlValue* table, const char* key = "file") const {
    TomlValue* file = table->Find(key);
    if (file != nullptr) MoveName(file);
  }

  void MoveName(TomlValue* file) const {
    if (file->type != TomlValue::Type::kString ||
        (c_.data != nullptr && c_.data->Has(file->text))) {
      return;
    }
    std::error_code status;
    const fs::path from = fs::weakly_canonical(
        fs::absolute(ResolvePath(c_.path, file->text), status), status);
    fs::path to = from.lexically_proximate(
        fs::weakly_canonical(fs::absolute(final_folder_, status), status));
    if (to.empty()) to = from;
    *file = TomlValue::String(to.string());
  }

  bool SetRecords() {
    if (root_.Find("record") == nullptr) return true;
    std::vector<TomlValue>& tables = root_.Find("record")->elements;
    // Ambient records are stored separately in the problem, and their sensors
    // are ideal.
    size_t r = 0;
    for (TomlValue& table : tables) {
      MovePath(&table);
      for (const char* key :
           {"ground", "force", "motion", "covariate", "channel"}) {
        TomlValue* signals = table.Find(key);
        if (signals == nullptr) continue;
        for (TomlValue& signal : signals->elements) {
          MovePath(&signal);
          if (std::string(key) == "force") SetScale(&signal);
        }
      }
      const TomlValue* excitation = table.Find("excitation");
      if (excitation != nullptr && excitation->text == "ambient") continue;
      TomlValue* channels = table.Find("channel");
      CHECK(channels != nullptr &&
            channels->elements.size() == c_.problem.records[r].channels.size());
      for (size_t i = 0; i < channels->elements.size(); ++i) {
        SetSensor(r, i, &channels->elements[i]);
      }
      ++r;
    }
    return true;
  }

  bool SetModes() {
    TomlValue* modes = root_.Find("mode");
    if (modes == nullptr) return true;
    for (TomlValue& mode : modes->elements) {
      MovePath(&mode, "shape");
      MovePath(&mode, "shape_covariance");
      TomlValue* covariance = mode.Find("shape_covariance");
      if (covariance != nullptr && covariance->IsTable()) MovePath(covariance);
    }
    return true;
  }

  // Sets where the files are, and the sensors. One key describes the gains of
  // all responses, so it has their mean, from which a fit can begin.
  bool SetFrfs() {
    TomlValue* tables = root_.Find("frf");
    if (tables == nullptr) return true;
    for (size_t i = 0; i < tables->elements.size(); ++i) {
      TomlValue& table = tables->elements[i];
      for (TomlValue& file : table.Find("files")->elements) MoveName(&file);
      if (i >= c_.problem.frfs.size()) continue;
      const FrfRecord& record = c_.problem.frfs[i];
      SetMean("gain", record.gains, 1.0, &table);
      SetMean("delay", record.delays,
              c_.problem.description.HzPerModelFrequency(), &table);
      SetMean("loss_factor", {record.loss_factor}, 1.0, &table);
    }
    return true;
  }

  // Sets the unknown `key` to the mean of these sensor parameters, over
  // `factor`.
  void SetMean(const char* key, const std::vector<int>& indices, double factor,
               TomlValue* table) const {
    TomlValue* keys = table->Find(key);
    if (keys == nullptr || indices.empty() || indices.front() < 0) return;
    Parameter parameter =
        sensors_.parameters[static_cast<size_t>(indices.front())];
    double sum = 0.0;
    for (const int index : indices) {
      sum += sensors_.parameters[static_cast<size_t>(index)].value;
    }
    parameter.value = sum / static_cast<double>(indices.size());
    SetParameter(parameter, factor, keys);
  }

  bool SetReferenceCurves() {
    TomlValue* curves = root_.Find("reference_curve");
    if (curves == nullptr) return true;
    for (TomlValue& curve : curves->elements) MovePath(&curve);
    return true;
  }

  // DOFs that a reduction has removed need no place.
  bool SetGeometry() {
    TomlValue* geometry = root_.Find("geometry");
    if (geometry == nullptr) return true;
    MovePath(geometry);
    TomlValue* dofs = geometry->Find("dofs");
    if (dofs == nullptr) return true;
    const std::vector<std::string>& names = dynamics_.model().dof_names;
    const std::vector<TomlValue::Entry> placed = dofs->entries;
    for (const auto& [dof, place] : placed) {
      if (std::find(names.begin(), names.end(), dof) == names.end()) {
        dofs->Erase(dof);
      }
    }
    return true;
  }

  // Writes the records of a case that was made in memory.
  bool WriteArrays() {
    return c_.data == nullptr ||
           WriteCaseData(*c_.data, folder_, &root_, error_);
  }

  void SetScale(TomlValue* force) const {
    const std::string name = ForceScaleName(*force);
    for (const ForceScaleTerm& term : dynamics_.force_scales()) {
      if (term.name != name) continue;
      SetParameter(term.parameters.parameters[0], 1.0, force->Find("scale"));
    }
  }

  void SetSensor(size_t r, size_t i, TomlValue* table) const {
    const MeasuredChannel& channel = c_.problem.records[r].channels[i];
    const auto set = [&](const char* key, int index, double factor) {
      TomlValue* keys = table->Find(key);
      if (index < 0 || keys == nullptr) return;
      SetParameter(sensors_.parameters[static_cast<size_t>(index)], factor,
                   keys);
    };
    set("gain", channel.gain, 1.0);
    set("offset", channel.offset,
        c_.problem.records[r].channels[i].description.factor);
    set("delay", channel.delay, c_.problem.description.HzPerModelFrequency());
  }

  const Case& c_;
  StructuralDynamics dynamics_;
  ParameterBlock sensors_;
  const std::string folder_;
  const std::string final_folder_;
  std::string* error_;
  TomlValue root_;
};

}  // namespace

bool WriteModelCase(const Case& c, const IdentifiedModel& model,
                    const std::string& folder, const std::string& final_folder,
                    std::string* error) {
  return ModelCaseWriter(c, model, folder, final_folder, error).Write();
}

}  // namespace pinode
