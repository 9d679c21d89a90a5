#include "pinode/study/damage/damage_remarks.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"

namespace pinode {

void RemarkWhatIsOpen(const std::string& records,
                      const std::vector<std::string>& directions,
                      std::vector<std::string>* remarks) {
  for (const std::string& direction : directions) {
    remarks->push_back("Not determined by " + records + ": " + direction +
                       ". If all of these change together, nothing is seen.");
  }
}

void RemarkAnotherSolution(const std::string& whose, const Doubts& doubts,
                           std::vector<std::string>* remarks) {
  if (!doubts.other_solution) return;
  remarks->push_back("Another solution describes the data of " + whose +
                     " as well, so no group is named. Add mode shapes, sensors "
                     "or priors to its case and fit it again.");
}

void RemarkWhatDiffers(const std::vector<GroupState>& healthy,
                       const GroupState& current,
                       const std::vector<std::string>& groups,
                       const ChangeEstimate& estimate,
                       std::vector<std::string>* remarks) {
  // Less than this nobody notices in two tables.
  constexpr double kNoticed = 0.02;

  PooledBaselines pooled;
  std::string unused;
  if (!PoolBaselines(healthy, &pooled, &unused)) return;
  std::vector<std::string> texts;
  for (size_t j = 0; j < groups.size(); ++j) {
    const GroupChange& change = estimate.groups[j];
    const auto i = static_cast<Eigen::Index>(j);
    const double before = 1.0 + pooled.state.values[i];
    if (!change.changed || !(before > 0.1)) continue;
    const double free = (1.0 + current.values[i]) / before - 1.0;
    if (std::abs(free - change.change) < kNoticed ||
        (change.lower95 <= free && free <= change.upper95)) {
      continue;
    }
    texts.push_back(groups[j] + " " + FormatNumber(100.0 * free, 3) +
                    " % instead of " + FormatNumber(100.0 * change.change, 3) +
                    " %");
  }
  if (texts.empty()) return;
  remarks->push_back(
      "The two tables differ. In the fit of the table of parameters all "
      "groups are free. In that of the table of changes only the changed "
      "groups are. With all groups free: " +
      Join(texts, ", ") +
      ". Rely on the table of changes: with all groups free, a change "
      "spreads over groups that the records cannot tell apart.");
}

void RemarkWhatIsMissed(const MissedMotion& missed,
                        std::vector<std::string>* remarks) {
  if (!missed.IsMore()) return;
  remarks->push_back(
      "Of the motion of the new records " +
      FormatNumber(100.0 * missed.last, 2) +
      " % is unexplained and too large to be noise; of the baselines' " +
      FormatNumber(100.0 * missed.healthy, 2) +
      " %. A part of the change is of a kind that was not looked for. Small "
      "changes may be side effects.");
}

void RemarkMassInstead(const GroupState& healthy, const GroupState& current,
                       const std::vector<bool>& is_logarithm,
                       const std::vector<ChangeSubject>& groups,
                       const std::vector<ChangeCandidate>& candidates,
                       const std::vector<ChangeCandidate>& found,
                       std::vector<std::string>* remarks) {
  // Squared correlation from which two changes are one, in place of the other.
  constexpr double kOne = 0.99;
  const Vector change = current.values - healthy.values;
  const Matrix covariance = current.covariance + healthy.covariance;
  const auto percent = [](double logarithm) {
    return FormatNumber(100.0 * std::expm1(logarithm), 3);
  };
  bool any = false;
  for (size_t c = 0; c < candidates.size(); ++c) {
    const ChangeSubject& mass = candidates[c].subject;
    const bool is_found = std::any_of(found.begin(), found.end(),
                                      [&mass](const ChangeCandidate& other) {
                                        return other.subject.name == mass.name;
                                      });
    if (mass.kind != ChangeKind::kMass || !is_found ||
        !is_logarithm[groups.size() + c]) {
      continue;
    }
    const auto m = static_cast<Eigen::Index>(groups.size() + c);
    std::vector<std::string> names, changes;
    for (size_t j = 0; j < groups.size(); ++j) {
      if (groups[j].kind != ChangeKind::kStiffness || !is_logarithm[j]) {
        continue;
      }
      const auto i = static_cast<Eigen::Index>(j);
      const double slope = covariance(i, m) / covariance(m, m);
      const double shared = slope * covariance(i, m) / covariance(i, i);
      if (!(shared > kOne)) continue;
      const double alone = change[i] - slope * change[m];
      const double half =
          1.96 * std::sqrt(std::max(0.0, (1.0 - shared) * covariance(i, i)));
      names.push_back("'" + groups[j].name + "'");
      changes.push_back(names.back() + " has changed by " + percent(alone) +
                        " % (95 % interval " + percent(alone - half) + " to " +
                        percent(alone + half) + " %)");
    }
    if (names.empty()) continue;
    any = true;
    remarks->push_back(
        "The records do not tell " + Join(names, ", ") + " from the mass at " +
        mass.place + ". If that mass has not changed, " + Join(changes, ", ") +
        ". The scatter between records is not included.");
  }
  if (!any) return;
  remarks->back() +=
      " If no mass can have changed, set damage.kinds = [\"damping\", "
      "\"stiffness\", \"nonlinear\"], leave out damage.masses and run again.";
}

}  // namespace pinode
