// Random numbers for tests.

#ifndef TESTS_SUPPORT_GAUSSIAN_TESTING_H_
#define TESTS_SUPPORT_GAUSSIAN_TESTING_H_

#include <cmath>
#include <cstdint>
#include <random>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"

namespace pinode::testing {

// Independent normal numbers of unit variance, the same on every machine.
class Gaussian {
 public:
  explicit Gaussian(uint64_t seed) : random_(seed) {}

  double Next() {
    const double radius = std::sqrt(-2.0 * std::log(Uniform()));
    return radius * std::cos(kTwoPi * Uniform());
  }
  Vector Draw(Eigen::Index count) {
    return Vector::NullaryExpr(count, [this]() { return Next(); });
  }
  Matrix Draw(Eigen::Index rows, Eigen::Index cols) {
    return Matrix::NullaryExpr(rows, cols, [this]() { return Next(); });
  }

 private:
  // Returns a uniform number in (0, 1).
  double Uniform() {
    return (static_cast<double>(random_() >> 11) + 0.5) * 0x1.0p-53;
  }

  std::mt19937_64 random_;
};

}  // namespace pinode::testing

#endif  // TESTS_SUPPORT_GAUSSIAN_TESTING_H_
