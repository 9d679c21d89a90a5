#include "pinode/case/run/fit_case.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "pinode/base/stopwatch.h"
#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/estimate/certainty/profile.h"
#include "pinode/study/identify/identify.h"

namespace pinode {
namespace {

// Writes checkpoints into a folder, and says once if they cannot be written.
class CheckpointWatch : public ForwardingWatch {
 public:
  // `begun`: the checkpoint from which the identification goes on.
  CheckpointWatch(const ResultFolder& folder, const Checkpoint& begun,
                  CaseWatch* watch)
      : ForwardingWatch(watch),
        folder_(folder),
        begun_(begun),
        watch_(*watch) {}

  bool OnIteration(const std::string& what,
                   const IdentificationProblem& problem,
                   const IdentificationProgress& progress) override {
    // Later fits are short, and go on from where the first has ended.
    if (what.empty() && folder_.writes()) {
      if (!writer_.has_value()) {
        writer_.emplace(ProblemIdentity(problem), folder_.checkpoint_path());
        writer_->set_choice(begun_.choice);
        writer_->set_profiles(begun_.profiles);
      }
      std::string error;
      if (!writer_->Update(progress, &error)) Tell(error);
    }
    return ForwardingWatch::OnIteration(what, problem, progress);
  }

  void OnChoice(const IdentificationProblem& all,
                const Checkpoint& checkpoint) override {
    Write(all, checkpoint);
    ForwardingWatch::OnChoice(all, checkpoint);
  }

  void Write(const IdentificationProblem& problem,
             const Checkpoint& checkpoint) {
    if (!folder_.writes()) return;
    std::string error;
    if (!WriteCheckpoint(folder_.checkpoint_path(), ProblemIdentity(problem),
                         checkpoint, &error)) {
      Tell(error);
    }
  }

 private:
  void Tell(const std::string& error) {
    if (!told_) watch_.OnTrouble("no checkpoint: " + error);
    told_ = true;
  }

  const ResultFolder& folder_;
  const Checkpoint& begun_;
  CaseWatch& watch_;
  std::optional<CheckpointWriter> writer_;
  bool told_ = false;
};

// Checks that a checkpoint's choice is one among the case's candidates.
bool IsChoiceOf(const Case& c, const ModelChoice& choice, std::string* error) {
  Case left = c;
  return choice.left_out.empty() ||
         LeaveOutOfCase(choice.left_out, &left, error);
}

}  // namespace

bool FitCase(const ResultFolder& folder, const IdentifiedModel* begin_from,
             CaseWatch* watch, Case* c, IdentificationSummary* summary,
             IdentifiedModel* model, std::string* error) {
  Checkpoint checkpoint;
  IdentificationExtras extras = ExtrasOf(*c);
  extras.start = begin_from;
  if (!folder.resume_path().empty()) {
    const bool ok =
        ReadCheckpoint(folder.resume_path(), c->problem, &checkpoint, error) &&
        IsChoiceOf(*c, checkpoint.choice, error);
    // All ranks have read it before it is written anew.
    if (!CommunicatorOrSingle(c->options.communicator).AllTrue(ok)) {
      if (ok) *error = folder.resume_path() + ": not all ranks can read it";
      return false;
    }
    extras.start = &checkpoint.model;
    extras.resumed = true;
    extras.choice = checkpoint.choice;
  }
  CheckpointWatch checkpoints(folder, checkpoint, watch);
  // Records are most of a problem: they are moved in and out, not copied.
  const std::shared_ptr<const StructuralDynamics> dynamics =
      c->problem.dynamics;
  Identification found =
      Identify(std::move(c->problem), c->options, extras, &checkpoints);
  c->problem.dynamics = dynamics;
  *summary = std::move(found.summary);
  *model = std::move(found.model);
  if (summary->termination == Termination::kInterrupted &&
      !checkpoint.profiles.empty()) {
    summary->profiles = checkpoint.profiles;
    summary->remarks.push_back(
        "The profiles are from the earlier fit that this one continued. It was "
        "interrupted before its own.");
  }
  TakeOver(std::move(found.problem), found.reduced, *summary, c);
  return true;
}

void ProfileCase(const ResultFolder& folder, CaseWatch* watch, Case* c,
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
  CheckpointWatch checkpoints(folder, checkpoint, watch);
  options.callback = [&](const std::vector<ParameterProfile>& done, int of) {
    watch->OnProfile(done, of);
    checkpoint.profiles = done;
    checkpoints.Write(c->problem, checkpoint);
    return true;
  };
  options.stop = [watch] { return watch->StopsProfiles(); };
  if (summary->termination != Termination::kConverged ||
      !ProfileParameters(c->problem, *summary, model, c->options, options,
                         &summary->profiles, &error)) {
    c->problem.description.remarks.push_back("No profiles: " + error + ".");
  }
  summary->profile_seconds = SecondsSince(begin);
}

}  // namespace pinode
