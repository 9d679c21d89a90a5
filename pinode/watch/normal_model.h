// Normal behaviour of the watched frequencies, learned on a reference period.

#ifndef PINODE_WATCH_NORMAL_MODEL_H_
#define PINODE_WATCH_NORMAL_MODEL_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"

namespace pinode {

// Features over time, in the order of their times. A feature is the natural
// logarithm of the frequency of a mode, so differences are relative changes.
struct FeatureSeries {
  std::vector<std::string> names;
  Vector times;   // s, of each record
  Matrix values;  // records x features; NaN: the mode was not found
  Matrix sigmas;  // standard deviations of the estimates, likewise
  std::vector<std::string> covariate_names;
  Vector kinks;       // of each covariate; NaN: none
  Matrix covariates;  // records x covariates; NaN: missing

  Eigen::Index num_records() const { return values.rows(); }
  Eigen::Index num_features() const { return values.cols(); }
};

// Features as functions of the covariates, with what they leave:
//
//   y_t = X_t b + w_t + n_t
//
// X_t holds 1, each covariate, and the part of a covariate below its kink. w is
// scatter with a memory, cov(w_t, w_s) = S exp(-|t - s| / T), such as a
// temperature that was not measured. n is noise of the estimates, independent
// between records, with a correlation between the features of one record.
// Coefficients are estimated by generalised least squares.
struct NormalModel {
  // Number of records with a feature and all covariates that it was learned
  // from.
  int num_records = 0;
  Vector centres, scales;  // of the covariates, in the regression
  Vector lowest, highest;  // learned range of each covariate
  // True for covariates with enough records on both sides of their kink.
  std::vector<bool> has_kink;
  Matrix coefficients;  // terms x features
  // Covariance of the coefficients, features one after the other.
  Matrix covariance;
  Matrix scatter;       // S
  double memory = 0.0;  // T, s
  // Variance of n relative to that of the estimates, for each feature.
  Vector noise_factors;
  Matrix noise_correlation;
  // Standard deviation of a typical n, for each feature.
  Vector noise_deviations;

  Eigen::Index num_terms() const { return coefficients.rows(); }
  // Returns the row X_t; NaN if a covariate is missing.
  RowVector Terms(const FeatureSeries& series, Eigen::Index record) const;
  // Returns how far each covariate is outside of the learned range, in its
  // scale; 0 inside.
  Vector Outside(const FeatureSeries& series, Eigen::Index record) const;
};

// Learns the model from records with `is_reference`. Returns false, with a
// sentence that begins in lower case, if they are too few.
[[nodiscard]] bool LearnNormal(const FeatureSeries& series,
                               const std::vector<bool>& is_reference,
                               NormalModel* model, std::string* error);

// Information of one record about a change of the features.
struct Innovation {
  // False if a covariate or all features are missing.
  bool valid = false;
  int num_present = 0;
  // Features minus X b, minus what the scatter before lets expect; NaN if the
  // feature is missing. `deviations` are their standard deviations.
  Vector residuals, deviations;
  // Normal score of T^2, the size of the residuals, in view of the uncertainty
  // of the model's coefficients.
  double t2_score = 0.0;
  // L^-1 e and L^-1 M. L L' is the covariance of the residuals e of the present
  // features, and M their mean after a lasting change of each feature by one.
  Vector whitened;
  Matrix whitened_change;
  // Score of a lasting change, M' (L L')^-1 e, and its information.
  Vector score;
  Matrix information;
  // The same score of residuals that are not limited. It tells how large a
  // change is, but raises no alarm.
  Vector unlimited_score;
  // M' (L L')^-1 G. G is the effect of the model's coefficients, and behind
  // them of slopes outside of the learned range, one per feature and covariate.
  Matrix coefficient_effect;
};

// Filters the series by the model, from its first record on (R. E. Kalman
// 1960). A residual beyond four deviations counts as four: a mode that was
// mistaken for another one is no change of the structure.
std::vector<Innovation> FilterSeries(const FeatureSeries& series,
                                     const NormalModel& model);

// Returns the covariance of the coefficients in Innovation: that of the model,
// and slopes outside of the learned range that may be anything up to twice the
// learned one.
Matrix CovarianceWithOutside(const NormalModel& model);

// Returns the standard normal score of a chi^2 value (E. B. Wilson and M. M.
// Hilferty 1931).
double NormalScore(double chi2, double degrees);

}  // namespace pinode

#endif  // PINODE_WATCH_NORMAL_MODEL_H_
