// Products of matrices of a few rows, for the inner loop of the trainer: what
// Eigen makes of them packs its operands or asks for their sizes at every
// entry, which takes longer than the product.
//
// All matrices are dense and column-major, without gaps between columns where
// no stride is given. Nothing here allocates.

#ifndef PINODE_BASE_SMALL_MATRIX_H_
#define PINODE_BASE_SMALL_MATRIX_H_

#include "pinode/base/types.h"

namespace pinode {

// C = A B, with A rows x inner, B inner x cols, C rows x cols. `c` overlaps
// neither `a` nor `b`.
void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c);

// The same into rows of a taller matrix: `stride` lies between C's columns.
void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c, Eigen::Index stride);

// y += A x, with A rows x cols and `stride` between its columns.
void AddProductSmall(int rows, int cols, const double* a, Eigen::Index stride,
                     const double* x, double* y);

// result = left * right, as above where `left` is small and by Eigen where it
// is not.
void Multiply(const Matrix& left, const Eigen::Ref<const Matrix>& right,
              Eigen::Ref<Matrix> result);

// C = A diag(d), all with rows x cols entries but d, which has cols. `c` may be
// `a`.
void ScaleColumnsSmall(int rows, int cols, const double* a, const double* d,
                       double* c);

// B += sum_k v_k r_k' over `count` outer products; v_k has `rows` entries, r_k
// has `cols`, and B is rows x cols. B overlaps none of them.
void AddOuterProducts(int count, int rows, int cols, const double* const* v,
                      const double* const* r, double* b);

}  // namespace pinode

#endif  // PINODE_BASE_SMALL_MATRIX_H_
