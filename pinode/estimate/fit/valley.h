// End of fits that crawl along a valley.

#ifndef PINODE_ESTIMATE_FIT_VALLEY_H_
#define PINODE_ESTIMATE_FIT_VALLEY_H_

#include <algorithm>
#include <cmath>

namespace pinode {

// Counts the steps in a row that save less than a share of the cost.
class Valley {
 public:
  // Number of steps that make a valley. A right model of ambient records takes
  // some 15 steps in all. Two exchanged sensors took 350 steps that each saved
  // 5e-6 of the cost, and their end was not in sight.
  static constexpr int kMostSteps = 50;
  // A step that saves more is worth its time, however long the record: the cost
  // is a negative log-likelihood.
  static constexpr double kMostSaving = 1.0;
  // Steps of smaller costs, which grow with lines and channels, are quick, and
  // such fits go on until they converge: one channel in a band of 2 Hz, with a
  // cost of 3.7e3, takes 15 ms a step.
  static constexpr double kLeastCost = 1e4;
  // Share of the cost for fits of ambient records.
  static constexpr double kShare = 1e-5;

  // `share` of the cost that a step must save; 0: there are no valleys.
  explicit Valley(double share) : share_(share) {}

  // Notes a successful step, by its change of the cost and the cost after it.
  void Note(double change, double cost) {
    const bool crawls = cost > kLeastCost &&
                        std::abs(change) < std::min(share_ * cost, kMostSaving);
    steps_ = crawls ? steps_ + 1 : 0;
  }
  // True if the last steps are a valley.
  bool IsOne() const { return steps_ >= kMostSteps; }

 private:
  double share_;
  int steps_ = 0;  // one after the other
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_VALLEY_H_
