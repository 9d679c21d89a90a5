#include "pinode/integrate/forced_exponential.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace pinode {
namespace {

// Returns for each input a power of two that scales its column to about one.
Vector InputUnits(const Matrix& columns) {
  Vector units = Vector::Ones(columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const double largest = columns.col(c).cwiseAbs().maxCoeff();
    if (largest > 0.0 && std::isfinite(largest)) {
      units[c] = std::exp2(-std::round(std::log2(largest)));
    }
  }
  return units;
}

// exp(A) by its series after halvings, with all intermediate matrices. For the
// derivative along dA, the derivative of each matrix is computed with it.
class Series {
 public:
  // Uses at least `halvings` halvings.
  Series(const Matrix& a, int halvings) {
    constexpr double kSmall = 0.5;  // |A| at which so many terms are enough
    const double norm = a.cwiseAbs().colwise().sum().maxCoeff();
    const int squarings = std::max(
        halvings, static_cast<int>(std::ceil(std::log2(norm / kSmall))));
    share_ = std::exp2(-squarings);
    a_ = share_ * a;
    sums_.push_back(Matrix::Identity(a.rows(), a.cols()));
    for (int k = kTermsOfSeries; k >= 1; --k) {
      Matrix sum = a_ * sums_.back() / k;
      sum.diagonal().array() += 1.0;
      sums_.push_back(std::move(sum));
    }
    squares_.push_back(sums_.back());
    for (int s = 0; s < squarings; ++s) {
      squares_.push_back(squares_.back() * squares_.back());
    }
  }

  const Matrix& whole() const { return squares_.back(); }
  // Returns exp(A / 2), if there are halvings.
  const Matrix& half() const { return squares_[squares_.size() - 2]; }

  // Returns the derivative of whole() along `da`, and that of half() if
  // requested.
  Matrix Derivative(const Matrix& da, Matrix* half) const {
    // A group changes only a few rows.
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < da.rows(); ++i) {
      if (!da.row(i).isZero(0.0)) rows.push_back(i);
    }
    const Matrix moved = share_ * da(rows, Eigen::all);
    Matrix sum = Matrix::Zero(da.rows(), da.cols());
    Matrix next(da.rows(), da.cols());
    for (int k = kTermsOfSeries; k >= 1; --k) {
      const Matrix& value = sums_[static_cast<size_t>(kTermsOfSeries - k)];
      next.noalias() = a_ * sum;
      next(rows, Eigen::all) += moved * value;
      sum = next / k;
    }
    for (size_t s = 0; s + 1 < squares_.size(); ++s) {
      if (half != nullptr && s + 2 == squares_.size()) *half = sum;
      next.noalias() = squares_[s] * sum;
      next.noalias() += sum * squares_[s];
      sum.swap(next);
    }
    return sum;
  }

 private:
  static constexpr int kTermsOfSeries = 14;
  double share_ = 1.0;
  Matrix a_;
  std::vector<Matrix> sums_;  // from the last term on
  std::vector<Matrix> squares_;
};

}  // namespace

ParameterizedMap Product(const ParameterizedMap& left,
                         const ParameterizedMap& right) {
  ParameterizedMap product;
  product.value.noalias() = left.value * right.value;
  for (size_t j = 0; j < left.derivatives.size(); ++j) {
    Matrix derivative = left.derivatives[j] * right.value;
    derivative.noalias() += left.value * right.derivatives[j];
    product.derivatives.push_back(std::move(derivative));
  }
  return product;
}

ParameterizedMap ForcedExponential(const ParameterizedMap& rate,
                                   double duration, Eigen::Index terms) {
  return ForcedExponential(rate, duration, terms, nullptr);
}

ParameterizedMap ForcedExponential(const ParameterizedMap& rate,
                                   double duration, Eigen::Index terms,
                                   ParameterizedMap* half) {
  const Eigen::Index ns = rate.value.rows();
  const Eigen::Index ni = rate.value.cols() - ns;
  const Eigen::Index size = ns + terms * ni;
  const Vector unit = VelocityUnits(rate.value.leftCols(ns));
  const Vector input_unit =
      InputUnits(duration * unit.asDiagonal() * rate.value.rightCols(ni));
  const auto augmented = [&](const Matrix& own) {
    Matrix a = Matrix::Zero(size, size);
    a.topLeftCorner(ns, ns) = duration * unit.asDiagonal() * own.leftCols(ns) *
                              unit.cwiseInverse().asDiagonal();
    a.block(0, ns, ns, ni) = duration * unit.asDiagonal() * own.rightCols(ni) *
                             input_unit.asDiagonal();
    return a;
  };
  Matrix a = augmented(rate.value);
  a.block(ns, ns + ni, (terms - 1) * ni, (terms - 1) * ni).setIdentity();
  const Series series(a, half != nullptr ? 1 : 0);
  // `share`: fraction of the duration to which the inputs' derivatives refer.
  const auto own = [&](const Matrix& whole, double share) {
    Matrix rows = unit.cwiseInverse().asDiagonal() * whole.topRows(ns);
    rows.leftCols(ns) = rows.leftCols(ns) * unit.asDiagonal();
    double factor = 1.0;
    for (Eigen::Index k = 0; k < terms; ++k) {
      auto block = rows.middleCols(ns + k * ni, ni);
      block = block * (factor * input_unit.cwiseInverse()).asDiagonal();
      factor /= share;
    }
    return rows;
  };
  ParameterizedMap result{own(series.whole(), 1.0), {}};
  if (half != nullptr) *half = {own(series.half(), 0.5), {}};
  for (const Matrix& derivative : rate.derivatives) {
    Matrix by_half;
    const Matrix whole = series.Derivative(
        augmented(derivative), half != nullptr ? &by_half : nullptr);
    result.derivatives.push_back(own(whole, 1.0));
    if (half != nullptr) half->derivatives.push_back(own(by_half, 0.5));
  }
  return result;
}

}  // namespace pinode
