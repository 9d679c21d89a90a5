// The augmented Lagrangian that closes the gaps between a record's segments.

#ifndef PINODE_ESTIMATE_SHOOTING_GAP_PENALTY_H_
#define PINODE_ESTIMATE_SHOOTING_GAP_PENALTY_H_

#include "pinode/base/types.h"

namespace pinode {

// With phi_k the state at the end of segment k, s_{k+1} the start of the next
// one, state scales D, a penalty mu and scaled multipliers lambda,
//
//   mu/2 sum_k |D^-1 (phi_k - s_{k+1}) + lambda_k|^2
//
// (J. Nocedal and S. Wright, Numerical Optimization, 2nd ed., 2006, ch. 17).
// `ends` and `starts` hold phi and s of all segments of one record as columns.
class GapPenalty {
 public:
  // No multipliers, unit scales.
  GapPenalty() = default;
  GapPenalty(int num_states, int num_segments);

  // D, positive.
  void set_scales(const Vector& scales) { scales_ = scales; }
  const Vector& scales() const { return scales_; }
  void ResetMultipliers(int num_segments);

  double Cost(double mu, const Matrix& ends, const Matrix& starts) const;
  // mu D^-1 (D^-1 gap + lambda): how gap k pulls at what it joins, num_states.
  Vector Force(double mu, const Matrix& ends, const Matrix& starts,
               int gap) const;

  // lambda_k += D^-1 gap_k.
  void UpdateMultipliers(const Matrix& ends, const Matrix& starts);
  // After a change of mu: mu * lambda is what must stay.
  void RescaleMultipliers(double factor) { multipliers_ *= factor; }
  // max |D^-1 gap|.
  double LargestGap(const Matrix& ends, const Matrix& starts) const;

 private:
  // D^-1 gap_k.
  Vector Scaled(const Matrix& ends, const Matrix& starts, int gap) const;

  Vector scales_;
  Matrix multipliers_;  // num_states x gaps
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_GAP_PENALTY_H_
