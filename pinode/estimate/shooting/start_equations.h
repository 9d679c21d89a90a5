// The normal equations of a record's segment starts.

#ifndef PINODE_ESTIMATE_SHOOTING_START_EQUATIONS_H_
#define PINODE_ESTIMATE_SHOOTING_START_EQUATIONS_H_

#include <algorithm>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/block_tridiagonal.h"

namespace pinode {

class ShootingRecord;

// Equations for the free parameters, a dense symmetric matrix and a gradient.
// The matrix holds its lower triangle alone while it is being summed.
struct FreeEquations {
  Matrix hessian;   // num_free x num_free
  Vector gradient;  // num_free
};

// A record's part of
//
//   F(s, theta) = 1/2 |r(s, theta)|^2 + (the gaps' penalty)
//               + kappa/2 |D^-1 s_0|^2        (where its first start is free),
//
// block tridiagonal in the starts s, from the results of the record's segments.
class StartEquations {
 public:
  // Equations for the present cut of `record`, which must outlive this object.
  // `start_precision`: kappa.
  StartEquations(const ShootingRecord& record, bool start_is_free,
                 double start_precision);

  // True if there is a start to be found.
  bool HasFreeStarts() const;

  // The record's part of F, from the segments' results and the penalty.
  double Cost(double mu, const Matrix& starts) const;

  // Fills system() with the normal equations of the starts, and *right with
  // their coupling to the free parameters, negative (num_free rows, 0 to leave
  // them out), and, in the last row, their gradient.
  void Assemble(double mu, const Matrix& starts, int num_free, Matrix* right);
  BlockTridiagonal& system() { return system_; }

  // Adds the gaps' part to the equations of the free parameters and takes the
  // starts out of them. False where their matrix is singular.
  bool Eliminate(double mu, const Matrix& starts, FreeEquations* equations);
  // d starts / d free after Eliminate, (num_states * segments) x num_free;
  // empty before.
  auto start_sensitivity() const {
    return right_.topRows(std::max<Eigen::Index>(0, right_.rows() - 1))
        .transpose();
  }

  // Sum over segments of the mean of diag(D J_s'J_s D).
  double DataCurvature() const;

  // Cost at the last evaluation, and at the last linearisation.
  double cost = 0.0;
  double linearized_cost = 0.0;

 private:
  // Adds the gaps to the equations of the free parameters.
  void AddGaps(double mu, const Matrix& starts, FreeEquations* equations);
  const Vector& scales() const;

  const ShootingRecord& record_;
  int num_states_;
  bool start_is_free_;
  double start_precision_;
  BlockTridiagonal system_;
  // Eliminate turns what Assemble wrote into the transposed start_sensitivity()
  // in the first num_free rows. Kept, it is too large to be asked for anew.
  Matrix right_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_START_EQUATIONS_H_
