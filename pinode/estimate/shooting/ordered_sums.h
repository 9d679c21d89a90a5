// Sums over tasks that threads and ranks share.

#ifndef PINODE_ESTIMATE_SHOOTING_ORDERED_SUMS_H_
#define PINODE_ESTIMATE_SHOOTING_ORDERED_SUMS_H_

#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/estimate/shooting/shooting_record.h"

namespace pinode {

// Equations of the free parameters, summed over tasks. Every task has its slot,
// and slots are added up in an order that does not depend on who has filled
// them: one, two or four ranks or threads find the same bits. (A fit with
// networks goes hundreds of iterations along a valley, where a last bit grows
// into another end.) Of other numbers each finds its own bits.
class OrderedSums {
 public:
  // `num_own`: unknowns that a task has to itself. `communicator` must outlive
  // the object.
  OrderedSums(int num_free, int num_own, int num_threads,
              Communicator* communicator);

  void Clear();
  // Whose a task is, from 0.
  int RankOf(int task) const {
    return GroupOf(task) * communicator_.size() / groups_;
  }
  // Slots of this rank: a thread fills one at a time, its tasks in order.
  int num_slots() const { return static_cast<int>(slots_.size()); }
  // The slot of a task of this rank.
  int SlotOf(int task) const;
  // Slots in the order in which they come up, so that threads that take them in
  // turns are equally busy where tasks are few.
  const std::vector<int>& order() const { return order_; }
  // Lower triangle of [J_own J r]'[J_own J r], J by the free parameters and r
  // the residuals, in the last rows and columns: J'J and J'r are summed, the
  // rest is a task's own. In all WholeFours rows.
  Matrix& slot(int index) { return slots_[static_cast<size_t>(index)]; }

  // The sum over all slots of all ranks. False where a rank does not answer.
  [[nodiscard]] bool Total(FreeEquations* total);

 private:
  int GroupOf(int task) const;

  Communicator& communicator_;
  int groups_ = 1;  // of tasks, over all ranks
  int parts_ = 1;   // that a group has, so that threads are equally busy
  Eigen::Index num_free_;
  std::vector<Matrix> slots_;
  std::vector<int> order_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_ORDERED_SUMS_H_
