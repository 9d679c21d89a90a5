// Products of matrices of a few rows, for the inner loop of the trainer.
//
// All matrices are dense and column-major, without gaps between columns unless
// a leading dimension is given. Nothing here allocates.

#ifndef PINODE_NETWORK_SMALL_MATRIX_H_
#define PINODE_NETWORK_SMALL_MATRIX_H_

namespace pinode {

// C = A B, with A rows x inner, B inner x cols, C rows x cols. `c` overlaps
// neither `a` nor `b`.
void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c);

// B += sum_k v_k r_k' over `count` outer products; v_k has `rows` entries, r_k
// has `cols`, and B is rows x cols. B overlaps none of them.
void AddOuterProducts(int count, int rows, int cols, const double* const* v,
                      const double* const* r, double* b);

}  // namespace pinode

#endif  // PINODE_NETWORK_SMALL_MATRIX_H_
