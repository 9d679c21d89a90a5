#include "pinode/study/damage/linear_causes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/dynamics/feature.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// Least ratio of the first mode that a damper is measured by.
constexpr double kLeastDamperRatio = 0.005;
// Number of springs up to which each is tried.
constexpr size_t kMostSprings = 8;

// Damping per stiffness that gives the first mode its ratio; 0: none vibrates.
double DampingPerStiffness(const StructuralModel& model) {
  ModalProperties modes;
  std::string unused;
  if (!ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                    &unused)) {
    return 0.0;
  }
  for (Eigen::Index i = 0; i < modes.frequency_hz.size(); ++i) {
    if (!(modes.frequency_hz[i] > 0.0)) continue;
    const double ratio = modes.damping_ratio[i];
    return 2.0 *
           (std::isfinite(ratio) ? std::max(ratio, kLeastDamperRatio)
                                 : kLeastDamperRatio) /
           (kTwoPi * modes.frequency_hz[i]);
  }
  return 0.0;
}

ChangeCandidate DamperAt(const StructuralModel& model,
                         const ChangeCandidate& force,
                         double damping_per_stiffness) {
  ChangeCandidate damper;
  damper.subject.name = TermName("damping." + force.subject.place);
  damper.subject.kind = ChangeKind::kDamping;
  damper.subject.place = force.subject.place;
  const int size = model.num_dofs();
  Vector ends = Vector::Zero(size);
  ends[force.to] = 1.0;
  double stiffness = model.stiffness(force.to, force.to);
  if (force.from != Feature::kGround) {
    ends[force.from] = -1.0;
    const double coupling = -model.stiffness(force.from, force.to);
    if (coupling > 0.0) stiffness = coupling;
  }
  damper.matrix = damping_per_stiffness * stiffness * ends * ends.transpose();
  return damper;
}

bool IsOfMeasurement(const Explanation& explanation) {
  static const std::set<std::string> kKinds = {
      "sensor_gain",       "sensor_delay",     "sensor_offset",
      "sensors_exchanged", "excitation_delay", "excitation_scale",
      "clock_rate"};
  size_t begin = 0;
  while (begin <= explanation.kind.size()) {
    const size_t end =
        std::min(explanation.kind.find('+', begin), explanation.kind.size());
    if (kKinds.count(explanation.kind.substr(begin, end - begin)) == 0) {
      return false;
    }
    begin = end + 1;
  }
  return true;
}

}  // namespace

std::vector<std::vector<ChangeCandidate>> DampersToTry(
    const StructuralModel& model, const std::vector<ChangeCandidate>& found,
    const std::vector<ChangeCandidate>& candidates) {
  std::vector<ChangeCandidate> others;
  for (const ChangeCandidate& candidate : found) {
    if (candidate.subject.kind != ChangeKind::kNonlinear) {
      others.push_back(candidate);
    }
  }
  const bool has_forces = others.size() < found.size();
  std::vector<const ChangeCandidate*> forces;  // one of each place
  std::set<std::string> places;
  for (const ChangeCandidate& candidate : has_forces ? found : candidates) {
    if (candidate.subject.kind == ChangeKind::kNonlinear &&
        places.insert(candidate.subject.place).second) {
      forces.push_back(&candidate);
    }
  }
  if (forces.empty() || (!has_forces && forces.size() > kMostSprings)) {
    return {};
  }
  const double per_stiffness = DampingPerStiffness(model);
  if (!(per_stiffness > 0.0)) return {};
  std::vector<std::vector<ChangeCandidate>> sets;
  for (const ChangeCandidate* force : forces) {
    if (sets.empty() || !has_forces) sets.push_back(others);
    sets.back().push_back(DamperAt(model, *force, per_stiffness));
  }
  return sets;
}

bool HasNegativeDamping(const Matrix& damping) {
  // Rounding of a direction without damping.
  constexpr double kRoundedZero = 1e-9;
  const double largest = damping.diagonal().cwiseAbs().maxCoeff();
  Matrix raised = 0.5 * (damping + damping.transpose());
  raised.diagonal().array() += kRoundedZero * std::max(largest, 1e-300);
  return raised.llt().info() != Eigen::Success;
}

const Explanation* FaultInsteadOfChanges(
    const std::vector<Explanation>& explanations, size_t num_changes,
    double left_by_changes) {
  if (explanations.empty()) return nullptr;
  const Explanation& best = explanations[0];
  const auto parts = static_cast<size_t>(
      std::count(best.kind.begin(), best.kind.end(), '+') + 1);
  if (!IsOfMeasurement(best) || parts >= num_changes ||
      !(best.log_odds > limits::kLogOdds) ||
      !(best.leaves < limits::kNotedUnexplained) ||
      !(best.leaves <= left_by_changes)) {
    return nullptr;
  }
  for (const Explanation& other : explanations) {
    if (!IsOfMeasurement(other) &&
        other.log_odds > best.log_odds - limits::kLogOdds &&
        std::count(other.kind.begin(), other.kind.end(), '+') + 1 <=
            static_cast<std::ptrdiff_t>(parts)) {
      return nullptr;
    }
  }
  return &best;
}

}  // namespace pinode
