#include "pinode/study/explanations/modes_search.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/problem/close_modes.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Number of suspects together.
constexpr size_t kMostModesTogether = 2;

// Squared errors above which a mode may be wrong, as a multiple of what its
// standard deviations allow.
constexpr double kWorst = 4.0;

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
  for (Suspect& suspect : MakeSuspects(problem, model)) {
    if (suspect.kind == Suspect::Kind::kMass ||
        suspect.kind == Suspect::Kind::kStiffness ||
        suspect.kind == Suspect::Kind::kBound) {
      suspects_.push_back(std::move(suspect));
    }
  }
  for (size_t i = 0; i < fit.modes.size(); ++i) {
    if (fit.modes[i].InUse())
      num_measured_ += NumbersOf(problem.modal.modes[i]);
  }
  // Each pair of close modes has one number less: the angle between the two.
  for (const std::vector<int>& set : CloseModes(OnlyModes(
           problem.modal, ModesInUse(problem.modal, *problem.dynamics)))) {
    const int size = static_cast<int>(set.size());
    num_measured_ -= size * (size - 1) / 2;
  }
  left_ = std::max(1.0, num_measured_ - fit.effective_parameters);
}

double ModesSearch::SquaredErrorLeft() const {
  return 2.0 * fit_.final_modal_cost / left_;
}

bool ModesSearch::Run() {
  if (ChiSquareProbability(2.0 * fit_.final_modal_cost, left_) >=
      limits::kModesProbability) {
    return false;
  }
  AddModes();
  Refit own;
  own.problem = problem_;
  own.fit = fit_;
  own.model = model_;
  own.log_odds = 0.0;
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

// Modes that may be wrong themselves: misread, or of something else.
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
  inner_.Run("another explanation", refit.problem, options_, &begin, &refit.fit,
             &refit.model);
  if (refit.fit.termination == Termination::kInterrupted) {
    interrupted_ = true;
    return;
  }
  if (refit.fit.termination == Termination::kFailure) return;
  refit.log_odds = LogOdds(refit);
  if (std::isfinite(refit.log_odds)) refits_.push_back(std::move(refit));
}

double ModesSearch::MeanSquare(const FitSummary& fit) const {
  return std::max(1.0, 2.0 * fit.final_modal_cost / left_);
}

double ModesSearch::LogOdds(const Refit& refit) const {
  double unknowns = 0.0;
  for (const size_t i : refit.suspects) {
    unknowns += static_cast<double>(suspects_[i].Unknowns().size());
    for (const int mode : suspects_[i].left_out_modes) {
      unknowns += NumbersOf(problem_.modal.modes[static_cast<size_t>(mode)]);
    }
  }
  const double count = num_measured_;
  return 0.5 * count * std::log(MeanSquare(fit_) / MeanSquare(refit.fit)) -
         0.5 * unknowns * std::log(std::max(count, 2.0)) -
         static_cast<double>(refit.suspects.size()) *
             std::log(static_cast<double>(suspects_.size()));
}

const Refit* ModesSearch::Best() const {
  const auto best = std::max_element(
      refits_.begin(), refits_.end(),
      [](const Refit& a, const Refit& b) { return a.log_odds < b.log_odds; });
  return best == refits_.end() ? nullptr : &*best;
}

}  // namespace pinode
