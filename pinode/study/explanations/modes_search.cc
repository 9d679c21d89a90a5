#include "pinode/study/explanations/modes_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/problem/close_modes.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/explanations/shape_suspects.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Number of suspects together.
constexpr size_t kMostModesTogether = 2;

// Number of faults of sensors of each kind to refit, and of places up to which
// the gain of each sensor is fitted.
constexpr size_t kMostShapeSuspects = 2;
constexpr size_t kMostGainPlaces = 40;

// Squared errors above which a mode may be wrong, as a multiple of what its
// standard deviations allow.
constexpr double kWorst = 4.0;

// MAC below which faults of sensors are tried where modes have no standard
// deviations. MakeShapeSuspects does not offer what improves a MAC by less.
constexpr double kUnlike = 0.98;

// Range of the entries of a shape whose largest is one.
constexpr double kRangeOfEntry = 2.0;
// Mean squared error of modes without standard deviations that rounding may
// leave.
constexpr double kRoundingSquare = 1e-20;
// Degrees of freedom, at least one but for rounding, that show the size of
// residuals without standard deviations.
constexpr double kLeastLeft = 0.5;
// Number of DOFs up to which modes without standard deviations are searched.
// Modes of larger models are not worth their time here.
constexpr int kMostSearchedDofs = 200;

Suspect LeftOut(const IdentificationProblem& problem, size_t i) {
  const MeasuredMode& mode = problem.modal.modes[i];
  Suspect suspect;
  suspect.kind = Suspect::Kind::kMode;
  suspect.place = mode.name.empty() ? std::to_string(i + 1) : mode.name;
  suspect.what = "mode " + suspect.place + " (" +
                 FormatNumber(mode.frequency, 4) +
                 ") misread or mistaken for another";
  suspect.left_out_modes = {static_cast<int>(i)};
  return suspect;
}

// True if a shape with an entry at `place` has two others.
bool OthersRemain(int place, const ModalData& data) {
  return std::any_of(
      data.modes.begin(), data.modes.end(), [place](const MeasuredMode& mode) {
        return mode.dofs.size() > 2 &&
               std::count(mode.dofs.begin(), mode.dofs.end(), place) > 0;
      });
}

}  // namespace

int NumbersOf(const MeasuredMode& mode) {
  return 1 + (mode.HasShape() ? static_cast<int>(mode.shape.size()) - 1 : 0);
}

std::vector<Suspect> WorstModes(const IdentificationProblem& problem,
                                const FitSummary& fit,
                                const IdentifiedModel& model, size_t most) {
  std::vector<std::pair<double, size_t>> ranked;
  const ParameterLayout layout(problem);
  if (!problem.modal.HasSigmasOfAll()) return {};
  size_t in_use = 0;
  for (size_t i = 0; i < fit.modes.size(); ++i) {
    if (!fit.modes[i].InUse()) continue;
    ++in_use;
    std::vector<bool> only(fit.modes.size(), false);
    only[i] = true;
    ModalCost own(OnlyModes(problem.modal, only), *problem.dynamics, layout);
    double cost = 0.0;
    if (!own.Evaluate(layout.Free(model.parameters), &cost)) continue;
    const double worse = 2.0 * cost / NumbersOf(problem.modal.modes[i]);
    if (worse > kWorst) ranked.emplace_back(-worse, i);
  }
  if (in_use < 2) return {};
  std::sort(ranked.begin(), ranked.end());
  std::vector<Suspect> suspects;
  for (const auto& [unused, i] : ranked) {
    if (suspects.size() < most) suspects.push_back(LeftOut(problem, i));
  }
  return suspects;
}

bool IsOfModes(const IdentificationProblem& problem) {
  return problem.num_train_records() == 0 && !problem.HasSpectra() &&
         !problem.modal.empty() && problem.modal.HasSigmasOfAll();
}

bool HasModesAlone(const IdentificationProblem& problem) {
  return IsOfModes(problem) ||
         (problem.num_train_records() == 0 && !problem.HasSpectra() &&
          !problem.modal.empty() && !problem.modal.HasSigmas() &&
          problem.modal.form == ModalForm::kEigenvectorDifference);
}

ModesSearch::ModesSearch(const IdentificationProblem& problem,
                         const IdentificationOptions& options,
                         const FitSummary& fit, const IdentifiedModel& model,
                         InnerFit* inner)
    : problem_(problem),
      options_(options),
      fit_(fit),
      model_(model),
      inner_(*inner) {
  BeginNearTheEnd(&options_);
  options_.num_starts = 0;
  num_measured_ = NumMeasuredIn(problem, fit);
  left_ = num_measured_ - fit.effective_parameters;
}

// Number of measured numbers of the modes that a fit uses.
int ModesSearch::NumMeasuredIn(const IdentificationProblem& problem,
                               const FitSummary& fit) const {
  int count = 0;
  for (size_t i = 0; i < fit.modes.size(); ++i) {
    if (fit.modes[i].InUse()) count += NumbersOf(problem.modal.modes[i]);
  }
  // Each pair of close modes has one number less: the angle between the two.
  for (const std::vector<int>& set : CloseModes(OnlyModes(
           problem.modal, ModesInUse(problem.modal, *problem.dynamics)))) {
    const int size = static_cast<int>(set.size());
    count -= size * (size - 1) / 2;
  }
  return count;
}

double ModesSearch::SquaredErrorLeft() const {
  return 2.0 * fit_.final_modal_cost / std::max(1.0, left_);
}

bool ModesSearch::IsBeyondDeviations() const {
  return problem_.modal.HasSigmasOfAll() &&
         ChiSquareProbability(2.0 * fit_.final_modal_cost,
                              std::max(1.0, left_)) < limits::kModesProbability;
}

// True if a shape has no partner, or one that a fault of a sensor may explain.
bool ModesSearch::IsAnyShapeUnlike() const {
  const bool has_deviations = problem_.modal.HasSigmasOfAll();
  if (!has_deviations &&
      problem_.dynamics->model().num_dofs() > kMostSearchedDofs) {
    return false;
  }
  return std::any_of(fit_.modes.begin(), fit_.modes.end(),
                     [&](const ModeScore& score) {
                       return !score.InUse() ||
                              (!has_deviations && score.updated.mac < kUnlike);
                     });
}

bool ModesSearch::Run() {
  if (!IsBeyondDeviations() && !IsAnyShapeUnlike()) return false;
  if (IsBeyondDeviations()) AddCatalogue();
  for (Suspect& suspect :
       MakeShapeSuspects(problem_, model_, kMostShapeSuspects)) {
    suspects_.push_back(std::move(suspect));
  }
  Refit own;
  own.problem = problem_;
  own.fit = fit_;
  own.model = model_;
  own.log_odds = 0.0;
  if (IsBeyondDeviations()) AddGains();
  for (size_t i = 0; i < suspects_.size(); ++i) Try(own, {i});
  for (size_t together = 2; together <= kMostModesTogether; ++together) {
    if (Best() == nullptr || Best()->log_odds < limits::kLogOdds) break;
    const Refit best = *Best();
    for (size_t i = 0; i < suspects_.size(); ++i) {
      std::vector<size_t> more = best.suspects;
      more.push_back(i);
      Try(best, std::move(more));
    }
  }
  std::stable_sort(
      refits_.begin(), refits_.end(),
      [](const Refit& a, const Refit& b) { return a.log_odds > b.log_odds; });
  return true;
}

// Masses, springs and bounds; modes that may be wrong themselves.
void ModesSearch::AddCatalogue() {
  for (Suspect& suspect : MakeSuspects(problem_, model_)) {
    if (suspect.kind == Suspect::Kind::kMass ||
        suspect.kind == Suspect::Kind::kStiffness ||
        suspect.kind == Suspect::Kind::kBound) {
      suspects_.push_back(std::move(suspect));
    }
  }
  AddModes();
}

// Gains of single sensors, each from a fit without its entries: the other
// entries and the frequencies know nothing of it.
void ModesSearch::AddGains() {
  const std::vector<int> places = MeasuredPlaces(problem_.modal);
  if (places.size() > kMostGainPlaces) return;
  for (const int place : places) {
    if (interrupted_) return;
    if (!OthersRemain(place, problem_.modal)) continue;
    IdentificationProblem without = problem_;
    LeaveOutPlace(place, &without.modal);
    std::string unused;
    if (!without.IsValid(&unused)) continue;
    const IdentifiedModel begin =
        BeginFrom(ParametersByName(problem_, model_), model_, without);
    FitSummary fit;
    IdentifiedModel model;
    inner_.Run("another explanation", without, options_, &begin, &fit, &model);
    if (fit.termination == Termination::kInterrupted) interrupted_ = true;
    if (fit.termination == Termination::kInterrupted ||
        fit.termination == Termination::kFailure) {
      continue;
    }
    std::optional<Suspect> gain =
        MakeGainOfShapes(problem_, model.parameters, place);
    if (!gain.has_value()) continue;
    gain->num_compared = places.size();
    suspects_.push_back(std::move(*gain));
  }
}

// Misread modes, or modes of something else.
void ModesSearch::AddModes() {
  int in_use = 0;
  for (const ModeScore& score : fit_.modes) in_use += score.InUse() ? 1 : 0;
  for (size_t i = 0; i < fit_.modes.size() && in_use > 1; ++i) {
    if (!fit_.modes[i].InUse()) continue;
    suspects_.push_back(LeftOut(problem_, i));
  }
}

void ModesSearch::Try(const Refit& from, std::vector<size_t> suspects) {
  Refit refit;
  refit.suspects = std::move(suspects);
  const std::set<size_t> key(refit.suspects.begin(), refit.suspects.end());
  if (interrupted_ || key.size() != refit.suspects.size() ||
      !tried_.insert(key).second) {
    return;
  }
  std::string unused;
  refit.problem = problem_;
  std::vector<Suspect> added;
  for (const size_t i : refit.suspects) added.push_back(suspects_[i]);
  if (!AddSuspects(added, &refit.problem, &unused)) return;
  const IdentifiedModel begin = BeginFrom(
      ParametersByName(from.problem, from.model), from.model, refit.problem);
  // The fit has adapted to a fault of a sensor: the first fit without it begins
  // with the initial model.
  const bool is_cold =
      from.suspects.empty() && !added.front().shape_changes.empty();
  IdentificationOptions options = options_;
  if (is_cold) options.num_starts = 1;
  inner_.Run("another explanation", refit.problem, options,
             is_cold ? nullptr : &begin, &refit.fit, &refit.model);
  if (refit.fit.termination == Termination::kInterrupted) {
    interrupted_ = true;
    return;
  }
  if (refit.fit.termination == Termination::kFailure) return;
  refit.log_odds = LogOdds(refit);
  if (std::isfinite(refit.log_odds)) refits_.push_back(std::move(refit));
}

double ModesSearch::LogOdds(const Refit& refit) const {
  double unknowns = 0.0, left_out = 0.0, choice = 0.0;
  for (const size_t i : refit.suspects) {
    const Suspect& suspect = suspects_[i];
    unknowns += static_cast<double>(suspect.Unknowns().size());
    choice += std::log(
        static_cast<double>(std::max(suspects_.size(), suspect.num_compared)));
    // A gain is an unknown, a sign is not.
    for (const Suspect::ShapeChange& change : suspect.shape_changes) {
      unknowns += change.kind == Suspect::ShapeChange::Kind::kScale &&
                          change.factor > 0.0
                      ? 1.0
                      : 0.0;
    }
    for (const int mode : suspect.left_out_modes) {
      left_out += NumbersOf(problem_.modal.modes[static_cast<size_t>(mode)]);
    }
  }
  // Numbers that the fit had to leave out and the refit describes.
  const double gained =
      NumMeasuredIn(refit.problem, refit.fit) - (num_measured_ - left_out);
  const double count = num_measured_ + std::max(0.0, gained);
  const bool has_deviations = problem_.modal.HasSigmasOfAll();
  // Residuals of as many numbers as unknowns are remainders of the solver.
  if (!has_deviations && std::min(left_, left_ + gained) < kLeastLeft) {
    return -kInfinity;
  }
  const double least = has_deviations ? 1.0 : kRoundingSquare;
  const auto mean_square = [least](const FitSummary& fit, double left) {
    return std::max(least, 2.0 * fit.final_modal_cost / std::max(1.0, left));
  };
  const double after = mean_square(refit.fit, left_ + gained);
  unknowns += left_out;
  return 0.5 * num_measured_ * std::log(mean_square(fit_, left_) / after) -
         0.5 * unknowns * std::log(std::max(count, 2.0)) +
         LogWorthOfRegained(refit, after) - choice;
}

// `mean_square` is that of the refit's residuals.
double ModesSearch::LogWorthOfRegained(const Refit& refit,
                                       double mean_square) const {
  const double step = std::sqrt(mean_square * 2.0 * kPi * std::exp(1.0));
  const double count = std::max(2.0, static_cast<double>(num_measured_));
  std::set<int> left_out;
  for (const size_t i : refit.suspects) {
    left_out.insert(suspects_[i].left_out_modes.begin(),
                    suspects_[i].left_out_modes.end());
  }
  double worth = 0.0;
  size_t next = 0;  // mode of the refit
  for (size_t i = 0; i < fit_.modes.size(); ++i) {
    if (left_out.count(static_cast<int>(i)) > 0) continue;
    const MeasuredMode& mode = refit.problem.modal.modes[next];
    const bool is_used = refit.fit.modes[next++].InUse();
    if (is_used == fit_.modes[i].InUse()) continue;
    if (!is_used) {  // Its numbers are unknowns now.
      worth -= 0.5 * NumbersOf(mode) * std::log(count);
      continue;
    }
    // The residual of a frequency is that of its square, relative.
    const double frequency_error = mode.frequency_sigma > 0.0
                                       ? mode.frequency_sigma / mode.frequency
                                       : 0.5 / mode.frequency_weight;
    worth += std::log(2.0 * limits::kModeDistance / (step * frequency_error));
    if (!mode.HasShape()) continue;
    const double largest = mode.shape.cwiseAbs().maxCoeff();
    double entry_error = 1.0 / mode.shape_weight;
    if (mode.shape_sigma > 0.0) {
      entry_error = mode.shape_sigma / largest;
    } else if (mode.shape_covariance.size() > 0) {
      entry_error =
          std::sqrt(mode.shape_covariance.diagonal().mean()) / largest;
    }
    worth +=
        (NumbersOf(mode) - 1) * std::log(kRangeOfEntry / (step * entry_error));
  }
  return worth;
}

const Refit* ModesSearch::Best() const {
  const auto best = std::max_element(
      refits_.begin(), refits_.end(),
      [](const Refit& a, const Refit& b) { return a.log_odds < b.log_odds; });
  return best == refits_.end() ? nullptr : &*best;
}

}  // namespace pinode
