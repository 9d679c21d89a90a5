#include "pinode/study/damage/scale_instead.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

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

// All entries by their kind. Stiffness and masses are logarithms. Damping of
// groups is too, that of candidates is near zero in both states and is none.
struct EntriesByKind {
  // Stiffness of groups, then that of springs in no group.
  Entries stiffness;
  Entries masses, damping;
  // Entries that make up all masses together, each once, and all damping.
  Entries all_masses, all_damping;
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
  Entries masses_of_groups, masses_of_candidates;
  for (int j = 0; j < static_cast<int>(is_logarithm.size()); ++j) {
    const bool is_log = is_logarithm[static_cast<size_t>(j)];
    const bool is_group = j < num_groups;
    const ChangeSubject& subject = SubjectAt(all, j);
    switch (subject.kind) {
      case ChangeKind::kStiffness:
        if (is_log) result.stiffness.push_back(j);
        break;
      case ChangeKind::kMass:
        if (!is_log) break;
        result.masses.push_back(j);
        (is_group ? masses_of_groups : masses_of_candidates).push_back(j);
        break;
      case ChangeKind::kDamping:
        if (is_group && !is_log) break;
        result.damping.push_back(j);
        if (is_group) result.all_damping.push_back(j);
        break;
      case ChangeKind::kNonlinear:
        break;
    }
  }
  // One candidate is a factor on all damping; others are modes and dampers.
  for (const int j : result.damping) {
    if (SubjectAt(all, j).place == kAllModes) result.all_damping = {j};
  }
  // A group and a candidate may be the same mass.
  result.all_masses =
      masses_of_candidates.empty() ? masses_of_groups : masses_of_candidates;
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

std::string PercentOf(double fraction) {
  return " (" + std::string(fraction > 0.0 ? "+" : "") +
         FormatNumber(100.0 * fraction, 3) + " %)";
}

std::string NameOf(const ChangeSubject& subject) {
  if (subject.place.empty()) return "'" + subject.name + "'";
  switch (subject.kind) {
    case ChangeKind::kMass:
      return "the mass at " + subject.place;
    case ChangeKind::kDamping:
      return "the damping of " + subject.place;
    case ChangeKind::kStiffness:
      if (subject.place == "rest") return "the stiffness in no group";
      return "spring " + subject.place;
    case ChangeKind::kNonlinear:
      break;
  }
  return subject.place;
}

// Change of entry `i` of a fit, a logarithm.
GroupChange ChangeIn(const ChangeSets::Fit& fit, Eigen::Index i,
                     double quantile, double threshold) {
  GroupChange change;
  change.change = fit.sizes[i];
  change.sigma = std::sqrt(fit.covariance(i, i));
  change.lower95 = change.change - quantile * change.sigma;
  change.upper95 = change.change + quantile * change.sigma;
  FromLogarithm(threshold, 1.0, &change);
  return change;
}

// Masses and damping in place of losses.
class MassesForLosses {
 public:
  MassesForLosses(const ChangeSets& sets, const EntriesByKind& all,
                  const std::vector<bool>& is_logarithm,
                  const ChangeOptions& options, ResultSubjects* subjects)
      : sets_(sets),
        all_(all),
        is_logarithm_(is_logarithm),
        options_(options),
        subjects_(*subjects),
        found_(subjects->ChangedEntries()) {}

  // The likeliest for all losses, and for each.
  std::vector<MassesInstead> Run() {
    for (const int j : found_) {
      if (!IsAmong(all_.stiffness, j)) continue;
      const GroupChange& change = subjects_.estimate().groups[SubjectOf(j)];
      if (change.change < 0.0) losses_.push_back(j);
    }
    if (losses_.empty() || all_.masses.empty() || all_.damping.empty()) {
      return {};
    }
    own_ = sets_.FitOf(DirectionsOf(sets_.size(), found_));
    TryAll();
    for (const int loss : losses_) {
      std::optional<MassesInstead> best;
      for (const int mass : all_.masses) {
        for (const int damping : all_.damping) {
          if (IsAmong(found_, mass) || IsAmong(found_, damping)) continue;
          Try({Exchanged(found_, {loss}, {}), {mass}, {damping}, {loss}},
              &best);
        }
      }
      if (best.has_value()) result_.push_back(std::move(*best));
    }
    return result_;
  }

  // Subjects of losses that are not 20 times as likely as one of the sets, or
  // may be none beside one.
  const std::vector<size_t>& unsure() const { return unsure_; }

 private:
  // One factor on `masses` and one on `damping` in place of `losses`. The
  // changes `beside` stay; of these `named`, the last, may be part of the set.
  struct Exchange {
    Entries beside, masses, damping, losses;
    bool named = false;
  };

  size_t SubjectOf(int entry) const {
    return static_cast<size_t>(subjects_.SubjectOf(entry));
  }

  // One factor on all masses and one on all damping for all losses, alone or
  // with one of the changes that were found.
  void TryAll() {
    if ((losses_.size() < 2 && all_.all_masses.size() < 2) ||
        all_.all_masses.empty() || all_.all_damping.empty()) {
      return;
    }
    const Entries rest = Exchanged(
        Exchanged(Exchanged(found_, all_.stiffness, {}), all_.masses, {}),
        all_.damping, {});
    std::optional<MassesInstead> best, best_with_one;
    Try({rest, all_.all_masses, all_.all_damping, losses_}, &best);
    for (const int one : found_) {
      const bool may_stay =
          IsAmong(all_.stiffness, one) ||
          (IsAmong(all_.masses, one) && all_.all_masses.size() > 1);
      const Entries losses = Exchanged(losses_, {one}, {});
      if (!may_stay || losses.empty()) continue;
      Try({Exchanged(rest, {}, {one}), all_.all_masses, all_.all_damping,
           losses, true},
          &best_with_one);
    }
    if (best_with_one.has_value() &&
        (!best.has_value() || best_with_one->log_odds > best->log_odds)) {
      result_.push_back(std::move(*best_with_one));
    }
    if (best.has_value()) result_.push_back(std::move(*best));
  }

  // Keeps `exchange` in *best if it explains the records and is the likeliest
  // so far.
  void Try(const Exchange& exchange, std::optional<MassesInstead>* best) {
    const ChangeSets::Fit fit = sets_.FitOf(DirectionsOf(
        sets_.size(), exchange.beside, {exchange.masses, exchange.damping}));
    if (!(own_.gain - fit.gain < options_.rival_loss)) return;
    MassesInstead instead;
    instead.log_odds = fit.log_evidence - own_.log_evidence;
    for (const int j : exchange.losses) {
      instead.losses.push_back(SubjectOf(j));
      if (instead.log_odds > -limits::kLogOdds) {
        unsure_.push_back(instead.losses.back());
      }
    }
    const auto at = static_cast<Eigen::Index>(exchange.beside.size());
    if (exchange.named && instead.log_odds > -limits::kLogOdds) {
      DoubtBeside(exchange.beside.back(), fit, at - 1);
    }
    if (best->has_value() && instead.log_odds <= (*best)->log_odds) return;
    instead.what = TextOf(exchange.masses, "masses", fit.sizes[at]) + " with " +
                   TextOf(exchange.damping, "damping", fit.sizes[at + 1]);
    if (exchange.named) {
      instead.what +=
          " and " + TextOf({exchange.beside.back()}, "", fit.sizes[at - 1]);
    }
    *best = std::move(instead);
  }

  // A loss that stays beside masses may be smaller than it was found, or none.
  void DoubtBeside(int entry, const ChangeSets::Fit& fit, Eigen::Index i) {
    if (!IsAmong(losses_, entry)) return;
    const size_t j = SubjectOf(entry);
    if (!IsLostEitherWay(ChangeIn(fit, i, sets_.quantile(), options_.threshold),
                         &subjects_.mutable_estimate()->groups[j])) {
      unsure_.push_back(j);
    }
  }

  // Entries that change together, and by how much.
  std::string TextOf(const Entries& entries, const std::string& what,
                     double size) const {
    const bool is_log = is_logarithm_[static_cast<size_t>(entries[0])];
    return (entries.size() > 1 ? "all " + what + " that were looked at"
                               : NameOf(SubjectAt(subjects_, entries[0]))) +
           PercentOf(is_log ? std::expm1(size) : size);
  }

  const ChangeSets& sets_;
  const EntriesByKind& all_;
  const std::vector<bool>& is_logarithm_;
  const ChangeOptions& options_;
  ResultSubjects& subjects_;
  const Entries found_;
  Entries losses_;
  ChangeSets::Fit own_;
  std::vector<MassesInstead> result_;
  std::vector<size_t> unsure_;
};

// A loss of all stiffness in place of several masses.
void FindLossOfAll(const ChangeSets& sets, const EntriesByKind& all,
                   const ChangeOptions& options, ResultSubjects* subjects,
                   std::vector<bool>* is_loss) {
  const Entries found = subjects->ChangedEntries();
  const auto num_masses =
      std::count_if(all.masses.begin(), all.masses.end(),
                    [&](int mass) { return IsAmong(found, mass); });
  Entries springs = all.stiffness;
  if (static_cast<std::ptrdiff_t>(springs.size()) > num_masses) {
    const int num_groups = static_cast<int>(subjects->num_groups());
    springs.erase(std::lower_bound(springs.begin(), springs.end(), num_groups),
                  springs.end());
  }
  if (num_masses < 2 || springs.empty() ||
      static_cast<std::ptrdiff_t>(springs.size()) > num_masses) {
    return;
  }
  const ChangeSets::Fit with =
      sets.FitOf(DirectionsOf(sets.size(), Exchanged(found, {}, all.damping)));
  const Entries instead =
      Exchanged(Exchanged(found, all.masses, all.damping), {}, springs);
  const ChangeSets::Fit without =
      sets.FitOf(DirectionsOf(sets.size(), instead));
  if (!(with.gain - without.gain < options.rival_loss)) return;
  const auto begin = static_cast<Eigen::Index>(instead.size() - springs.size());
  for (size_t k = 0; k < springs.size(); ++k) {
    const Eigen::Index i = begin + static_cast<Eigen::Index>(k);
    GroupChange change =
        ChangeIn(without, i, sets.quantile(), options.threshold);
    if (!(change.lower95 < -options.threshold)) continue;
    const auto j = static_cast<size_t>(subjects->SubjectOf(springs[k]));
    is_loss->resize(subjects->subjects().size(), false);
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
  MassesForLosses exchange(sets, all, states.is_logarithm, options, subjects);
  *masses = exchange.Run();
  for (const size_t j : exchange.unsure()) (*is_loss)[j] = true;
  FindLossOfAll(sets, all, options, subjects, is_loss);
  return true;
}

void RemarkMassesInstead(const std::vector<MassesInstead>& instead,
                         const ResultSubjects& subjects,
                         std::vector<std::string>* remarks) {
  for (const MassesInstead& one : instead) {
    std::vector<std::string> losses;
    for (const size_t j : one.losses) {
      losses.push_back(NameOf(subjects.subjects()[j]) +
                       PercentOf(subjects.estimate().groups[j].change));
    }
    const bool is_one = losses.size() == 1;
    std::string remark = "Or, with the same motion: " + one.what +
                         " in place of " + Join(losses, ", ") +
                         ". The records do not tell these apart. ";
    if (one.log_odds > -limits::kLogOdds) {
      remark +=
          "If no mass can have changed, set damage.kinds = [\"damping\", "
          "\"stiffness\", \"nonlinear\"], leave out damage.masses, fix mass "
          "groups and run again.";
    } else {
      // Larger odds are more than states of one record each can show.
      constexpr double kMostOdds = 1000.0;
      const double odds = std::exp(-one.log_odds);
      remark += "The sizes of two changes would have to match, so the " +
                std::string(is_one ? "loss is " : "losses are ") +
                (odds > kMostOdds ? "more than 1000" : FormatNumber(odds, 2)) +
                " times as likely. If the masses have changed, " +
                (is_one ? "this is" : "these are") + " no damage.";
    }
    remarks->push_back(std::move(remark));
  }
}

}  // namespace pinode
