#include "pinode/modal/subspace.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using Complex = std::complex<double>;

constexpr double kStep = 0.02;

// Correlations C A^(l - 1) G of two modes at three channels, and windows that
// differ from them at random.
WindowedCorrelations ExactCorrelations(int num_lags, double scatter,
                                       std::vector<Complex>* poles,
                                       Eigen::MatrixXcd* shapes) {
  *poles = {Complex(-0.3, 12.0), Complex(-0.5, 31.0)};
  shapes->resize(3, 2);
  *shapes << Complex(1, 0), Complex(0.5, 0.1), Complex(-0.6, 0.2),
      Complex(1, 0), Complex(0.3, 0), Complex(-0.8, -0.3);
  Eigen::MatrixXcd next(2, 3);
  next << Complex(1, 0.5), Complex(0.2, 0), Complex(-1, 0.3), Complex(0.7, 0),
      Complex(-0.4, 1), Complex(1, 0);
  WindowedCorrelations result;
  result.num_channels = 3;
  result.num_references = 3;
  result.num_lags = num_lags;
  result.window_samples = 100;
  Matrix exact(3 * num_lags, 3);
  for (int lag = 0; lag < num_lags; ++lag) {
    Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(3, 3);
    for (int m = 0; m < 2; ++m) {
      sum += shapes->col(m) *
             std::exp((*poles)[static_cast<size_t>(m)] * kStep *
                      static_cast<double>(lag)) *
             next.row(m);
    }
    exact.middleRows(3 * lag, 3) = 2.0 * sum.real();
  }
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  constexpr int kWindows = 12;
  result.mean = Matrix::Zero(exact.rows(), exact.cols());
  for (int w = 0; w < kWindows; ++w) {
    Matrix window = exact;
    for (double& value : window.reshaped()) value += scatter * normal(random);
    result.windows.push_back(window);
    result.mean += window / kWindows;
  }
  return result;
}

std::vector<SubspacePole> FindPoles(const WindowedCorrelations& correlations,
                                    int max_order) {
  SubspaceOptions options;
  options.block_rows = 8;
  options.max_order = max_order;
  std::vector<SubspacePole> poles;
  std::string error;
  EXPECT_TRUE(IdentifySubspace(correlations, kStep, options, 2, &poles, &error))
      << error;
  return poles;
}

TEST(SubspaceTest, FindsThePolesOfExactCorrelations) {
  std::vector<Complex> poles;
  Eigen::MatrixXcd shapes;
  const auto correlations = ExactCorrelations(15, 0.0, &poles, &shapes);
  std::vector<SubspacePole> found = FindPoles(correlations, 4);
  found.erase(
      std::remove_if(found.begin(), found.end(),
                     [](const SubspacePole& p) { return p.order != 4; }),
      found.end());
  ASSERT_EQ(found.size(), 2u);
  for (size_t m = 0; m < 2; ++m) {
    EXPECT_LT(std::abs(found[m].s - poles[m]), 1e-9 * std::abs(poles[m]));
    const Eigen::VectorXcd expected = shapes.col(static_cast<int>(m));
    const Complex scale = found[m].shape[0] / expected[0];
    EXPECT_LT((found[m].shape - scale * expected).norm(),
              1e-9 * found[m].shape.norm());
  }
}

// An influence is the derivative along a window's difference from the mean: the
// change of the estimate if the mean is moved by it.
TEST(SubspaceTest, InfluencesAreDerivatives) {
  std::vector<Complex> truth;
  Eigen::MatrixXcd shapes;
  const auto correlations = ExactCorrelations(15, 0.02, &truth, &shapes);
  const std::vector<SubspacePole> poles = FindPoles(correlations, 10);
  ASSERT_GT(poles.size(), 10u);
  constexpr double kMove = 1e-6;
  for (const int w : {0, 7}) {
    WindowedCorrelations moved = correlations;
    const Matrix change =
        kMove *
        (correlations.windows[static_cast<size_t>(w)] - correlations.mean);
    moved.mean += change;
    const std::vector<SubspacePole> forth = FindPoles(moved, 10);
    moved.mean -= 2.0 * change;
    const std::vector<SubspacePole> back = FindPoles(moved, 10);
    ASSERT_EQ(forth.size(), poles.size());
    ASSERT_EQ(back.size(), poles.size());
    for (size_t i = 0; i < poles.size(); ++i) {
      const Complex slope = (forth[i].s - back[i].s) / (2.0 * kMove);
      EXPECT_LT(std::abs(slope - poles[i].s_influence[w]),
                1e-5 * std::abs(slope) + 1e-6)
          << "order " << poles[i].order << ", " << poles[i].frequency();
      // Shapes have no scale; they are one at the first channel.
      const Eigen::VectorXcd ratio = (forth[i].shape / forth[i].shape[0] -
                                      back[i].shape / back[i].shape[0]) /
                                     (2.0 * kMove);
      const Eigen::VectorXcd own = (poles[i].shape_influence.col(w) -
                                    poles[i].shape / poles[i].shape[0] *
                                        poles[i].shape_influence(0, w)) /
                                   poles[i].shape[0];
      EXPECT_LT((ratio - own).norm(), 1e-5 * ratio.norm() + 1e-5)
          << "order " << poles[i].order << ", " << poles[i].frequency();
    }
  }
}

TEST(SubspaceTest, RefusesOrdersThatTheMatrixDoesNotHold) {
  std::vector<Complex> truth;
  Eigen::MatrixXcd shapes;
  const auto correlations = ExactCorrelations(15, 0.02, &truth, &shapes);
  SubspaceOptions options;
  options.block_rows = 8;
  options.max_order = 22;
  std::vector<SubspacePole> poles;
  std::string error;
  EXPECT_FALSE(
      IdentifySubspace(correlations, kStep, options, 1, &poles, &error));
  EXPECT_THAT(error, HasSubstr("order 22"));
}

}  // namespace
}  // namespace pinode
