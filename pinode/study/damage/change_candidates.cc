#include "pinode/study/damage/change_candidates.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {
namespace {

constexpr double kPriorDeviation = 1.0;

using SpringPlace = DamageSearch::SpringPlace;

// Deformation and its rate at a place, at every sample of the training records.
struct Motion {
  Vector deformation;
  Vector rate;
};

Motion MotionAt(const FitSummary& summary, int num_dofs, int from, int to) {
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

std::vector<Feature> FeaturesAt(int from, int to) {
  if (from < 0) return {Feature::Displacement(to), Feature::Velocity(to)};
  return {Feature::Deformation(from, to), Feature::DeformationRate(from, to)};
}

// Returns the names of the deformation and its rate as functions write them.
std::vector<std::string> FeatureNames(const StructuralModel& model, int from,
                                      int to) {
  std::vector<std::string> names;
  for (const Feature& feature : FeaturesAt(from, to)) {
    names.push_back(feature.Name(model.dof_names, {}));
  }
  return names;
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

GroupTerm MatrixTerm(const ChangeCandidate& candidate) {
  GroupTerm term;
  term.group.name = candidate.subject.name;
  if (candidate.subject.kind == ChangeKind::kMass) {
    term.group.target = MatrixGroup::Target::kMass;
    term.group.matrix = candidate.masses.asDiagonal();
  } else {
    term.group.target = MatrixGroup::Target::kDamping;
    term.group.matrix = candidate.damping;
  }
  term.alpha.name = candidate.subject.name;
  term.alpha.prior_sigma = PriorOf(candidate);
  return term;
}

// All damping of `model` by one factor, and that of each of its lowest modes.
std::vector<ChangeCandidate> DampingCandidates(const StructuralModel& model) {
  // The modes that records show; what changes in all of them is the first.
  constexpr int kMostModes = 5;
  std::vector<ChangeCandidate> candidates;
  const auto add = [&candidates](const std::string& name,
                                 const std::string& place,
                                 const Matrix& damping) {
    ChangeCandidate candidate;
    candidate.subject.name = name;
    candidate.subject.kind = ChangeKind::kDamping;
    candidate.subject.place = place;
    candidate.damping = damping;
    candidates.push_back(std::move(candidate));
  };
  add("damping.all", "all modes", model.damping);
  ModalProperties modes;
  std::string unused;
  if (!ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                    &unused)) {
    return candidates;
  }
  int number = 0;
  for (Eigen::Index i = 0; i < modes.frequency_hz.size(); ++i) {
    if (!(modes.frequency_hz[i] > 0.0)) continue;
    const Vector shape = modes.mode_shapes.col(i);
    const double damping = shape.dot(model.damping * shape);
    if (!(damping > 0.0)) continue;
    if (++number > kMostModes) break;
    const Vector momentum = model.mass * shape;
    const std::string mode = "mode" + std::to_string(i + 1);
    add("damping." + mode, mode, damping * momentum * momentum.transpose());
  }
  // One mode alone is all of them.
  if (candidates.size() == 2) candidates.pop_back();
  return candidates;
}

bool ForceTerm(const ChangeCandidate& candidate,
               const StructuralDynamics& dynamics, const UnitSystem& units,
               LawTerm* term, std::string* error) {
  LibrarySpec spec;
  spec.name = candidate.library;
  spec.features = FeaturesOf(candidate);
  spec.output = candidate.subject.dof;
  spec.acts_as = ActsAs::kForce;
  spec.coefficients.resize(1);
  spec.coefficients[0].basis = candidate.basis;
  spec.coefficients[0].parameter.prior_sigma = PriorOf(candidate);
  return MakeLibraryTerm(spec, dynamics, units, term, error);
}

}  // namespace

std::vector<ChangeCandidate> MakeChangeCandidates(
    const IdentificationProblem& problem, const DamageSearch& search,
    const FitSummary& summary, const IdentifiedModel& model) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const StructuralModel corrected =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  const int size = corrected.num_dofs();
  std::vector<ChangeCandidate> candidates;
  for (const DamageSearch::MassPlace& place : search.masses) {
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
  if (search.damping) {
    for (ChangeCandidate& candidate : DampingCandidates(corrected)) {
      candidates.push_back(std::move(candidate));
    }
  }
  for (const SpringPlace& place : search.springs) {
    const Motion motion = MotionAt(summary, size, place.from, place.to);
    const std::vector<std::string> names =
        FeatureNames(corrected, place.from, place.to);
    // Stiffness that couples the two; if there is none, that holds the one.
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

std::vector<Feature> FeaturesOf(const ChangeCandidate& candidate) {
  return FeaturesAt(candidate.from, candidate.to);
}

double PriorOf(const ChangeCandidate& candidate) {
  return kPriorDeviation * candidate.unit;
}

bool AddCandidates(const IdentificationProblem& problem,
                   const std::vector<ChangeCandidate>& candidates,
                   IdentificationProblem* extended, std::string* error) {
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  std::set<std::string> names;
  for (const ParameterBlock& block : dynamics->blocks()) {
    for (const Parameter& parameter : block.parameters) {
      names.insert(parameter.name);
    }
  }
  for (const ChangeCandidate& candidate : candidates) {
    if (!names.insert(candidate.subject.name).second) {
      *error = "two unknowns are named '" + candidate.subject.name + "'";
      return false;
    }
    if (candidate.subject.kind != ChangeKind::kNonlinear) {
      if (!dynamics->AddGroup(MatrixTerm(candidate), error)) return false;
      continue;
    }
    LawTerm term;
    if (!ForceTerm(candidate, *dynamics, problem.description.units, &term,
                   error) ||
        !dynamics->AddLaw(std::move(term), error)) {
      return false;
    }
  }
  IdentificationProblem result = problem;
  result.dynamics = std::move(dynamics);
  result.description.known_as.clear();
  if (!result.IsValid(error)) return false;
  *extended = std::move(result);
  return true;
}

void SetForceShares(const IdentificationProblem& extended,
                    const FitSummary& summary, const IdentifiedModel& model,
                    std::vector<ChangeCandidate>* candidates) {
  const StructuralDynamics& dynamics = *extended.dynamics;
  const StructuralModel corrected =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  const std::map<std::string, double> values =
      ParametersByName(extended, model);
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
      if (value == values.end()) continue;
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
