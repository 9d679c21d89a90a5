#include "pinode/case/run/fit_case.h"

#include <chrono>
#include <optional>
#include <utility>

#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/estimate/certainty/profile.h"
#include "pinode/estimate/fit/identify.h"
#include "pinode/problem/progress.h"
#include "pinode/study/identify/load_spectra.h"
#include "pinode/study/identify/step_check.h"
#include "pinode/study/terms/term_choice.h"

namespace pinode {
namespace {

// Says once that checkpoints cannot be written.
class CheckpointTrouble {
 public:
  explicit CheckpointTrouble(const FitWatch& watch) : watch_(watch) {}
  void Tell(const std::string& what) {
    if (!told_ && watch_.on_trouble) {
      watch_.on_trouble("no checkpoint: " + what);
    }
    told_ = true;
  }

 private:
  const FitWatch& watch_;
  bool told_ = false;
};

// Whether a choice can begin with such a fit: candidates that are nearly the
// same may keep it from converging.
bool CanChoose(const IdentificationSummary& summary) {
  return summary.termination == Termination::kConverged ||
         summary.termination == Termination::kNoConvergence;
}

// Leaves out of *c what the choice in *checkpoint has, and takes the basis of
// its values where the case renews it; *all is the case with all candidates. A
// choice that was cut off goes on in the basis in which it was made.
bool GoOn(Checkpoint* checkpoint, Case* c, Case* all, std::string* error) {
  const ModelChoice& begun = checkpoint->choice;
  if (!begun.left_out.empty() && !LeaveOutOfCase(begun.left_out, c, error)) {
    return false;
  }
  if (!RenewsBasis(*c) || (!begun.empty() && !begun.complete)) return true;
  // In the basis of what was found; where it has none, in that of the export.
  Case renewed;
  IdentifiedModel begin;
  std::string unused;
  if (RenewCase(*c, checkpoint->model, &renewed, &begin, &unused)) {
    *c = std::move(renewed);
    checkpoint->model = std::move(begin);
    if (begun.empty()) *all = *c;
  }
  return true;
}

// After a fit of *c, which is `all` without what summary->choice has left out.
void ChooseTermsOfCase(const Case& all, const ResultFolder& folder,
                       const FitWatch& watch, Case* c,
                       IdentificationSummary* summary, IdentifiedModel* model) {
  if (summary->choice.complete) {
    summary->remarks.push_back(summary->choice.Sentence());
    return;
  }
  if (summary->termination == Termination::kInterrupted) return;
  std::string error = "the fit with all candidates: " + summary->message;
  TermChoiceOptions options;
  options.identification = c->options;
  options.fit = WatchedFit(watch);
  CheckpointTrouble trouble(watch);
  options.on_choice = [&](const Checkpoint& checkpoint) {
    if (!folder.writes()) return;
    std::string what;
    if (!WriteCheckpoint(folder.checkpoint_path(), ProblemIdentity(all.problem),
                         checkpoint, &what)) {
      trouble.Tell(what);
    }
  };
  TermFit fit{c->problem, *summary, *model};
  if (!CanChoose(*summary) ||
      !ChooseTerms(all.problem, all.candidates, options, &fit, &error)) {
    c->problem.description.remarks.push_back("No model choice: " + error + ".");
    return;
  }
  *summary = std::move(fit.summary);
  *model = std::move(fit.model);
  *c = CaseAfterChoice(all, summary->choice.left_out, fit.problem);
}

// Finer steps where they would move what was found, and a fit that goes on with
// them; says what is left. A fit that is not usable has its reason already.
void SettleSteps(const FitWatch& watch, Case* c, IdentificationSummary* summary,
                 IdentifiedModel* model) {
  constexpr int kMostRounds = 2;
  constexpr double kTooFar = 2.0;  // deviations
  constexpr double kNotable = 0.5;
  StepCheck check;
  for (int round = 0;; ++round) {
    if (!summary->usable || !CheckStepsAtFit(c->problem, *summary, *model,
                                             c->options.num_threads, &check)) {
      return;
    }
    if (round == kMostRounds || !RefineSteps(check, &c->problem)) break;
    IdentificationOptions options = c->options;
    BeginNearTheEnd(&options);
    const ModelChoice choice = summary->choice;
    const std::string way = summary->way;
    const double linear_error = summary->linear_error;
    const double seconds = summary->seconds;
    const IdentifiedModel begin = *model;
    WatchedFit(watch)("finer steps", c->problem, options, &begin, summary,
                      model);
    summary->way = way;
    summary->linear_error = linear_error;
    summary->seconds += seconds;
    summary->choice = choice;
    if (!choice.empty()) summary->remarks.push_back(choice.Sentence());
  }
  if (check.shift > kTooFar && check.is_large) {
    summary->usable = false;
    summary->message = "the steps are too long: " + check.Sentence();
  } else if (check.shift > kNotable) {
    summary->remarks.push_back(check.Sentence());
  }
}

}  // namespace

FitFunction WatchedFit(const FitWatch& watch) {
  return [watch](const std::string& what, const IdentificationProblem& problem,
                 const IdentificationOptions& options,
                 const IdentifiedModel* begin, IdentificationSummary* summary,
                 IdentifiedModel* model) {
    IdentificationOptions watched = options;
    if (watch.on_iteration) {
      watched.callback = [&](const IdentificationProgress& progress) {
        const bool go_on = !options.callback || options.callback(progress);
        return watch.on_iteration(what, progress) && go_on;
      };
    }
    Identify(problem, watched, begin, summary, model);
    if (watch.on_end) watch.on_end();
  };
}

bool FitCase(const ResultFolder& folder, const IdentifiedModel* begin_from,
             const FitWatch& watch, Case* c, IdentificationSummary* summary,
             IdentifiedModel* model, std::string* error) {
  Checkpoint checkpoint;
  // Records are most of it.
  Case all;
  if (!c->candidates.empty()) all = *c;
  if (!folder.resume_path().empty()) {
    const bool ok =
        ReadCheckpoint(folder.resume_path(), c->problem, &checkpoint, error) &&
        GoOn(&checkpoint, c, &all, error);
    // All ranks have read it before it is written anew.
    if (!CommunicatorOrSingle(c->options.communicator).AllTrue(ok)) {
      if (ok) *error = folder.resume_path() + ": not all ranks can read it";
      return false;
    }
    begin_from = &checkpoint.model;
  }
  const ModelChoice& begun = checkpoint.choice;
  IdentificationOptions options = c->options;
  if (!begun.empty()) BeginNearTheEnd(&options);
  CheckpointTrouble trouble(watch);
  std::optional<CheckpointWriter> writer;
  if (folder.writes()) {
    writer.emplace(ProblemIdentity(c->problem), folder.checkpoint_path());
    writer->set_choice(begun);
    writer->set_profiles(checkpoint.profiles);
    options.callback = [&](const IdentificationProgress& progress) {
      std::string what;
      if (!writer->Update(progress, &what)) trouble.Tell(what);
      return true;
    };
  }
  WatchedFit(watch)("", c->problem, options, begin_from, summary, model);
  summary->choice = begun;
  if (summary->termination == Termination::kInterrupted &&
      !checkpoint.profiles.empty()) {
    summary->profiles = checkpoint.profiles;
    summary->remarks.push_back(
        "The profiles are those of the fit that this one went on from; it was "
        "interrupted before its own.");
  }
  if (!all.candidates.empty()) {
    ChooseTermsOfCase(all, folder, watch, c, summary, model);
  }
  if (RenewsBasis(*c) && summary->usable) {
    const ModelChoice choice = summary->choice;
    RenewCaseUntilSettled(WatchedFit(watch), c, summary, model);
    if (summary->choice.empty() && !choice.empty()) {
      summary->choice = choice;
      summary->remarks.push_back(choice.Sentence());
    }
  }
  if (!c->problem.ambient.empty()) {
    SettleLoadSpectra(WatchedFit(watch), c->options, &c->problem, summary,
                      model);
  }
  SettleSteps(watch, c, summary, model);
  return true;
}

void ProfileCase(const ResultFolder& folder, const FitWatch& watch, Case* c,
                 const IdentifiedModel& model, IdentificationSummary* summary) {
  const auto begin = std::chrono::steady_clock::now();
  std::string error = "the fit did not converge";
  ProfileOptions options;
  if (c->profiles.has_value()) options.parameters = *c->profiles;
  Checkpoint checkpoint;
  std::string unused;
  if (!folder.resume_path().empty() &&
      ReadCheckpoint(folder.resume_path(), c->problem, &checkpoint, &unused)) {
    options.known = std::move(checkpoint.profiles);
  }
  checkpoint.iteration = summary->num_iterations;
  checkpoint.cost = summary->final_cost;
  checkpoint.model = model;
  checkpoint.choice = summary->choice;
  CheckpointTrouble trouble(watch);
  options.callback = [&](const std::vector<ParameterProfile>& done, int of) {
    if (watch.on_profile) watch.on_profile(done, of);
    checkpoint.profiles = done;
    if (!folder.writes()) return true;
    std::string what;
    if (!WriteCheckpoint(folder.checkpoint_path(), ProblemIdentity(c->problem),
                         checkpoint, &what)) {
      trouble.Tell(what);
    }
    return true;
  };
  options.stop = watch.stop;
  if (summary->termination != Termination::kConverged ||
      !ProfileParameters(c->problem, *summary, model, c->options, options,
                         &summary->profiles, &error)) {
    c->problem.description.remarks.push_back("No profiles: " + error + ".");
  }
  summary->profile_seconds = SecondsSince(begin);
}

}  // namespace pinode
