// Products of matrices of a few rows.

#ifndef PINODE_INTEGRATE_FEW_ROWS_H_
#define PINODE_INTEGRATE_FEW_ROWS_H_

#include "pinode/base/types.h"
#include "pinode/network/small_matrix.h"

namespace pinode {

// left * right; without the packing of a product of large matrices where `left`
// has few rows, as a step's matrices do that act on a wide sensitivity.
inline void MultiplyFewRows(const Matrix& left, const Matrix& right,
                            Matrix* product) {
  constexpr int kFewRows = 16;
  product->resize(left.rows(), right.cols());
  if (left.rows() > kFewRows) {
    product->noalias() = left * right;
    return;
  }
  MultiplySmall(static_cast<int>(left.rows()), static_cast<int>(left.cols()),
                static_cast<int>(right.cols()), left.data(), right.data(),
                product->data());
}

}  // namespace pinode

#endif  // PINODE_INTEGRATE_FEW_ROWS_H_
