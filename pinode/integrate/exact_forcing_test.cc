#include "pinode/integrate/exact_forcing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace pinode {
namespace {

using Complex = std::complex<double>;

// phi_1, phi_3 and phi_6 by adaptive quadrature (scipy.integrate.quad).
TEST(PhiFunctions, EqualQuadrature) {
  struct Row {
    Complex x, phi1, phi3, phi6;
  };
  const Row rows[] = {
      {{-0.3, 2.0},
       {0.425363068782613, 0.590340119179198},
       {0.128641164151634, 0.065291683846251},
       {0.00124540944066609, 0.000349595561233327}},
      {{-9.5, 1.0},
       {0.104106068830557, 0.0109519034934259},
       {0.0424269775764912, 0.00355254316466955},
       {0.000557763075623269, 3.64800239095649e-05}},
      {{-30.0, 0.0},
       {0.0333333333333302, 0.0},
       {0.0155925925925926, 0.0},
       {0.000237076817558299, 0.0}},
      {{-2.0, 60.0},
       {-6.02962662315043e-05, 0.0188169278832529},
       {0.00055399204690261, 0.00830039626831486},
       {1.60452643317798e-05, 0.00013720474720331}},
      {{0.0, 0.0}, {1.0, 0.0}, {1.0 / 6.0, 0.0}, {1.0 / 720.0, 0.0}}};
  for (const Row& row : rows) {
    const Eigen::VectorXcd phi = PhiFunctions(row.x, 8);
    EXPECT_LT(std::abs(phi[0] - std::exp(row.x)), 1e-15);
    EXPECT_LT(std::abs(phi[1] - row.phi1), 1e-12 * std::abs(row.phi1)) << row.x;
    EXPECT_LT(std::abs(phi[3] - row.phi3), 1e-12 * std::abs(row.phi3)) << row.x;
    EXPECT_LT(std::abs(phi[6] - row.phi6), 1e-12 * std::abs(row.phi6)) << row.x;
  }
}

TEST(NodePolynomial, IsThatOfThePolynomialsThemselves) {
  for (const int steps : {1, 2, 4}) {
    const Matrix polynomial = NodePolynomial(steps);
    ASSERT_EQ(polynomial.rows(), 2 * steps + 1);
    ASSERT_EQ(polynomial.cols(), 3 * steps);
    for (int power = 0; power <= 2 * steps; ++power) {
      Vector values(3 * steps);
      for (int k = 0; k < 3 * steps; ++k) {
        values[k] = std::pow((k / 3 + 0.5 * (k % 3)) / steps, power);
      }
      const Vector coefficients = polynomial * values;
      EXPECT_LT((coefficients - Vector::Unit(2 * steps + 1, power)).norm(),
                1e-9)
          << steps << " " << power;
    }
  }
}

// z' = lambda z + t^2 over h: the closed form, and slopes by differences.
TEST(ExactStep, SolvesForAParabola) {
  constexpr double kDuration = 0.7;
  const Matrix polynomial = NodePolynomial(2);
  const auto squares = [&](double t) { return t * t; };
  Vector nodes(6);
  for (int k = 0; k < 6; ++k) {
    nodes[k] = squares(kDuration * (k / 3 + 0.5 * (k % 3)) / 2.0);
  }
  const auto forced = [&](Complex lambda) {
    return Complex(nodes.cast<Complex>().dot(
        ExactStep(lambda, kDuration, polynomial).forcing));
  };
  for (const Complex lambda : {Complex(-0.4, 3.0), Complex(-40.0, 5.0)}) {
    const double t = kDuration;
    // -(t^2 / l + 2 t / l^2 + 2 / l^3) + 2 e^(l t) / l^3
    const Complex expected =
        -(t * t / lambda + 2.0 * t / (lambda * lambda) +
          2.0 / (lambda * lambda * lambda)) +
        2.0 * std::exp(lambda * t) / (lambda * lambda * lambda);
    EXPECT_LT(std::abs(forced(lambda) - expected), 1e-12 * std::abs(expected));
    const ExactStep step(lambda, kDuration, polynomial);
    EXPECT_LT(std::abs(step.advance - std::exp(lambda * t)), 1e-15);
    EXPECT_LT(std::abs(step.advance_slope - t * std::exp(lambda * t)), 1e-15);
    const double h = 1e-4;
    const Complex slope = (forced(lambda + h) - forced(lambda - h)) / (2.0 * h);
    const Complex found = nodes.cast<Complex>().dot(step.forcing_slope);
    EXPECT_LT(std::abs(found - slope), 1e-7 * std::abs(slope));
  }
}

}  // namespace
}  // namespace pinode
