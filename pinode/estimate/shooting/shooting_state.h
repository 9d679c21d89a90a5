// State of multiple shooting: how much is propagated, and at which parameters.

#ifndef PINODE_ESTIMATE_SHOOTING_SHOOTING_STATE_H_
#define PINODE_ESTIMATE_SHOOTING_SHOOTING_STATE_H_

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"

namespace pinode {

// Place and time at which a trajectory stopped being finite.
struct Divergence {
  int record = -1;  // index into the problem's records
  int segment = -1;
  Eigen::Index sample = -1;
  int state = -1;
  bool Happened() const { return record >= 0; }
};

// The last linearisation. Searches for starts begin from it.
struct ShootingLinearization {
  Vector free;  // empty: none since the records were cut
  // Starts at `free`; without a linearisation those of the cut. num_states x
  // segments per training record.
  std::vector<Matrix> starts;
  // Infinite: none with the present weights.
  double cost = std::numeric_limits<double>::infinity();
  CondensedSystem system;
  // Sums of squares of each channel's residuals in the sensors' units (weights
  // of a robust loss included), per training record, of which modal problems
  // have none. Not set: no linearisation holds.
  std::optional<std::vector<Vector>> squares;
  // Mean over segments and states of D^2 J'J of the data: how firmly the data
  // alone hold a start, compared with mu. A new cut leaves it.
  double data_curvature = 0.0;
};

// Answers what is valid: the cost and the starts of the last evaluation, its
// derivatives, its normal equations, and the last linearisation.
class ShootingState {
 public:
  // The most that holds at the point of the last evaluation. Each level
  // includes those before it.
  enum class Propagated {
    kNothing,
    kTrajectory,     // the cost and the best starts
    kDerivatives,    // the segments' derivatives by the parameters
    kSensitivities,  // the normal equations, and how the starts follow
  };

  bool HasTrajectoryAt(const Vector& free) const {
    return propagated_ >= Propagated::kTrajectory && IsAt(free_, free);
  }
  // The segments' results hold derivatives by the parameters, not yet summed.
  bool HasDerivatives() const {
    return propagated_ == Propagated::kDerivatives;
  }
  bool HasSensitivitiesAt(const Vector& free) const {
    return propagated_ == Propagated::kSensitivities && IsAt(free_, free);
  }
  // The starts' tangent of the last linearisation is there, for so many free
  // parameters.
  bool HasTangent(Eigen::Index num_free) const {
    return num_free > 0 && linearization_.free.size() == num_free;
  }

  // Cost of the last evaluation; valid with a trajectory.
  double cost() const { return cost_; }
  const ShootingLinearization& linearization() const { return linearization_; }
  double data_curvature() const { return linearization_.data_curvature; }
  // Squares of the last linearisation, where that was at `free`; nullptr where
  // it was not.
  const std::vector<Vector>* SquaresAt(const Vector& free) const {
    return linearization_.squares.has_value() && IsAt(linearization_.free, free)
               ? &*linearization_.squares
               : nullptr;
  }
  // The last evaluation failed.
  bool HasFailed() const { return failure_.has_value(); }
  // Place where the last evaluation stopped being finite, if it did.
  const Divergence& divergence() const;

  // The records were cut anew: searches begin at these starts.
  void SetCut(const std::vector<Matrix>& starts);
  // The cost has changed: nothing that was evaluated holds.
  void SetCostChanged();
  // Nothing holds at the point of the last evaluation. The linearisation stays.
  void SetNothing() { propagated_ = Propagated::kNothing; }
  // An evaluation at `free` has succeeded.
  void SetTrajectory(const Vector& free, double cost, bool with_derivatives);
  // The segments were propagated for something else, at other levels.
  void DropDerivatives();
  // A linearisation at the point of the last evaluation. With normal equations
  // that are not finite the starts' tangent alone holds.
  void SetLinearization(ShootingLinearization linearization);
  // The evaluation, or the linearisation after it, has failed.
  void SetFailed(const Divergence& divergence) { failure_ = divergence; }

 private:
  static bool IsAt(const Vector& known, const Vector& free) {
    return known.size() == free.size() && known == free;
  }

  Propagated propagated_ = Propagated::kNothing;
  Vector free_;  // of the last evaluation
  double cost_ = 0.0;
  std::optional<Divergence> failure_;
  ShootingLinearization linearization_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SHOOTING_STATE_H_
