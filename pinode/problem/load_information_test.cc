#include "pinode/problem/load_information.h"

#include <complex>
#include <vector>

#include "gtest/gtest.h"

namespace pinode {
namespace {

// W_p of its definition, by the entries of both knots.
std::vector<ComplexMatrix> Changes(const LoadSpectrum& spectrum,
                                   const ComplexMatrix& h, double below,
                                   double above, const Matrix& root,
                                   const Matrix& next_root) {
  std::vector<ComplexMatrix> changes;
  for (int side = 0; side < 2; ++side) {
    for (const auto& [i, j] : spectrum.entries()) {
      Matrix d = Matrix::Zero(root.rows(), root.rows());
      d.row(i) += (side == 0 ? root : next_root).col(j).transpose();
      d.col(i) += (side == 0 ? root : next_root).col(j);
      changes.push_back((side == 0 ? below : above) * h * d * h.adjoint());
    }
  }
  return changes;
}

void ExpectSumOverLines(bool correlated) {
  constexpr int kAreas = 4;
  const LoadSpectrum spectrum(1.0, 4.0, 3, kAreas, correlated);
  const Vector unknowns = Vector::Random(spectrum.num_unknowns());
  const Matrix root = spectrum.Root(unknowns, 1);
  const Matrix next_root = spectrum.Root(unknowns, 2);
  LoadInformation information(spectrum);
  const Eigen::Index size = 2 * spectrum.per_knot();
  Matrix expected = Matrix::Zero(size, size);
  for (int line = 0; line < 40; ++line) {
    const ComplexMatrix h = ComplexMatrix::Random(3, kAreas);
    const double count = 1.0 + line % 3;
    const double above = line / 40.0;
    information.Add(h.adjoint() * h, count, 1.0 - above, above);
    const std::vector<ComplexMatrix> w =
        Changes(spectrum, h, 1.0 - above, above, root, next_root);
    for (size_t p = 0; p < w.size(); ++p) {
      for (size_t q = 0; q < w.size(); ++q) {
        expected(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(q)) +=
            count * (w[p] * w[q]).trace().real();
      }
    }
  }
  const Matrix found = information.Finish(root, next_root);
  EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm())
      << found << "\n\n"
      << expected;
}

TEST(LoadInformationTest, IsTheSumOverLines) { ExpectSumOverLines(true); }

TEST(LoadInformationTest, IsTheSumOverLinesOfLoadsApart) {
  ExpectSumOverLines(false);
}

TEST(LoadInformationTest, DerivativesByEntries) {
  const LoadSpectrum spectrum(1.0, 4.0, 2, 3, true);
  Vector unknowns = Vector::Random(spectrum.num_unknowns());
  Matrix s = Matrix::Random(3, 3);
  s = (s + s.transpose()).eval();
  const Vector derivatives =
      ByLoadEntries(spectrum, spectrum.Root(unknowns, 0), s);
  const auto value = [&] {
    const Matrix root = spectrum.Root(unknowns, 0);
    return (root * root.transpose() * s).trace();
  };
  for (int e = 0; e < spectrum.per_knot(); ++e) {
    constexpr double kStep = 1e-5;
    unknowns[e] += kStep;
    const double forth = value();
    unknowns[e] -= 2.0 * kStep;
    const double back = value();
    unknowns[e] += kStep;
    EXPECT_NEAR(derivatives[e], (forth - back) / (2.0 * kStep), 1e-8);
  }
}

}  // namespace
}  // namespace pinode
