#include "pinode/case/sections/plan_section.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/observation.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/problem_description.h"

namespace pinode {
namespace {

// Largest number of names that are compared for a hint, which must be quick.
constexpr size_t kMostHinted = 5000;

// True for the name of a rotation, "12.4" to "12.6".
bool IsRotation(const std::string& name) {
  const std::string plain = name.substr(0, name.find('#'));
  const size_t point = plain.rfind('.');
  return point != std::string::npos && point + 2 == plain.size() &&
         plain[point + 1] >= '4' && plain[point + 1] <= '6';
}

// Possible places of sensors, and their observation of the coordinates.
class Places {
 public:
  Places(const StructuralDynamics& dynamics, const ReducedStructure* structure)
      : dynamics_(dynamics), structure_(structure) {}

  const std::vector<std::string>& names() const {
    return structure_ != nullptr ? structure_->exported.dof_names
                                 : dynamics_.model().dof_names;
  }

  // Returns the weights of the coordinates at a DOF; empty if it cannot move or
  // its motion is prescribed.
  Vector Weights(size_t dof) const {
    const auto row = static_cast<Eigen::Index>(dof);
    const Vector weights =
        structure_ != nullptr
            ? Vector(structure_->expansion.row(row).transpose())
            : Vector(Vector::Unit(dynamics_.num_dofs(), row));
    if (weights.isZero(0.0)) return Vector();
    for (const PrescribedDof& held : dynamics_.prescribed()) {
      if (weights[held.dof] != 0.0) return Vector();
    }
    return weights;
  }

 private:
  const StructuralDynamics& dynamics_;
  const ReducedStructure* structure_;
};

class PlanReader {
 public:
  PlanReader(const TomlTable& root, const UnitSystem& units,
             const ReducedStructure* structure,
             const std::vector<RecordSection>& sections,
             const IdentificationProblem& problem, SensorRequest* request)
      : table_(root.Table("plan", "[plan]")),
        units_(units),
        places_(*problem.dynamics, structure),
        sections_(sections),
        problem_(problem),
        request_(request) {}

  bool Read() {
    if (!table_.AllowKeys()) {
      return false;
    }
    using Criterion = SensorPlanOptions::Criterion;
    request_->options.criterion =
        table_.Choice("criterion", {"determinant", "worst_deviation"},
                      "determinant") == "determinant"
            ? Criterion::kDeterminant
            : Criterion::kWorstDeviation;
    request_->options.keep_own = table_.Boolean("keep_own", false);
    return table_.errors()->ok() && ReadParameters() && ReadDurations() &&
           ReadExcite() && ReadCandidates() && ReadOwn();
  }

 private:
  bool ReadParameters() {
    const ParameterLayout layout(problem_);
    std::vector<std::string> free;
    for (int j = 0; j < layout.num_free_dynamics(); ++j) {
      if (layout.IsNamed(layout.free()[static_cast<size_t>(j)])) {
        free.push_back(layout.free_parameter(j).name);
      }
    }
    for (const std::string& name : table_.Strings("parameters")) {
      if (std::find(free.begin(), free.end(), name) == free.end()) {
        return table_.Fail("parameters",
                           "'parameters' has '" + name +
                               "', expected the names of free parameters" +
                               NameHint(name, free));
      }
      request_->options.targets.push_back(name);
    }
    return table_.errors()->ok();
  }

  bool ReadDurations() {
    double second = 1.0;
    std::string error;
    if (!UnitFactor("s", Dimension::kTime, units_, &second, &error)) {
      return table_.Fail("durations", error);
    }
    for (const double duration : table_.Numbers("durations")) {
      const double time = duration * second;
      for (const IdentificationRecord& record : problem_.records) {
        if (record.role != IdentificationRecord::Role::kTrain) continue;
        const double step = record.sampling_step();
        const double length =
            step * static_cast<double>(record.num_samples() - 1);
        if (time >= step && time <= length * (1.0 + 1e-9)) continue;
        return table_.Fail("durations",
                           "'durations' has " + FormatNumber(duration, 6) +
                               " s, expected not more than record '" +
                               record.name + "' has, " +
                               FormatNumber(length / second, 6) +
                               " s, and no less than a step of it");
      }
      request_->durations.push_back(time);
    }
    return table_.errors()->ok();
  }

  bool ReadExcite() {
    const StructuralModel& model = problem_.dynamics->model();
    for (const std::string& name : table_.Strings("excite")) {
      int dof = -1;
      if (!FindDof(model, table_, "excite", name, false, &dof)) return false;
      request_->excite.push_back(name);
    }
    return table_.errors()->ok();
  }

  bool ReadCandidates() {
    if (!table_.Has("candidate")) {
      AddAll(Quantity::kAbsoluteAcceleration, CandidateSensor());
    }
    for (const TomlTable& table : table_.Tables("candidate", "plan")) {
      if (!ReadCandidate(table)) return false;
    }
    if (!table_.errors()->ok()) return false;
    NameCandidates();
    return true;
  }

  bool ReadCandidate(const TomlTable& table) {
    if (!table.AllowKeys()) {
      return false;
    }
    Quantity quantity = Quantity::kAbsoluteAcceleration;
    std::string error;
    const std::string name = table.String("quantity", QuantityName(quantity));
    if (!table.errors()->ok()) return false;
    if (!ParseQuantity(name, &quantity, &error)) {
      return table.Fail("quantity", error);
    }
    if (quantity == Quantity::kStrain || quantity == Quantity::kForce ||
        quantity == Quantity::kAbsoluteDisplacement) {
      return table.Fail("quantity",
                        "'quantity' is " + name +
                            ", expected displacement, velocity, "
                            "relative_acceleration or absolute_acceleration");
    }
    CandidateSensor noise;
    if (table.Has("sigma") && table.Has("sigma_percent")) {
      return table.Fail("sigma_percent",
                        "'sigma_percent' and 'sigma' are both given, expected "
                        "one of them");
    }
    if (table.Has("sigma")) {
      double factor = 1.0;
      if (!table.RequireKey("unit", "that of 'sigma'")) return false;
      if (!UnitFactor(table.String("unit"), DimensionOf(quantity), units_,
                      &factor, &error)) {
        return table.Fail("unit", error);
      }
      noise.sigma = factor * table.PositiveNumber("sigma", 1.0);
    }
    if (table.Has("sigma_percent")) {
      noise.noise_share = table.PositiveNumber("sigma_percent", 1.0) / 100.0;
    }
    if (!table.errors()->ok()) return false;
    if (!table.Has("dofs")) {
      AddAll(quantity, noise);
      return true;
    }
    const std::vector<std::string>& names = places_.names();
    for (const std::string& dof : table.Strings("dofs")) {
      const auto place = std::find(names.begin(), names.end(), dof);
      if (place == names.end()) {
        return table.Fail("dofs", "'" + dof + "' is not a DOF" +
                                      (names.size() <= kMostHinted
                                           ? NameHint(dof, names)
                                           : ", expected a name such as '" +
                                                 names.front() + "'"));
      }
      if (!Add(static_cast<size_t>(place - names.begin()), quantity, noise)) {
        return table.Fail(
            "dofs",
            "'" + dof +
                "' has a prescribed motion, expected a DOF that moves freely");
      }
    }
    return table.errors()->ok();
  }

  // Adds a candidate; false if it observes nothing.
  bool Add(size_t dof, Quantity quantity, const CandidateSensor& noise) {
    CandidateSensor candidate = noise;
    candidate.observation.name = places_.names()[dof];
    candidate.observation.quantity = quantity;
    candidate.observation.weights = places_.Weights(dof);
    if (candidate.observation.weights.size() == 0) return false;
    if (seen_.insert({dof, quantity}).second) {
      request_->candidates.push_back(std::move(candidate));
    }
    return true;
  }

  void AddAll(Quantity quantity, const CandidateSensor& noise) {
    for (size_t dof = 0; dof < places_.names().size(); ++dof) {
      if (!IsRotation(places_.names()[dof])) (void)Add(dof, quantity, noise);
    }
  }

  // Names candidates by their DOFs, with the quantity if there are several.
  void NameCandidates() {
    std::vector<CandidateSensor>& candidates = request_->candidates;
    const bool alike = std::all_of(
        candidates.begin(), candidates.end(), [&](const CandidateSensor& c) {
          return c.observation.quantity == candidates[0].observation.quantity;
        });
    if (alike) return;
    for (CandidateSensor& candidate : candidates) {
      candidate.observation.name +=
          std::string(" ") + QuantityName(candidate.observation.quantity);
    }
  }

  // Reads own sensors. Noise in per cent refers to the predicted signal here,
  // elsewhere to the measured one.
  bool ReadOwn() {
    request_->own = OwnSensors(problem_);
    for (OwnSensor& sensor : request_->own) {
      const SignalSection& signal =
          sections_[static_cast<size_t>(sensor.record)]
              .channels[static_cast<size_t>(sensor.channel)]
              .signal;
      if (signal.sigma_percent > 0.0) {
        sensor.noise_share = signal.sigma_percent / 100.0;
      }
    }
    return true;
  }

  const TomlTable table_;
  const UnitSystem& units_;
  const Places places_;
  const std::vector<RecordSection>& sections_;
  const IdentificationProblem& problem_;
  SensorRequest* request_;
  std::set<std::pair<size_t, Quantity>> seen_;
};

}  // namespace

bool ReadPlan(const TomlTable& root, const UnitSystem& units,
              const ReducedStructure* structure,
              const std::vector<RecordSection>& sections,
              const IdentificationProblem& problem, SensorRequest* request) {
  *request = SensorRequest();
  return PlanReader(root, units, structure, sections, problem, request).Read();
}

bool MoveForces(const std::string& path, const std::string& force_dof,
                TomlValue* tree, std::string* error) {
  if (force_dof.empty()) return true;
  TomlValue* records = tree->Find("record");
  if (records == nullptr || !records->IsArrayOfTables()) return true;
  for (TomlValue& record : records->elements) {
    TomlValue* forces = record.Find("force");
    if (forces == nullptr || !forces->IsArrayOfTables() ||
        forces->elements.empty()) {
      return CaseErrors(path, error)
          .Fail(record.line,
                "a record has no [[record.force]], expected one to place at "
                "the DOFs of 'excite'");
    }
    TomlValue force = forces->elements.front();
    force.Set("dof", TomlValue::String(force_dof));
    forces->elements = {std::move(force)};
    record.Erase("ground");
  }
  return true;
}

}  // namespace pinode
