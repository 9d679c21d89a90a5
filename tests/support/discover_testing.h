// Regressions shared by the tests of this layer.

#ifndef TESTS_SUPPORT_DISCOVER_TESTING_H_
#define TESTS_SUPPORT_DISCOVER_TESTING_H_

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/candidate_library.h"
#include "pinode/discover/regression_problem.h"
#include "tests/support/gaussian_testing.h"

namespace pinode::testing {

inline std::vector<std::string> Names(int count) {
  std::vector<std::string> names;
  for (int j = 0; j < count; ++j) names.push_back("c" + std::to_string(j));
  return names;
}

inline RegressionProblem Problem(const Matrix& theta, const Vector& y) {
  RegressionOutput output;
  output.name = "y";
  output.candidates = Names(static_cast<int>(theta.cols()));
  output.theta = theta;
  output.y = y;
  RegressionProblem problem;
  problem.outputs = {output};
  return problem;
}

// Acceleration of a Duffing oscillator, -0.3 v - 4 x - 6 x^3, under two sines,
// on monomials of x and v to degree 5 (20, in CandidateLibrary's order: x is
// the first, v the second, x^3 the sixth), with white noise of `noise` times
// its standard deviation.
inline const std::vector<int>& DuffingSupport() {
  static const auto& support = *new std::vector<int>{0, 1, 5};
  return support;
}

inline RegressionProblem Duffing(Eigen::Index samples, double noise,
                                 uint64_t seed) {
  const auto rate = [](double t, const Eigen::Vector2d& h) {
    const double force = 0.8 * std::sin(2.3 * t) + 0.5 * std::sin(5.1 * t + 1);
    return Eigen::Vector2d(
        h[1], force - 0.3 * h[1] - 4.0 * h[0] - 6.0 * h[0] * h[0] * h[0]);
  };
  const double step = 0.02;
  constexpr int kStride = 5;
  Eigen::Vector2d h(0.6, 0.0);
  Matrix features(samples, 2);
  for (Eigen::Index i = 0; i < samples * kStride; ++i) {
    if (i % kStride == 0) features.row(i / kStride) = h.transpose();
    const double t = step * static_cast<double>(i);
    const Eigen::Vector2d k1 = rate(t, h);
    const Eigen::Vector2d k2 = rate(t + step / 2, h + step / 2 * k1);
    const Eigen::Vector2d k3 = rate(t + step / 2, h + step / 2 * k2);
    const Eigen::Vector2d k4 = rate(t + step, h + step * k3);
    h += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  CandidateLibraryOptions options;
  options.polynomial_degree = 5;
  CandidateLibrary library;
  std::string error;
  Matrix theta;
  if (!CandidateLibrary::Create({"x", "v"}, options, &library, &error) ||
      !library.Evaluate(features, &theta, &error)) {
    return {};
  }
  const Vector x = features.col(0);
  Vector y = -0.3 * features.col(1) - 4.0 * x - 6.0 * x.array().cube().matrix();
  Gaussian random(seed);
  y += noise * std::sqrt(y.squaredNorm() / static_cast<double>(samples)) *
       random.Draw(samples, 1);
  RegressionProblem problem = Problem(theta, y);
  problem.outputs[0].candidates = library.Names();
  return problem;
}

}  // namespace pinode::testing

#endif  // TESTS_SUPPORT_DISCOVER_TESTING_H_
