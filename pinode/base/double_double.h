// Numbers of some 32 digits, as unevaluated sums of two doubles.

#ifndef PINODE_BASE_DOUBLE_DOUBLE_H_
#define PINODE_BASE_DOUBLE_DOUBLE_H_

#include <cmath>

namespace pinode {

// The number high + low, |low| at most half a unit in the last place of high.
// Relative rounding errors are some 1e-31 (T. J. Dekker, A floating-point
// technique for extending the available precision, Numer. Math. 18, 1971; the
// sums are D. E. Knuth's).
struct DoubleDouble {
  double high = 0.0;
  double low = 0.0;

  double Rounded() const { return high + low; }
};

// Returns a + b exactly.
inline DoubleDouble ExactSum(double a, double b) {
  const double sum = a + b;
  const double part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

// Returns a b exactly, unless it overflows or underflows.
inline DoubleDouble ExactProduct(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

inline DoubleDouble operator-(const DoubleDouble& a) {
  return {-a.high, -a.low};
}

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = ExactSum(a.high, b.high);
  const DoubleDouble low = ExactSum(a.low, b.low);
  const DoubleDouble sum = ExactSum(high.high, high.low + low.high);
  return ExactSum(sum.high, sum.low + low.low);
}

inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
  return a + -b;
}

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble product = ExactProduct(a.high, b.high);
  return ExactSum(product.high,
                  product.low + (a.high * b.low + a.low * b.high));
}

inline DoubleDouble operator*(const DoubleDouble& a, double b) {
  const DoubleDouble product = ExactProduct(a.high, b);
  return ExactSum(product.high, product.low + a.low * b);
}

inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double first = a.high / b.high;
  const DoubleDouble rest = a - b * first;
  const double second = rest.high / b.high;
  const DoubleDouble last = rest - b * second;
  return ExactSum(first, second) + DoubleDouble{last.high / b.high, 0.0};
}

// Returns the square root of a positive number: one step of Newton from that
// of its leading part.
inline DoubleDouble SquareRoot(const DoubleDouble& a) {
  const double root = std::sqrt(a.high);
  const DoubleDouble rest = a - ExactProduct(root, root);
  return ExactSum(root, rest.high / (2.0 * root));
}

}  // namespace pinode

#endif  // PINODE_BASE_DOUBLE_DOUBLE_H_
