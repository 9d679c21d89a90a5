// Deterministic-stochastic subspace identification: responses to a measured
// input, and to what nobody measured beside it.

#ifndef PINODE_MODAL_INPUT_PROJECTION_H_
#define PINODE_MODAL_INPUT_PROJECTION_H_

#include <memory>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Of outputs y and inputs u, y_f and u_f stacked samples behind k, z_p stacked
// samples of references and inputs up to k,
//
//   H = E[e_f z^T],   e_f = y_f - B u_f,   z = z_p - D u_f
//
// B and D the regressions on u_f: what the future input does is projected out,
// and the past, which the noise of the future does not know, serves as
// instrument. Since y_f = O x + (Toeplitz matrix) u_f + noise, the columns of H
// are those of O (past-output MOESP: M. Verhaegen, Automatica 30 (1994) 61).
// All sums are over the same samples, so that without noise H is exact. By the
// regressions H does not change to first order: a window's H is its mean of e_f
// z^T (P. Mellinger, M. Doehler, L. Mevel, J. Sound Vib. 379 (2016) 1).
//
// u_f reaches over a few samples more on either side: a force that moves
// between samples acts on them all by its interpolation.
//
// outputs: channels x samples; NaN: missing, such stretches do not count.
// inputs: inputs x samples, complete. Both of mean zero.
HankelWindows ProjectInput(std::shared_ptr<const Matrix> outputs,
                           std::shared_ptr<const Matrix> inputs,
                           const std::vector<int>& references, int block_rows,
                           int num_windows, int num_threads,
                           Eigen::Index* window_samples);

}  // namespace pinode

#endif  // PINODE_MODAL_INPUT_PROJECTION_H_
