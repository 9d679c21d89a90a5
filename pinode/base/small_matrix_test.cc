#include "pinode/base/small_matrix.h"

#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/types.h"

namespace pinode {
namespace {

void ExpectEqual(const Matrix& a, const Matrix& b) {
  EXPECT_LE((a - b).norm(), 1e-14 * (1.0 + b.norm()))
      << a.rows() << " x " << a.cols();
}

TEST(SmallMatrix, AgreesWithEigenAtEverySize) {
  for (const int rows : {1, 2, 3, 4, 6, 7, 8, 9, 15, 30}) {
    for (const int inner : {1, 2, 5, 9}) {
      for (const int cols : {0, 1, 3, 4, 5, 8, 13}) {
        const Matrix a = Matrix::Random(rows, inner);
        const Matrix b = Matrix::Random(inner, cols);
        Matrix c = Matrix::Constant(rows, cols, 99.0);
        MultiplySmall(rows, inner, cols, a.data(), b.data(), c.data());
        ExpectEqual(c, a.lazyProduct(b));

        // `inner` outer products of the columns of a and the rows of b.
        const Matrix b_transposed = b.transpose();
        std::vector<const double*> v;
        std::vector<const double*> r;
        for (int k = 0; k < inner; ++k) {
          v.push_back(a.col(k).data());
          r.push_back(b_transposed.col(k).data());
        }
        AddOuterProducts(inner, rows, cols, v.data(), r.data(), c.data());
        ExpectEqual(c, 2.0 * a.lazyProduct(b));

        // The product uses all rows but the first.
        const Vector x = Vector::Random(inner);
        Vector y = Vector::Random(rows - 1);
        const Vector sum = y + a.bottomRows(rows - 1).lazyProduct(x);
        AddProductSmall(rows - 1, inner, a.data() + 1, rows, x.data(),
                        y.data());
        ExpectEqual(y, sum);

        AddProductSmall(rows - 1, 0, nullptr, rows, nullptr, y.data());
        ExpectEqual(y, sum);

        const Vector d = Vector::Random(cols);
        const Matrix expected = c * d.asDiagonal();
        ScaleColumnsSmall(rows, cols, c.data(), d.data(), c.data());
        ExpectEqual(c, expected);
      }
    }
  }
}

}  // namespace
}  // namespace pinode
