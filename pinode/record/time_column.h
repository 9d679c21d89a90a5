// Finds the uniform grid of a logger's time column.

#ifndef PINODE_RECORD_TIME_COLUMN_H_
#define PINODE_RECORD_TIME_COLUMN_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/table.h"

namespace pinode {

struct TimeColumnOptions {
  // Factor from the column's numbers to grid times. `unit` is the unit of the
  // product, for messages.
  double factor = 1.0;
  std::string unit = "s";
  // Largest distance of a row from its place on the grid, as a fraction of the
  // step. Rounded times of a regular clock stay well below.
  double largest_jitter = 0.1;
  // True: rows that lie farther off are interpolated instead of refused. Set it
  // if the record is resampled anyway.
  bool interpolate_irregular = false;
};

// A uniform grid. Sample i is at start_time + i * step.
struct TimeGrid {
  double start_time = 0.0;
  double step = 0.0;

  // Rows of the table that are used, in order (repeated ones are left out).
  std::vector<Eigen::Index> rows;
  // For each sample of the grid, a position in `rows`, or -1 if there is no
  // row. On an irregular grid it is the last row at or before the sample.
  // Values are interpolated between it and the next one.
  std::vector<Eigen::Index> positions;
  // Times of `rows` if they are irregular. Empty on a regular grid.
  std::vector<double> irregular_times;

  // Remarks on this column for the report, one sentence each: rate found,
  // jitter, rows dropped, samples missing.
  std::vector<std::string> remarks;

  Eigen::Index num_samples() const {
    return static_cast<Eigen::Index>(positions.size());
  }
};

// Finds the uniform grid behind a table's time column. The step is fitted to
// all rows: the median of the differences counts the samples, and a straight
// line through the times gives the step. The step is then rounded to the
// simplest rate or step that explains the times as well. Times written with few
// digits therefore do not change the frequencies of the record.
//
// Accepts, with a remark: jitter within the limit; rows that repeat the one
// before (dropped); gaps of whole steps (missing samples).
//
// Refuses with `path:line: ...`:
//
// - fewer than two rows;
// - NaN or decreasing times;
// - one time with different values;
// - times off the grid by more than the limit;
// - gaps that are most of the grid.
[[nodiscard]] bool FindTimeGrid(const Table& table,
                                const std::string& time_column,
                                const TimeColumnOptions& options,
                                TimeGrid* grid, std::string* error);

// Builds the grid of a table without a time column: one row per sample from t =
// 0. Refuses fewer than two rows and a step that is not positive.
[[nodiscard]] bool TimeGridFromStep(const Table& table, double step,
                                    TimeGrid* grid, std::string* error);

// Returns a column of the table on its grid; NaN means missing. Irregular rows
// are interpolated by the cubic through the two neighbours with slopes of the
// parabolas through three. Beside a missing value the interpolation is linear.
Vector OnTimeGrid(const Table& table, int column, const TimeGrid& grid);

}  // namespace pinode

#endif  // PINODE_RECORD_TIME_COLUMN_H_
