#include "pinode/watch/normal_model.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

namespace pinode {
namespace {

constexpr double kHour = 3600.0;

// Features that follow a temperature with a kink, with scatter of a memory of
// ten hours that is the same in all features, and noise.
FeatureSeries MakeSeries(Eigen::Index records, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FeatureSeries series;
  const Eigen::Index p = 3;
  series.names = {"f1", "f2", "f3"};
  series.covariate_names = {"T"};
  series.kinks = Vector::Constant(1, 0.0);
  series.times.resize(records);
  series.values.resize(records, p);
  series.sigmas = Matrix::Constant(records, p, 1e-3);
  series.covariates.resize(records, 1);
  double scatter = normal(random);
  const double keep = std::exp(-1.0 / 10.0);
  for (Eigen::Index r = 0; r < records; ++r) {
    series.times[r] = kHour * static_cast<double>(r);
    const double t =
        5.0 + 12.0 * std::sin(static_cast<double>(r) * 0.013) + normal(random);
    series.covariates(r, 0) = t;
    scatter = keep * scatter + std::sqrt(1.0 - keep * keep) * normal(random);
    for (Eigen::Index f = 0; f < p; ++f) {
      const double slope = -1e-3 * static_cast<double>(1 + f);
      series.values(r, f) = 1.0 + slope * t + 2e-3 * std::max(0.0, -t) +
                            1e-3 * scatter + 1e-3 * normal(random);
      if (f == 1 && r % 5 == 0) series.values(r, f) = kNaN;
    }
  }
  return series;
}

NormalModel Learned(const FeatureSeries& series, size_t reference) {
  std::vector<bool> is_reference(static_cast<size_t>(series.num_records()));
  for (size_t r = 0; r < reference; ++r) is_reference[r] = true;
  NormalModel model;
  std::string error;
  EXPECT_TRUE(LearnNormal(series, is_reference, &model, &error)) << error;
  return model;
}

TEST(NormalModel, FindsSlopesAndScatter) {
  const FeatureSeries series = MakeSeries(3000, 1);
  const NormalModel model = Learned(series, 3000);
  ASSERT_EQ(model.num_terms(), 3);
  EXPECT_TRUE(model.has_kink[0]);
  for (Eigen::Index f = 0; f < 3; ++f) {
    const double slope = -1e-3 * static_cast<double>(1 + f);
    const double scale = model.scales[0];
    const auto deviation = [&](Eigen::Index term) {
      return std::sqrt(model.covariance(3 * f + term, 3 * f + term));
    };
    EXPECT_NEAR(model.coefficients(1, f), slope * scale, 4.0 * deviation(1));
    EXPECT_NEAR(model.coefficients(2, f), 2e-3 * scale, 4.0 * deviation(2));
    // They are known to better than 3 %, or the check above says nothing.
    EXPECT_LT(deviation(1), 0.03 * std::abs(slope) * scale + 1e-4);
    EXPECT_NEAR(model.scatter(f, f), 1e-6, 0.3e-6);
    EXPECT_NEAR(model.noise_deviations[f], 1e-3, 0.15e-3);
  }
  EXPECT_NEAR(model.memory / kHour, 10.0, 4.0);
  // The scatter is common to the features.
  EXPECT_GT(model.scatter(0, 2), 0.8 * model.scatter(0, 0));
}

TEST(NormalModel, RefusesAConstantCovariate) {
  FeatureSeries series = MakeSeries(300, 1);
  series.covariates.setConstant(20.0);
  NormalModel model;
  std::string error;
  EXPECT_FALSE(
      LearnNormal(series, std::vector<bool>(300, true), &model, &error));
  EXPECT_NE(error.find("covariate T is constant"), std::string::npos) << error;
}

// Values without any scatter must not give a noise that is no number.
TEST(NormalModel, HasNoiseOfConstantFeatures) {
  FeatureSeries series = MakeSeries(300, 1);
  series.values.setConstant(1.0);
  const NormalModel model = Learned(series, 300);
  EXPECT_TRUE(model.noise_correlation.allFinite());
  EXPECT_TRUE(model.scatter.allFinite());
  EXPECT_GT(model.noise_deviations.minCoeff(), 0.0);
  for (const Innovation& innovation : FilterSeries(series, model)) {
    EXPECT_TRUE(std::isfinite(innovation.t2_score));
  }
}

// Estimates of many series must scatter by the deviations that are stated.
TEST(NormalModel, StatesTheDeviationsOfSlopes) {
  double squares = 0.0;
  constexpr int kSeries = 60;
  for (unsigned seed = 1; seed <= kSeries; ++seed) {
    const NormalModel model = Learned(MakeSeries(400, seed), 400);
    const double error = model.coefficients(1, 0) + 1e-3 * model.scales[0];
    squares += error * error / model.covariance(1, 1);
  }
  // Chi-square with 60 degrees of freedom: within its 99.9 % interval, and some
  // more as the scatter is estimated from the same records.
  EXPECT_GT(squares / kSeries, 0.5);
  EXPECT_LT(squares / kSeries, 1.8);
}

// The whole covariance of a short series, dense.
struct Dense {
  Matrix covariance;
  Vector residuals;
  Matrix changes;  // of each feature
  std::vector<std::pair<Eigen::Index, Eigen::Index>> places;
};

Dense MakeDense(const FeatureSeries& series, const NormalModel& model) {
  Dense dense;
  for (Eigen::Index r = 0; r < series.num_records(); ++r) {
    for (Eigen::Index f = 0; f < series.num_features(); ++f) {
      if (!std::isnan(series.values(r, f))) dense.places.emplace_back(r, f);
    }
  }
  const Eigen::Index n = static_cast<Eigen::Index>(dense.places.size());
  dense.covariance.resize(n, n);
  dense.residuals.resize(n);
  dense.changes = Matrix::Zero(n, series.num_features());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto [r, f] = dense.places[static_cast<size_t>(i)];
    dense.residuals[i] = series.values(r, f) -
                         model.Terms(series, r).dot(model.coefficients.col(f));
    dense.changes(i, f) = 1.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto [s, g] = dense.places[static_cast<size_t>(j)];
      double value =
          model.scatter(f, g) *
          std::exp(-std::abs(series.times[r] - series.times[s]) / model.memory);
      if (r == s) {
        value += model.noise_correlation(f, g) * series.sigmas(r, f) *
                 series.sigmas(s, g) *
                 std::sqrt(model.noise_factors[f] * model.noise_factors[g]);
      }
      dense.covariance(i, j) = value;
    }
  }
  return dense;
}

TEST(NormalModel, FilterIsTheDenseCovariance) {
  const FeatureSeries series = MakeSeries(60, 3);
  const NormalModel model = Learned(MakeSeries(1000, 2), 1000);
  const Dense dense = MakeDense(series, model);
  const Eigen::LLT<Matrix> factor(dense.covariance);
  const double chi2 = dense.residuals.dot(factor.solve(dense.residuals));
  const Vector score =
      dense.changes.transpose() * factor.solve(dense.residuals);
  const Matrix information =
      dense.changes.transpose() * factor.solve(dense.changes);
  double chi2_of_filter = 0.0;
  Vector score_of_filter = Vector::Zero(3);
  Matrix information_of_filter = Matrix::Zero(3, 3);
  for (const Innovation& innovation : FilterSeries(series, model)) {
    ASSERT_TRUE(innovation.valid);
    chi2_of_filter += innovation.whitened.squaredNorm();
    score_of_filter += innovation.score;
    information_of_filter += innovation.information;
  }
  EXPECT_NEAR(chi2_of_filter, chi2, 1e-5 * chi2);
  EXPECT_LT((score_of_filter - score).norm(), 1e-5 * score.norm());
  EXPECT_LT((information_of_filter - information).norm(),
            1e-5 * information.norm());
}

TEST(NormalModel, AnOutlierCountsAsFourDeviations) {
  FeatureSeries series = MakeSeries(60, 3);
  const NormalModel model = Learned(MakeSeries(1000, 2), 1000);
  series.values(30, 0) += 0.5;
  const Innovation innovation = FilterSeries(series, model)[30];
  EXPECT_NEAR(innovation.residuals[0], 4.0 * innovation.deviations[0], 1e-12);
}

TEST(NormalModel, KnowsItsRange) {
  FeatureSeries series = MakeSeries(500, 4);
  const NormalModel model = Learned(series, 500);
  series.covariates(3, 0) = model.lowest[0] - 2.0 * model.scales[0];
  EXPECT_NEAR(model.Outside(series, 3)[0], 2.0, 1e-12);
  EXPECT_EQ(model.Outside(series, 4)[0], 0.0);
  series.covariates(3, 0) = kNaN;
  EXPECT_FALSE(FilterSeries(series, model)[3].valid);
}

TEST(NormalModel, RefusesTooFewRecords) {
  const FeatureSeries series = MakeSeries(8, 1);
  NormalModel model;
  std::string error;
  EXPECT_FALSE(LearnNormal(series, std::vector<bool>(8, true), &model, &error));
  EXPECT_NE(error.find("expected at least 10"), std::string::npos) << error;
}

}  // namespace
}  // namespace pinode
