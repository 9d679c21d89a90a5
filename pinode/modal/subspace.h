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

// A pole of an identified state-space model: a mode, or an artefact of noise.
struct SubspacePole {
  int order = 0;           // states of the model
  std::complex<double> s;  // continuous, 1 / s; Im > 0 of a pair
  Eigen::VectorXcd shape;  // channels, in the units of the samples
  // Influence of each block of the record on s and on the shape, to first
  // order: blocks; channels x blocks. The mean over the blocks is zero.
  Eigen::VectorXcd s_influence;
  Eigen::MatrixXcd shape_influence;

  double frequency() const { return std::abs(s) / 6.283185307179586; }  // Hz
  double damping_ratio() const { return -s.real() / std::abs(s); }
};

// Matrix from which poles are identified. Except for noise, its columns lie in
// those of the observability matrix. Also holds its changes by parts of the
// record.
struct HankelWindows {
  int num_channels = 0;
  Matrix mean;  // block rows * channels x columns
  int num_windows = 0;
  // Returns the matrix of window b minus the mean. May be called from several
  // threads at once.
  std::function<Matrix(int)> change;
};

struct SubspaceOptions {
  // Block rows of the Hankel matrix. For correlations, num_lags + 1 minus these
  // is the number of block columns.
  int block_rows = 30;
  // Highest order: orders 2, 4, ... up to this one are computed.
  int max_order = 60;
  // Ranges of frequency and damping ratio. Poles outside are ignored.
  double lowest_hz = 0.0;
  double highest_hz = 1e300;
  double max_damping_ratio = 0.2;
};

// Returns the Hankel matrix whose block (i, j) is R_(i + j + 1).
HankelWindows HankelOfCorrelations(const WindowedCorrelations& correlations,
                                   int block_rows);

// Computes the poles of all orders, by order and frequency.
//
//   H      the mean, of correlations the Hankel matrix of R_1 ... R_L;
//          H = U S V^T
//   O_n    first n columns of U: observability matrix of order n
//   A, C   O_n without its last block row times A = O_n without its first;
//          C = its first block row
//   A phi = lambda phi, s = ln(lambda) / step, shape = C phi
//
// The decomposition is computed once; Q and R of the shifted O serve all
// orders. To first order, a change dH moves O_n by U W, with
//
//   W_kj = (s_j (U^T dH V)_kj + s_k (U^T dH V)_jk) / (s_j^2 - s_k^2),
//   k > n >= j.
//
// Movements within the span of O_n are not needed, because poles and shapes do
// not depend on its basis. The changes of A and C move lambda and phi. Sources:
// B. Peeters and G. De Roeck, Mech. Syst. Signal Process. 13 (1999) 855 (the
// method); E. Reynders, R. Pintelon, G. De Roeck, ibid. 22 (2008) 948 (its
// uncertainty); M. Doehler and L. Mevel, ibid. 38 (2013) 346 (several orders at
// a time).
//
// Returns false if the matrix is too small for max_order.
[[nodiscard]] bool IdentifySubspace(const HankelWindows& hankel,
                                    double sampling_step,
                                    const SubspaceOptions& options,
                                    int num_threads,
                                    std::vector<SubspacePole>* poles,
                                    std::string* error);

// Does the same for correlations.
[[nodiscard]] bool IdentifySubspace(const WindowedCorrelations& correlations,
                                    double sampling_step,
                                    const SubspaceOptions& options,
                                    int num_threads,
                                    std::vector<SubspacePole>* poles,
                                    std::string* error);

// Returns all discrete eigenvalues of the model of one order.
Eigen::VectorXcd FindEigenvalues(const HankelWindows& hankel, int order);

}  // namespace pinode

#endif  // PINODE_MODAL_SUBSPACE_H_
