// The inner problem of multiple shooting: the best starts of one record for
// given parameters.

#ifndef PINODE_ESTIMATE_SHOOTING_START_SEARCH_H_
#define PINODE_ESTIMATE_SHOOTING_START_SEARCH_H_

#include <limits>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/shooting_record.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// How far a search has come.
struct StartProgress {
  double cost = std::numeric_limits<double>::infinity();  // the least so far
  bool is_at_trial = false;  // whether that is the last trial's
  // By how much the next step promises to lower the cost. The search ends there
  // if a further one promises no more than last_promise.
  double promise = 0.0;
  double last_promise = 0.0;
  bool done = false;
};

// Damped Gauss-Newton on the starts, one step at a time: whoever holds the
// search propagates the record's segments from trial() and calls Advance. For
// linear dynamics one step is the Rauch-Tung-Striebel smoother (AIAA J. 3
// (1965) 1445-1450) in information form; a step that does not lower the cost is
// repeated with damping.
class StartSearch {
 public:
  // `predicted`: where to begin; `fallback`: where to begin again if no finite
  // trajectory leaves there, the starts of the last linearisation, or nullptr.
  // `record` and `fallback` must outlive this object.
  StartSearch(const StartTuning& tuning, ShootingRecord* record, double mu,
              Matrix predicted, const Matrix* fallback);

  // From the record's results at trial(): the next trial, or done. `finite`:
  // whether all its segments were. `linearized_cost`: of all records at the
  // last linearisation, infinite where there was none. False where no starts
  // can be found.
  [[nodiscard]] bool Advance(bool finite, double linearized_cost);

  bool done() const { return progress_.done; }
  bool found() const {
    return progress_.cost < std::numeric_limits<double>::infinity();
  }
  const Matrix& trial() const { return trial_; }  // num_states x segments
  const Matrix& best() const { return best_; }
  double best_cost() const { return progress_.cost; }
  const StartProgress& progress() const { return progress_; }

 private:
  // Takes the trial for the best so far, or asks for more damping.
  void Accept(double cost);
  [[nodiscard]] bool Reject();
  // Solves for the next trial; done where it would gain too little.
  [[nodiscard]] bool Step(bool improved, double linearized_cost);

  const StartTuning& tuning_;
  ShootingRecord* record_;
  double mu_;
  const Matrix* fallback_;
  int iteration_ = 0;
  Matrix trial_, best_;
  double damping_ = 0.0;
  StartProgress progress_;
  bool failed_once_ = false;
  Matrix gradient_;  // at best_
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_START_SEARCH_H_
