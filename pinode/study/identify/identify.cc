#include "pinode/study/identify/identify.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/problem/motion_levels.h"
#include "pinode/study/explanations/explain.h"
#include "pinode/study/explanations/record_checks.h"
#include "pinode/study/explanations/unknown_forces.h"
#include "pinode/study/identify/load_spectra.h"
#include "pinode/study/identify/step_check.h"
#include "pinode/study/problem/inner_fit.h"
#include "pinode/study/reduction/renewed_basis.h"
#include "pinode/study/terms/term_choice.h"

namespace pinode {
namespace {

// Widens the intervals of a result that lacks something.
void Widen(const std::vector<ExplainedValue>& intervals,
           std::vector<ParameterEstimate>* parameters) {
  for (ParameterEstimate& estimate : *parameters) {
    for (const ExplainedValue& wide : intervals) {
      if (wide.name != estimate.name) continue;
      estimate.lower95 = std::min(estimate.lower95, wide.lower95);
      estimate.upper95 = std::max(estimate.upper95, wide.upper95);
    }
  }
  FollowSources(parameters);
}

// The steps of one identification; what stands is in problem_, fit_, model_,
// choice_ and reduced_.
class MainJob {
 public:
  MainJob(IdentificationProblem problem, const IdentificationOptions& options,
          const IdentificationExtras& extras, IdentificationWatch* watch)
      : options_(options),
        extras_(extras),
        inner_(watch),
        problem_(std::move(problem)),
        choice_(extras.choice),
        reduced_(extras.reduced) {
    if (extras.start != nullptr) model_ = *extras.start;
  }

  Identification Run() {
    std::string error;
    if (!options_.GivesIntervals(&error) || !GoOn(&error)) {
      fit_.message = error;
      return Judged({});
    }
    FirstFit();
    ChooseAmongCandidates();
    if (RenewsBasis() && IsSound()) Renew();
    SettleLoadSpectra(options_, &inner_, &problem_, &fit_, &model_);
    // A fit that is not sound has its reasons already.
    SettledSteps steps;
    if (IsSound()) steps = Settle();
    if (MayHaveFalseTerms(steps)) steps = ChooseAgain(std::move(steps));
    return Judged(std::move(steps.findings));
  }

 private:
  bool IsSound() const { return CheckFit(options_.tuning.gaps, fit_).empty(); }
  bool RenewsBasis() const {
    return reduced_ != nullptr && reduced_->renew_basis;
  }

  // Brings the problem to where a checkpoint stands: without the terms that
  // were left out and, where no choice is under way, in the basis of its
  // values. A choice that was interrupted goes on in the basis in which it
  // began.
  bool GoOn(std::string* error) {
    if (!extras_.candidates.empty()) all_ = problem_;
    if (!choice_.left_out.empty() && !LeaveOutChosen(error)) return false;
    if (!extras_.resumed || !RenewsBasis() ||
        (!choice_.empty() && !choice_.complete)) {
      return true;
    }
    ReducedProblem renewed;
    IdentifiedModel begin;
    std::string unused;
    // Values without modes stay in the basis of the export.
    if (RenewBasis({problem_, *reduced_}, model_, &renewed, &begin, &unused)) {
      Take(std::move(renewed));
      model_ = std::move(begin);
      if (choice_.empty() && !extras_.candidates.empty()) all_ = problem_;
    }
    return true;
  }

  bool LeaveOutChosen(std::string* error) {
    std::vector<ModelCandidate> gone;
    for (const std::string& name : choice_.left_out) {
      const auto found =
          std::find_if(extras_.candidates.begin(), extras_.candidates.end(),
                       [&name](const ModelCandidate& candidate) {
                         return candidate.name == name;
                       });
      if (found == extras_.candidates.end()) {
        *error =
            "'" + name + "', which the choice left out, is not a candidate";
        return false;
      }
      gone.push_back(*found);
    }
    IdentificationProblem left;
    if (!LeaveOut(problem_, gone, &left, error)) return false;
    problem_ = std::move(left);
    return true;
  }

  void FirstFit() {
    IdentificationOptions options = options_;
    if (!choice_.empty()) BeginNearTheEnd(&options);
    const IdentifiedModel start = std::move(model_);
    inner_.Run("", problem_, options,
               extras_.start != nullptr ? &start : nullptr, &fit_, &model_);
  }

  void ChooseAmongCandidates() {
    if (extras_.candidates.empty() || choice_.complete ||
        fit_.termination == Termination::kInterrupted) {
      return;
    }
    TermFit fit{std::move(problem_), std::move(fit_), std::move(model_),
                choice_};
    std::string error =
        "the fit with all candidates failed: " + fit.summary.message;
    // Candidates that are nearly the same may keep a fit from converging.
    const bool chosen =
        fit.summary.termination != Termination::kFailure &&
        ChooseTerms(all_, extras_.candidates, options_, &inner_, &fit, &error);
    problem_ = std::move(fit.problem);
    fit_ = std::move(fit.summary);
    model_ = std::move(fit.model);
    choice_ = std::move(fit.choice);
    if (!chosen) {
      problem_.description.remarks.push_back("No model choice: " + error + ".");
    }
  }

  SettledSteps Settle() {
    return SettleSteps(options_, &inner_, &problem_, &fit_, &model_);
  }

  // True if terms were kept or left out by fits with an error of their steps,
  // which a term can make up for.
  bool MayHaveFalseTerms(const SettledSteps& steps) const {
    return steps.were_long && steps.refined && !extras_.candidates.empty() &&
           !RenewsBasis() && fit_.termination != Termination::kInterrupted;
  }

  // Fits all candidates with the finer steps, from what was found, and chooses
  // among them. The result so far stays if that does not come to an end.
  SettledSteps ChooseAgain(SettledSteps steps) {
    const TermFit so_far{problem_, fit_, model_, choice_};
    const bool was_sound = IsSound();
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& finer = problem_.records[r];
      all_.records[r].substeps = finer.substeps;
      all_.records[r].exponential_steps = finer.exponential_steps;
    }
    const IdentifiedModel begin = ModelOfOther(problem_, model_, all_);
    IdentificationOptions near = options_;
    BeginNearTheEnd(&near);
    const FitHistory history = FitHistory::Of(fit_);
    problem_ = all_;
    choice_ = ModelChoice();
    inner_.Run("all terms, finer steps", problem_, near, &begin, &fit_,
               &model_);
    history.Enter(&fit_);
    ChooseAmongCandidates();
    SettleLoadSpectra(options_, &inner_, &problem_, &fit_, &model_);
    SettledSteps again = IsSound() ? Settle() : SettledSteps();
    if (IsSound() || !was_sound) return again;
    const FitSummary failed = std::move(fit_);
    problem_ = so_far.problem;
    fit_ = so_far.summary;
    model_ = so_far.model;
    choice_ = so_far.choice;
    if (failed.termination == Termination::kInterrupted) {
      fit_.termination = Termination::kInterrupted;
      fit_.message = failed.message;
      return steps;
    }
    Finding finding{"terms_of_long_steps",
                    "the terms were chosen with long steps, and the choice "
                    "with finer ones failed: " +
                        failed.message};
    finding.advice = "give `substeps`";
    finding.grade = Grade::kWithCare;
    steps.findings.push_back(std::move(finding));
    return steps;
  }

  void Renew() {
    ReducedProblem renewed{problem_, *reduced_};
    RenewBasisUntilSettled(options_, &inner_, &renewed, &fit_, &model_);
    if (fit_.termination != Termination::kInterrupted) Take(std::move(renewed));
  }

  void Take(ReducedProblem renewed) {
    problem_ = std::move(renewed.problem);
    reduced_ =
        std::make_shared<const ReducedStructure>(std::move(renewed.structure));
  }

  // The only place that makes a verdict of an identification. A fit that is not
  // sound may have an explanation too.
  Identification Judged(std::vector<Finding> of_steps) {
    std::vector<Finding> findings = CheckFit(options_.tuning.gaps, fit_);
    const auto add = [&findings](std::vector<Finding> more) {
      std::move(more.begin(), more.end(), std::back_inserter(findings));
    };
    // Frequencies far off say more than that the initial model was as good.
    if (std::all_of(findings.begin(), findings.end(),
                    [](const Finding& finding) {
                      return finding.check == "modes_not_met_better";
                    })) {
      std::vector<Finding> far = CheckMeasuredFrequencies(problem_, fit_);
      if (!far.empty()) findings = std::move(far);
    }
    const bool sound = findings.empty();
    add(std::move(of_steps));
    Explained explained;
    if (sound) add(CheckDoubts(fit_));
    if (fit_.termination != Termination::kFailure &&
        fit_.termination != Termination::kInterrupted) {
      add(extras_.findings);
      add(CheckAgainstProblem(problem_, fit_, model_));
      add(CheckUnknownForces(problem_, fit_));
      explained = Explain(problem_, options_, fit_, model_, &inner_);
      add(std::move(explained.findings));
    }
    Identification result{std::move(problem_),
                          IdentificationSummary(std::move(fit_)),
                          std::move(model_), std::move(reduced_)};
    IdentificationSummary& summary = result.summary;
    summary.verdict = Verdict(std::move(findings));
    for (const Finding& finding : summary.verdict.findings()) {
      if (finding.grade != Grade::kNotUsable) continue;
      summary.message = finding.Sentence();
      break;
    }
    if (summary.verdict.grade() == Grade::kWithCare) {
      Widen(explained.intervals, &summary.parameters);
      if (!explained.forces.empty()) summary.forces = explained.forces;
      const std::string range = LevelSentence(MotionLevels(result.problem));
      if (!range.empty()) summary.remarks.push_back(range);
    }
    summary.explanations = std::move(explained.explanations);
    summary.choice = std::move(choice_);
    if (!summary.choice.empty()) {
      summary.remarks.push_back(summary.choice.Sentence());
    }
    return result;
  }

  const IdentificationOptions& options_;
  const IdentificationExtras& extras_;
  InnerFit inner_;
  IdentificationProblem all_;  // with all candidates
  IdentificationProblem problem_;
  FitSummary fit_;
  IdentifiedModel model_;
  ModelChoice choice_;
  std::shared_ptr<const ReducedStructure> reduced_;
};

}  // namespace

Identification Identify(IdentificationProblem problem,
                        const IdentificationOptions& options,
                        const IdentificationExtras& extras,
                        IdentificationWatch* watch) {
  return MainJob(std::move(problem), options, extras, watch).Run();
}

}  // namespace pinode
