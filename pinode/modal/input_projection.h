// Deterministic-stochastic subspace identification: responses to a measured
// input and to additional unmeasured loads.

#ifndef PINODE_MODAL_INPUT_PROJECTION_H_
#define PINODE_MODAL_INPUT_PROJECTION_H_

#include <memory>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Returns the Hankel matrix for outputs y and inputs u. y_f and u_f are stacked
// samples after k. z_p are stacked samples of references and inputs up to k.
// Then
//
//   H = E[e_f z^T],   e_f = y_f - B u_f,   z = z_p - D u_f
//
// with B and D the regressions on u_f. The regressions remove the effect of the
// future input. The past serves as instrument, because it is uncorrelated with
// the noise of the future. Since y_f = O x + (Toeplitz matrix) u_f + noise, the
// columns of H are those of O (past-output MOESP: M. Verhaegen, Automatica 30
// (1994) 61). All sums are over the same samples, so that without noise H is
// exact. Changes of the regressions do not change H to first order: a window's
// H is its mean of e_f z^T (P. Mellinger, M. Doehler, L. Mevel, J. Sound Vib.
// 379 (2016) 1).
//
// u_f extends a few samples more on either side, because the interpolation of a
// force between samples depends on all of them.
//
// outputs: channels x samples; NaN: missing, such stretches do not count.
// inputs: inputs x samples, complete. Both have zero mean.
HankelWindows ProjectInput(std::shared_ptr<const Matrix> outputs,
                           std::shared_ptr<const Matrix> inputs,
                           const std::vector<int>& references, int block_rows,
                           int num_windows, int num_threads,
                           Eigen::Index* window_samples);

}  // namespace pinode

#endif  // PINODE_MODAL_INPUT_PROJECTION_H_
