#include "pinode/study/damage/scale_instead.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/damage/loss_instead.h"
#include "pinode/study/damage/wide_state.h"

namespace pinode {
namespace {

using Entries = std::vector<int>;

double LogDeterminantOf(const Eigen::LLT<Matrix>& llt) {
  return 2.0 * Matrix(llt.matrixL()).diagonal().array().log().sum();
}

// All entries by their kind. Stiffness and masses are logarithms, and so is
// damping: that of a candidate is near zero in both states.
struct EntriesByKind {
  Entries stiffness, masses, damping;
  // Those that make up all damping together.
  Entries all_damping;
};

const ChangeSubject& SubjectAt(const ResultSubjects& all, int entry) {
  const auto j = static_cast<size_t>(entry);
  const size_t num_groups = all.num_groups();
  return j < num_groups ? all.subjects()[j]
                        : all.candidates()[j - num_groups].subject;
}

EntriesByKind SortEntries(const ResultSubjects& all,
                          const std::vector<bool>& is_logarithm) {
  EntriesByKind result;
  const int num_groups = static_cast<int>(all.num_groups());
  int first_damping = -1;
  for (int j = 0; j < static_cast<int>(is_logarithm.size()); ++j) {
    const bool is_log = is_logarithm[static_cast<size_t>(j)];
    switch (SubjectAt(all, j).kind) {
      case ChangeKind::kStiffness:
        if (is_log && j < num_groups) result.stiffness.push_back(j);
        break;
      case ChangeKind::kMass:
        if (is_log) result.masses.push_back(j);
        break;
      case ChangeKind::kDamping:
        if (j < num_groups && !is_log) break;
        result.damping.push_back(j);
        if (j < num_groups) result.all_damping.push_back(j);
        // The first candidate is one factor on all damping.
        if (j >= num_groups && first_damping < 0) first_damping = j;
        break;
      case ChangeKind::kNonlinear:
        break;
    }
  }
  if (first_damping >= 0) result.all_damping = {first_damping};
  return result;
}

bool IsAmong(const Entries& entries, int entry) {
  return std::find(entries.begin(), entries.end(), entry) != entries.end();
}

// `entries` without `others`, then `more`.
Entries Exchanged(const Entries& entries, const Entries& others,
                  const Entries& more) {
  Entries result;
  for (const int j : entries) {
    if (!IsAmong(others, j) && !IsAmong(more, j)) result.push_back(j);
  }
  result.insert(result.end(), more.begin(), more.end());
  return result;
}

// One column per entry, then one per list of entries that change together.
Matrix DirectionsOf(Eigen::Index size, const Entries& entries,
                    const std::vector<Entries>& together = {}) {
  const auto alone = static_cast<Eigen::Index>(entries.size());
  const auto count = alone + static_cast<Eigen::Index>(together.size());
  Matrix directions = Matrix::Zero(size, count);
  for (Eigen::Index k = 0; k < alone; ++k) {
    directions(entries[static_cast<size_t>(k)], k) = 1.0;
  }
  for (Eigen::Index k = alone; k < count; ++k) {
    for (const int j : together[static_cast<size_t>(k - alone)]) {
      directions(j, k) = 1.0;
    }
  }
  return directions;
}

std::string PercentOf(double logarithm) {
  const double change = std::expm1(logarithm);
  return " (" + std::string(change > 0.0 ? "+" : "") +
         FormatNumber(100.0 * change, 3) + " %)";
}

std::string NameOf(const ChangeSubject& subject) {
  if (subject.place.empty()) return "'" + subject.name + "'";
  return (subject.kind == ChangeKind::kMass ? "the mass at "
                                            : "the damping of ") +
         subject.place;
}

// Losses of stiffness in logarithms among what was found.
Entries LossesOf(const ResultSubjects& subjects, const Entries& stiffness) {
  Entries losses;
  for (const int j : stiffness) {
    const GroupChange& change =
        subjects.estimate().groups[static_cast<size_t>(j)];
    if (change.changed && change.change < 0.0) losses.push_back(j);
  }
  return losses;
}

// Keeps `other` in *best if it is the likeliest so far.
void KeepLikeliest(MassesInstead other, bool* any, MassesInstead* best) {
  if (*any && other.log_odds <= best->log_odds) return;
  *any = true;
  *best = std::move(other);
}

// Masses and damping in place of losses.
std::vector<MassesInstead> MassesForLosses(const ChangeSets& sets,
                                           const EntriesByKind& all,
                                           const ChangeOptions& options,
                                           const ResultSubjects& subjects) {
  std::vector<MassesInstead> result;
  const Entries found = subjects.ChangedEntries();
  const Entries losses = LossesOf(subjects, all.stiffness);
  if (losses.empty() || all.masses.empty() || all.damping.empty()) {
    return result;
  }
  const ChangeSets::Fit own = sets.FitOf(DirectionsOf(sets.size(), found));
  const auto counts = [&](const ChangeSets::Fit& fit) {
    return own.gain - fit.gain < options.rival_loss;
  };
  // One factor on all masses and one on all damping for all losses.
  if (losses.size() > 1) {
    const Entries rest = Exchanged(
        Exchanged(Exchanged(found, all.stiffness, {}), all.masses, {}),
        all.damping, {});
    const ChangeSets::Fit fit = sets.FitOf(
        DirectionsOf(sets.size(), rest, {all.masses, all.all_damping}));
    if (counts(fit)) {
      MassesInstead instead;
      const auto at = static_cast<Eigen::Index>(rest.size());
      for (const int j : losses) {
        instead.losses.push_back(static_cast<size_t>(j));
      }
      instead.what = "all masses" + PercentOf(fit.sizes[at]) +
                     " with all damping" + PercentOf(fit.sizes[at + 1]);
      instead.log_odds = fit.log_evidence - own.log_evidence;
      result.push_back(std::move(instead));
    }
  }
  // One of each for one loss.
  for (const int loss : losses) {
    bool any = false;
    MassesInstead best;
    for (const int mass : all.masses) {
      for (const int damping : all.damping) {
        if (IsAmong(found, mass) || IsAmong(found, damping)) continue;
        const Entries rest = Exchanged(found, {loss}, {mass, damping});
        const ChangeSets::Fit fit = sets.FitOf(DirectionsOf(sets.size(), rest));
        if (!counts(fit)) continue;
        const auto at = static_cast<Eigen::Index>(rest.size()) - 2;
        KeepLikeliest(
            {{static_cast<size_t>(loss)},
             NameOf(SubjectAt(subjects, mass)) + PercentOf(fit.sizes[at]) +
                 " with " + NameOf(SubjectAt(subjects, damping)) +
                 PercentOf(fit.sizes[at + 1]),
             fit.log_evidence - own.log_evidence},
            &any, &best);
      }
    }
    if (any) result.push_back(std::move(best));
  }
  return result;
}

// A loss of all stiffness in place of several masses.
void FindLossOfAll(const ChangeSets& sets, const EntriesByKind& all,
                   const ChangeOptions& options, ResultSubjects* subjects,
                   std::vector<bool>* is_loss) {
  const Entries found = subjects->ChangedEntries();
  const auto num_masses =
      std::count_if(all.masses.begin(), all.masses.end(),
                    [&](int mass) { return IsAmong(found, mass); });
  if (num_masses < 2 || all.stiffness.empty() ||
      static_cast<std::ptrdiff_t>(all.stiffness.size()) > num_masses) {
    return;
  }
  const ChangeSets::Fit with =
      sets.FitOf(DirectionsOf(sets.size(), Exchanged(found, {}, all.damping)));
  const Entries instead =
      Exchanged(Exchanged(found, all.masses, all.damping), {}, all.stiffness);
  const ChangeSets::Fit without =
      sets.FitOf(DirectionsOf(sets.size(), instead));
  if (!(with.gain - without.gain < options.rival_loss)) return;
  const auto begin =
      static_cast<Eigen::Index>(instead.size() - all.stiffness.size());
  for (size_t k = 0; k < all.stiffness.size(); ++k) {
    const Eigen::Index i = begin + static_cast<Eigen::Index>(k);
    const auto j = static_cast<size_t>(all.stiffness[k]);
    GroupChange change;
    change.change = without.sizes[i];
    change.sigma = std::sqrt(without.covariance(i, i));
    change.lower95 = change.change - sets.quantile() * change.sigma;
    change.upper95 = change.change + sets.quantile() * change.sigma;
    FromLogarithm(options.threshold, 1.0, &change);
    if (!(change.lower95 < -options.threshold)) continue;
    GroupChange& own = subjects->mutable_estimate()->groups[j];
    if (!(*is_loss)[j] && IsLostEitherWay(change, &own)) continue;
    change.changed = own.changed;
    change.p_value = own.p_value;
    own = change;
    (*is_loss)[j] = true;
  }
}

}  // namespace

ChangeSets::ChangeSets(const PooledBaselines& expected,
                       const GroupState& current) {
  const Matrix covariance = current.covariance + expected.state.covariance;
  information_ = covariance.llt().solve(
      Matrix::Identity(covariance.rows(), covariance.cols()));
  right_ = information_ * (current.values - expected.state.values);
  quantile_ = StudentQuantile(
      DegreesOfFreedom(expected.between, covariance.diagonal(),
                       static_cast<size_t>(expected.num_baselines)));
}

ChangeSets::Fit ChangeSets::FitOf(const Matrix& directions) const {
  const Matrix weight = directions.transpose() * information_ * directions;
  const Vector right = directions.transpose() * right_;
  const Matrix identity = Matrix::Identity(weight.rows(), weight.cols());
  const Eigen::LLT<Matrix> alone(weight);
  const Eigen::LLT<Matrix> with_prior(Matrix(weight + identity));
  Fit fit;
  fit.sizes = alone.solve(right);
  fit.covariance = alone.solve(identity);
  fit.gain = right.dot(fit.sizes);
  fit.log_evidence = 0.5 * right.dot(Vector(with_prior.solve(right))) -
                     0.5 * LogDeterminantOf(with_prior) -
                     static_cast<double>(directions.cols()) *
                         std::log(static_cast<double>(size()));
  return fit;
}

bool FindScaleInstead(const ComparedStates& states,
                      const ChangeOptions& options, ResultSubjects* subjects,
                      std::vector<bool>* is_loss,
                      std::vector<MassesInstead>* masses, std::string* error) {
  PooledBaselines pooled;
  if (!PoolBaselines(states.healthy, &pooled, error)) return false;
  const ChangeSets sets(pooled, states.current);
  const EntriesByKind all = SortEntries(*subjects, states.is_logarithm);
  is_loss->resize(subjects->subjects().size(), false);
  *masses = MassesForLosses(sets, all, options, *subjects);
  for (const MassesInstead& instead : *masses) {
    if (!(instead.log_odds > -limits::kLogOdds)) continue;
    for (const size_t j : instead.losses) (*is_loss)[j] = true;
  }
  FindLossOfAll(sets, all, options, subjects, is_loss);
  return true;
}

void RemarkMassesInstead(const std::vector<MassesInstead>& instead,
                         const ResultSubjects& subjects,
                         std::vector<std::string>* remarks) {
  for (const MassesInstead& one : instead) {
    std::vector<std::string> losses;
    for (const size_t j : one.losses) {
      losses.push_back(
          "'" + subjects.subjects()[j].name + "'" +
          PercentOf(std::log1p(subjects.estimate().groups[j].change)));
    }
    std::string remark = "Or, equally: " + one.what + " in place of " +
                         Join(losses, ", ") +
                         ". The records do not tell these apart. ";
    if (one.log_odds > -limits::kLogOdds) {
      remark +=
          "If no mass can have changed, set damage.kinds = [\"damping\", "
          "\"stiffness\", \"nonlinear\"], leave out damage.masses and run "
          "again.";
    } else {
      // Larger odds are more than states of one record each can show.
      constexpr double kMostOdds = 1000.0;
      const double odds = std::exp(-one.log_odds);
      remark +=
          "The sizes of two changes would have to match, so the loss is " +
          (odds > kMostOdds ? "more than 1000" : FormatNumber(odds, 2)) +
          " times as likely. If that mass has changed, this is no "
          "damage.";
    }
    remarks->push_back(std::move(remark));
  }
}

}  // namespace pinode
