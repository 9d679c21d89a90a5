#include "pinode/estimate/certainty/input_noise_filter.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// A record of the small nonlinear structure with its linearisation, and the
// same model as one dense Gaussian: q = G e + S x_0 + v.
class InputNoiseFilterTest : public ::testing::TestWithParam<Interpolation> {
 protected:
  static constexpr int kSamples = 14;
  static constexpr int kChannels = 3;

  void SetUp() override {
    auto dynamics = testing::MakeSmallNonlinear();
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, kSamples, 0.1, GetParam());
    record.channels = {
        testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0),
        testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1),
        testing::MakeChannel("a1", Quantity::kRelativeAcceleration, 2, 0)};
    const int ns = dynamics->num_states();
    const Matrix states =
        testing::Simulate(*dynamics, dynamics->Parameters(),
                          Vector::LinSpaced(ns, -0.2, 0.3), 0.0, 1, &record);
    IdentificationProblem problem;
    problem.records.push_back(record);
    problem.dynamics = dynamics;
    const ParameterLayout layout(problem);
    record_ = LinearizeRecord(problem, layout, 0, {0}, layout.InitialValues(),
                              states);

    noise_.resize(kChannels, kSamples);
    for (int i = 0; i < kSamples; ++i) {
      noise_.col(i) = Eigen::Vector3d(0.01, 0.3, 0.2);
    }
    noise_(1, 5) = noise_(0, 9) = noise_(2, 0) =
        std::numeric_limits<double>::quiet_NaN();
    noise_.col(11).setConstant(std::numeric_limits<double>::quiet_NaN());
    input_sigma_ = Vector::Constant(1, 0.4);
    start_sigmas_ = 0.05 * Vector::LinSpaced(ns, 0.0, 1.0);

    // Each row's response by an adjoint run, and to each start.
    const int rows = kChannels * kSamples;
    response_ = InputSensitivity(record_, 0, Matrix::Identity(rows, rows));
    Matrix by_start(rows, ns);
    Matrix transition = Matrix::Identity(ns, ns);
    for (int i = 0; i < kSamples; ++i) {
      const auto& sample = record_.samples[static_cast<size_t>(i)];
      by_start.middleRows(kChannels * i, kChannels) =
          sample.by_state * transition;
      if (i + 1 < kSamples) transition = sample.transition * transition;
    }
    for (int i = 0; i < kSamples; ++i) {
      for (int c = 0; c < kChannels; ++c) {
        if (!std::isnan(noise_(c, i))) present_.push_back(kChannels * i + c);
      }
    }
    Vector variance(rows);
    for (int row = 0; row < rows; ++row) {
      variance[row] = std::pow(noise_(row % kChannels, row / kChannels), 2);
    }
    const Matrix sigma =
        std::pow(input_sigma_[0], 2) * response_ * response_.transpose() +
        by_start * start_sigmas_.cwiseAbs2().asDiagonal() *
            by_start.transpose() +
        Matrix(variance.asDiagonal());
    inverse_ = sigma(present_, present_).inverse();
  }

  LinearizedRecord record_;
  Matrix noise_;
  Vector input_sigma_, start_sigmas_;
  Matrix response_;           // rows x samples
  std::vector<int> present_;  // rows with a residual
  Matrix inverse_;            // of Sigma, of those rows
};

TEST_P(InputNoiseFilterTest, InformationEqualsTheDenseOne) {
  const InputNoiseFilter filter(record_, input_sigma_, start_sigmas_, noise_);
  const Matrix columns = Matrix::Random(kChannels * kSamples, 4);
  const Matrix some = columns(present_, Eigen::all);
  const Matrix expected = some.transpose() * inverse_ * some;
  EXPECT_LT((filter.Information(columns) - expected).norm(),
            1e-9 * expected.norm());
}

TEST_P(InputNoiseFilterTest, SmoothEqualsTheDenseConditionalMean) {
  const InputNoiseFilter filter(record_, input_sigma_, start_sigmas_, noise_);
  const Vector residuals = Vector::Random(kChannels * kSamples);
  Matrix errors;
  Vector mean_square;
  filter.Smooth(residuals, &errors, &mean_square);

  const Matrix response = response_(present_, Eigen::all);
  const Vector weighted = inverse_ * residuals(present_);
  const Vector expected =
      std::pow(input_sigma_[0], 2) * response.transpose() * weighted;
  ASSERT_EQ(errors.cols(), kSamples);
  EXPECT_LT((errors.row(0).transpose() - expected).norm(),
            1e-9 * expected.norm());

  // E v = R Sigma^-1 q, cov v = R - R Sigma^-1 R.
  Vector sums = Vector::Zero(kChannels);
  Vector counts = Vector::Zero(kChannels);
  for (size_t k = 0; k < present_.size(); ++k) {
    const int row = static_cast<int>(k);
    const int c = present_[k] % kChannels;
    const double variance = std::pow(noise_(c, present_[k] / kChannels), 2);
    sums[c] += std::pow(variance * weighted[row], 2) + variance -
               variance * variance * inverse_(row, row);
    counts[c] += 1.0;
  }
  const Vector expected_squares = sums.cwiseQuotient(counts);
  EXPECT_LT((mean_square - expected_squares).norm(),
            1e-8 * expected_squares.norm());
}

INSTANTIATE_TEST_SUITE_P(Interpolations, InputNoiseFilterTest,
                         ::testing::Values(Interpolation::kHeld,
                                           Interpolation::kLinear));

}  // namespace
}  // namespace pinode
