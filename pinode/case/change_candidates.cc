#include "pinode/case/change_candidates.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/case/grown_case.h"
#include "pinode/case/toml_value.h"
#include "pinode/dynamics/library_function.h"

namespace pinode {
namespace {

constexpr double kPriorDeviation = 1.0;

using SpringPlace = DamageSearch::SpringPlace;

// Deformation and its rate at a place, at every sample of the training records.
struct Motion {
  Vector deformation;
  Vector rate;
};

Motion MotionAt(const IdentificationSummary& summary, int num_dofs, int from,
                int to) {
  Motion motion;
  for (const RecordScore& record : summary.records) {
    if (record.role != IdentificationRecord::Role::kTrain || !record.finite) {
      continue;
    }
    const auto relative = [&](int offset) {
      Vector value = record.states.row(offset + to).transpose();
      if (from >= 0) value -= record.states.row(offset + from).transpose();
      return value;
    };
    const Eigen::Index before = motion.rate.size();
    motion.deformation.conservativeResize(before + record.states.cols());
    motion.rate.conservativeResize(before + record.states.cols());
    motion.deformation.tail(record.states.cols()) = relative(0);
    motion.rate.tail(record.states.cols()) = relative(num_dofs);
  }
  return motion;
}

double Rms(const Vector& values) {
  return values.size() == 0 ? 0.0
                            : std::sqrt(values.squaredNorm() /
                                        static_cast<double>(values.size()));
}

// Deformation, then its rate, as case files write them.
std::vector<std::string> FeatureNames(const StructuralModel& model, int from,
                                      int to) {
  if (from < 0) {
    return {Feature::Displacement(to).Name(model.dof_names, {}),
            Feature::Velocity(to).Name(model.dof_names, {})};
  }
  return {Feature::Deformation(from, to).Name(model.dof_names, {}),
          Feature::DeformationRate(from, to).Name(model.dof_names, {})};
}

Vector Values(const std::string& basis, const std::vector<std::string>& names,
              const Motion& motion) {
  LibraryFunction function;
  std::string error;
  CHECK(LibraryFunction::Parse(basis, names, &function, &error)) << error;
  Vector values(motion.rate.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double q[2] = {motion.deformation[i], motion.rate[i]};
    values[i] = function.Evaluate(q);
  }
  return values;
}

std::string OutputName(const StructuralModel& model, int from, int to) {
  const std::string& end = model.dof_names[static_cast<size_t>(to)];
  return from < 0 ? end
                  : end + "-" + model.dof_names[static_cast<size_t>(from)];
}

void AppendTo(const char* key, TomlValue table, TomlValue* tree) {
  std::vector<TomlValue> tables;
  if (const TomlValue* present = tree->Find(key)) tables = present->elements;
  tables.push_back(std::move(table));
  tree->Set(key, TomlValue::Array(std::move(tables)));
}

}  // namespace

std::vector<ChangeCandidate> MakeChangeCandidates(
    const Case& c, const IdentificationSummary& summary,
    const IdentifiedModel& model) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  const StructuralModel corrected =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  const int size = corrected.num_dofs();
  std::vector<ChangeCandidate> candidates;
  for (const DamageSearch::MassPlace& place : c.damage.masses) {
    ChangeCandidate candidate;
    candidate.subject.name = TermName("mass." + place.name);
    candidate.subject.kind = ChangeKind::kMass;
    candidate.subject.place = place.name;
    double mean = 0.0;
    for (const int dof : place.dofs) mean += corrected.mass(dof, dof);
    mean /= static_cast<double>(place.dofs.size());
    candidate.masses = Vector::Zero(size);
    for (const int dof : place.dofs) candidate.masses[dof] = mean;
    candidates.push_back(std::move(candidate));
  }
  for (const SpringPlace& place : c.damage.springs) {
    const Motion motion = MotionAt(summary, size, place.from, place.to);
    const std::vector<std::string> names =
        FeatureNames(corrected, place.from, place.to);
    // What couples the two, or, where nothing does, what holds the one.
    double stiffness = place.from < 0
                           ? corrected.stiffness.row(place.to).sum()
                           : -corrected.stiffness(place.from, place.to);
    if (!(stiffness > 0.0)) {
      stiffness = corrected.stiffness(place.to, place.to);
    }
    const double force = stiffness * Rms(motion.deformation);
    const double rate = Rms(motion.rate);
    if (!(force > 0.0) || !(rate > 0.0)) continue;
    const std::vector<std::pair<std::string, std::string>> forces = {
        {"opening", "abs(" + names[0] + ")"},
        {"hardening", names[0] + "^3"},
        {"friction",
         "tanh(" + names[1] + "/" + FormatNumber(0.1 * rate, 6) + ")"},
        {"drag", "abs(" + names[1] + ")*" + names[1]}};
    for (const auto& [form, basis] : forces) {
      ChangeCandidate candidate;
      candidate.basis = basis;
      candidate.library = TermName(place.name + "." + form);
      candidate.subject.name = candidate.library + "." + basis;
      candidate.subject.kind = ChangeKind::kNonlinear;
      candidate.subject.place = place.name;
      candidate.subject.dof = OutputName(corrected, place.from, place.to);
      candidate.from = place.from;
      candidate.to = place.to;
      candidate.unit = force / Rms(Values(basis, names, motion));
      if (std::isfinite(candidate.unit)) {
        candidates.push_back(std::move(candidate));
      }
    }
  }
  return candidates;
}

bool AddCandidates(const Case& c,
                   const std::vector<ChangeCandidate>& candidates,
                   Case* extended, std::string* error) {
  const StructuralModel& model = c.problem.dynamics->model();
  TomlValue tree = *c.source;
  for (const ChangeCandidate& candidate : candidates) {
    const TomlValue prior = TomlValue::Float(kPriorDeviation * candidate.unit);
    if (candidate.subject.kind == ChangeKind::kMass) {
      TomlValue matrix = TomlValue::Table();
      matrix.Set("diagonal", TomlValue::Numbers({candidate.masses.begin(),
                                                 candidate.masses.end()}));
      TomlValue group = TomlValue::Table();
      group.Set("name", TomlValue::String(candidate.subject.name));
      group.Set("adds_to", TomlValue::String("mass"));
      group.Set("matrix", std::move(matrix));
      group.Set("prior_sigma", prior);
      AppendTo("group", std::move(group), &tree);
      continue;
    }
    std::vector<std::string> inputs;
    for (const std::string& name :
         FeatureNames(model, candidate.from, candidate.to)) {
      if (candidate.basis.find(name) != std::string::npos) {
        inputs.push_back(name);
      }
    }
    TomlValue term = TomlValue::Table();
    term.Set("basis", TomlValue::String(candidate.basis));
    term.Set("prior_sigma", prior);
    TomlValue library = TomlValue::Table();
    library.Set("name", TomlValue::String(candidate.library));
    library.Set("inputs", TomlValue::Strings(inputs));
    library.Set("output", TomlValue::String(candidate.subject.dof));
    library.Set("acts_as", TomlValue::String("force"));
    library.Set("terms", TomlValue::Array({std::move(term)}));
    AppendTo("library", std::move(library), &tree);
  }
  return RebuildCase(c, tree, extended, error);
}

void SetForceShares(const Case& extended, const IdentificationSummary& summary,
                    const IdentifiedModel& model,
                    std::vector<ChangeCandidate>* candidates) {
  const StructuralDynamics& dynamics = *extended.problem.dynamics;
  const StructuralModel corrected =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  const std::map<std::string, double> values =
      ParametersByName(extended.problem, model);
  for (ChangeCandidate& candidate : *candidates) {
    if (candidate.subject.kind != ChangeKind::kNonlinear) continue;
    const std::vector<std::string> names =
        FeatureNames(corrected, candidate.from, candidate.to);
    const Motion motion =
        MotionAt(summary, corrected.num_dofs(), candidate.from, candidate.to);
    Vector force = Vector::Zero(motion.rate.size());
    for (const ChangeCandidate& other : *candidates) {
      if (other.subject.place != candidate.subject.place ||
          other.subject.kind != ChangeKind::kNonlinear) {
        continue;
      }
      const auto value = values.find(other.subject.name);
      CHECK(value != values.end()) << other.subject.name;
      force += value->second * Values(other.basis, names, motion);
    }
    Vector restoring = force;
    Eigen::Index sample = 0;
    for (const RecordScore& record : summary.records) {
      if (record.role != IdentificationRecord::Role::kTrain || !record.finite) {
        continue;
      }
      restoring.segment(sample, record.states.cols()) +=
          (corrected.stiffness.row(candidate.to) *
           record.states.topRows(corrected.num_dofs()))
              .transpose();
      sample += record.states.cols();
    }
    candidate.subject.force_share =
        Rms(force) / std::max(Rms(restoring), 1e-300);
  }
}

}  // namespace pinode
