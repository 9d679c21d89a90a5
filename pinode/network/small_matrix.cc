#include "pinode/network/small_matrix.h"

#include <algorithm>

#include "pinode/base/types.h"

namespace pinode {
namespace {

// kRows rows of kCols columns of C = A B, held in registers.
template <int kRows, int kCols>
inline void MultiplyTile(int inner, const double* a, int lda, const double* b,
                         double* c, int ldc) {
  using Column = Eigen::Array<double, kRows, 1>;
  Column sums[kCols];
  for (int j = 0; j < kCols; ++j) sums[j].setZero();
  for (int k = 0; k < inner; ++k) {
    const Column column = Eigen::Map<const Column>(a + k * lda);
    for (int j = 0; j < kCols; ++j) sums[j] += column * b[j * inner + k];
  }
  for (int j = 0; j < kCols; ++j) Eigen::Map<Column>(c + j * ldc) = sums[j];
}

template <int kRows>
inline void MultiplyRows(int inner, int cols, const double* a, int lda,
                         const double* b, double* c, int ldc) {
  constexpr int kCols = 4;
  int j = 0;
  for (; j + kCols <= cols; j += kCols) {
    MultiplyTile<kRows, kCols>(inner, a, lda, b + j * inner, c + j * ldc, ldc);
  }
  for (; j < cols; ++j) {
    MultiplyTile<kRows, 1>(inner, a, lda, b + j * inner, c + j * ldc, ldc);
  }
}

// Two columns at a time share the loads of v.
template <int kCount>
void AddOuterProductsOf(int rows, int cols, const double* const* v,
                        const double* const* r, double* __restrict b) {
  const double* __restrict v_k[kCount];
  for (int k = 0; k < kCount; ++k) v_k[k] = v[k];
  int j = 0;
  for (; j + 2 <= cols; j += 2) {
    double* __restrict left = b + j * rows;
    double* __restrict right = left + rows;
    double r_left[kCount];
    double r_right[kCount];
    for (int k = 0; k < kCount; ++k) {
      r_left[k] = r[k][j];
      r_right[k] = r[k][j + 1];
    }
    for (int i = 0; i < rows; ++i) {
      double sum_left = left[i];
      double sum_right = right[i];
      for (int k = 0; k < kCount; ++k) {
        sum_left += v_k[k][i] * r_left[k];
        sum_right += v_k[k][i] * r_right[k];
      }
      left[i] = sum_left;
      right[i] = sum_right;
    }
  }
  for (; j < cols; ++j) {
    double* __restrict column = b + j * rows;
    double r_j[kCount];
    for (int k = 0; k < kCount; ++k) r_j[k] = r[k][j];
    for (int i = 0; i < rows; ++i) {
      double sum = column[i];
      for (int k = 0; k < kCount; ++k) sum += v_k[k][i] * r_j[k];
      column[i] = sum;
    }
  }
}

}  // namespace

void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c) {
  if (rows == 1) {
    // Dot products: with one row there is nothing else to vectorise.
    const Eigen::Map<const Vector> row(a, inner);
    for (int j = 0; j < cols; ++j) {
      c[j] = row.dot(Eigen::Map<const Vector>(b + j * inner, inner));
    }
    return;
  }
  int i = 0;
  for (; i + 8 <= rows; i += 8) {
    MultiplyRows<8>(inner, cols, a + i, rows, b, c + i, rows);
  }
  if (i + 4 <= rows) {
    MultiplyRows<4>(inner, cols, a + i, rows, b, c + i, rows);
    i += 4;
  }
  if (i + 2 <= rows) {
    MultiplyRows<2>(inner, cols, a + i, rows, b, c + i, rows);
    i += 2;
  }
  if (i < rows) MultiplyRows<1>(inner, cols, a + i, rows, b, c + i, rows);
}

void AddOuterProducts(int count, int rows, int cols, const double* const* v,
                      const double* const* r, double* b) {
  // More than four streams at a time would run out of registers.
  for (int k = 0; k < count; k += 4) {
    switch (std::min(4, count - k)) {
      case 1:
        AddOuterProductsOf<1>(rows, cols, v + k, r + k, b);
        break;
      case 2:
        AddOuterProductsOf<2>(rows, cols, v + k, r + k, b);
        break;
      case 3:
        AddOuterProductsOf<3>(rows, cols, v + k, r + k, b);
        break;
      default:
        AddOuterProductsOf<4>(rows, cols, v + k, r + k, b);
    }
  }
}

}  // namespace pinode
