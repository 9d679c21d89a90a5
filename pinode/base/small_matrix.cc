#include "pinode/base/small_matrix.h"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

namespace pinode {
namespace {

template <int kRows>
using Column = Eigen::Array<double, kRows, 1>;
template <int kRows>
using ColumnMap = Eigen::Map<Column<kRows>>;
template <int kRows>
using ConstColumnMap = Eigen::Map<const Column<kRows>>;

// The tiles below are written as folds over the columns. An array in a loop
// would stay in memory at -O2, and every sum would wait for the one before it.

// kRows rows of C = A B, held in registers; J counts its columns.
template <int kRows, int... J>
inline void MultiplyTile(std::integer_sequence<int, J...> /*columns*/,
                         int inner, const double* a, int lda, const double* b,
                         double* c, Eigen::Index ldc) {
  std::array<Column<kRows>, sizeof...(J)> sums;
  (sums[J].setZero(), ...);
  for (int k = 0; k < inner; ++k) {
    const Column<kRows> column = ConstColumnMap<kRows>(a + k * lda);
    ((sums[J] += column * b[J * inner + k]), ...);
  }
  ((ColumnMap<kRows>(c + J * ldc) = sums[J]), ...);
}

// kRows rows of A b, in several sums. A single sum would wait for its own
// previous value.
template <int kRows, int... S>
inline Column<kRows> ProductColumn(std::integer_sequence<int, S...> /*sums*/,
                                   int inner, const double* a, Eigen::Index lda,
                                   const double* b) {
  constexpr int kSums = sizeof...(S);
  std::array<Column<kRows>, kSums> sums;
  (sums[S].setZero(), ...);
  int k = 0;
  for (; k + kSums <= inner; k += kSums) {
    ((sums[S] += ConstColumnMap<kRows>(a + (k + S) * lda) * b[k + S]), ...);
  }
  for (; k < inner; ++k) {
    sums[0] += ConstColumnMap<kRows>(a + k * lda) * b[k];
  }
  ((sums[0] += S > 0 ? sums[S] : Column<kRows>::Zero().eval()), ...);
  return sums[0];
}

template <int kRows>
inline void MultiplyRows(int inner, int cols, const double* a, int lda,
                         const double* b, double* c, Eigen::Index ldc) {
  constexpr std::make_integer_sequence<int, 8> kEight;
  constexpr std::make_integer_sequence<int, 4> kFour;
  int j = 0;
  for (; j + 8 <= cols; j += 8) {
    MultiplyTile<kRows>(kEight, inner, a, lda, b + j * inner, c + j * ldc, ldc);
  }
  for (; j + 4 <= cols; j += 4) {
    MultiplyTile<kRows>(kFour, inner, a, lda, b + j * inner, c + j * ldc, ldc);
  }
  for (; j < cols; ++j) {
    ColumnMap<kRows> column(c + j * ldc);
    column = ProductColumn<kRows>(kFour, inner, a, lda, b + j * inner);
  }
}

// Calls rows(std::integral_constant of the number of rows, index of the first
// row) for blocks of 8, 4, 2 and 1.
template <typename Rows>
inline void ForEachRowBlock(int rows, const Rows& block) {
  int i = 0;
  for (; i + 8 <= rows; i += 8) block(std::integral_constant<int, 8>(), i);
  if (i + 4 <= rows) {
    block(std::integral_constant<int, 4>(), i);
    i += 4;
  }
  if (i + 2 <= rows) {
    block(std::integral_constant<int, 2>(), i);
    i += 2;
  }
  if (i < rows) block(std::integral_constant<int, 1>(), i);
}

// kRows rows of B += sum_k v_k r_k', J counting its columns.
template <int kRows, int kCount, int... J>
inline void AddOuterTile(std::integer_sequence<int, J...> /*columns*/,
                         const double* const* v, const double* const* r, int i,
                         int j, int ldb, double* b) {
  std::array<Column<kRows>, sizeof...(J)> sums{
      Column<kRows>(ConstColumnMap<kRows>(b + J * ldb))...};
  for (int k = 0; k < kCount; ++k) {
    const Column<kRows> column = ConstColumnMap<kRows>(v[k] + i);
    ((sums[J] += column * r[k][j + J]), ...);
  }
  ((ColumnMap<kRows>(b + J * ldb) = sums[J]), ...);
}

template <int kCount>
void AddOuterProductsOf(int rows, int cols, const double* const* v,
                        const double* const* r, double* b) {
  constexpr std::make_integer_sequence<int, 4> kFour;
  constexpr std::make_integer_sequence<int, 1> kOne;
  int j = 0;
  for (; j + 4 <= cols; j += 4) {
    ForEachRowBlock(rows, [&](auto block, int i) {
      AddOuterTile<block(), kCount>(kFour, v, r, i, j, rows, b + j * rows + i);
    });
  }
  for (; j < cols; ++j) {
    ForEachRowBlock(rows, [&](auto block, int i) {
      AddOuterTile<block(), kCount>(kOne, v, r, i, j, rows, b + j * rows + i);
    });
  }
}

}  // namespace

void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c) {
  MultiplySmall(rows, inner, cols, a, b, c, rows);
}

void MultiplySmall(int rows, int inner, int cols, const double* a,
                   const double* b, double* c, Eigen::Index stride) {
  if (cols == 0) return;  // nothing may have no address
  if (rows == 1) {
    // Dot products: with one row there is nothing else to vectorise.
    const Eigen::Map<const Vector> row(a, inner);
    for (int j = 0; j < cols; ++j) {
      c[j * stride] = row.dot(Eigen::Map<const Vector>(b + j * inner, inner));
    }
    return;
  }
  ForEachRowBlock(rows, [&](auto block, int i) {
    MultiplyRows<block()>(inner, cols, a + i, rows, b, c + i, stride);
  });
}

void AddProductSmall(int rows, int cols, const double* a, Eigen::Index stride,
                     const double* x, double* y) {
  if (cols == 0) return;  // nothing may have no address
  constexpr std::make_integer_sequence<int, 4> kFour;
  ForEachRowBlock(rows, [&](auto block, int i) {
    ColumnMap<block()>(y + i) +=
        ProductColumn<block()>(kFour, cols, a + i, stride, x);
  });
}

void Multiply(const Matrix& left, const Eigen::Ref<const Matrix>& right,
              Eigen::Ref<Matrix> result) {
  // Size above which packing pays off.
  constexpr Eigen::Index kFew = 16;
  if (left.rows() > kFew || left.cols() > kFew ||
      right.outerStride() != right.rows()) {
    result.noalias() = left * right;
    return;
  }
  MultiplySmall(static_cast<int>(left.rows()), static_cast<int>(left.cols()),
                static_cast<int>(right.cols()), left.data(), right.data(),
                result.data(), result.outerStride());
}

void ScaleColumnsSmall(int rows, int cols, const double* a, const double* d,
                       double* c) {
  ForEachRowBlock(rows, [&](auto block, int i) {
    for (int j = 0; j < cols; ++j) {
      const int at = j * rows + i;
      ColumnMap<block()>(c + at) = ConstColumnMap<block()>(a + at) * d[j];
    }
  });
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
