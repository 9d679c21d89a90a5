// Observer of an identification, for progress, checkpoints and interrupts.

#ifndef PINODE_STUDY_PROBLEM_IDENTIFICATION_WATCH_H_
#define PINODE_STUDY_PROBLEM_IDENTIFICATION_WATCH_H_

#include <string>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

struct Checkpoint;

// Callbacks of a running identification. By default they do nothing. They are
// called in the thread that called Identify.
class IdentificationWatch {
 public:
  virtual ~IdentificationWatch() = default;

  // Callback at the end of each iteration. `what` names the fit, such as "finer
  // steps", and is empty for the first one. `problem` is the fitted problem.
  // Return false to stop the identification with the best model so far.
  virtual bool OnIteration(const std::string& what,
                           const IdentificationProblem& problem,
                           const IdentificationProgress& progress) {
    (void)what, (void)problem, (void)progress;
    return true;
  }
  // Callback at the end of each fit.
  virtual void OnFitEnd(Termination termination) { (void)termination; }
  // Callback at the end of each step of the choice among candidates. The choice
  // can continue from `checkpoint`. It belongs to the problem `all` with all
  // candidates.
  virtual void OnChoice(const IdentificationProblem& all,
                        const Checkpoint& checkpoint) {
    (void)all, (void)checkpoint;
  }
};

// Watch that calls another watch, `next`, which may be nullptr. Derive from it
// and override the callbacks that are to differ.
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
