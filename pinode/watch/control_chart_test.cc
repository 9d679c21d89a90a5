#include "pinode/watch/control_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pinode {
namespace {

constexpr double kStep = 3.0 * 3600.0;

// White innovations of two features, one of which is missing now and then.
std::vector<Innovation> WhiteInnovations(int count, unsigned seed,
                                         double change = 0.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Innovation> innovations(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    Innovation& innovation = innovations[static_cast<size_t>(i)];
    const Eigen::Index present = i % 7 == 0 ? 1 : 2;
    innovation.valid = true;
    innovation.num_present = static_cast<int>(present);
    innovation.whitened.resize(present);
    for (double& value : innovation.whitened) value = normal(random);
    innovation.whitened[0] += change;
    innovation.whitened_change = Matrix::Identity(present, 2);
    innovation.score =
        innovation.whitened_change.transpose() * innovation.whitened;
    innovation.information =
        innovation.whitened_change.transpose() * innovation.whitened_change;
    innovation.unlimited_score = innovation.score;
    innovation.t2_score = NormalScore(innovation.whitened.squaredNorm(),
                                      static_cast<double>(present));
    innovation.coefficient_effect = Matrix::Zero(2, 0);
  }
  return innovations;
}

Vector Times(int count) {
  return Vector::LinSpaced(count, 0.0, kStep * (count - 1));
}

// The chart written down once more, by its definition.
int RisesOf(const std::vector<Innovation>& innovations,
            const ChartLimits& limits, const ChartOptions& options,
            double step = kStep) {
  int rises = 0;
  double last = -1e300;
  const double keep = std::exp(-step / (options.memory_days * kDay));
  Vector sum = Vector::Zero(2);
  Vector variance = Vector::Zero(2);
  for (size_t i = 0; i < innovations.size(); ++i) {
    sum = keep * sum + innovations[i].score;
    variance = keep * keep * variance + innovations[i].information.diagonal();
    double chi2 = 0.0;
    int count = 0;
    for (int f = 0; f < 2; ++f) {
      if (variance[f] <= 0.0) continue;
      chi2 += sum[f] * sum[f] / variance[f];
      ++count;
    }
    const double time = step * static_cast<double>(i);
    if (NormalScore(chi2, count) <= limits.average &&
        innovations[i].t2_score <= limits.t2) {
      continue;
    }
    if (time - last >= options.clear_days * kDay) ++rises;
    last = time;
  }
  return rises;
}

TEST(NormalScore, HasTheQuantilesOfChiSquare) {
  // SciPy: chi2.isf(norm.sf(3), k) for k = 1, 4, 10.
  EXPECT_NEAR(NormalScore(10.2730, 1.0), 3.0, 0.12);
  EXPECT_NEAR(NormalScore(17.8006, 4.0), 3.0, 0.03);
  EXPECT_NEAR(NormalScore(28.7850, 10.0), 3.0, 0.03);
}

// The rate in new years, of innovations that the limits have not seen.
TEST(ControlChart, RaisesAtTheStatedRate) {
  ChartOptions options;
  options.false_alarms_per_year = 4.0;
  options.most_simulated = 60000;
  const int per_year = static_cast<int>(365.25 * kDay / kStep);
  ChartThresholds thresholds;
  std::string error;
  const int reference = 2 * per_year;
  ASSERT_TRUE(FindThresholds(WhiteInnovations(reference, 1), Times(reference),
                             0.0, options, &thresholds, &error))
      << error;
  EXPECT_NEAR(thresholds.reference_years, 2.0, 0.01);
  const int years = 20;
  const double rate = RisesOf(WhiteInnovations(years * per_year, 2),
                              thresholds.alarm, options) /
                      static_cast<double>(years);
  EXPECT_GT(rate, 2.0);
  EXPECT_LT(rate, 6.0);
  const double notices = RisesOf(WhiteInnovations(years * per_year, 2),
                                 thresholds.notice, options) /
                         static_cast<double>(years);
  // A quarter of the year, in weeks: more notices would merge.
  EXPECT_GT(notices, 6.5);
  EXPECT_LT(notices, 26.0);
  EXPECT_LT(thresholds.lower95.average, thresholds.alarm.average);
  EXPECT_GT(thresholds.upper95.average, thresholds.alarm.average);
}

// Rare alarms that the simulation does not hold: 20000 days are 55 years, with
// five alarms in them.
TEST(ControlChart, ExtrapolatesToARareRate) {
  ChartOptions options;
  options.false_alarms_per_year = 0.1;
  options.most_simulated = 20000;
  const double step = kDay;
  const int reference = 6000;
  ChartThresholds thresholds;
  std::string error;
  ASSERT_TRUE(
      FindThresholds(WhiteInnovations(reference, 1),
                     Vector::LinSpaced(reference, 0.0, step * (reference - 1)),
                     0.0, options, &thresholds, &error))
      << error;
  EXPECT_TRUE(thresholds.is_extrapolated);
  EXPECT_NEAR(thresholds.simulated_years, 20000.0 / 365.25, 0.1);
  // Counted over 400 years, in which 40 rises are expected.
  const int years = 400;
  const int rises = RisesOf(WhiteInnovations(years * 365, 2), thresholds.alarm,
                            options, step);
  EXPECT_GT(rises, 8);
  EXPECT_LT(rises, 80);
}

TEST(ControlChart, FindsALastingChange) {
  ChartOptions options;
  const int count = 1000;
  std::vector<Innovation> innovations = WhiteInnovations(count, 3);
  const std::vector<Innovation> changed = WhiteInnovations(200, 4, 1.0);
  innovations.insert(innovations.end(), changed.begin(), changed.end());
  NormalModel model;
  model.coefficients = Matrix::Zero(0, 2);
  model.centres.resize(0);
  ScoreAverage average(2, 0, options.memory_days * kDay);
  for (const Innovation& innovation : innovations) {
    average.Add(kStep, innovation);
  }
  Vector change, deviation;
  average.Change(Matrix(0, 0), &change, &deviation);
  EXPECT_NEAR(change[0], 1.0, 4.0 * deviation[0]);
  EXPECT_NEAR(change[1], 0.0, 4.0 * deviation[1]);
  // An average of 1 / (1 - keep) records, and of twice as many squares.
  const double keep = std::exp(-kStep / (options.memory_days * kDay));
  EXPECT_NEAR(deviation[0], std::sqrt((1.0 - keep) / (1.0 + keep)), 1e-6);
  EXPECT_GT(average.Score(Matrix()), 4.0);
}

// Coefficients that are not known well widen the limits of the average.
TEST(ControlChart, AllowsForTheModel) {
  ScoreAverage average(1, 1, kDay);
  Innovation innovation;
  innovation.score = Vector::Constant(1, 2.0);
  innovation.information = Matrix::Ones(1, 1);
  innovation.coefficient_effect = Matrix::Ones(1, 1);
  average.Add(0.0, innovation);
  EXPECT_NEAR(average.Score(Matrix()), NormalScore(4.0, 1.0), 1e-6);
  EXPECT_NEAR(average.Score(Matrix::Constant(1, 1, 3.0)), NormalScore(1.0, 1.0),
              1e-6);
}

TEST(ControlChart, CountsRisesAfterAllClear) {
  std::vector<ChartValues> values(400, {0.0, 0.0});
  values[10].t2 = 5.0;
  values[20].average = 5.0;  // 1.25 days later: the same alarm
  values[100].t2 = 5.0;      // ten days later: another one
  const ChartLimits limits = {4.0, 4.0};
  EXPECT_EQ(CountRises(values, Times(400), limits, 7.0), 2);
}

TEST(ControlChart, RefusesWhatIsNotFinite) {
  std::vector<Innovation> innovations = WhiteInnovations(100, 1);
  innovations[50].score[0] = kNaN;
  ChartThresholds thresholds;
  std::string error;
  EXPECT_FALSE(FindThresholds(innovations, Times(100), 0.0, ChartOptions(),
                              &thresholds, &error));
  EXPECT_NE(error.find("no finite limits"), std::string::npos) << error;
}

TEST(ControlChart, RefusesTooFewInnovations) {
  ChartThresholds thresholds;
  std::string error;
  EXPECT_FALSE(FindThresholds(WhiteInnovations(20, 1), Times(20), 0.0,
                              ChartOptions(), &thresholds, &error));
  EXPECT_NE(error.find("at least 25"), std::string::npos) << error;
}

}  // namespace
}  // namespace pinode
