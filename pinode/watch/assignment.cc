#include "pinode/watch/assignment.h"

#include <cstddef>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"

namespace pinode {

std::vector<int> AssignRows(const Matrix& costs) {
  const int rows = static_cast<int>(costs.rows());
  const int columns = static_cast<int>(costs.cols());
  CHECK_LE(rows, columns) << "a row of the costs would stay without a column";
  // Dual prices, and the row of each column. Column 0 and row 0 are virtual.
  std::vector<double> row_price(static_cast<size_t>(rows) + 1, 0.0);
  std::vector<double> column_price(static_cast<size_t>(columns) + 1, 0.0);
  std::vector<int> row_of(static_cast<size_t>(columns) + 1, 0);
  std::vector<int> before(static_cast<size_t>(columns) + 1, 0);
  for (int row = 1; row <= rows; ++row) {
    row_of[0] = row;
    int column = 0;
    std::vector<double> slack(static_cast<size_t>(columns) + 1, kInfinity);
    std::vector<bool> seen(static_cast<size_t>(columns) + 1, false);
    // The cheapest path from this row to a free column.
    do {
      seen[static_cast<size_t>(column)] = true;
      const int from = row_of[static_cast<size_t>(column)];
      double least = kInfinity;
      int next = 0;
      for (int j = 1; j <= columns; ++j) {
        const size_t at = static_cast<size_t>(j);
        if (seen[at]) continue;
        const double reduced = costs(from - 1, j - 1) -
                               row_price[static_cast<size_t>(from)] -
                               column_price[at];
        if (reduced < slack[at]) {
          slack[at] = reduced;
          before[at] = column;
        }
        if (slack[at] < least) {
          least = slack[at];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        const size_t at = static_cast<size_t>(j);
        if (seen[at]) {
          row_price[static_cast<size_t>(row_of[at])] += least;
          column_price[at] -= least;
        } else {
          slack[at] -= least;
        }
      }
      column = next;
    } while (row_of[static_cast<size_t>(column)] != 0);
    // Every row on the path moves to the next column.
    while (column != 0) {
      const int previous = before[static_cast<size_t>(column)];
      row_of[static_cast<size_t>(column)] =
          row_of[static_cast<size_t>(previous)];
      column = previous;
    }
  }
  std::vector<int> column_of(static_cast<size_t>(rows), -1);
  for (int j = 1; j <= columns; ++j) {
    const int row = row_of[static_cast<size_t>(j)];
    if (row > 0) column_of[static_cast<size_t>(row - 1)] = j - 1;
  }
  return column_of;
}

}  // namespace pinode
