#include "pinode/problem/load_information.h"

#include <array>
#include <utility>

namespace pinode {
namespace {

// Lines that a product takes together, and pairs of the two knots beside a
// line.
constexpr Eigen::Index kLinesAtATime = 32;
constexpr int kPairs = 3;

// Index into the lower triangle by columns.
Eigen::Index Packed(Eigen::Index i, Eigen::Index j, Eigen::Index n) {
  if (i < j) std::swap(i, j);
  return j * n - j * (j - 1) / 2 + (i - j);
}

}  // namespace

LoadInformation::LoadInformation(const LoadSpectrum& spectrum)
    : spectrum_(spectrum),
      areas_(spectrum.num_areas()),
      weights_(kPairs, kLinesAtATime) {
  const Eigen::Index square = areas_ * (areas_ + 1) / 2;
  if (spectrum.correlated()) {
    real_.resize(square, kLinesAtATime);
    imaginary_.resize(square, kLinesAtATime);
    real_products_.assign(kPairs, Matrix::Zero(square, square));
    imaginary_products_ = real_products_;
  } else {
    real_products_.assign(kPairs, Matrix::Zero(areas_, areas_));
  }
}

void LoadInformation::Add(const Eigen::MatrixXcd& a, double count, double below,
                          double above) {
  const std::array<double, kPairs> weights = {
      count * below * below, count * below * above, count * above * above};
  if (!spectrum_.correlated()) {
    const Matrix power = a.cwiseAbs2();
    for (size_t p = 0; p < kPairs; ++p) {
      real_products_[p] += weights[p] * power;
    }
    return;
  }
  Eigen::Index place = 0;
  for (Eigen::Index j = 0; j < areas_; ++j) {
    for (Eigen::Index i = j; i < areas_; ++i, ++place) {
      real_(place, waiting_) = a(i, j).real();
      imaginary_(place, waiting_) = a(i, j).imag();
    }
  }
  for (int p = 0; p < kPairs; ++p) {
    weights_(p, waiting_) = weights[static_cast<size_t>(p)];
  }
  if (++waiting_ == kLinesAtATime) Flush();
}

void LoadInformation::Flush() {
  if (waiting_ == 0) return;
  for (int p = 0; p < kPairs; ++p) {
    const auto roots = weights_.row(p).head(waiting_).cwiseSqrt().eval();
    const size_t pair = static_cast<size_t>(p);
    real_products_[pair].selfadjointView<Eigen::Lower>().rankUpdate(
        real_.leftCols(waiting_) * roots.asDiagonal());
    imaginary_products_[pair].selfadjointView<Eigen::Lower>().rankUpdate(
        imaginary_.leftCols(waiting_) * roots.asDiagonal());
  }
  waiting_ = 0;
}

Matrix LoadInformation::Block(int pair, const Matrix& l,
                              const Matrix& m) const {
  const Eigen::Index size = spectrum_.per_knot();
  const Matrix& real = real_products_[static_cast<size_t>(pair)];
  Matrix block(size, size);
  if (!spectrum_.correlated()) {
    for (Eigen::Index p = 0; p < size; ++p) {
      for (Eigen::Index q = 0; q < size; ++q) {
        block(p, q) = 4.0 * l(p, p) * m(q, q) * real(p, q);
      }
    }
    return block;
  }
  const Matrix& imaginary = imaginary_products_[static_cast<size_t>(pair)];
  const Eigen::Index n = areas_;
  // sum Re(A_ab A_cd), A Hermitian.
  const auto product = [&](Eigen::Index a, Eigen::Index b, Eigen::Index c,
                           Eigen::Index d) {
    const Eigen::Index first = Packed(a, b, n);
    const Eigen::Index second = Packed(c, d, n);
    const double sign = (a < b) == (c < d) ? 1.0 : -1.0;
    return real(first, second) - sign * imaginary(first, second);
  };
  // With D_p = e_i l_j^T + l_j e_i^T and D_q = e_k m_o^T + m_o e_k^T:
  //   tr(A D_p A D_q) = 2 Re sum_ab l_aj m_bo (A_ak A_bi + A_ab A_ki).
  // Entries stand in the order of the lower triangle.
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      Matrix sum(n, n);  // over a, b
      for (Eigen::Index b = 0; b < n; ++b) {
        for (Eigen::Index a = 0; a < n; ++a) {
          sum(a, b) = product(a, k, b, i) + product(a, b, k, i);
        }
      }
      const Matrix both = 2.0 * l.transpose() * sum * m;  // over j, o
      for (Eigen::Index j = 0; j <= i; ++j) {
        for (Eigen::Index o = 0; o <= k; ++o) {
          block(Packed(i, j, n), Packed(k, o, n)) = both(j, o);
        }
      }
    }
  }
  return block;
}

Matrix LoadInformation::Finish(const Matrix& root, const Matrix& next_root) {
  Flush();
  if (spectrum_.correlated()) {
    for (std::vector<Matrix>* products :
         {&real_products_, &imaginary_products_}) {
      for (Matrix& product : *products) {
        product.triangularView<Eigen::StrictlyUpper>() =
            product.transpose().triangularView<Eigen::StrictlyUpper>();
      }
    }
  }
  const Eigen::Index size = spectrum_.per_knot();
  Matrix information(2 * size, 2 * size);
  information.topLeftCorner(size, size) = Block(0, root, root);
  information.bottomLeftCorner(size, size) = Block(1, next_root, root);
  information.topRightCorner(size, size) =
      information.bottomLeftCorner(size, size).transpose();
  information.bottomRightCorner(size, size) = Block(2, next_root, next_root);
  return information;
}

Vector ByLoadEntries(const LoadSpectrum& spectrum, const Matrix& root,
                     const Matrix& s) {
  const Matrix product = 2.0 * s * root;
  Vector values(spectrum.per_knot());
  for (int e = 0; e < spectrum.per_knot(); ++e) {
    const auto& [i, j] = spectrum.entries()[static_cast<size_t>(e)];
    values[e] = product(i, j);
  }
  return values;
}

}  // namespace pinode
