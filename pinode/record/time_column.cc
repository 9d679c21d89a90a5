#include "pinode/record/time_column.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Largest number of missing samples for each existing row.
constexpr double kMostMissingPerRow = 10.0;
// A longer interval between irregular rows, in median steps, is a gap.
constexpr double kIrregularGap = 2.5;
constexpr size_t kMostGapRemarks = 10;

std::string Line(const Table& table, Eigen::Index row) {
  return std::to_string(table.line_numbers[static_cast<size_t>(row)]);
}

std::string Where(const Table& table, Eigen::Index row) {
  return table.path + ":" + Line(table, row) + ": ";
}

std::string Number(double value) { return FormatNumber(value, 6); }

// Returns a time with all digits: microseconds matter late in a long record.
std::string Time(double value) { return FormatNumber(value, 10); }

bool Same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

// Drops rows that repeat the one before; refuses NaN, decreasing times and one
// time with two values.
bool SelectRows(const Table& table, int column, const std::string& unit,
                const Vector& times, TimeGrid* grid, std::string* error) {
  const std::string& name = table.columns[static_cast<size_t>(column)];
  std::vector<std::string> dropped;
  for (Eigen::Index i = 0; i < table.num_rows(); ++i) {
    if (std::isnan(times[i])) {
      *error =
          Where(table, i) + "column '" + name +
          "': the time is missing (NaN or an empty cell). Delete the line if "
          "it is no row";
      return false;
    }
    if (i == 0 || times[i] > times[i - 1]) {
      grid->rows.push_back(i);
      continue;
    }
    if (times[i] < times[i - 1]) {
      *error = Where(table, i) + "column '" + name + "': time decreases from " +
               Time(times[i - 1]) + " to " + Time(times[i]) + " " + unit +
               ", expected increasing times";
      return false;
    }
    for (int j = 0; j < table.values.cols(); ++j) {
      if (Same(table.values(i, j), table.values(i - 1, j))) continue;
      *error = Where(table, i) + "time " + Time(times[i]) + " " + unit +
               " occurs again with other values (column '" +
               table.columns[static_cast<size_t>(j)] +
               "': " + Number(table.values(i - 1, j)) + " on line " +
               Line(table, i - 1) + ", " + Number(table.values(i, j)) +
               " here). If the clock is coarser than the rows, give the "
               "sampling rate instead of the time column";
      return false;
    }
    dropped.push_back(Line(table, i));
  }
  if (!dropped.empty()) {
    const size_t num_dropped = dropped.size();
    if (num_dropped > kMostGapRemarks) {
      dropped.resize(kMostGapRemarks);
      dropped.push_back("...");
    }
    grid->remarks.push_back(
        std::to_string(num_dropped) +
        (num_dropped == 1 ? " row repeats the row before and was dropped (line "
                          : " rows repeat the row before and were dropped "
                            "(lines ") +
        Join(dropped, ", ") + ")");
  }
  if (grid->rows.size() < 2) {
    *error = table.path + ": has " + std::to_string(grid->rows.size()) +
             " sample, at least two are needed";
    return false;
  }
  return true;
}

// Returns the numbers of steps from the first row to each row. Within a run of
// rows without a gap the count is certain. Across a gap it depends on the step,
// so the step is first found from the runs alone. *step is a rough guess on
// entry and refined on return.
std::vector<double> CountSteps(const std::vector<double>& times, double* step) {
  const size_t n = times.size();
  std::vector<double> counts(n, 0.0);
  for (int pass = 0; pass < 3; ++pass) {
    // Fits the slope of straight lines with one slope and one intercept per
    // run.
    double covariance = 0.0;
    double variance = 0.0;
    size_t first = 0;
    for (size_t i = 1; i <= n; ++i) {
      double increment = 0.0;
      if (i < n) {
        increment =
            std::max(1.0, std::round((times[i] - times[i - 1]) / *step));
        counts[i] = counts[i - 1] + increment;
        if (increment == 1.0) continue;
      }
      // Rows first .. i - 1 are a run.
      const double size = static_cast<double>(i - first);
      const double mean_count = 0.5 * (counts[first] + counts[i - 1]);
      double mean_time = 0.0;
      for (size_t k = first; k < i; ++k) mean_time += times[k] / size;
      for (size_t k = first; k < i; ++k) {
        const double deviation = counts[k] - mean_count;
        covariance += deviation * (times[k] - mean_time);
        variance += deviation * deviation;
      }
      first = i;
    }
    if (variance > 0.0) *step = covariance / variance;
  }
  return counts;
}

// Returns half the spread of times - step * counts, the distance of the worst
// row from the best grid of this step.
double HalfSpread(const std::vector<double>& times,
                  const std::vector<double>& counts, double step) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (size_t i = 0; i < times.size(); ++i) {
    const double offset = times[i] - step * counts[i];
    low = std::min(low, offset);
    high = std::max(high, offset);
  }
  return 0.5 * (high - low);
}

double LeastSquaresStep(const std::vector<double>& times,
                        const std::vector<double>& counts) {
  const double size = static_cast<double>(times.size());
  double mean_time = 0.0;
  double mean_count = 0.0;
  for (size_t i = 0; i < times.size(); ++i) {
    mean_time += times[i] / size;
    mean_count += counts[i] / size;
  }
  double covariance = 0.0;
  double variance = 0.0;
  for (size_t i = 0; i < times.size(); ++i) {
    const double deviation = counts[i] - mean_count;
    covariance += deviation * (times[i] - mean_time);
    variance += deviation * deviation;
  }
  return covariance / variance;
}

double RoundToDigits(double value, int digits) {
  double rounded = value;
  CHECK(ParseDouble(FormatNumber(value, digits), &rounded));
  return rounded;
}

// Returns the simplest rate or step that leaves no row farther from the grid
// than the fit does.
double SimplestStep(const std::vector<double>& times,
                    const std::vector<double>& counts, double fitted) {
  const double allowed =
      1.05 * HalfSpread(times, counts, fitted) + 1e-9 * fitted;
  for (int digits = 1; digits <= 12; ++digits) {
    for (const double candidate : {1.0 / RoundToDigits(1.0 / fitted, digits),
                                   RoundToDigits(fitted, digits)}) {
      if (HalfSpread(times, counts, candidate) <= allowed) return candidate;
    }
  }
  return fitted;
}

void RemarkOnGaps(const Table& table, const std::string& unit, TimeGrid* grid) {
  size_t num_gaps = 0;
  Eigen::Index num_missing = 0;
  Eigen::Index i = 0;
  while (i < grid->num_samples()) {
    if (grid->positions[static_cast<size_t>(i)] >= 0) {
      ++i;
      continue;
    }
    const Eigen::Index first = i;
    while (i < grid->num_samples() &&
           grid->positions[static_cast<size_t>(i)] < 0) {
      ++i;
    }
    // A grid begins with a row; an irregular one may end before its last.
    const size_t after =
        i < grid->num_samples()
            ? static_cast<size_t>(grid->positions[static_cast<size_t>(i)])
            : grid->rows.size() - 1;
    num_missing += i - first;
    if (++num_gaps > kMostGapRemarks) continue;
    grid->remarks.push_back(
        std::to_string(i - first) +
        (i - first == 1 ? " sample is missing" : " samples are missing") +
        " from " +
        Time(grid->start_time + static_cast<double>(first) * grid->step) +
        " to " +
        Time(grid->start_time + static_cast<double>(i - 1) * grid->step) + " " +
        unit + " (between lines " + Line(table, grid->rows[after - 1]) +
        " and " + Line(table, grid->rows[after]) + ")");
  }
  if (num_gaps > kMostGapRemarks) {
    grid->remarks.push_back("in all " + std::to_string(num_missing) +
                            " samples are missing in " +
                            std::to_string(num_gaps) + " gaps");
  }
}

bool RefuseSparse(const Table& table, double num_samples, size_t num_rows,
                  std::string* error) {
  if (num_samples <=
      (1.0 + kMostMissingPerRow) * static_cast<double>(num_rows)) {
    return true;
  }
  *error = table.path + ": the time column has gaps of " +
           Number(num_samples - static_cast<double>(num_rows)) +
           " samples between only " + std::to_string(num_rows) +
           " rows; use a record at a constant rate";
  return false;
}

// Lays a grid of the median step over irregular rows.
bool LayIrregularGrid(const Table& table, const std::vector<double>& times,
                      double median, const std::string& unit, TimeGrid* grid,
                      std::string* error) {
  const double span = times.back() - times.front();
  const double last = std::floor(span / median + 1e-9);
  if (!RefuseSparse(table, last + 1.0, times.size(), error)) return false;
  // A few fast rows can leave the grid with its first sample alone.
  if (last < 1.0) {
    *error = table.path + ": sampling is too irregular to interpolate";
    return false;
  }
  grid->step = median;
  grid->irregular_times = times;
  size_t row = 0;
  for (Eigen::Index i = 0; i <= static_cast<Eigen::Index>(last); ++i) {
    const double time = times.front() + static_cast<double>(i) * median;
    while (row + 1 < times.size() && times[row + 1] <= time) ++row;
    const bool gap = row + 1 < times.size() && times[row] != time &&
                     times[row + 1] - times[row] > kIrregularGap * median;
    grid->positions.push_back(gap ? -1 : static_cast<Eigen::Index>(row));
  }
  grid->remarks.push_back(
      "sampling is irregular: interpolated to the median rate of " +
      Number(1.0 / median) + " per " + unit);
  RemarkOnGaps(table, unit, grid);
  return true;
}

}  // namespace

bool FindTimeGrid(const Table& table, const std::string& time_column,
                  const TimeColumnOptions& options, TimeGrid* grid,
                  std::string* error) {
  CHECK(grid != nullptr);
  CHECK(error != nullptr);
  CHECK_EQ(table.line_numbers.size(), static_cast<size_t>(table.num_rows()));
  CHECK_GT(options.factor, 0.0) << "the factor to the grid's unit of time";
  const int column = table.FindColumn(time_column);
  CHECK_GE(column, 0) << "the table was read without its time column '"
                      << time_column << "'";

  const Vector all_times = options.factor * table.values.col(column);
  TimeGrid result;
  if (!SelectRows(table, column, options.unit, all_times, &result, error)) {
    return false;
  }
  std::vector<double> times;
  for (const Eigen::Index row : result.rows) times.push_back(all_times[row]);
  std::vector<double> differences;
  for (size_t i = 1; i < times.size(); ++i) {
    differences.push_back(times[i] - times[i - 1]);
  }
  const double median = Median(differences);
  result.start_time = times.front();

  double step = median;
  const std::vector<double> counts = CountSteps(times, &step);
  if (!RefuseSparse(table, counts.back() + 1.0, times.size(), error)) {
    return false;
  }
  step = SimplestStep(times, counts, LeastSquaresStep(times, counts));

  // How far the rows lie from the grid, about the middle of their spread.
  double low = 0.0;
  double high = 0.0;
  for (size_t i = 0; i < times.size(); ++i) {
    const double offset = times[i] - times[0] - step * counts[i];
    low = std::min(low, offset);
    high = std::max(high, offset);
  }
  const double jitter = 0.5 * (high - low) / step;
  if (jitter > options.largest_jitter) {
    if (options.interpolate_irregular) {
      if (!LayIrregularGrid(table, times, median, options.unit, &result,
                            error)) {
        return false;
      }
      *grid = std::move(result);
      return true;
    }
    // The row with the worst step of its own is more informative than the one
    // farthest off.
    size_t worst = 1;
    double deviation = 0.0;
    for (size_t i = 1; i < times.size(); ++i) {
      const double steps = (times[i] - times[i - 1]) / step;
      const double off = std::abs(steps - std::max(1.0, std::round(steps)));
      if (off > deviation) {
        deviation = off;
        worst = i;
      }
    }
    const bool drifts = deviation <= options.largest_jitter;
    *error =
        Where(table, result.rows[worst]) + "column '" + time_column + "': " +
        (drifts ? "the sampling step drifts: rows lie up to "
                : "sampling is irregular: rows lie up to ") +
        FormatNumber(100.0 * jitter, 3) + " % of the step (" + Number(step) +
        " " + options.unit + ") off a uniform grid, expected at most " +
        FormatNumber(100.0 * options.largest_jitter, 3) + " %" +
        (drifts ? ""
                : "; worst here, after " +
                      Number(times[worst] - times[worst - 1]) + " " +
                      options.unit) +
        ". If the clock is regular, give the sampling rate instead of the time "
        "column. Otherwise ask for resampling";
    return false;
  }

  result.step = step;
  result.positions.assign(static_cast<size_t>(counts.back()) + 1, -1);
  for (size_t i = 0; i < counts.size(); ++i) {
    result.positions[static_cast<size_t>(counts[i])] =
        static_cast<Eigen::Index>(i);
  }
  if (jitter > 1e-6) {
    result.remarks.push_back(
        "times lie up to " + FormatNumber(100.0 * jitter, 2) +
        " % of the step off the grid of " + Number(1.0 / step) +
        " samples per " + options.unit + "; the grid is used");
  }
  RemarkOnGaps(table, options.unit, &result);
  *grid = std::move(result);
  return true;
}

bool TimeGridFromStep(const Table& table, double step, TimeGrid* grid,
                      std::string* error) {
  CHECK(grid != nullptr);
  CHECK(error != nullptr);
  if (!(step > 0.0) || !std::isfinite(step)) {
    *error = table.path + ": sampling step " + Number(step) +
             ", expected a positive one";
    return false;
  }
  if (table.num_rows() < 2) {
    *error = table.path + ": has " + std::to_string(table.num_rows()) +
             " sample, at least two are needed";
    return false;
  }
  TimeGrid result;
  result.step = step;
  for (Eigen::Index i = 0; i < table.num_rows(); ++i) {
    result.rows.push_back(i);
    result.positions.push_back(i);
  }
  *grid = std::move(result);
  return true;
}

Vector OnTimeGrid(const Table& table, int column, const TimeGrid& grid) {
  CHECK_GE(column, 0);
  CHECK_LT(column, table.values.cols());
  const auto values = table.values.col(column);
  const Eigen::Index num_rows = static_cast<Eigen::Index>(grid.rows.size());
  auto value = [&](Eigen::Index position) {
    return position < 0 || position >= num_rows
               ? std::numeric_limits<double>::quiet_NaN()
               : values[grid.rows[static_cast<size_t>(position)]];
  };

  Vector result(grid.num_samples());
  if (grid.irregular_times.empty()) {
    for (Eigen::Index i = 0; i < grid.num_samples(); ++i) {
      result[i] = value(grid.positions[static_cast<size_t>(i)]);
    }
    return result;
  }

  auto time = [&grid](Eigen::Index position) {
    return grid.irregular_times[static_cast<size_t>(position)];
  };
  // Slope at a row of the parabola through it and its neighbours, NaN if one
  // of the three is missing.
  auto slope = [&](Eigen::Index k) {
    if (k < 1 || k + 1 >= num_rows) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const double before = time(k) - time(k - 1);
    const double after = time(k + 1) - time(k);
    const double slope_before = (value(k) - value(k - 1)) / before;
    const double slope_after = (value(k + 1) - value(k)) / after;
    return (after * slope_before + before * slope_after) / (before + after);
  };
  for (Eigen::Index i = 0; i < grid.num_samples(); ++i) {
    const Eigen::Index k = grid.positions[static_cast<size_t>(i)];
    const double t = grid.start_time + static_cast<double>(i) * grid.step;
    if (k < 0 || k + 1 >= num_rows || t == time(k)) {
      result[i] = value(k);
      continue;
    }
    const double width = time(k + 1) - time(k);
    const double x = (t - time(k)) / width;
    const double left = value(k);
    const double right = value(k + 1);
    double left_slope = slope(k);
    double right_slope = slope(k + 1);
    if (std::isnan(left_slope) || std::isnan(right_slope)) {
      left_slope = right_slope = (right - left) / width;
    }
    // Cubic Hermite interpolation.
    result[i] =
        left + x * x * (3.0 - 2.0 * x) * (right - left) +
        width * x * (1.0 - x) * ((1.0 - x) * left_slope - x * right_slope);
  }
  return result;
}

}  // namespace pinode
