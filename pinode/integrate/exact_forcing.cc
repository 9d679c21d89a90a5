#include "pinode/integrate/exact_forcing.h"

#include <Eigen/LU>
#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Radius up to which the series is used. Beyond it the recurrence is used,
// which divides by x.
constexpr double kSeriesRadius = 10.0;
constexpr int kSeriesTerms = 90;

// Returns sum_i x^i / (i + k)!.
Complex PhiBySeries(Complex x, int k) {
  double factorial = 1.0;
  for (int i = 2; i <= k; ++i) factorial *= i;
  Complex term = 1.0 / factorial;
  Complex sum = term;
  for (int i = 1; i < kSeriesTerms; ++i) {
    term *= x / static_cast<double>(i + k);
    sum += term;
    if (std::abs(term) < 1e-18 * std::abs(sum)) break;
  }
  return sum;
}

}  // namespace

Matrix NodePolynomial(int steps) {
  CHECK_GE(steps, 1);
  const int degree = 2 * steps;
  Matrix powers(degree + 1, degree + 1);
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; j <= degree; ++j) {
      powers(i, j) = std::pow(static_cast<double>(i) / degree, j);
    }
  }
  const Matrix inverse = powers.fullPivLu().inverse();
  Matrix polynomial = Matrix::Zero(degree + 1, 3 * steps);
  for (int s = 0; s < steps; ++s) {
    for (int node = s == 0 ? 0 : 1; node < 3; ++node) {
      polynomial.col(3 * s + node) = inverse.col(2 * s + node);
    }
  }
  return polynomial;
}

Eigen::VectorXcd PhiFunctions(std::complex<double> x, int count) {
  Eigen::VectorXcd phi(count);
  if (std::abs(x) < kSeriesRadius) {
    // From the highest one on, so that the lower ones lose no accuracy: phi_k =
    // 1/k! + x phi_k+1.
    phi[count - 1] = PhiBySeries(x, count - 1);
    double factorial = 1.0;
    for (int i = 2; i < count - 1; ++i) factorial *= i;
    for (int k = count - 2; k >= 0; --k) {
      phi[k] = 1.0 / factorial + x * phi[k + 1];
      if (k > 1) factorial /= k;
    }
    phi[0] = std::exp(x);
    return phi;
  }
  phi[0] = std::exp(x);
  double factorial = 1.0;
  for (int k = 1; k < count; ++k) {
    phi[k] = (phi[k - 1] - 1.0 / factorial) / x;
    factorial *= k;
  }
  return phi;
}

ExactStep::ExactStep(Complex lambda, double duration,
                     const Matrix& polynomial) {
  const int terms = static_cast<int>(polynomial.rows());
  const Eigen::VectorXcd phi = PhiFunctions(lambda * duration, terms + 2);
  advance = phi[0];
  advance_slope = duration * phi[0];
  // int_0^1 e^((1 - s) x) s^j ds = j! phi_j+1(x).
  Eigen::VectorXcd powers(terms), slopes(terms);
  double factorial = 1.0;
  for (int j = 0; j < terms; ++j) {
    if (j > 1) factorial *= j;
    powers[j] = duration * factorial * phi[j + 1];
    slopes[j] = duration * duration * factorial *
                (phi[j + 1] - static_cast<double>(j + 1) * phi[j + 2]);
  }
  forcing = polynomial.transpose() * powers;
  forcing_slope = polynomial.transpose() * slopes;
}

}  // namespace pinode
