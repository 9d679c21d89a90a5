// Data-driven stochastic subspace identification: the projection of the future
// on the past.

#ifndef PINODE_MODAL_DATA_DRIVEN_H_
#define PINODE_MODAL_DATA_DRIVEN_H_

#include "pinode/modal/subspace.h"
#include "pinode/modal/windowed_correlations.h"

namespace pinode {

// Returns the projection of the future y_f on the row space of the past y_p,
// E[y_f y_p^T] E[y_p y_p^T]^-1 y_p. Its left singular vectors and values are
// those of H T^(-1/2), with H the Hankel and T the Toeplitz matrix of
// correlations (unweighted principal components; P. Van Overschee and B. De
// Moor, Subspace Identification for Linear Systems, 1996, chapter 3). It
// therefore costs as much as the covariance-driven identification. It weights
// the same correlations differently: directions of the past count by their
// information, not by their size. Changes of T between windows move the columns
// of H only within their span. They are neglected, which is an approximation
// for model orders that include noise.
HankelWindows DataDrivenHankel(const WindowedCorrelations& correlations,
                               const std::vector<int>& references,
                               int block_rows);

}  // namespace pinode

#endif  // PINODE_MODAL_DATA_DRIVEN_H_
