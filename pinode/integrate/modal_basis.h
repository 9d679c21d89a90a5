// Modes of linear dynamics, and their advance between two samples.

#ifndef PINODE_INTEGRATE_MODAL_BASIS_H_
#define PINODE_INTEGRATE_MODAL_BASIS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/integrate/integration_grid.h"

namespace pinode {

// The state matrix F of dh/dt = F h + G u as V diag(lambda) W, W = V^-1. In the
// coordinates W h the modes are uncoupled. The response z of a mode to an input
// u advances from sample i to the next one by
//
//   z(i + 1) = rho(lambda) z(i) + sum_k kappa_k(lambda) u_k(i),
//
// where u_k is the input at the nodes of the interval in the order of
// IntegrationGrid::AtNode. For Runge-Kutta these are the discrete steps, not
// the exact solution. Only one mode of a conjugate pair is stored.
class ModalBasis {
 public:
  struct Spectrum {
    Matrix state_matrix;
    ComplexVector eigenvalues;
    ComplexMatrix modes;
    ComplexMatrix inverse_modes;
  };

  // Returns the modes of `state_matrix`, F, alone. Returns nullptr where
  // Compute() returns false.
  static std::shared_ptr<const Spectrum> FindSpectrum(
      const Matrix& state_matrix);

  // Computes the modes of `state_matrix`, F. Returns false if the modes do not
  // span the states to working accuracy. Rigid-body modes do not: their two
  // eigenvalues 0 have one mode.
  [[nodiscard]] bool Compute(const Matrix& state_matrix,
                             const IntegrationGrid& grid);

  int num_states() const {
    return static_cast<int>(spectrum_->eigenvalues.size());
  }
  int num_kept() const { return static_cast<int>(kept_.size()); }
  // Eigenvalues and modes, all of them. The modes are the columns of V.
  const ComplexVector& eigenvalues() const { return spectrum_->eigenvalues; }
  const ComplexMatrix& modes() const { return spectrum_->modes; }
  const ComplexMatrix& inverse_modes() const {
    return spectrum_->inverse_modes;
  }
  // Kept modes, and the weight of each: 2 for one of a conjugate pair, whose
  // real part is used, and 1 for a real mode.
  const std::vector<int>& kept() const { return kept_; }
  const Vector& weights() const { return weights_; }

  // Coefficients of the kept modes: rho and its derivative with respect to
  // lambda; kappa and its derivative, kept x (3 * substeps).
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
