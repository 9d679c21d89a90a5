#include "pinode/dynamics/monomial.h"

#include <array>
#include <cmath>
#include <cstdlib>

namespace pinode {

double IntegerPower(double x, int exponent) {
  double result = 1.0;
  double square = x;
  for (int n = std::abs(exponent); n > 0; n /= 2) {
    if (n % 2 == 1) result *= square;
    square *= square;
  }
  return exponent < 0 ? 1.0 / result : result;
}

Monomial Monomial::Number(double coefficient) {
  Monomial result;
  result.coefficient_ = coefficient;
  return result;
}

Monomial Monomial::Feature(int index) {
  Monomial result;
  result.factors_.push_back({index, 1, false});
  return result;
}

bool Monomial::Multiply(const Monomial& other) {
  coefficient_ *= other.coefficient_;
  for (const Factor& factor : other.factors_) {
    bool merged = false;
    for (Factor& own : factors_) {
      if (own.feature != factor.feature ||
          own.is_absolute != factor.is_absolute) {
        continue;
      }
      own.power += factor.power;
      merged = true;
      break;
    }
    if (!merged) factors_.push_back(factor);
  }
  return std::isfinite(coefficient_) && factors_.size() <= kMaxFactors;
}

bool Monomial::Raise(int power) {
  constexpr int kMostPower = 64;
  if (power < 1 || power > kMostPower) return false;
  coefficient_ = IntegerPower(coefficient_, power);
  for (Factor& factor : factors_) {
    factor.power *= power;
    if (factor.power > kMostPower) return false;
  }
  return std::isfinite(coefficient_);
}

void Monomial::TakeAbsolute() {
  coefficient_ = std::abs(coefficient_);
  for (Factor& factor : factors_) factor.is_absolute = true;
}

double Monomial::Evaluate(const double* q) const {
  double result = coefficient_;
  for (const Factor& factor : factors_) {
    const double x = q[factor.feature];
    result *= IntegerPower(factor.is_absolute ? std::abs(x) : x, factor.power);
  }
  return result;
}

double Monomial::Linearize(const double* q, double* gradient) const {
  std::array<double, kMaxFactors> values, slopes;
  const size_t count = factors_.size();
  double result = coefficient_;
  for (size_t i = 0; i < count; ++i) {
    const Factor& factor = factors_[i];
    const double x = q[factor.feature];
    const double base = factor.is_absolute ? std::abs(x) : x;
    const double lower = IntegerPower(base, factor.power - 1);
    values[i] = lower * base;
    slopes[i] = factor.power * lower;
    if (factor.is_absolute) {
      slopes[i] *= static_cast<double>((x > 0.0) - (x < 0.0));
    }
    result *= values[i];
  }
  for (size_t i = 0; i < count; ++i) {
    double slope = coefficient_ * slopes[i];
    for (size_t k = 0; k < count; ++k) {
      if (k != i) slope *= values[k];
    }
    gradient[factors_[i].feature] += slope;
  }
  return result;
}

}  // namespace pinode
