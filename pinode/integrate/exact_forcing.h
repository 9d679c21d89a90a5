// The exact response of linear dynamics to an input that is a polynomial
// between two samples.

#ifndef PINODE_INTEGRATE_EXACT_FORCING_H_
#define PINODE_INTEGRATE_EXACT_FORCING_H_

#include <Eigen/Core>
#include <complex>

#include "pinode/base/types.h"

namespace pinode {

// Returns the coefficients c_j of the polynomial sum_j c_j tau^j, tau in [0,
// 1], through an input at the nodes of an interval of IntegrationGrid with
// `steps` steps. The result is (degree + 1) x (3 * steps) with degree = 2 *
// steps. If two nodes coincide, the first one is used.
Matrix NodePolynomial(int steps);

// Returns phi_0 ... phi_count-1 at x, with phi_0 = exp and
//
//   phi_k(x) = int_0^1 e^((1 - s) x) s^(k-1) / (k-1)! ds
//
// (M. Hochbruck, A. Ostermann, Acta Numerica 19 (2010) 209). The relative error
// is below 1e-12 for Re x <= 1. Their derivatives are phi_k' = phi_k - k
// phi_k+1.
Eigen::VectorXcd PhiFunctions(std::complex<double> x, int count);

// The exact step of dz/dt = lambda z + u over `duration`, with u the polynomial
// through its values u_k at the nodes:
//
//   z_next = advance z + sum_k forcing_k u_k.
//
// Also holds the derivatives of `advance` and `forcing` with respect to lambda.
struct ExactStep {
  // Computes the step. `polynomial` is the result of NodePolynomial.
  ExactStep(std::complex<double> lambda, double duration,
            const Matrix& polynomial);

  std::complex<double> advance;
  std::complex<double> advance_slope;
  Eigen::VectorXcd forcing;  // one per node
  Eigen::VectorXcd forcing_slope;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_EXACT_FORCING_H_
