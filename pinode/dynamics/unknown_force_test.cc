#include "pinode/dynamics/unknown_force.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

Vector SomeCoefficients(int n) {
  Vector p(n);
  for (int k = 0; k < n; ++k) p[k] = std::sin(1.3 * k + 0.4);
  return p;
}

Matrix Rows(const CombinationPrior& prior, int n) {
  Matrix rows =
      Matrix::Zero(static_cast<Eigen::Index>(prior.combinations.size()), n);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const auto& c = prior.combinations[static_cast<size_t>(i)];
    rows.row(i).segment(c.first, c.weights.size()) = c.weights.transpose();
  }
  return rows;
}

TEST(SplineForce, OfDegreeOneJoinsItsCoefficientsByLines) {
  const SplineForce force({1, 2.0, 0.5, 4, 10.0});
  const double p[] = {1.0, 3.0, -1.0, 2.0};
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(force.Evaluate(2.0 + 0.5 * k, p).value, 10.0 * p[k], 1e-12);
  }
  EXPECT_NEAR(force.Evaluate(2.1, p).value, 10.0 * (0.8 * 1.0 + 0.2 * 3.0),
              1e-12);
  // To zero within one spacing beyond the outer knots.
  EXPECT_NEAR(force.Evaluate(1.75, p).value, 5.0, 1e-12);
  EXPECT_NEAR(force.Evaluate(3.75, p).value, 10.0, 1e-12);
  EXPECT_EQ(force.Evaluate(1.4, p).value, 0.0);
  EXPECT_EQ(force.Evaluate(4.1, p).value, 0.0);
  EXPECT_EQ(force.Evaluate(-1e300, p).count, 0);
  EXPECT_EQ(force.Evaluate(1e300, p).count, 0);
}

// Cubic B-splines reproduce cubic polynomials; on a uniform grid the
// coefficients of t^2 are t_k^2 - spacing^2 / 3.
TEST(SplineForce, OfDegreeThreeReproducesParabolas) {
  const double h = 0.25;
  const int n = 13;
  const SplineForce force({3, -1.0, h, n, 1.0});
  Vector p(n);
  for (int k = 0; k < n; ++k) {
    const double t = -1.0 + k * h;
    p[k] = 2.0 - 3.0 * t + 0.5 * (t * t - h * h / 3.0);
  }
  for (double t = -0.75; t < 1.75; t += 0.0371) {
    EXPECT_NEAR(force.Evaluate(t, p.data()).value, 2.0 - 3.0 * t + 0.5 * t * t,
                1e-13);
  }
}

TEST(ForceHistory, DerivativesAreLocalAndEqualThoseOfJets) {
  const SplineForce hats({1, 0.0, 0.1, 8, 1.7});
  const SplineForce cubic({3, 0.0, 0.1, 8, 1.7});
  const HalfSinePulse pulse;
  for (const ForceHistory* force : {static_cast<const ForceHistory*>(&hats),
                                    static_cast<const ForceHistory*>(&cubic),
                                    static_cast<const ForceHistory*>(&pulse)}) {
    const int n = force->num_parameters();
    Vector p = SomeCoefficients(n);
    if (force == &pulse) p << 0.21, 0.33, 4.0;
    int active = 0;
    for (double t = -0.35; t < 1.2; t += 0.0137) {
      std::vector<WideJet> jets(static_cast<size_t>(n));
      for (int k = 0; k < n; ++k) {
        jets[static_cast<size_t>(k)] = WideJet(p[k], k);
      }
      const WideJet expected = force->Evaluate(t, jets.data());
      const ForceHistory::Local local = force->Evaluate(t, p.data());
      EXPECT_NEAR(local.value, expected.a, 1e-14);
      ASSERT_LE(local.count, ForceHistory::kMostLocal);
      active += local.value != 0.0;
      for (int k = 0; k < n; ++k) {
        const int i = k - local.first;
        EXPECT_NEAR(i >= 0 && i < local.count ? local.derivatives[i] : 0.0,
                    expected.v[k], 1e-12)
            << force->Description() << ", t = " << t << ", " << k;
      }
    }
    EXPECT_GT(active, 15) << force->Description();
  }
}

TEST(SplineForce, OptionsThatDoNotFitAreRefused) {
  std::string error;
  EXPECT_TRUE(SplineForce::AreValid({3, 0.0, 0.1, 8, 1.0}, &error)) << error;
  for (const SplineForce::Options& options :
       {SplineForce::Options{2, 0.0, 0.1, 8, 1.0},
        SplineForce::Options{3, 0.0, 0.0, 8, 1.0},
        SplineForce::Options{3, 0.0, std::nan(""), 8, 1.0},
        SplineForce::Options{3, 0.0, 0.1, 0, 1.0},
        SplineForce::Options{3, std::nan(""), 0.1, 8, 1.0}}) {
    error.clear();
    EXPECT_FALSE(SplineForce::AreValid(options, &error));
    EXPECT_FALSE(error.empty());
  }
}

TEST(HalfSinePulse, IsHalfASine) {
  const HalfSinePulse pulse;
  const double p[] = {0.5, 0.02, 3.0};
  EXPECT_NEAR(pulse.Evaluate(0.51, p).value, 3.0, 1e-14);
  EXPECT_NEAR(pulse.Evaluate(0.505, p).value, 3.0 * std::sqrt(0.5), 1e-12);
  EXPECT_EQ(pulse.Evaluate(0.499, p).value, 0.0);
  EXPECT_EQ(pulse.Evaluate(0.521, p).value, 0.0);
}

// As many independent combinations as parameters, as the evidence's rule
// requires.
TEST(CombinationPrior, HasFullRank) {
  const int n = 40;
  for (const CombinationPrior& prior :
       {SmoothnessPrior(n, 7, 0.0), SmoothnessPrior(n, 1, 0.3),
        BandPrior(n, 0.02, 2.0, 8.0, 1e4)}) {
    const Matrix rows = Rows(prior, n);
    ASSERT_EQ(rows.rows(), n);
    EXPECT_EQ(Eigen::ColPivHouseholderQR<Matrix>(rows).rank(), n);
  }
}

TEST(CombinationPrior, SmoothnessIsOfNeighbourhoods) {
  const CombinationPrior prior = SmoothnessPrior(10, 4, 0.0);
  ASSERT_EQ(prior.num_groups(), 3);
  EXPECT_EQ(prior.combinations[3].group, 0);
  EXPECT_EQ(prior.combinations[4].group, 1);
  EXPECT_EQ(prior.combinations[9].group, 2);
  // A straight line is perfectly smooth except at the ends, where zeros follow.
  const Vector line = Vector::LinSpaced(10, 1.0, 10.0);
  const Vector differences = Rows(prior, 10) * line;
  EXPECT_LT(differences.head(9).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(differences[9], -11.0, 1e-12);
}

TEST(CombinationPrior, RelaxationIsAnExponential) {
  const int n = 30;
  const double steps = 6.0;  // relaxation in knots
  const Matrix rows = Rows(SmoothnessPrior(n, 1, 1.0 / steps), n);
  Vector force(n);
  for (int k = 0; k < n; ++k) force[k] = std::exp(-k / steps);
  // Second differences of it are (2 cosh(1 / steps) - 2) force.
  const double error =
      2.0 * std::cosh(1.0 / steps) - 2.0 - 1.0 / (steps * steps);
  EXPECT_LT((rows * force).segment(1, n - 2).cwiseAbs().maxCoeff(),
            1.01 * error);
  EXPECT_LT(error, 1e-4);
}

TEST(CombinationPrior, BandTellsInsideFromOutside) {
  const int n = 200;
  const double h = 0.01;  // 2 s
  const CombinationPrior prior = BandPrior(n, h, 3.0, 12.0, 1e4);
  const Matrix rows = Rows(prior, n);
  EXPECT_LT((rows * rows.transpose() - Matrix::Identity(n, n)).norm(), 1e-11);
  const auto outside = [&](double hertz) {
    Vector p(n);
    for (int k = 0; k < n; ++k) {
      p[k] = std::cos(kTwoPi * hertz * (k + 0.5) * h);
    }
    const Vector parts = rows * p;
    double sum = 0.0;
    for (int m = 0; m < n; ++m) {
      if (prior.combinations[static_cast<size_t>(m)].group == 1) {
        sum += parts[m] * parts[m];
      }
    }
    return sum / parts.squaredNorm();
  };
  EXPECT_LT(outside(6.0), 1e-12);
  EXPECT_GT(outside(1.0), 1.0 - 1e-12);
  EXPECT_GT(outside(0.0), 1.0 - 1e-12);
  EXPECT_GT(outside(20.0), 1.0 - 1e-12);
}

}  // namespace
}  // namespace pinode
