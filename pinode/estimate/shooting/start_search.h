// The inner problem of multiple shooting: the best starts of one record for
// given parameters, and when derivatives by the parameters are found with them.

#ifndef PINODE_ESTIMATE_SHOOTING_START_SEARCH_H_
#define PINODE_ESTIMATE_SHOOTING_START_SEARCH_H_

#include <limits>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/start_equations.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// How far a search has come.
struct StartProgress {
  double cost = std::numeric_limits<double>::infinity();  // the least so far
  bool is_at_trial = false;  // whether that is the last trial's
  // The next step promises to lower the cost by so much. The search ends there
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
  // `equations` and `fallback` must outlive this object.
  StartSearch(const StartTuning& tuning, StartEquations* equations, double mu,
              Matrix predicted, const Matrix* fallback);

  // Finds the next trial from the record's results at trial(), or is done.
  // `finite`: all its segments were. `linearized_cost`: of all records at the
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
  // Takes the trial for the best so far, or raises the damping.
  void Accept(double cost);
  [[nodiscard]] bool Reject();
  // Solves for the next trial; done where it would gain too little.
  [[nodiscard]] bool Step(bool improved, double linearized_cost);

  const StartTuning& tuning_;
  StartEquations* equations_;
  double mu_;
  const Matrix* fallback_;
  int iteration_ = 0;
  Matrix trial_, best_;
  double damping_ = 0.0;
  StartProgress progress_;
  bool failed_once_ = false;
  Matrix gradient_;  // at best_
};

// A point that is accepted is linearised at the starts that its search ended
// at. Where that search's last sweep has taken all derivatives along, the
// linearisation costs nothing more; where it was not the last one, or the point
// is rejected, they were for nothing. So they go along
//
// - with the first sweep, where they cost about as much as what it does anyway;
// - with the second one, where it is likely to be the last. Gauss-Newton on the
//   starts leaves after a step what is left of the square of what that step
//   promised; how much, the searches before tell.
class LookAhead {
 public:
  // `goes_first`: with first sweeps.
  explicit LookAhead(bool goes_first) : goes_first_(goes_first) {}

  // True if derivatives are to go along with the sweep that follows
  // `num_sweeps` of these searches, one for each record. `linearized_cost`: of
  // all records at the last linearisation.
  bool GoesAlong(int num_sweeps, const std::vector<StartProgress>& searches,
                 double linearized_cost) const;
  // The searches have looked at the num_sweeps-th sweep.
  void Learn(int num_sweeps, const std::vector<StartProgress>& searches);
  // Forgets what was learned of other segments, weights or unknowns.
  void Forget() { bend_.clear(); }

 private:
  bool goes_first_;
  // One number per record: what the first step of the search at hand promises,
  // and what a second one has promised by the square of that; empty: unknown.
  std::vector<double> promised_, bend_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_START_SEARCH_H_
