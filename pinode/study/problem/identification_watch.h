// Observer of an identification: progress, checkpoints, interrupts.

#ifndef PINODE_STUDY_PROBLEM_IDENTIFICATION_WATCH_H_
#define PINODE_STUDY_PROBLEM_IDENTIFICATION_WATCH_H_

#include <string>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

struct Checkpoint;

// Callbacks of a running identification. Each does nothing by default. They are
// called in the thread that called Identify.
class IdentificationWatch {
 public:
  virtual ~IdentificationWatch() = default;

  // An iteration of a fit of `problem` has ended. `what` names the fit, such as
  // "finer steps"; it is empty for the first one. Return false to stop the
  // identification with the best model so far.
  virtual bool OnIteration(const std::string& what,
                           const IdentificationProblem& problem,
                           const IdentificationProgress& progress) {
    (void)what, (void)problem, (void)progress;
    return true;
  }
  // A fit has ended.
  virtual void OnFitEnd(Termination termination) { (void)termination; }
  // A step of the choice among candidates has ended. The choice can go on from
  // `checkpoint`, which belongs to the problem `all` with all candidates.
  virtual void OnChoice(const IdentificationProblem& all,
                        const Checkpoint& checkpoint) {
    (void)all, (void)checkpoint;
  }
};

// Watch that passes everything on to another one (nullptr: to nobody). Override
// what differs.
class ForwardingWatch : public IdentificationWatch {
 public:
  explicit ForwardingWatch(IdentificationWatch* next) : next_(next) {}

  bool OnIteration(const std::string& what,
                   const IdentificationProblem& problem,
                   const IdentificationProgress& progress) override {
    return next_ == nullptr || next_->OnIteration(what, problem, progress);
  }
  void OnFitEnd(Termination termination) override {
    if (next_ != nullptr) next_->OnFitEnd(termination);
  }
  void OnChoice(const IdentificationProblem& all,
                const Checkpoint& checkpoint) override {
    if (next_ != nullptr) next_->OnChoice(all, checkpoint);
  }

 private:
  IdentificationWatch* const next_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_IDENTIFICATION_WATCH_H_
