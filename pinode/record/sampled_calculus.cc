#include "pinode/record/sampled_calculus.h"

#include <algorithm>

namespace pinode {

Vector Differentiate(const Vector& values, double step) {
  const Eigen::Index n = values.size();
  Vector derivative(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    // Differences of the fourth order, and of the second order near the ends.
    const Eigen::Index room = std::min(i, n - 1 - i);
    if (room >= 2) {
      derivative[i] = (8.0 * (values[i + 1] - values[i - 1]) -
                       (values[i + 2] - values[i - 2])) /
                      (12.0 * step);
    } else if (room == 1) {
      derivative[i] = (values[i + 1] - values[i - 1]) / (2.0 * step);
    } else if (n == 1) {
      derivative[i] = 0.0;
    } else if (n == 2) {
      derivative[i] = (values[1] - values[0]) / step;
    } else {
      const Eigen::Index inward = i == 0 ? 1 : -1;
      derivative[i] = static_cast<double>(inward) *
                      (4.0 * values[i + inward] - 3.0 * values[i] -
                       values[i + 2 * inward]) /
                      (2.0 * step);
    }
  }
  return derivative;
}

Vector IntegrateTwice(const Vector& acceleration, double step,
                      Interpolation interpolation) {
  const Eigen::Index n = acceleration.size();
  Vector displacement = Vector::Zero(n);
  double velocity = 0.0;
  const auto at = [&](Eigen::Index i) {
    return acceleration[std::min(std::max<Eigen::Index>(i, 0), n - 1)];
  };
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    // In an interval a(s) = c0 + c1 s + c2 s^2 + c3 s^3, s from 0 to 1.
    const double a = at(i);
    const double b = at(i + 1);
    double c0 = a;
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
    if (interpolation == Interpolation::kLinear) {
      c1 = b - a;
    } else if (interpolation != Interpolation::kHeld) {
      const double slope_a = 0.5 * (b - at(i - 1));
      const double slope_b = 0.5 * (at(i + 2) - a);
      c1 = slope_a;
      c2 = 3.0 * (b - a) - 2.0 * slope_a - slope_b;
      c3 = 2.0 * (a - b) + slope_a + slope_b;
    }
    displacement[i + 1] =
        displacement[i] + step * velocity +
        step * step * (c0 / 2.0 + c1 / 6.0 + c2 / 12.0 + c3 / 20.0);
    velocity += step * (c0 + c1 / 2.0 + c2 / 3.0 + c3 / 4.0);
  }
  return displacement;
}

}  // namespace pinode
