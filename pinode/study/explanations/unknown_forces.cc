#include "pinode/study/explanations/unknown_forces.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/dynamics/unknown_force.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/verdict_limits.h"

namespace pinode {
namespace {

using Findings = std::vector<Finding>;

void CheckWhatForcesLeave(const FitSummary& fit, Findings* findings) {
  for (const RecordScore& score : fit.records) {
    if (score.role != IdentificationRecord::Role::kTrain) continue;
    const double left = StructuredError(score);
    if (!(left > limits::kLittleUnexplainedByForce)) continue;
    const bool much = left > limits::kUnexplainedByForce;
    const std::string missed =
        "the unknown force leaves " + FormatNumber(100.0 * left, 2) +
        " % of the motion of record '" + score.name + "' unexplained";
    if (much) {
      findings->push_back({"force_not_found", missed + ", and takes over more",
                           left, limits::kUnexplainedByForce,
                           "look for a force at another place, for a second "
                           "one, or for what the model lacks"});
    } else {
      findings->push_back({"force_takes_over",
                           missed + ": it may be wrong by several times that",
                           left, limits::kLittleUnexplainedByForce,
                           "look for what the model lacks", Grade::kWithCare});
    }
    return;
  }
}

// True if the force acts in the record.
bool ActsIn(const UnknownForceTerm& force, const IdentificationRecord& record) {
  return force.input < 0 ||
         (record.excitation &&
          (record.excitation->samples().row(force.input).array() != 0.0).any());
}

void CheckSensorsOfForces(const IdentificationProblem& problem,
                          Findings* findings) {
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const auto& forces = problem.dynamics->unknown_forces();
    const auto acting = std::count_if(forces.begin(), forces.end(),
                                      [&record](const UnknownForceTerm& force) {
                                        return ActsIn(force, record);
                                      });
    const auto fitted = std::count_if(
        record.channels.begin(), record.channels.end(),
        [](const MeasuredChannel& channel) { return channel.fit; });
    if (acting == 0 || fitted > acting) continue;
    findings->push_back(
        {"nothing_checks_the_force",
         "record '" + record.name +
             "' has as many unknown forces as sensors (" +
             std::to_string(fitted) +
             "): whatever the model lacks becomes a part of the force, and no "
             "sensor shows it",
         static_cast<double>(fitted), static_cast<double>(acting + 1),
         "add a sensor, or check the model with a record of a measured load",
         Grade::kWithCare});
    return;
  }
}

}  // namespace

std::vector<Finding> CheckUnknownForces(const IdentificationProblem& problem,
                                        const FitSummary& fit) {
  Findings findings;
  if (problem.dynamics->unknown_forces().empty()) return findings;
  CheckWhatForcesLeave(fit, &findings);
  CheckSensorsOfForces(problem, &findings);
  return findings;
}

std::vector<Suspect> MakeForcePlaces(const IdentificationProblem& problem) {
  constexpr int kMostDofs = 12;
  std::vector<Suspect> places;
  const StructuralModel& model = problem.dynamics->model();
  if (model.num_dofs() > kMostDofs) return places;
  for (const UnknownForceTerm& force : problem.dynamics->unknown_forces()) {
    if ((force.outputs.array() != 0.0).count() != 1) continue;
    for (int dof = 0; dof < model.num_dofs(); ++dof) {
      if (force.outputs[dof] != 0.0) continue;
      const std::string& name = model.dof_names[static_cast<size_t>(dof)];
      Suspect suspect;
      suspect.kind = Suspect::Kind::kForcePlace;
      suspect.place = force.name + "," + name;
      suspect.what = "the unknown force '" + force.name + "' at " + name;
      suspect.moved_forces.push_back(
          {force.name,
           force.outputs.sum() * Vector::Unit(model.num_dofs(), dof)});
      places.push_back(std::move(suspect));
    }
  }
  return places;
}

MovedForce MostMovedForce(const std::vector<ForceEstimate>& own,
                          const std::vector<ForceEstimate>& other) {
  MovedForce most;
  for (size_t i = 0; i < std::min(own.size(), other.size()); ++i) {
    const ForceEstimate& a = own[i];
    const ForceEstimate& b = other[i];
    if (a.name != b.name || a.value.size() != b.value.size() ||
        a.value.size() == 0) {
      continue;
    }
    const double width = 0.5 * (a.upper95 - a.lower95).norm();
    if (!(width > 0.0) || !std::isfinite(width)) continue;
    const double shift = (b.value - a.value).norm() / width;
    if (!(shift > most.shift)) continue;
    most = {a.name, shift, a.value.cwiseAbs().maxCoeff(),
            b.value.cwiseAbs().maxCoeff()};
  }
  return most;
}

void WidenForces(const std::vector<ForceEstimate>& other,
                 std::vector<ForceEstimate>* forces) {
  for (size_t i = 0; i < std::min(other.size(), forces->size()); ++i) {
    ForceEstimate& wide = (*forces)[i];
    if (wide.name != other[i].name ||
        wide.value.size() != other[i].value.size()) {
      continue;
    }
    // Without a covariance the bounds of `other` are infinite or NaN.
    const auto use = other[i].lower95.array().isFinite() &&
                     other[i].upper95.array().isFinite();
    wide.lower95 =
        use.select(wide.lower95.cwiseMin(other[i].lower95), wide.lower95);
    wide.upper95 =
        use.select(wide.upper95.cwiseMax(other[i].upper95), wide.upper95);
  }
}

}  // namespace pinode
