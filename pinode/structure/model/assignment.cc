#include "pinode/structure/model/assignment.h"

#include <limits>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Returns the minimum-cost assignment of every row of `cost`, which has at
// least as many columns as rows. Rows enter one at a time. Each is placed along
// the cheapest alternating path. The cost of a path is the reduced cost under
// the potentials of the rows and columns, which stays non-negative.
std::vector<int> AssignRows(const Matrix& cost) {
  const int rows = static_cast<int>(cost.rows());
  const int columns = static_cast<int>(cost.cols());
  // Column `columns` is a virtual one that holds the row being placed.
  Vector row_potential = Vector::Zero(rows);
  Vector column_potential = Vector::Zero(columns + 1);
  std::vector<int> row_of_column(columns + 1, -1);

  for (int row = 0; row < rows; ++row) {
    row_of_column[columns] = row;
    Vector distance =
        Vector::Constant(columns, std::numeric_limits<double>::infinity());
    std::vector<int> previous(columns, columns);
    std::vector<bool> visited(columns + 1, false);
    int current = columns;
    while (row_of_column[current] >= 0) {
      visited[current] = true;
      const int i = row_of_column[current];
      double step = std::numeric_limits<double>::infinity();
      int next = -1;
      for (int j = 0; j < columns; ++j) {
        if (visited[j]) continue;
        const double reduced =
            cost(i, j) - row_potential[i] - column_potential[j];
        if (reduced < distance[j]) {
          distance[j] = reduced;
          previous[j] = current;
        }
        if (next < 0 || distance[j] < step) {
          step = distance[j];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        if (visited[j]) {
          row_potential[row_of_column[j]] += step;
          column_potential[j] -= step;
        } else if (j < columns) {
          distance[j] -= step;
        }
      }
      current = next;
    }
    // Shift the rows along the path that was found.
    while (current != columns) {
      row_of_column[current] = row_of_column[previous[current]];
      current = previous[current];
    }
  }

  std::vector<int> column_of_row(rows, -1);
  for (int j = 0; j < columns; ++j) {
    if (row_of_column[j] >= 0) column_of_row[row_of_column[j]] = j;
  }
  return column_of_row;
}

}  // namespace

std::vector<int> MaximumProfitAssignment(const Matrix& profit) {
  CHECK(profit.allFinite()) << "an assignment needs finite profits";
  if (profit.rows() <= profit.cols()) return AssignRows(-profit);
  // More rows than columns: place the columns instead.
  const std::vector<int> row_of_column = AssignRows(-profit.transpose());
  std::vector<int> column_of_row(profit.rows(), -1);
  for (int j = 0; j < profit.cols(); ++j) column_of_row[row_of_column[j]] = j;
  return column_of_row;
}

}  // namespace pinode
