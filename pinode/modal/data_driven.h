// Data-driven stochastic subspace identification: the future projected on the
// past.

#ifndef PINODE_MODAL_DATA_DRIVEN_H_
#define PINODE_MODAL_DATA_DRIVEN_H_

#include "pinode/modal/subspace.h"
#include "pinode/modal/windowed_correlations.h"

namespace pinode {

// The projection of the future y_f on the row space of the past y_p is
// E[y_f y_p^T] E[y_p y_p^T]^-1 y_p: its left singular vectors and values are
// those of H T^(-1/2), H the Hankel and T the Toeplitz matrix of correlations
// (unweighted principal components; P. Van Overschee and B. De Moor, Subspace
// Identification for Linear Systems, 1996, chapter 3). So it costs what the
// covariance-driven identification costs, and weighs the same correlations
// otherwise: directions of the past count by what they say, not by their size.
// What windows change of T moves the columns of H only within their span and is
// left out, for orders of noise as an approximation.
HankelWindows DataDrivenHankel(const WindowedCorrelations& correlations,
                               const std::vector<int>& references,
                               int block_rows);

}  // namespace pinode

#endif  // PINODE_MODAL_DATA_DRIVEN_H_
