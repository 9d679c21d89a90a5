// Modes of linear dynamics, and what each of them does between two samples.

#ifndef PINODE_INTEGRATE_MODAL_BASIS_H_
#define PINODE_INTEGRATE_MODAL_BASIS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/integrate/integration_grid.h"

namespace pinode {

// The state matrix F of dh/dt = F h + G u as V diag(lambda) W, W = V^-1. In the
// coordinates W h each mode goes its own way: the response z of a mode to an
// input u goes from sample i to the next one by
//
//   z(i + 1) = rho(lambda) z(i) + sum_k kappa_k(lambda) u_k(i),
//
// u_k being the input at the nodes of the interval in the order of
// IntegrationGrid::AtNode. By Runge-Kutta these are the steps themselves, not
// the exact solution. Of a pair of conjugate modes one is kept.
class ModalBasis {
 public:
  struct Spectrum {
    Matrix state_matrix;
    ComplexVector eigenvalues;
    ComplexMatrix modes;
    ComplexMatrix inverse_modes;
  };

  // `state_matrix`: F. False where the modes do not span the states to working
  // accuracy, as those of a rigid body, whose two eigenvalues 0 have one mode.
  [[nodiscard]] bool Compute(const Matrix& state_matrix,
                             const IntegrationGrid& grid);

  int num_states() const {
    return static_cast<int>(spectrum_->eigenvalues.size());
  }
  int num_kept() const { return static_cast<int>(kept_.size()); }
  // All modes; V has them as columns.
  const ComplexVector& eigenvalues() const { return spectrum_->eigenvalues; }
  const ComplexMatrix& modes() const { return spectrum_->modes; }
  const ComplexMatrix& inverse_modes() const {
    return spectrum_->inverse_modes;
  }
  // Those that are kept, and how often each counts: 2 for one of a pair, of
  // which the real part is taken, and 1 for a real mode.
  const std::vector<int>& kept() const { return kept_; }
  const Vector& weights() const { return weights_; }

  // Of the kept modes: rho and its derivative by lambda; kappa and its own,
  // kept x (3 * substeps).
  const ComplexVector& advance() const { return advance_; }
  const ComplexVector& advance_slope() const { return advance_slope_; }
  const ComplexMatrix& forcing() const { return forcing_; }
  const ComplexMatrix& forcing_slope() const { return forcing_slope_; }

 private:
  void ComputeSteps(double step, int substeps);
  void ComputeExactly(double sampling_step, int substeps);

  std::shared_ptr<const Spectrum> spectrum_;
  std::vector<int> kept_;
  Vector weights_;
  ComplexVector advance_;
  ComplexVector advance_slope_;
  ComplexMatrix forcing_;
  ComplexMatrix forcing_slope_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_MODAL_BASIS_H_
