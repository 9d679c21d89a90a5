#include "pinode/study/damage/change_candidates.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/explanations/nonlinear_force.h"
#include "pinode/study/explanations/ungrouped_stiffness.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {
namespace {

// Prior deviation of a change, in the candidate's own unit.
constexpr double kPriorDeviation = 1.0;

using SpringPlace = DamageSearch::SpringPlace;

GroupTerm MatrixTerm(const ChangeCandidate& candidate) {
  GroupTerm term;
  term.group.name = candidate.subject.name;
  if (candidate.subject.kind == ChangeKind::kMass) {
    term.group.target = MatrixGroup::Target::kMass;
    term.group.matrix = candidate.masses.asDiagonal();
  } else {
    term.group.target = candidate.subject.kind == ChangeKind::kDamping
                            ? MatrixGroup::Target::kDamping
                            : MatrixGroup::Target::kStiffness;
    term.group.matrix = candidate.matrix;
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
    candidate.matrix = damping;
    candidates.push_back(std::move(candidate));
  };
  add("damping.all", kAllModes, model.damping);
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

// Parts of "a+b", empty ones too.
std::vector<std::string> PartsOf(const std::string& text) {
  std::vector<std::string> parts;
  size_t begin = 0;
  for (size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find('+', begin);
    parts.push_back(text.substr(
        begin, end == std::string::npos ? std::string::npos : end - begin));
    if (end == std::string::npos) break;
  }
  return parts;
}

// The candidate of one part of an explanation; nullptr if there is none.
const ChangeCandidate* CandidateOf(
    const std::string& kind, const std::string& place,
    const std::vector<ChangeCandidate>& candidates) {
  for (const ChangeCandidate& candidate : candidates) {
    const ChangeSubject& subject = candidate.subject;
    switch (subject.kind) {
      case ChangeKind::kDamping:
        // All modes are the first; modes of their own follow where they differ.
        if (kind == "damping" && place.empty()) return &candidate;
        break;
      case ChangeKind::kMass:
        if (kind == "mass" && place == subject.place) return &candidate;
        break;
      case ChangeKind::kStiffness:
        if (kind == "stiffness" && place == subject.place) return &candidate;
        break;
      case ChangeKind::kNonlinear:
        break;
    }
  }
  return nullptr;
}

}  // namespace

std::vector<ChangeCandidate> ExplainedCandidates(
    const std::vector<Explanation>& explanations,
    const std::vector<ChangeCandidate>& candidates) {
  for (const Explanation& explanation : explanations) {
    if (explanation.log_odds < limits::kLogOdds ||
        explanation.log_odds < explanations[0].log_odds - limits::kLogOdds) {
      break;
    }
    // One factor on all masses is the same structure in other units: what is
    // worth as much may stand for it. What else is no candidate, as a sensor,
    // is likelier than the explanations behind it.
    if (explanation.kind == "mass" && explanation.place.empty()) continue;
    if (!(explanation.leaves < limits::kNotedUnexplained)) break;
    const std::vector<std::string> kinds = PartsOf(explanation.kind);
    const std::vector<std::string> places = PartsOf(explanation.place);
    if (kinds.size() != places.size()) break;
    std::vector<ChangeCandidate> named;
    for (size_t i = 0; i < kinds.size(); ++i) {
      const ChangeCandidate* candidate =
          CandidateOf(kinds[i], places[i], candidates);
      if (candidate == nullptr) return {};
      named.push_back(*candidate);
    }
    return named;
  }
  return {};
}

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
  if (search.stiffness) {
    for (UngroupedStiffness& part :
         FindUngroupedStiffness(dynamics, corrected)) {
      ChangeCandidate candidate;
      candidate.subject.name = TermName("stiffness." + part.place);
      candidate.subject.kind = ChangeKind::kStiffness;
      candidate.subject.place = part.place;
      candidate.matrix = std::move(part.matrix);
      candidates.push_back(std::move(candidate));
    }
  }
  for (const SpringPlace& place : search.springs) {
    // Stiffness that couples the two; if there is none, that holds the one.
    double stiffness = place.from < 0
                           ? corrected.stiffness.row(place.to).sum()
                           : -corrected.stiffness(place.from, place.to);
    if (!(stiffness > 0.0)) {
      stiffness = corrected.stiffness(place.to, place.to);
    }
    for (const NonlinearForce& force : NonlinearForcesAt(
             corrected, summary, place.from, place.to, stiffness, place.name)) {
      ChangeCandidate candidate;
      candidate.basis = force.spec.coefficients[0].basis;
      candidate.library = TermName(force.spec.name);
      candidate.subject.name = candidate.library + "." + candidate.basis;
      candidate.subject.kind = ChangeKind::kNonlinear;
      candidate.subject.place = place.name;
      candidate.subject.dof = force.spec.output;
      candidate.from = place.from;
      candidate.to = place.to;
      candidate.unit = force.unit;
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

std::vector<Feature> FeaturesOf(const ChangeCandidate& candidate) {
  return FeaturesOfSpring(candidate.from, candidate.to);
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
    const SpringMotion motion =
        MotionOfSpring(corrected, summary, candidate.from, candidate.to);
    Vector force = Vector::Zero(motion.rate.size());
    for (const ChangeCandidate& other : *candidates) {
      if (other.subject.place != candidate.subject.place ||
          other.subject.kind != ChangeKind::kNonlinear) {
        continue;
      }
      const auto value = values.find(other.subject.name);
      if (value == values.end()) continue;
      force += value->second * motion.Values(other.basis);
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
        RmsOfPresent(force) / std::max(RmsOfPresent(restoring), 1e-300);
  }
}

}  // namespace pinode
