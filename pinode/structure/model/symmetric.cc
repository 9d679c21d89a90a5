#include "pinode/structure/model/symmetric.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {

Asymmetry LargestAsymmetry(const Matrix& matrix) {
  CHECK_EQ(matrix.rows(), matrix.cols())
      << "only a square matrix can be symmetric";
  Asymmetry worst;
  for (int j = 0; j < matrix.cols(); ++j) {
    for (int i = j + 1; i < matrix.rows(); ++i) {
      const double lower = matrix(i, j);
      const double upper = matrix(j, i);
      if (lower == upper) continue;
      // The roots are taken one by one: a product of diagonals may overflow.
      const double scale = std::max({std::abs(lower), std::abs(upper),
                                     std::sqrt(std::abs(matrix(i, i))) *
                                         std::sqrt(std::abs(matrix(j, j)))});
      // Each term is divided by itself: their difference may overflow.
      const double relative = std::abs(lower / scale - upper / scale);
      if (relative > worst.relative) worst = {relative, i, j};
    }
  }
  return worst;
}

Matrix SymmetricPart(const Matrix& matrix) {
  CHECK_EQ(matrix.rows(), matrix.cols())
      << "only a square matrix has a symmetric part";
  return 0.5 * matrix + 0.5 * matrix.transpose();
}

}  // namespace pinode
