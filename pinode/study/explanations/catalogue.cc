#include "pinode/study/explanations/catalogue.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/dynamics/feature.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/explanations/nonlinear_force.h"
#include "pinode/study/explanations/ungrouped_stiffness.h"

namespace pinode {
namespace {

using Kind = Suspect::Kind;
using Target = MatrixGroup::Target;

// Least damping ratio on which a factor per mode is based.
constexpr double kLeastRatio = 0.005;

GroupTerm FactorGroup(const std::string& name, Target target,
                      const Matrix& matrix) {
  GroupTerm term;
  term.group.name = SuspectUnknown(name);
  term.group.target = target;
  term.group.matrix = matrix;
  term.alpha.name = term.group.name;
  // The prior only keeps undetermined factors from growing.
  term.alpha.prior_sigma = 1.0;
  return term;
}

// Mean strain energy of a spring over the training records of `fit`, times two.
double EnergyOf(const Spring& spring, const FitSummary& fit) {
  double energy = 0.0;
  for (const RecordScore& record : fit.records) {
    if (record.role != IdentificationRecord::Role::kTrain || !record.finite) {
      continue;
    }
    Vector d = record.states.row(spring.to).transpose();
    if (spring.from >= 0) d -= record.states.row(spring.from).transpose();
    energy += spring.stiffness * d.squaredNorm();
  }
  return energy;
}

class Catalogue {
 public:
  Catalogue(const IdentificationProblem& problem, const IdentifiedModel& model)
      : problem_(problem),
        dynamics_(*problem.dynamics),
        corrected_(dynamics_.CorrectedModel(
            model.parameters.head(dynamics_.num_parameters()))) {}

  std::vector<Suspect> Make() {
    AddDampings();
    AddMasses();
    AddUngroupedStiffness();
    AddGroups();
    AddClockRate();
    AddSensorSuspects(problem_, &suspects_);
    return std::move(suspects_);
  }

 private:
  Suspect* Add(Kind kind, const std::string& place, const std::string& what) {
    Suspect suspect;
    suspect.kind = kind;
    suspect.place = place;
    suspect.what = what;
    if (kind == Kind::kDamping) suspect.usual = 0.3;
    suspects_.push_back(std::move(suspect));
    return &suspects_.back();
  }

  std::string Dof(int j) const { return PlaceName(corrected_, j); }

  void AddDampings() {
    const Matrix& damping = corrected_.damping;
    const double size = damping.cwiseAbs().maxCoeff();
    ModalProperties modes;
    std::string unused;
    if (!ComputeModes(corrected_.mass, damping, corrected_.stiffness, &modes,
                      &unused)) {
      return;
    }
    if (size > 0.0) {
      Add(Kind::kDamping, "",
          "all damping by one factor (if all stiffness is free, a wrong clock "
          "or a factor on all masses looks the same)")
          ->groups = {FactorGroup("damping", Target::kDamping, damping)};
    }
    std::vector<int> vibrating;
    for (int i = 0; i < modes.frequency_hz.size(); ++i) {
      if (modes.frequency_hz[i] > 0.0) vibrating.push_back(i);
    }
    if (vibrating.empty()) return;
    const auto circular = [&](int i) {
      return 2.0 * kPi * modes.frequency_hz[i];
    };
    const auto ratio = [&](int i) {
      const double zeta = modes.damping_ratio[i];
      return std::isfinite(zeta) ? std::max(zeta, kLeastRatio) : kLeastRatio;
    };
    const int first = vibrating.front();
    Add(Kind::kDamping, "", "damping proportional to mass and to stiffness")
        ->groups = {
        FactorGroup("damping.mass", Target::kDamping,
                    2.0 * ratio(first) * circular(first) * corrected_.mass),
        FactorGroup(
            "damping.stiffness", Target::kDamping,
            2.0 * ratio(first) / circular(first) * corrected_.stiffness)};
    if (vibrating.size() < 2 ||
        vibrating.size() > static_cast<size_t>(kMostPlaces)) {
      return;
    }
    Suspect* per_mode =
        Add(Kind::kDamping, "", "a factor on the damping of each mode");
    for (const int i : vibrating) {
      const Vector shape = corrected_.mass * modes.mode_shapes.col(i);
      per_mode->groups.push_back(FactorGroup(
          "damping.mode" + std::to_string(i + 1), Target::kDamping,
          2.0 * ratio(i) * circular(i) * shape * shape.transpose()));
    }
  }

  void AddMasses() {
    Add(Kind::kMass, "",
        "all masses by one factor (if all stiffness is free, a factor on the "
        "damping or a wrong clock looks the same)")
        ->groups = {FactorGroup("mass", Target::kMass, corrected_.mass)};
    const int size = corrected_.num_dofs();
    if (size > kMostPlaces) return;
    for (int j = 0; j < size; ++j) {
      if (!(corrected_.mass(j, j) > 0.0)) continue;
      Matrix matrix = Matrix::Zero(size, size);
      matrix(j, j) = corrected_.mass(j, j);
      Add(Kind::kMass, Dof(j), "the mass at " + Dof(j))->groups = {
          FactorGroup("mass." + Dof(j), Target::kMass, matrix)};
    }
  }

  void AddUngroupedStiffness() {
    for (const UngroupedStiffness& part :
         FindUngroupedStiffness(dynamics_, corrected_)) {
      Suspect* suspect = Add(Kind::kStiffness, part.place, part.what);
      suspect->groups = {FactorGroup("stiffness." + part.place,
                                     Target::kStiffness, part.matrix)};
      suspect->usual = 0.2;
    }
  }

  // Groups that are fixed or follow another one, and groups with bounds.
  void AddGroups() {
    for (const GroupTerm& term : dynamics_.groups()) {
      const Parameter& alpha = term.alpha;
      if (!alpha.free) {
        Kind kind = Kind::kStiffness;
        if (term.group.target == Target::kMass) kind = Kind::kMass;
        if (term.group.target == Target::kDamping) kind = Kind::kDamping;
        Add(kind, term.group.name,
            "group '" + term.group.name +
                (alpha.IsTied() ? "' apart from '" + alpha.tie + "'"
                                : "', which is fixed"))
            ->freed = {term.group.name};
      } else if (std::isfinite(alpha.lower) || std::isfinite(alpha.upper)) {
        Add(Kind::kBound, term.group.name,
            "group '" + term.group.name + "' beyond its bounds")
            ->freed = {term.group.name};
      }
    }
  }

  // In the logger's time t = q tau, with the true time tau, the equation of
  // motion is that of stiffness / q^2 and damping / q for y = q^2 x, of which
  // accelerations are the true ones.
  void AddClockRate() {
    bool any_gain = false, any_motion = false;
    std::set<std::string> names;
    std::vector<std::pair<int, int>> moved;
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      for (size_t c = 0; c < record.channels.size(); ++c) {
        const MeasuredChannel& channel = record.channels[c];
        if (!channel.fit) continue;
        any_motion = true;
        const Quantity quantity = channel.observation.quantity;
        if (quantity == Quantity::kRelativeAcceleration ||
            quantity == Quantity::kAbsoluteAcceleration) {
          continue;
        }
        any_gain = any_gain || channel.gain >= 0;
        names.insert(channel.observation.name);
        moved.emplace_back(static_cast<int>(r), static_cast<int>(c));
      }
    }
    if (!any_motion || any_gain ||
        !(corrected_.damping.cwiseAbs().maxCoeff() > 0.0)) {
      return;
    }
    Suspect* suspect =
        Add(Kind::kClockRate, "", "the rate of the logger's clock");
    suspect->groups = {
        FactorGroup("clock.stiffness", Target::kStiffness,
                    corrected_.stiffness),
        FactorGroup("clock.damping", Target::kDamping, corrected_.damping)};
    if (!moved.empty()) suspect->sensors = {UnknownGain("clock", moved)};
    for (const std::string& name : names) {
      suspect->tied.push_back(SuspectUnknown("gain." + name));
    }
    suspect->usual = 0.02;
  }

  const IdentificationProblem& problem_;
  const StructuralDynamics& dynamics_;
  const StructuralModel corrected_;
  std::vector<Suspect> suspects_;
};

}  // namespace

std::vector<Suspect> MakeSuspects(const IdentificationProblem& problem,
                                  const IdentifiedModel& model) {
  return Catalogue(problem, model).Make();
}

std::vector<Suspect> MakeForceSuspects(const IdentificationProblem& problem,
                                       const FitSummary& fit,
                                       const IdentifiedModel& model,
                                       size_t most_places) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const StructuralModel corrected =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  std::vector<std::pair<double, Spring>> ranked;
  for (const Spring& spring : SpringsOf(corrected)) {
    ranked.emplace_back(-EnergyOf(spring, fit), spring);
  }
  std::stable_sort(
      ranked.begin(), ranked.end(),
      [](const auto& a, const auto& b) { return a.first < b.first; });
  if (ranked.size() > most_places) ranked.resize(most_places);
  std::vector<Suspect> suspects;
  for (const auto& [unused, spring] : ranked) {
    const std::string start = PlaceName(corrected, spring.from);
    const std::string end = PlaceName(corrected, spring.to);
    const std::string place = start + "-" + end;
    for (NonlinearForce& force :
         NonlinearForcesAt(corrected, fit, spring.from, spring.to,
                           spring.stiffness, SuspectUnknown(place))) {
      Suspect suspect;
      suspect.kind = Kind::kNonlinear;
      suspect.place = place;
      suspect.what = force.form + " between " + start + " and " + end;
      suspect.usual = 0.1 * force.unit;
      suspect.forces = {std::move(force.spec)};
      suspects.push_back(std::move(suspect));
    }
  }
  return suspects;
}

}  // namespace pinode
