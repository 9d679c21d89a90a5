// Products of matrices with a few rows, for the inner loop of the trainer.
// Eigen packs the operands or checks their sizes at every entry, which takes
// longer than the product.
//
// All matrices are dense and column-major. Without a stride there are no gaps
// between columns. No function here allocates memory.

#ifndef PINODE_BASE_SMALL_MATRIX_H_
#define PINODE_BASE_SMALL_MATRIX_H_

#include "pinode/base/types.h"

namespace pinode {

// Computes C = A B, with A rows x inner, B inner x cols, C rows x cols. `c`
// overlaps neither `a` nor `b`.
void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c);

// Computes the same into rows of a taller matrix. `stride` is the distance
// between C's columns.
void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c, Eigen::Index stride);

// Computes y += A x, with A rows x cols and `stride` between its columns.
void AddProductSmall(int rows, int cols, const double* a, Eigen::Index stride,
                     const double* x, double* y);

// Computes result = left * right, as above if `left` is small and with Eigen
// otherwise.
void Multiply(const Matrix& left, const Eigen::Ref<const Matrix>& right,
              Eigen::Ref<Matrix> result);

// Computes C = A diag(d). A and C are rows x cols, and d has `cols` entries.
// `c` may be `a`.
void ScaleColumnsSmall(int rows, int cols, const double* a, const double* d,
                       double* c);

// Computes B += sum_k v_k r_k' over `count` outer products. v_k has `rows`
// entries, r_k has `cols`, and B is rows x cols. B overlaps none of them.
void AddOuterProducts(int count, int rows, int cols, const double* const* v,
                      const double* const* r, double* b);

}  // namespace pinode

#endif  // PINODE_BASE_SMALL_MATRIX_H_
