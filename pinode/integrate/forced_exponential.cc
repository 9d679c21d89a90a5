#include "pinode/integrate/forced_exponential.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pinode {
namespace {

// For each input a power of two by which its column is of the order of one.
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
  constexpr double kSmall = 0.5;  // |A| at which so many terms are enough
  constexpr int kExponentialTerms = 14;
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
  ParameterizedMap a{augmented(rate.value), {}};
  for (const Matrix& derivative : rate.derivatives) {
    a.derivatives.push_back(augmented(derivative));
  }
  a.value.block(ns, ns + ni, (terms - 1) * ni, (terms - 1) * ni).setIdentity();
  const double norm = a.value.cwiseAbs().colwise().sum().maxCoeff();
  const int squarings =
      std::max(0, static_cast<int>(std::ceil(std::log2(norm / kSmall))));
  const double share = std::exp2(-squarings);
  a.value *= share;
  for (Matrix& derivative : a.derivatives) derivative *= share;
  ParameterizedMap sum;
  sum.value = Matrix::Identity(size, size);
  sum.derivatives.assign(a.derivatives.size(), Matrix::Zero(size, size));
  for (int k = kExponentialTerms; k >= 1; --k) {
    sum = Product(a, sum);
    sum.value /= k;
    sum.value.diagonal().array() += 1.0;
    for (Matrix& derivative : sum.derivatives) derivative /= k;
  }
  for (int s = 0; s < squarings; ++s) sum = Product(sum, sum);
  const auto own = [&](const Matrix& whole) {
    Matrix rows = unit.cwiseInverse().asDiagonal() * whole.topRows(ns);
    rows.leftCols(ns) = rows.leftCols(ns) * unit.asDiagonal();
    for (Eigen::Index k = 0; k < terms; ++k) {
      auto block = rows.middleCols(ns + k * ni, ni);
      block = block * input_unit.cwiseInverse().asDiagonal();
    }
    return rows;
  };
  ParameterizedMap result{own(sum.value), {}};
  for (const Matrix& derivative : sum.derivatives) {
    result.derivatives.push_back(own(derivative));
  }
  return result;
}

}  // namespace pinode
