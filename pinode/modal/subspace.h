// Covariance-driven stochastic subspace identification, with uncertainty.

#ifndef PINODE_MODAL_SUBSPACE_H_
#define PINODE_MODAL_SUBSPACE_H_

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/windowed_correlations.h"

namespace pinode {

// A pole of an identified state-space model: a mode, or what noise makes look
// like one.
struct SubspacePole {
  int order = 0;           // states of the model
  std::complex<double> s;  // continuous, 1 / s; of the pair that with Im > 0
  Eigen::VectorXcd shape;  // channels, in the units of the samples
  // To first order, by how much each block of the record moves s and the shape:
  // blocks; channels x blocks. The mean over the blocks is zero.
  Eigen::VectorXcd s_influence;
  Eigen::MatrixXcd shape_influence;

  double frequency() const { return std::abs(s) / 6.283185307179586; }  // Hz
  double damping_ratio() const { return -s.real() / std::abs(s); }
};

// What poles are read from: a matrix whose columns lie, but for noise, in those
// of the observability matrix, and what parts of the record change it by.
struct HankelWindows {
  int num_channels = 0;
  Matrix mean;  // block rows * channels x columns
  int num_windows = 0;
  // The matrix of window b less the mean; from several threads at once.
  std::function<Matrix(int)> change;
};

struct SubspaceOptions {
  // Block rows of the Hankel matrix; of correlations its block columns are
  // those that are left of num_lags + 1.
  int block_rows = 30;
  // Orders 2, 4, ... up to this one.
  int max_order = 60;
  // Poles outside are not looked at.
  double lowest_hz = 0.0;
  double highest_hz = 1e300;
  double max_damping_ratio = 0.2;
};

// Block (i, j) is R_(i + j + 1).
HankelWindows HankelOfCorrelations(const WindowedCorrelations& correlations,
                                   int block_rows);

// The poles of all orders, by order and frequency.
//
//   H      the mean, of correlations the Hankel matrix of R_1 ... R_L;
//          H = U S V^T
//   O_n    first n columns of U: observability matrix of order n
//   A, C   O_n without its last block row times A = O_n without its first;
//          C = its first block row
//   A phi = lambda phi, s = ln(lambda) / step, shape = C phi
//
// The decomposition is made once; Q and R of the shifted O serve all orders. To
// first order a change dH moves O_n by U W (within the span of O_n nothing need
// be moved, for poles and shapes do not depend on its basis), with
//
//   W_kj = (s_j (U^T dH V)_kj + s_k (U^T dH V)_jk) / (s_j^2 - s_k^2), k > n >=
//   j
//
// and what follows for A and C moves lambda and phi. Sources: B. Peeters and G.
// De Roeck, Mech. Syst. Signal Process. 13 (1999) 855 (the method); E.
// Reynders, R. Pintelon, G. De Roeck, ibid. 22 (2008) 948 (its uncertainty); M.
// Doehler and L. Mevel, ibid. 38 (2013) 346 (several orders at a time).
//
// False where the matrix is too small for max_order.
[[nodiscard]] bool IdentifySubspace(const HankelWindows& hankel,
                                    double sampling_step,
                                    const SubspaceOptions& options,
                                    int num_threads,
                                    std::vector<SubspacePole>* poles,
                                    std::string* error);

// The same of correlations.
[[nodiscard]] bool IdentifySubspace(const WindowedCorrelations& correlations,
                                    double sampling_step,
                                    const SubspaceOptions& options,
                                    int num_threads,
                                    std::vector<SubspacePole>* poles,
                                    std::string* error);

// The discrete eigenvalues of the model of one order, all of them.
Eigen::VectorXcd FindEigenvalues(const HankelWindows& hankel, int order);

}  // namespace pinode

#endif  // PINODE_MODAL_SUBSPACE_H_
