// From the time column of a logger to a uniform grid.

#ifndef PINODE_RECORD_TIME_COLUMN_H_
#define PINODE_RECORD_TIME_COLUMN_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/table.h"

namespace pinode {

struct TimeColumnOptions {
  // Grid times are `factor` times the column's numbers; `unit` is the unit of
  // the product, for messages.
  double factor = 1.0;
  std::string unit = "s";
  // A row may lie this far from its place on the grid, as a fraction of the
  // step. Rounded times of a regular clock stay well below.
  double largest_jitter = 0.1;
  // Rows that lie farther off are interpolated instead of refused. Whoever
  // says so asked for another sampling rate anyway.
  bool interpolate_irregular = false;
};

// Sample i of the grid is at start_time + i * step.
struct TimeGrid {
  double start_time = 0.0;
  double step = 0.0;

  // Rows of the table that count, in order (repeated ones are left out).
  std::vector<Eigen::Index> rows;
  // Per sample of the grid, a position in `rows`, or -1 where no row is. On an
  // irregular grid: the last row at or before the sample; between it and the
  // next one is interpolated.
  std::vector<Eigen::Index> positions;
  // Times of `rows` where they are irregular; empty on a regular grid.
  std::vector<double> irregular_times;

  // What a reader of the report should know about this column, one sentence
  // each: rate found, jitter, rows dropped, samples missing.
  std::vector<std::string> remarks;

  Eigen::Index num_samples() const {
    return static_cast<Eigen::Index>(positions.size());
  }
};

// Finds the uniform grid behind a table's time column. The step is fitted to
// all rows (the median of the differences counts the samples, a straight line
// through the times gives the step), then rounded to the simplest rate or step
// that explains the times as well, so that times written with few digits do
// not detune the record.
//
// Accepted and remarked on: jitter within the limit; rows that repeat the one
// before (dropped); gaps of whole steps (missing samples).
// Refused with `path:line: ...`: fewer than two rows, NaN or decreasing times,
// one time with different values, times off the grid by more than the limit,
// gaps that are most of the grid.
[[nodiscard]] bool FindTimeGrid(const Table& table,
                                const std::string& time_column,
                                const TimeColumnOptions& options,
                                TimeGrid* grid, std::string* error);

// The grid of a table without a time column: one row a sample from t = 0.
// Refused: fewer than two rows, a step that is not positive.
[[nodiscard]] bool TimeGridFromStep(const Table& table, double step,
                                    TimeGrid* grid, std::string* error);

// A column of the table on its grid; NaN where missing. Irregular rows are
// interpolated by the cubic through the two neighbours with slopes of the
// parabolas through three; linearly beside a missing value.
Vector OnTimeGrid(const Table& table, int column, const TimeGrid& grid);

}  // namespace pinode

#endif  // PINODE_RECORD_TIME_COLUMN_H_
