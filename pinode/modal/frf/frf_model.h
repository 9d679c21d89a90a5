// A modal model of frequency response functions, with its linear unknowns
// eliminated.

#ifndef PINODE_MODAL_FRF_FRF_MODEL_H_
#define PINODE_MODAL_FRF_FRF_MODEL_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/frf/frf_data.h"

namespace pinode {

// A mode as the nonlinear unknowns describe it.
struct FrfMode {
  std::complex<double> s;       // Im s > 0, for a pair
  ComplexVector participation;  // of the references; 1 at `reference`
  Eigen::Index reference = 0;
};

// A fit of the linear unknowns, and its slopes.
struct FrfFit {
  std::vector<FrfMode> modes;
  ComplexMatrix shapes;     // modes x outputs
  ComplexMatrix residuals;  // lines x pairs, not weighted
  Matrix leverages;         // lines x pairs: part of the noise that is fitted
  double cost = 0.0;        // sum of weighted squares of real numbers
  // Half the Hessian of the cost by Gauss and Newton and half its gradient, for
  // the nonlinear unknowns in the order of FrfModel::num_unknowns().
  Matrix normal;
  Vector gradient;
  // For each output: slopes of the shapes' real numbers by the nonlinear
  // unknowns, and their covariance if these are fixed. Two rows for each mode.
  std::vector<Matrix> shape_slopes, shape_covariances;
};

// The model of the FRF of output o to reference j is
//
//   H_oj(w) = (i w)^d (sum_r [psi_ro L_rj / (i w - s_r)
//                             + conj(psi_ro L_rj) / (i w - conj(s_r))]
//                      + lower_oj / (i w)^2 + upper_oj),
//
// with d the derivative of the displacement. The residuals hold the modes below
// and above the lines. Shapes psi and residuals are linear: for given poles s
// and participations L they are a least-squares solution (variable projection:
// G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413). The Jacobian of
// what remains is -P D c, with P the projection that removes the linear part
// and D c the slope of the model: its product with the remainder is the exact
// gradient, its square is the information about the nonlinear unknowns.
class FrfModel {
 public:
  // `data` must outlive this object.
  FrfModel(const FrfData& data, int num_threads);

  const FrfData& data() const { return data_; }
  // Variances of the values: lines x pairs. `even`: they are those of an output
  // at all lines and references.
  void set_variances(Matrix variances, bool even);
  const Matrix& variances() const { return variances_; }
  // Residuals of modes outside of the lines: real by default. Complex ones hold
  // errors of the sensors' phase too.
  bool complex_residuals() const { return complex_residuals_; }
  void set_complex_residuals(bool value) { complex_residuals_ = value; }

  // Number of nonlinear unknowns of a mode: real and imaginary part of s, then
  // of the participation of each reference but that of 1.
  Eigen::Index unknowns_of_mode() const { return 2 * data_.references; }

  // Fits the linear unknowns.
  FrfFit Solve(const std::vector<FrfMode>& modes) const;

  // Returns the increase of the cost without mode m, the others fixed.
  double GainOf(const FrfFit& fit, size_t m) const;

 private:
  struct Basis;
  Basis MakeBasis(const std::vector<FrfMode>& modes,
                  const Matrix& weights) const;
  void SolveOutput(const Basis& basis, Eigen::Index output, double scale,
                   FrfFit* fit, Matrix* normal, Vector* gradient,
                   double* cost) const;

  const FrfData& data_;
  const int num_threads_;
  Matrix variances_;
  bool even_ = true;
  bool complex_residuals_ = false;
};

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_FRF_MODEL_H_
