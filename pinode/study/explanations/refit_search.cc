#include "pinode/study/explanations/refit_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pinode/estimate/fit/multistart.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/ambient_suspects.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/explanations/frf_suspects.h"
#include "pinode/study/explanations/likely_delays.h"
#include "pinode/study/explanations/modes_search.h"
#include "pinode/study/explanations/rocking_base.h"
#include "pinode/study/explanations/unknown_forces.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Number of refits: of single suspects, of exchanges, and of suspects added to
// the best. Each costs a fraction of the fit, from whose end it begins.
constexpr size_t kMostSingles = 4;
constexpr size_t kMostExchanges = 2;
constexpr size_t kMostAdded = 2;
// A refit ends with the step that moves its log odds by less: an explanation
// that is the right one is met within a few steps. Wrong ones have long
// valleys.
constexpr double kLeastStepOfLogOdds = 0.1;
constexpr int kMostIterations = 15;
// Number of suspects together: more faults at once than these are another
// model.
constexpr size_t kMostTogether = 3;
// Number of kinds of wrong sensors of each ambient record to refit, of
// corrections of a gain, and the change of it that ends them.
constexpr size_t kMostAmbientSensors = 2;
constexpr int kMostGains = 4;
constexpr double kSameGain = 0.01;
// Number of refits of a rocking base, whose matrix follows the stiffness, and
// the change of the matrix that ends them.
constexpr int kMostRocking = 4;
constexpr double kSameMatrix = 0.01;
// Number of measured modes to leave out, one at a time.
constexpr size_t kMostModesLeftOut = 2;

bool IsTraining(const RecordScore& score) {
  return score.role == IdentificationRecord::Role::kTrain;
}

double MostUnexplained(const FitSummary& fit) {
  double most = 0.0;
  for (const RecordScore& score : fit.records) {
    if (IsTraining(score)) most = std::max(most, StructuredError(score));
  }
  return most;
}

// `fit` with the states of its training records.
FitSummary WithStates(const IdentificationProblem& problem,
                      const IdentifiedModel& model, const FitSummary& fit) {
  FitSummary result = fit;
  for (size_t r = 0; r < result.records.size(); ++r) {
    RecordScore& score = result.records[r];
    if (!IsTraining(score) || !score.finite || score.states.size() > 0) {
      continue;
    }
    const Vector start = score.start;
    ScoreRecord(problem, static_cast<int>(r), model.parameters, start,
                score.first_scored_sample, &score);
  }
  return result;
}

}  // namespace

double SquaredError(const FitSummary& fit) {
  double sum = 0.0;
  for (const RecordScore& score : fit.records) {
    if (IsTraining(score)) sum += std::pow(score.nrmse, 2);
  }
  return sum;
}

RefitSearch::RefitSearch(const IdentificationProblem& problem,
                         const IdentificationOptions& options,
                         const FitSummary& fit, const IdentifiedModel& model,
                         InnerFit* inner)
    : problem_(problem),
      options_(options),
      fit_(fit),
      model_(model),
      inner_(*inner),
      odds_(problem, fit),
      suspects_(MakeSuspects(problem, model)) {
  BeginNearTheEnd(&options_);
  options_.max_num_iterations =
      std::min(options_.max_num_iterations, kMostIterations);
  options_.keep_states = false;
  options_.num_starts = 0;
  if (problem.HasSpectra() || !problem.modal.empty()) AddSuspectsBeside();
  if (problem.num_train_records() == 0) return;
  // The log odds are N / 2m times the relative change of the cost.
  options_.function_tolerance =
      std::max(options_.function_tolerance,
               2.0 * kLeastStepOfLogOdds * ResidualMemory(problem, fit) /
                   std::max(odds_.num_samples(), 1.0));
}

// Sensors of ambient records and of frequency responses, and measured modes.
void RefitSearch::AddSuspectsBeside() {
  // The rate of one logger's clock is no factor on all data.
  suspects_.erase(std::remove_if(suspects_.begin(), suspects_.end(),
                                 [](const Suspect& suspect) {
                                   return suspect.kind ==
                                          Suspect::Kind::kClockRate;
                                 }),
                  suspects_.end());
  std::vector<bool> is_poor;
  for (const AmbientScore& score : fit_.ambient) {
    is_poor.push_back(score.LeastProbability() < limits::kSpectrumProbability);
  }
  for (Suspect& suspect :
       MakeAmbientSuspects(problem_, model_, is_poor, options_.num_threads,
                           kMostAmbientSensors)) {
    suspects_.push_back(std::move(suspect));
  }
  for (Suspect& suspect :
       MakeFrfSuspects(problem_, model_, kMostAmbientSensors)) {
    suspects_.push_back(std::move(suspect));
  }
  for (Suspect& suspect :
       WorstModes(problem_, fit_, model_, kMostModesLeftOut)) {
    suspects_.push_back(std::move(suspect));
  }
}

bool RefitSearch::Run() {
  Refit own;
  own.problem = problem_;
  own.fit = fit_;
  own.model = model_;
  own.log_odds = 0.0;
  if (problem_.num_train_records() > 0 && !problem_.HasSpectra()) {
    AddForceSuspects(own);
  }
  if (MostUnexplained(fit_) > limits::kLittleUnexplainedByForce) {
    for (Suspect& place : MakeForcePlaces(problem_)) {
      suspects_.push_back(std::move(place));
    }
  }
  if (!Score(own, suspects_, &scores_)) return false;
  // A bound that a fit has reached is a suspect whatever the score says.
  for (size_t i = 0; i < suspects_.size(); ++i) {
    if (suspects_[i].kind == Suspect::Kind::kBound && IsHeld(suspects_[i])) {
      Try(own, {i}, /*cold=*/false);
    }
  }
  for (const size_t i : Promising(scores_, kMostSingles, {})) {
    Try(own, {i}, /*cold=*/false);
  }
  if (MostUnexplained(fit_) > limits::kLittleUnexplained) {
    for (const size_t i : LikelyExchanges()) Try(own, {i}, /*cold=*/true);
  }
  for (size_t i = 0; i < suspects_.size(); ++i) {
    const Suspect& suspect = suspects_[i];
    // A force at a wrong place has adapted to it.
    if (!suspect.moved_forces.empty() || !suspect.ambient_exchanged.empty() ||
        !suspect.frf_changes.empty()) {
      Try(own, {i}, /*cold=*/true);
    }
    if (!suspect.left_out_modes.empty()) Try(own, {i}, /*cold=*/false);
    if (!suspect.ambient_scales.empty()) TryGain(own, i);
  }
  if (MostUnexplained(fit_) > limits::kLittleUnexplained) TryDelays(own);
  if (MostUnexplained(fit_) > limits::kNotedUnexplained) TryRocking(own);
  for (size_t together = 2; together <= kMostTogether; ++together) {
    if (!AddToBest()) break;
  }
  std::stable_sort(
      refits_.begin(), refits_.end(),
      [](const Refit& a, const Refit& b) { return a.log_odds > b.log_odds; });
  return true;
}

bool RefitSearch::Score(const Refit& at, std::vector<Suspect> suspects,
                        SuspectScores* scores) const {
  // Forces make a linear problem nonlinear: they are scored apart.
  std::vector<Suspect> forces(suspects.size());
  bool any_force = false;
  for (size_t i = 0; i < suspects.size(); ++i) {
    if (suspects[i].forces.empty()) continue;
    any_force = true;
    std::swap(suspects[i], forces[i]);
  }
  std::string unused;
  if (!ScoreSuspects(at.problem, at.fit, at.model, suspects,
                     options_.num_threads, scores, &unused)) {
    return false;
  }
  SuspectScores of_forces;
  if (!any_force || !ScoreSuspects(at.problem, at.fit, at.model, forces,
                                   options_.num_threads, &of_forces, &unused)) {
    return true;
  }
  for (size_t i = 0; i < forces.size(); ++i) {
    if (!forces[i].forces.empty()) scores->suspects[i] = of_forces.suspects[i];
  }
  return true;
}

void RefitSearch::AddForceSuspects(const Refit& own) {
  // A force elsewhere would be small if nothing is left but noise.
  constexpr double kWhite = 1.1;
  constexpr size_t kPlaces = 12;
  constexpr size_t kPlacesIfWhite = 3;
  const bool is_white = ResidualMemory(problem_, fit_) < kWhite;
  for (Suspect& suspect :
       MakeForceSuspects(problem_, WithStates(problem_, own.model, fit_),
                         own.model, is_white ? kPlacesIfWhite : kPlaces)) {
    suspects_.push_back(std::move(suspect));
  }
}

std::vector<size_t> RefitSearch::Promising(
    const SuspectScores& scores, size_t most,
    const std::vector<size_t>& taken) const {
  std::vector<std::pair<double, size_t>> ranked;
  for (size_t i = 0; i < scores.suspects.size(); ++i) {
    const SuspectScore& score = scores.suspects[i];
    if (score.num_unknowns == 0 ||
        std::find(taken.begin(), taken.end(), i) != taken.end()) {
      continue;
    }
    const double promise =
        score.gain - odds_.Penalty(score.num_unknowns, suspects_.size());
    if (promise > limits::kLogOdds) ranked.emplace_back(-promise, i);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<size_t> best;
  for (const auto& [unused, i] : ranked) {
    if (best.size() < most) best.push_back(i);
  }
  return best;
}

// Exchanges after which measured and predicted channels agree better.
std::vector<size_t> RefitSearch::LikelyExchanges() const {
  std::vector<std::pair<double, size_t>> ranked;
  for (size_t i = 0; i < suspects_.size(); ++i) {
    if (suspects_[i].exchanged.empty()) continue;
    double better = 0.0;
    for (const auto& [one, two] : suspects_[i].exchanged) {
      better += Agreement(one, two.second) + Agreement(two, one.second) -
                Agreement(one, one.second) - Agreement(two, two.second);
    }
    if (better > 0.0) ranked.emplace_back(-better, i);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<size_t> best;
  for (const auto& [unused, i] : ranked) {
    if (best.size() < kMostExchanges) best.push_back(i);
  }
  return best;
}

// Correlation of a measured channel with what another one should measure.
double RefitSearch::Agreement(const std::pair<int, int>& at,
                              int predicted) const {
  const size_t r = static_cast<size_t>(at.first);
  const Matrix& prediction = fit_.records[r].prediction;
  const Vector& values =
      problem_.records[r].channels[static_cast<size_t>(at.second)].values;
  if (prediction.cols() != values.size()) return 0.0;
  const Vector other = prediction.row(predicted).transpose();
  const auto present = values.array().isFinite();
  const Vector y = present.select(values, 0.0);
  const Vector p = present.select(other, 0.0);
  const double size = y.norm() * p.norm();
  return size > 0.0 ? y.dot(p) / size : 0.0;
}

bool RefitSearch::IsHeld(const Suspect& suspect) const {
  return std::any_of(
      suspect.freed.begin(), suspect.freed.end(), [&](const std::string& name) {
        const ParameterEstimate* estimate = FindEstimate(fit_, name);
        return estimate != nullptr && estimate->at_bound;
      });
}

// Refits with `suspects`, beginning with the values of `from`. `cold`: from
// the problem's own initial values, where the fit has adapted to the fault.
bool RefitSearch::Try(const Refit& from, std::vector<size_t> suspects,
                      bool cold) {
  Refit refit;
  refit.suspects = std::move(suspects);
  std::set<size_t> key(refit.suspects.begin(), refit.suspects.end());
  if (interrupted_ || !tried_.insert(key).second) return false;
  std::string unused;
  refit.problem = problem_;
  std::vector<Suspect> added;
  for (const size_t i : refit.suspects) added.push_back(suspects_[i]);
  if (!AddSuspects(added, &refit.problem, &unused)) return false;
  IdentifiedModel begin = BeginFrom(ParametersByName(from.problem, from.model),
                                    from.model, refit.problem);
  begin.decays = from.model.decays;
  IdentificationOptions options = options_;
  if (cold) options.shooting = IdentificationOptions().shooting;
  // The other starts of a fit that was lost are not for each explanation.
  if (cold && fit_.num_starts <= kStartsOfLost) options.num_starts = 1;
  inner_.Run("another explanation", refit.problem, options,
             cold ? nullptr : &begin, &refit.fit, &refit.model);
  if (refit.fit.termination == Termination::kInterrupted) {
    interrupted_ = true;
    return false;
  }
  if (refit.fit.termination == Termination::kFailure) return false;
  refit.log_odds = odds_.LogOddsOf(refit, suspects_);
  if (!std::isfinite(refit.log_odds)) return false;
  refits_.push_back(std::move(refit));
  return true;
}

// Refits with another gain of a channel until it is the one that the refit
// itself finds.
void RefitSearch::TryGain(const Refit& from, size_t i) {
  Suspect::AmbientScale& at = suspects_[i].ambient_scales.front();
  std::optional<Refit> former;
  double former_factor = at.factor;
  for (int round = 0; round < kMostGains; ++round) {
    if (!Try(from, {i}, /*cold=*/round == 0)) {
      // A later gain that cannot be fitted takes nothing from the former one.
      if (former.has_value()) {
        at.factor = former_factor;
        refits_.push_back(std::move(*former));
      }
      return;
    }
    if (at.factor < 0.0) return;
    const Refit& refit = refits_.back();
    const double again = AmbientScale(refit.problem, refit.model, at.record,
                                      at.channel, options_.num_threads);
    if (std::abs(std::log(again)) < kSameGain || round + 1 == kMostGains) {
      return;
    }
    former_factor = at.factor;
    at.factor *= again;
    former = std::move(refits_.back());
    refits_.pop_back();
    tried_.erase({i});
  }
}

// Refits with a rocking base until its matrix is that of the stiffness that the
// refit itself finds. The fit without it is far from the truth where a base
// rocks, so that no score at it tells: the first refit begins with the initial
// model.
void RefitSearch::TryRocking(const Refit& from) {
  const StructuralDynamics& dynamics = *problem_.dynamics;
  std::optional<Suspect> rocking = MakeRockingBase(dynamics.model());
  if (!rocking.has_value()) return;
  const size_t i = suspects_.size();
  suspects_.push_back(std::move(*rocking));
  // It has no score.
  scores_.suspects.resize(suspects_.size());
  Matrix& matrix = suspects_[i].groups[0].group.matrix;
  Matrix best_matrix = matrix;
  std::optional<Refit> best;
  for (int round = 0; round < kMostRocking; ++round) {
    tried_.erase({i});
    if (!Try(best.has_value() ? *best : from, {i}, /*cold=*/round == 0)) break;
    Refit next = std::move(refits_.back());
    refits_.pop_back();
    if (best.has_value() && next.log_odds <= best->log_odds) break;
    best = std::move(next);
    best_matrix = matrix;
    // Another matrix does not help a base that explains nothing.
    if (best->log_odds < 0.0) break;
    const IdentifiedModel own = BeginFrom(
        ParametersByName(best->problem, best->model), best->model, problem_);
    const StructuralModel corrected =
        dynamics.CorrectedModel(own.parameters.head(dynamics.num_parameters()));
    const Matrix again = RockingPerShare(corrected.stiffness,
                                         HeightsOfStoreys(dynamics.model()));
    const bool is_same = (again - matrix).norm() < kSameMatrix * matrix.norm();
    if (is_same || !again.allFinite()) break;
    matrix = again;
  }
  // The matrix of a round that was worse goes with its refit.
  matrix = best_matrix;
  if (best.has_value() && best->log_odds > 0.0) {
    refits_.push_back(std::move(*best));
  }
}

// Refits with delays that no step from zero reaches. The fit without one is
// lost in another valley: they begin with the initial model.
void RefitSearch::TryDelays(const Refit& from) {
  for (const LikelyDelay& likely :
       FindLikelyDelays(problem_, fit_, suspects_)) {
    const size_t i = likely.suspect;
    Parameter& delay = suspects_[i].sensors[0].parameter;
    delay.lower = std::min(delay.lower, -likely.widest);
    delay.upper = std::max(delay.upper, likely.widest);
    delay.value = likely.delay;
    tried_.erase({i});
    Try(from, {i}, /*cold=*/true);
    delay.value = 0.0;
    KeepBest({i});
  }
}

// Removes all refits with exactly these suspects but the best one.
void RefitSearch::KeepBest(const std::vector<size_t>& suspects) {
  double best = -kInfinity;
  for (const Refit& refit : refits_) {
    if (refit.suspects == suspects) best = std::max(best, refit.log_odds);
  }
  refits_.erase(std::remove_if(refits_.begin(), refits_.end(),
                               [&](const Refit& refit) {
                                 return refit.suspects == suspects &&
                                        refit.log_odds < best;
                               }),
                refits_.end());
}

// Adds a suspect to the best refit; true if that made it better by odds that
// count.
bool RefitSearch::AddToBest() {
  if (interrupted_ || refits_.empty()) return false;
  const Refit best = *std::max_element(
      refits_.begin(), refits_.end(),
      [](const Refit& a, const Refit& b) { return a.log_odds < b.log_odds; });
  if (best.log_odds < limits::kLogOdds) return false;
  SuspectScores scores;
  std::vector<Suspect> rest = suspects_;
  for (const size_t i : best.suspects) rest[i] = Suspect();
  if (!Score(best, std::move(rest), &scores)) return false;
  for (const size_t i : Promising(scores, kMostAdded, best.suspects)) {
    std::vector<size_t> more = best.suspects;
    more.push_back(i);
    if (!Try(best, more, /*cold=*/false)) continue;
    // An earlier suspect leaves again if the new one makes it needless.
    const Refit with = refits_.back();
    for (const size_t old : best.suspects) {
      std::vector<size_t> without = more;
      without.erase(std::find(without.begin(), without.end(), old));
      if (HoldsNothing(with, old)) Try(with, without, /*cold=*/false);
    }
  }
  return std::any_of(refits_.begin(), refits_.end(), [&](const Refit& other) {
    return other.suspects.size() > best.suspects.size() &&
           other.log_odds > best.log_odds + limits::kLogOdds;
  });
}

// True if the only unknown of suspect `i` is zero within its interval.
bool RefitSearch::HoldsNothing(const Refit& refit, size_t i) const {
  const std::vector<std::string> unknowns = suspects_[i].Unknowns();
  if (unknowns.size() != 1) return false;
  const ParameterEstimate* estimate = FindEstimate(refit.fit, unknowns[0]);
  if (estimate == nullptr) return false;
  const double nothing =
      suspects_[i].sensors.empty() ||
              suspects_[i].sensors[0].role != &MeasuredChannel::gain
          ? 0.0
          : 1.0;
  return estimate->lower95 < nothing && nothing < estimate->upper95;
}

}  // namespace pinode
