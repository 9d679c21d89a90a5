// When derivatives by the parameters go along with a search for starts.

#ifndef PINODE_ESTIMATE_SHOOTING_LOOK_AHEAD_H_
#define PINODE_ESTIMATE_SHOOTING_LOOK_AHEAD_H_

#include <vector>

#include "pinode/estimate/shooting/start_search.h"

namespace pinode {

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

  // With the sweep that follows `num_sweeps` of these searches, one for each
  // record. `linearized_cost`: of all records at the last linearisation.
  bool GoesAlong(int num_sweeps, const std::vector<StartProgress>& searches,
                 double linearized_cost) const;
  // The searches have looked at the num_sweeps-th sweep.
  void Learn(int num_sweeps, const std::vector<StartProgress>& searches);
  // What was learned is of other segments, weights or unknowns.
  void Forget() { bend_.clear(); }

 private:
  bool goes_first_;
  // Of each record: what the first step of the search at hand promises, and
  // what a second one has promised by the square of that; empty: unknown.
  std::vector<double> promised_, bend_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_LOOK_AHEAD_H_
