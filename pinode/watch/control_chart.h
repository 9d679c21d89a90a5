// Control chart of the innovations: when to raise an alarm.

#ifndef PINODE_WATCH_CONTROL_CHART_H_
#define PINODE_WATCH_CONTROL_CHART_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/watch/normal_model.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

// Seconds of a day.
inline constexpr double kDay = 86400.0;

// Statistics of a record, as standard normal scores; NaN: no chart. A lasting
// change raises the second one the longer it lasts.
struct ChartValues {
  double t2 = kNaN;       // of the record alone (H. Hotelling 1947)
  double average = kNaN;  // of the moving average (C. A. Lowry et al. 1992)
};

// Moving average of the scores of a lasting change. The weights decay with time
// by `memory`, so that gaps of the records are allowed for.
class ScoreAverage {
 public:
  // `num_effects`: columns of Innovation::coefficient_effect, or 0 without the
  // uncertainty of the model.
  ScoreAverage(Eigen::Index num_features, Eigen::Index num_effects,
               double memory);

  // Adds an innovation `step` seconds after the last one.
  void Add(double step, const Innovation& innovation);
  // Returns U' (J + V C V')^-1 U as a normal score: U is the sum of the scores,
  // J its covariance, V the effect of the model's coefficients on U and C their
  // covariance. An empty C is left out.
  double Score(const Matrix& coefficient_covariance) const;
  // Estimates the change of each feature and its standard deviation, by
  // residuals that are not limited.
  void Change(const Matrix& coefficient_covariance, Vector* change,
              Vector* deviation) const;

 private:
  double memory_;
  Vector sum_;
  Vector unlimited_sum_;
  Matrix sum_covariance_;
  Matrix weight_;  // information, decayed once
  Matrix effect_;
};

// Thresholds of both statistics, which are exceeded equally often.
struct ChartLimits {
  double t2 = 0.0;
  double average = 0.0;
};

struct ChartThresholds {
  ChartLimits alarm;
  // Limits of a notice: they are exceeded twelve times as often, but not so
  // often that one notice lasts into the next.
  ChartLimits notice;
  // 95 % intervals of the alarm's limits, as far as the length of the reference
  // leaves them uncertain.
  ChartLimits lower95, upper95;
  // Length of the reference in years. A reference that is much shorter than the
  // time between false alarms does not show such rare events.
  double reference_years = 0.0;
  // Length of the simulation in years. It may hold too few false alarms for the
  // limits to be counted.
  double simulated_years = 0.0;
  bool is_extrapolated = false;
};

// Finds the limits at which the chart rises `false_alarms_per_year` times a
// year. A rise is an exceedance after `clear_days` without one. The rate is
// counted in simulated years, whose innovations are blocks of the reference's,
// drawn with replacement (H. R. Kuensch 1989). Where these hold less than
// twenty false alarms, the limits are extrapolated from higher rates. The
// limits are at least those of normal innovations. False with a sentence if the
// reference has too few innovations.
[[nodiscard]] bool FindThresholds(const std::vector<Innovation>& reference,
                                  const Vector& times, double scatter_memory,
                                  const ChartOptions& options,
                                  ChartThresholds* thresholds,
                                  std::string* error);

// Returns the chart of all innovations, from the first one on.
std::vector<ChartValues> MakeChart(const std::vector<Innovation>& innovations,
                                   const Vector& times,
                                   const NormalModel& model,
                                   const ChartOptions& options);

// Returns the number of rises above the limits.
int CountRises(const std::vector<ChartValues>& values, const Vector& times,
               const ChartLimits& limits, double clear_days);

}  // namespace pinode

#endif  // PINODE_WATCH_CONTROL_CHART_H_
