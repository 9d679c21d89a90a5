// Finds the rows and columns of a matrix that are not zero.

#ifndef PINODE_BASE_ENTRIES_IN_USE_H_
#define PINODE_BASE_ENTRIES_IN_USE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Returns the rows (columns) of a matrix that are not all zero, ascending.
inline std::vector<int> RowsInUse(const Eigen::Ref<const Matrix>& matrix) {
  std::vector<int> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (!matrix.row(i).isZero(0.0)) rows.push_back(static_cast<int>(i));
  }
  return rows;
}
inline std::vector<int> ColumnsInUse(const Eigen::Ref<const Matrix>& matrix) {
  std::vector<int> columns;
  for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
    if (!matrix.col(i).isZero(0.0)) columns.push_back(static_cast<int>(i));
  }
  return columns;
}

}  // namespace pinode

#endif  // PINODE_BASE_ENTRIES_IN_USE_H_
