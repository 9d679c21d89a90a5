#include "pinode/watch/normal_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"

namespace pinode {
namespace {

// Records per coefficient and feature, at least.
constexpr int kRecordsPerTerm = 5;
// Share of the reference on each side of a kink, at least, to learn both
// slopes.
constexpr double kLeastShareBeyondKink = 0.03;
// Residuals beyond this many deviations count as this many.
constexpr double kLargestResidual = 4.0;
// Lags of the scatter's memory, in records.
constexpr Eigen::Index kMostLags = 72;

// Makes a symmetric matrix positive semi-definite.
Matrix WithoutNegative(const Matrix& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(
      0.5 * (matrix + matrix.transpose()));
  return solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
}

// The covariance of the noise of one record's features.
Matrix NoiseOf(const NormalModel& model, const FeatureSeries& series,
               Eigen::Index record, const std::vector<Eigen::Index>& present) {
  const Eigen::Index count = static_cast<Eigen::Index>(present.size());
  Matrix noise(count, count);
  const auto deviation = [&](Eigen::Index place) {
    const Eigen::Index f = present[static_cast<size_t>(place)];
    return std::sqrt(model.noise_factors[f]) * series.sigmas(record, f);
  };
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      noise(i, j) = model.noise_correlation(present[static_cast<size_t>(i)],
                                            present[static_cast<size_t>(j)]) *
                    deviation(i) * deviation(j);
    }
  }
  return noise;
}

std::vector<Eigen::Index> PresentFeatures(const FeatureSeries& series,
                                          Eigen::Index record) {
  std::vector<Eigen::Index> present;
  for (Eigen::Index f = 0; f < series.num_features(); ++f) {
    if (!std::isnan(series.values(record, f))) present.push_back(f);
  }
  return present;
}

// Kalman filter of several series with the same model: columns of states.
class Filter {
 public:
  Filter(const NormalModel& model, const FeatureSeries& series,
         Eigen::Index num_columns)
      : model_(model),
        series_(series),
        state_(Matrix::Zero(series.num_features(), num_columns)),
        covariance_(model.scatter) {}

  // Turns the columns at the present features into innovations, and factorises
  // their covariance. The first column holds measured values: its innovations
  // are limited before they enter the state.
  void Step(Eigen::Index record, const std::vector<Eigen::Index>& present,
            Matrix* columns, Eigen::LLT<Matrix>* factor, Vector* deviations) {
    const double step =
        last_ < 0 ? kInfinity : series_.times[record] - series_.times[last_];
    last_ = record;
    const double keep =
        model_.memory > 0.0 ? std::exp(-step / model_.memory) : 0.0;
    state_ *= keep;
    covariance_ =
        keep * keep * covariance_ + (1.0 - keep * keep) * model_.scatter;
    Matrix innovation_covariance = NoiseOf(model_, series_, record, present);
    const Eigen::Index count = static_cast<Eigen::Index>(present.size());
    Matrix gain_transposed(count, series_.num_features());
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index f = present[static_cast<size_t>(i)];
      columns->row(i) -= state_.row(f);
      gain_transposed.row(i) = covariance_.row(f);
      for (Eigen::Index j = 0; j < count; ++j) {
        innovation_covariance(i, j) +=
            covariance_(f, present[static_cast<size_t>(j)]);
      }
    }
    // Rounding must not make it singular.
    innovation_covariance.diagonal() *= 1.0 + 1e-9;
    *deviations = innovation_covariance.diagonal().cwiseSqrt();
    for (Eigen::Index i = 0; i < count; ++i) {
      const double limit = kLargestResidual * (*deviations)[i];
      (*columns)(i, 0) = std::clamp((*columns)(i, 0), -limit, limit);
    }
    factor->compute(innovation_covariance);
    const Matrix crossed = gain_transposed;
    gain_transposed = factor->solve(crossed);
    state_ += gain_transposed.transpose() * *columns;
    covariance_ -= gain_transposed.transpose() * crossed;
  }

 private:
  const NormalModel& model_;
  const FeatureSeries& series_;
  Matrix state_;
  Matrix covariance_;
  Eigen::Index last_ = -1;
};

class Learner {
 public:
  Learner(const FeatureSeries& series, const std::vector<bool>& is_reference,
          NormalModel* model)
      : series_(series), model_(*model) {
    for (Eigen::Index r = 0; r < series.num_records(); ++r) {
      if (!is_reference[static_cast<size_t>(r)] ||
          !series.covariates.row(r).allFinite() ||
          PresentFeatures(series, r).empty()) {
        continue;
      }
      records_.push_back(r);
    }
  }

  bool Run(std::string* error) {
    model_.num_records = static_cast<int>(records_.size());
    if (series_.num_features() == 0) {
      *error = "no mode is in enough records of the reference";
      return false;
    }
    PrepareTerms();
    const Eigen::Index terms =
        model_.Terms(series_, records_.empty() ? 0 : records_[0]).size();
    for (Eigen::Index f = 0; f < series_.num_features(); ++f) {
      Eigen::Index count = 0;
      for (const Eigen::Index r : records_) {
        if (!std::isnan(series_.values(r, f))) ++count;
      }
      if (count >= kRecordsPerTerm * terms) continue;
      *error = series_.names[static_cast<size_t>(f)] + " is in " +
               std::to_string(count) +
               " records of the reference with all covariates, expected at "
               "least " +
               std::to_string(kRecordsPerTerm * terms);
      return false;
    }
    // A slope along a constant would be anything, and wrong once it changes.
    for (Eigen::Index c = 0; c < model_.lowest.size(); ++c) {
      if (model_.lowest[c] < model_.highest[c]) continue;
      *error = "the covariate " +
               series_.covariate_names[static_cast<size_t>(c)] +
               " is constant in the reference; leave it out, or use a longer "
               "reference";
      return false;
    }
    OrdinaryFit(terms);
    EstimateScatter();
    // The scatter depends little on the weights.
    for (int round = 0; round < 2; ++round) {
      GeneralisedFit(terms);
      EstimateScatter();
    }
    return true;
  }

 private:
  void PrepareTerms() {
    const Eigen::Index count = series_.covariates.cols();
    model_.centres = Vector::Zero(count);
    model_.scales = Vector::Ones(count);
    model_.lowest = Vector::Constant(count, kInfinity);
    model_.highest = Vector::Constant(count, -kInfinity);
    model_.has_kink.assign(static_cast<size_t>(count), false);
    for (Eigen::Index c = 0; c < count; ++c) {
      Vector values(static_cast<Eigen::Index>(records_.size()));
      double below = 0.0;
      for (size_t i = 0; i < records_.size(); ++i) {
        const double value = series_.covariates(records_[i], c);
        values[static_cast<Eigen::Index>(i)] = value;
        model_.lowest[c] = std::min(model_.lowest[c], value);
        model_.highest[c] = std::max(model_.highest[c], value);
        if (value < series_.kinks[c]) below += 1.0;
      }
      if (values.size() == 0) continue;
      const double share = below / static_cast<double>(values.size());
      model_.has_kink[static_cast<size_t>(c)] =
          share > kLeastShareBeyondKink && share < 1.0 - kLeastShareBeyondKink;
      model_.centres[c] = values.mean();
      const double deviation = StandardDeviationOfPresent(values);
      if (deviation > 0.0) model_.scales[c] = deviation;
    }
  }

  void OrdinaryFit(Eigen::Index terms) {
    model_.coefficients = Matrix::Zero(terms, series_.num_features());
    for (Eigen::Index f = 0; f < series_.num_features(); ++f) {
      std::vector<Eigen::Index> present;
      for (const Eigen::Index r : records_) {
        if (!std::isnan(series_.values(r, f))) present.push_back(r);
      }
      Matrix rows(static_cast<Eigen::Index>(present.size()), terms);
      Vector values(rows.rows());
      for (size_t i = 0; i < present.size(); ++i) {
        rows.row(static_cast<Eigen::Index>(i)) =
            model_.Terms(series_, present[i]);
        values[static_cast<Eigen::Index>(i)] = series_.values(present[i], f);
      }
      model_.coefficients.col(f) = rows.colPivHouseholderQr().solve(values);
    }
  }

  // Residuals of the regression, records of the reference x features. Rare ones
  // are limited, as they are in the chart.
  Matrix Residuals() const {
    Matrix residuals(static_cast<Eigen::Index>(records_.size()),
                     series_.num_features());
    for (size_t i = 0; i < records_.size(); ++i) {
      residuals.row(static_cast<Eigen::Index>(i)) =
          series_.values.row(records_[i]) -
          model_.Terms(series_, records_[i]) * model_.coefficients;
    }
    for (Eigen::Index f = 0; f < residuals.cols(); ++f) {
      std::vector<double> sizes;
      for (const double value : residuals.col(f)) {
        if (!std::isnan(value)) sizes.push_back(std::abs(value));
      }
      const double limit =
          kLargestResidual * Median(sizes) / 0.6745;  // of a normal variable
      for (double& value : residuals.col(f)) {
        if (std::abs(value) > limit) value = std::copysign(limit, value);
      }
    }
    return residuals;
  }

  // Means of products of residuals `lag` records apart, and the mean time
  // between these.
  Matrix LagCovariance(const Matrix& residuals, Eigen::Index lag,
                       double* time) const {
    const Eigen::Index p = residuals.cols();
    Matrix sum = Matrix::Zero(p, p);
    Matrix count = Matrix::Zero(p, p);
    double times = 0.0;
    for (Eigen::Index i = lag; i < residuals.rows(); ++i) {
      times += series_.times[records_[static_cast<size_t>(i)]] -
               series_.times[records_[static_cast<size_t>(i - lag)]];
      for (Eigen::Index a = 0; a < p; ++a) {
        for (Eigen::Index b = 0; b < p; ++b) {
          const double product = residuals(i, a) * residuals(i - lag, b);
          if (std::isnan(product)) continue;
          sum(a, b) += product;
          count(a, b) += 1.0;
        }
      }
    }
    *time = times / static_cast<double>(residuals.rows() - lag);
    // The coefficients were fitted to the same records.
    const double records = static_cast<double>(residuals.rows());
    const double unbiased =
        records / (records - static_cast<double>(model_.num_terms()));
    return unbiased * (sum.array() / count.array().max(1.0)).matrix();
  }

  // Splits the covariance of the residuals into scatter with a memory, from the
  // covariances at lags, and noise, the rest.
  void EstimateScatter() {
    const Matrix residuals = Residuals();
    double no_time = 0.0;
    const Matrix total = LagCovariance(residuals, 0, &no_time);
    const Vector deviations = total.diagonal().cwiseMax(1e-24).cwiseSqrt();
    const Eigen::Index lags =
        std::min(kMostLags, static_cast<Eigen::Index>(records_.size()) / 4);
    std::vector<Matrix> covariances;
    Vector times(lags), correlations(lags);
    for (Eigen::Index lag = 1; lag <= lags; ++lag) {
      covariances.push_back(LagCovariance(residuals, lag, &times[lag - 1]));
      correlations[lag - 1] =
          (covariances.back().diagonal().array() / deviations.array().square())
              .mean();
    }
    FitMemory(times, correlations);
    Matrix scatter = Matrix::Zero(total.rows(), total.cols());
    double weights = 0.0;
    for (Eigen::Index i = 0; i < lags && model_.memory > 0.0; ++i) {
      const double decay = std::exp(-times[i] / model_.memory);
      scatter += decay * covariances[static_cast<size_t>(i)];
      weights += decay * decay;
    }
    if (weights > 0.0) scatter /= weights;
    // Neither the scatter nor the noise of a feature is quite zero.
    scatter = WithoutNegative(scatter);
    for (Eigen::Index f = 0; f < scatter.rows(); ++f) {
      const double most = 0.98 * total(f, f);
      if (scatter(f, f) <= most) continue;
      const double factor = std::sqrt(most / scatter(f, f));
      scatter.row(f) *= factor;
      scatter.col(f) *= factor;
    }
    model_.scatter = scatter;
    SetNoise(total - scatter, total);
  }

  // Finds the memory that describes the correlations best, by least squares
  // over a grid; 0 if they are not positive.
  void FitMemory(const Vector& times, const Vector& correlations) {
    model_.memory = 0.0;
    double least = correlations.squaredNorm();
    for (double memory = 0.25 * times[0];
         memory < 4.0 * times[times.size() - 1]; memory *= 1.15) {
      const Vector decay = (-times / memory).array().exp();
      const double share = std::min(
          1.0, decay.dot(correlations) / std::max(decay.squaredNorm(), 1e-300));
      if (share <= 0.0) continue;
      const double rest = (correlations - share * decay).squaredNorm();
      if (rest < least) {
        least = rest;
        model_.memory = memory;
      }
    }
  }

  void SetNoise(const Matrix& noise, const Matrix& total) {
    const Matrix positive = WithoutNegative(noise);
    const Eigen::Index p = positive.rows();
    model_.noise_factors.resize(p);
    model_.noise_deviations.resize(p);
    model_.noise_correlation = Matrix::Identity(p, p);
    for (Eigen::Index f = 0; f < p; ++f) {
      double squares = 0.0;
      double count = 0.0;
      for (const Eigen::Index r : records_) {
        if (std::isnan(series_.values(r, f))) continue;
        squares += series_.sigmas(r, f) * series_.sigmas(r, f);
        count += 1.0;
      }
      const double variance =
          std::max({positive(f, f), 0.02 * total(f, f), 1e-24});
      model_.noise_factors[f] = variance / std::max(squares / count, 1e-24);
      model_.noise_deviations[f] = std::sqrt(variance);
    }
    for (Eigen::Index a = 0; a < p; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        // Slightly less than was found, so that no difference is free of noise.
        const double correlation =
            0.98 * positive(a, b) /
            (model_.noise_deviations[a] * model_.noise_deviations[b]);
        model_.noise_correlation(a, b) = correlation;
        model_.noise_correlation(b, a) = correlation;
      }
    }
  }

  // Whitens the series and the terms by the filter, and solves the normal
  // equations of all features.
  void GeneralisedFit(Eigen::Index terms) {
    const Eigen::Index p = series_.num_features();
    const Eigen::Index unknowns = terms * p;
    Matrix normal = Matrix::Zero(unknowns, unknowns);
    Vector right = Vector::Zero(unknowns);
    Filter filter(model_, series_, 1 + unknowns);
    for (const Eigen::Index r : records_) {
      const std::vector<Eigen::Index> present = PresentFeatures(series_, r);
      const RowVector row = model_.Terms(series_, r);
      Matrix columns =
          Matrix::Zero(static_cast<Eigen::Index>(present.size()), 1 + unknowns);
      // Corrections of the last coefficients, so that outliers can be limited.
      for (size_t i = 0; i < present.size(); ++i) {
        const Eigen::Index at = static_cast<Eigen::Index>(i);
        const Eigen::Index f = present[i];
        columns(at, 0) =
            series_.values(r, f) - row.dot(model_.coefficients.col(f));
        columns.block(at, 1 + f * terms, 1, terms) = row;
      }
      Eigen::LLT<Matrix> factor;
      Vector deviations;
      filter.Step(r, present, &columns, &factor, &deviations);
      const Matrix solved = factor.solve(columns);
      normal +=
          columns.rightCols(unknowns).transpose() * solved.rightCols(unknowns);
      right += columns.rightCols(unknowns).transpose() * solved.col(0);
    }
    normal.diagonal() *= 1.0 + 1e-12;
    const Eigen::LDLT<Matrix> solver(normal);
    const Vector correction = solver.solve(right);
    for (Eigen::Index f = 0; f < p; ++f) {
      model_.coefficients.col(f) += correction.segment(f * terms, terms);
    }
    model_.covariance = solver.solve(Matrix::Identity(unknowns, unknowns));
  }

  const FeatureSeries& series_;
  NormalModel& model_;
  std::vector<Eigen::Index> records_;
};

}  // namespace

RowVector NormalModel::Terms(const FeatureSeries& series,
                             Eigen::Index record) const {
  Eigen::Index count = 1 + centres.size();
  for (const bool kink : has_kink) count += kink ? 1 : 0;
  RowVector terms(count);
  terms[0] = 1.0;
  Eigen::Index place = 1;
  for (Eigen::Index c = 0; c < centres.size(); ++c) {
    const double value = series.covariates(record, c);
    terms[place++] = (value - centres[c]) / scales[c];
    if (!has_kink[static_cast<size_t>(c)]) continue;
    terms[place++] = std::isnan(value)
                         ? kNaN
                         : std::max(0.0, series.kinks[c] - value) / scales[c];
  }
  return terms;
}

Vector NormalModel::Outside(const FeatureSeries& series,
                            Eigen::Index record) const {
  Vector outside(centres.size());
  for (Eigen::Index c = 0; c < centres.size(); ++c) {
    const double value = series.covariates(record, c);
    outside[c] = std::isnan(value)
                     ? 0.0
                     : std::max({0.0, lowest[c] - value, value - highest[c]}) /
                           scales[c];
  }
  return outside;
}

bool LearnNormal(const FeatureSeries& series,
                 const std::vector<bool>& is_reference, NormalModel* model,
                 std::string* error) {
  NormalModel learned;
  if (!Learner(series, is_reference, &learned).Run(error)) return false;
  *model = std::move(learned);
  return true;
}

Matrix CovarianceWithOutside(const NormalModel& model) {
  const Eigen::Index terms = model.num_terms();
  const Eigen::Index p = model.coefficients.cols();
  const Eigen::Index covariates = model.centres.size();
  const Eigen::Index known = model.covariance.rows();
  Matrix all = Matrix::Zero(known + p * covariates, known + p * covariates);
  all.topLeftCorner(known, known) = model.covariance;
  for (Eigen::Index f = 0; f < p; ++f) {
    Eigen::Index place = 1;
    for (Eigen::Index c = 0; c < covariates; ++c) {
      double slope = std::abs(model.coefficients(place++, f));
      if (model.has_kink[static_cast<size_t>(c)] && place < terms) {
        slope = std::max(slope, std::abs(model.coefficients(place++, f)));
      }
      const Eigen::Index at = known + f * covariates + c;
      all(at, at) = slope * slope;
    }
  }
  return all;
}

double NormalScore(double chi2, double degrees) {
  const double variance = 2.0 / (9.0 * degrees);
  return (std::cbrt(chi2 / degrees) - (1.0 - variance)) / std::sqrt(variance);
}

std::vector<Innovation> FilterSeries(const FeatureSeries& series,
                                     const NormalModel& model) {
  const Eigen::Index p = series.num_features();
  const Eigen::Index terms = model.num_terms();
  const Eigen::Index covariates = model.centres.size();
  const Eigen::Index effects = p * (terms + covariates);
  std::vector<Innovation> innovations(
      static_cast<size_t>(series.num_records()));
  // The second column holds the same values as the first one, unlimited.
  Filter filter(model, series, 2 + p + effects);
  const Matrix covariance = CovarianceWithOutside(model);
  for (Eigen::Index r = 0; r < series.num_records(); ++r) {
    Innovation& innovation = innovations[static_cast<size_t>(r)];
    innovation.residuals = Vector::Constant(p, kNaN);
    innovation.deviations = Vector::Constant(p, kNaN);
    innovation.score = Vector::Zero(p);
    innovation.unlimited_score = Vector::Zero(p);
    innovation.information = Matrix::Zero(p, p);
    innovation.coefficient_effect = Matrix::Zero(p, effects);
    const std::vector<Eigen::Index> present = PresentFeatures(series, r);
    const RowVector row = model.Terms(series, r);
    if (present.empty() || !row.allFinite()) continue;
    const Vector outside = model.Outside(series, r);
    const Eigen::Index count = static_cast<Eigen::Index>(present.size());
    Matrix columns = Matrix::Zero(count, 2 + p + effects);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index f = present[static_cast<size_t>(i)];
      columns(i, 0) = series.values(r, f) - row.dot(model.coefficients.col(f));
      columns(i, 1) = columns(i, 0);
      columns(i, 2 + f) = 1.0;
      columns.block(i, 2 + p + f * terms, 1, terms) = row;
      columns.block(i, 2 + p + p * terms + f * covariates, 1, covariates) =
          outside.transpose();
    }
    Eigen::LLT<Matrix> factor;
    Vector deviations;
    filter.Step(r, present, &columns, &factor, &deviations);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index f = present[static_cast<size_t>(i)];
      innovation.residuals[f] = columns(i, 0);
      innovation.deviations[f] = deviations[i];
    }
    const Matrix white = factor.matrixL().solve(columns);
    innovation.valid = true;
    innovation.num_present = static_cast<int>(count);
    innovation.whitened = white.col(0);
    innovation.whitened_change = white.middleCols(2, p);
    const auto effect = white.rightCols(effects);
    const Matrix wider = Matrix::Identity(count, count) +
                         effect * covariance * effect.transpose();
    innovation.t2_score =
        NormalScore(white.col(0).dot(wider.llt().solve(white.col(0))),
                    static_cast<double>(count));
    innovation.score = innovation.whitened_change.transpose() * white.col(0);
    innovation.unlimited_score =
        innovation.whitened_change.transpose() * white.col(1);
    innovation.information =
        innovation.whitened_change.transpose() * innovation.whitened_change;
    innovation.coefficient_effect =
        innovation.whitened_change.transpose() * effect;
  }
  return innovations;
}

}  // namespace pinode
