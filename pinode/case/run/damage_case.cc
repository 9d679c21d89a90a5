#include "pinode/case/run/damage_case.h"

#include <algorithm>
#include <map>

#include "pinode/base/strings.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/study/damage/held_followers.h"

namespace pinode {
namespace {

bool TakeOverChoice(const std::vector<Baseline>& baselines, Case* c,
                    std::string* error) {
  if (c->candidates.empty()) return true;
  std::vector<std::string> left_out;
  for (const ModelCandidate& candidate : c->candidates) {
    const bool known = std::any_of(
        baselines.begin(), baselines.end(), [&](const Baseline& baseline) {
          return std::count(baseline.parameter_names.begin(),
                            baseline.parameter_names.end(),
                            candidate.parameters[0]) > 0;
        });
    if (!known) left_out.push_back(candidate.name);
  }
  if (!LeaveOutOfCase(left_out, c, error)) return false;
  c->problem.description.remarks.push_back(
      "The model choice is that of the baseline. Left out: " +
      (left_out.empty() ? std::string("none") : Join(left_out, ", ")) + ".");
  return true;
}

// Of records that tell a follower only between several values of a covariate.
void RemarkOnUnknownFollowers(const std::vector<Baseline>& baselines,
                              const std::map<std::string, double>& held,
                              Case* c) {
  const IdentificationProblem& problem = c->problem;
  if (problem.num_train_records() > 0) return;
  for (const std::string& name : Followers(*problem.dynamics, /*free=*/true)) {
    for (const Baseline& baseline : baselines) {
      if (held.count(name) > 0 ||
          std::count(baseline.followers.begin(), baseline.followers.end(),
                     name) > 0) {
        continue;
      }
      c->problem.description.remarks.push_back(
          "'" + name + "' is free in the new records because baseline '" +
          baseline.name +
          "' did not determine it. Changes have wide intervals if the new "
          "records do not determine it either.");
      break;
    }
  }
}

// What new records are not asked of how the structure follows a covariate.
void HoldFollowers(const std::vector<Baseline>& baselines, Case* c) {
  const std::map<std::string, double> held =
      FollowersToHold(baselines, c->problem);
  RemarkOnUnknownFollowers(baselines, held, c);
  if (held.empty()) return;
  HoldInCase(held, c);
  std::vector<std::string> names;
  for (const auto& [name, value] : held) names.push_back(name);
  c->problem.description.remarks.push_back(
      "Held at the baselines' values, because ambient records and modes do not "
      "determine them: " +
      Join(names, ", ") + ". The intervals of the changes allow for it.");
}

// Remembers that a fit was interrupted.
class InterruptWatch : public ForwardingWatch {
 public:
  explicit InterruptWatch(IdentificationWatch* next) : ForwardingWatch(next) {}
  void OnFitEnd(Termination termination) override {
    interrupted_ = interrupted_ || termination == Termination::kInterrupted;
    ForwardingWatch::OnFitEnd(termination);
  }
  bool interrupted() const { return interrupted_; }

 private:
  bool interrupted_ = false;
};

}  // namespace

bool PrepareForBaselines(const std::vector<Baseline>& baselines, Case* c,
                         IdentifiedModel* begin_from, std::string* error) {
  if (baselines.empty()) {
    *error = "there is no baseline, expected a result of baseline records";
    return false;
  }
  if (!AreDifferentResults(baselines, error) ||
      !TakeOverChoice(baselines, c, error)) {
    return false;
  }
  HoldFollowers(baselines, c);
  *begin_from = BeginFromBaseline(baselines[0], c->problem);
  return !RenewsBasis(*c) || RenewCase(*c, *begin_from, c, begin_from, error);
}

JudgedChange JudgeChange(const IdentificationSummary& summary,
                         const IdentifiedModel& model,
                         const std::vector<Baseline>& baselines,
                         const ChangeOptions& change,
                         IdentificationWatch* watch, Case* c) {
  JudgedChange judgement;
  judgement.interrupted = summary.termination == Termination::kInterrupted;
  // A change that the case's groups do not have may be what a fit misses.
  if (!summary.verdict.MissesMotionAlone() || summary.covariance.size() == 0) {
    return judgement;
  }
  DamageAnalysisOptions options;
  options.change = change;
  options.search = c->damage;
  options.identification = c->options;
  InterruptWatch interrupts(watch);
  options.watch = &interrupts;
  DamageResult& result = judgement.result;
  judgement.judged = AnalyseDamage(c->problem, summary, model, baselines,
                                   options, &result, &judgement.why_not) &&
                     CaseWithCandidates(*c, result.added, result.problem, c,
                                        &judgement.why_not);
  judgement.interrupted = interrupts.interrupted();
  return judgement;
}

}  // namespace pinode
