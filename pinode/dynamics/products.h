// Products of a matrix of numbers with a vector on any scalar. Numbers use
// Eigen. Jets use plain loops that skip zeros.

#ifndef PINODE_DYNAMICS_PRODUCTS_H_
#define PINODE_DYNAMICS_PRODUCTS_H_

#include "pinode/base/small_matrix.h"
#include "pinode/base/types.h"

namespace pinode {

// Computes sum += matrix * vector. The two scalar types may differ, so that
// inputs, which are numbers, can be added to Jets.
inline void AddProduct(const Eigen::Ref<const Matrix>& matrix,
                       const double* vector, double* sum) {
  // Size above which Eigen is not slower.
  constexpr Eigen::Index kFew = 16;
  if (matrix.rows() <= kFew) {
    AddProductSmall(static_cast<int>(matrix.rows()),
                    static_cast<int>(matrix.cols()), matrix.data(),
                    matrix.outerStride(), vector, sum);
    return;
  }
  Eigen::Map<Vector>(sum, matrix.rows()).noalias() +=
      matrix * Eigen::Map<const Vector>(vector, matrix.cols());
}

template <typename T, typename S>
void AddProduct(const Eigen::Ref<const Matrix>& matrix, const S* vector,
                T* sum) {
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      if (matrix(i, j) != 0.0) sum[i] += matrix(i, j) * vector[j];
    }
  }
}

// Computes sum += factor * column.
inline void AddScaled(const Eigen::Ref<const Vector>& column, double factor,
                      double* sum) {
  Eigen::Map<Vector>(sum, column.size()) += factor * column;
}

template <typename T>
void AddScaled(const Eigen::Ref<const Vector>& column, const T& factor,
               T* sum) {
  for (Eigen::Index i = 0; i < column.size(); ++i) {
    if (column[i] != 0.0) sum[i] += column[i] * factor;
  }
}

}  // namespace pinode

#endif  // PINODE_DYNAMICS_PRODUCTS_H_
