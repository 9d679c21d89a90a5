#include "pinode/discover/least_squares_system.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/discover/active_set.h"

namespace pinode {
namespace {

// Triangularises `rows`, which holds [A b]; the caller sets num_residuals.
LeastSquaresSystem Triangularize(const Matrix& rows) {
  const Eigen::Index free = rows.cols() - 1;
  LeastSquaresSystem system;
  if (rows.rows() <= free) {
    system.A = rows.leftCols(free);
    system.b = rows.col(free);
    return system;
  }
  const Eigen::HouseholderQR<Matrix> qr(rows);
  const Matrix r =
      qr.matrixQR().topRows(free + 1).triangularView<Eigen::Upper>();
  system.A = r.topLeftCorner(free, free);
  system.b = r.col(free).head(free);
  system.rest = r(free, free) * r(free, free);
  return system;
}

}  // namespace

LeastSquaresSystem Condense(const RegressionProblem& problem,
                            const CoefficientMap& map, const TimeBlock& block) {
  CHECK(block.begin >= 0 && block.count > 0 &&
        block.begin + block.count <= problem.num_samples())
      << "block of " << block.count << " samples from " << block.begin
      << " on, of " << problem.num_samples();
  CHECK_EQ(map.num_coefficients(), problem.num_coefficients());
  const int free = map.num_free();
  std::vector<Matrix> parts;
  Eigen::Index num_rows = 0;
  double rest = 0.0;
  int coefficient = 0;
  for (const RegressionOutput& output : problem.outputs) {
    const int candidates = static_cast<int>(output.candidates.size());
    // Only the columns of this output take part in its QR.
    std::vector<int> local(static_cast<size_t>(free), -1);
    std::vector<int> columns;
    for (int j = 0; j < candidates; ++j) {
      const int i = map.free(coefficient + j);
      if (i >= 0 && local[static_cast<size_t>(i)] < 0) {
        local[static_cast<size_t>(i)] = static_cast<int>(columns.size());
        columns.push_back(i);
      }
    }
    const auto width = static_cast<Eigen::Index>(columns.size());
    Matrix rows = Matrix::Zero(block.count, width + 1);
    rows.col(width) = output.y.segment(block.begin, block.count);
    for (int j = 0; j < candidates; ++j) {
      const auto theta = output.theta.col(j).segment(block.begin, block.count);
      const int i = map.free(coefficient + j);
      if (i < 0) {
        rows.col(width) -= map.value(coefficient + j) * theta;
      } else {
        rows.col(local[static_cast<size_t>(i)]) +=
            map.factor(coefficient + j) * theta;
      }
    }
    rows /= output.sigma;
    const LeastSquaresSystem own = Triangularize(rows);
    rest += own.rest;
    Matrix part = Matrix::Zero(own.b.size(), free + 1);
    for (Eigen::Index c = 0; c < width; ++c) {
      part.col(columns[static_cast<size_t>(c)]) = own.A.col(c);
    }
    part.col(free) = own.b;
    num_rows += part.rows();
    parts.push_back(part);
    coefficient += candidates;
  }
  LeastSquaresSystem system;
  if (parts.size() == 1) {
    system.A = parts[0].leftCols(free);
    system.b = parts[0].col(free);
  } else {
    Matrix rows(num_rows, free + 1);
    Eigen::Index row = 0;
    for (const Matrix& part : parts) {
      rows.middleRows(row, part.rows()) = part;
      row += part.rows();
    }
    system = Triangularize(rows);
  }
  system.rest += rest;
  system.num_residuals =
      block.count * static_cast<Eigen::Index>(problem.outputs.size());
  return system;
}

LeastSquaresSystem Condense(const RegressionProblem& problem,
                            const CoefficientMap& map) {
  return Condense(problem, map, {0, problem.num_samples()});
}

LeastSquaresSystem Combine(const std::vector<LeastSquaresSystem>& systems,
                           const std::vector<int>& multiplicities) {
  CHECK_EQ(systems.size(), multiplicities.size());
  Eigen::Index num_rows = 0;
  Eigen::Index free = 0;
  double rest = 0.0;
  Eigen::Index num_residuals = 0;
  for (size_t i = 0; i < systems.size(); ++i) {
    if (multiplicities[i] == 0) continue;
    num_rows += systems[i].A.rows();
    free = systems[i].A.cols();
    rest += multiplicities[i] * systems[i].rest;
    num_residuals += multiplicities[i] * systems[i].num_residuals;
  }
  CHECK_GT(num_residuals, 0) << "no system counts";
  Matrix rows(num_rows, free + 1);
  Eigen::Index row = 0;
  for (size_t i = 0; i < systems.size(); ++i) {
    if (multiplicities[i] == 0) continue;
    const double weight = std::sqrt(static_cast<double>(multiplicities[i]));
    const Eigen::Index count = systems[i].A.rows();
    rows.block(row, 0, count, free) = weight * systems[i].A;
    rows.col(free).segment(row, count) = weight * systems[i].b;
    row += count;
  }
  LeastSquaresSystem system = Triangularize(rows);
  system.rest += rest;
  system.num_residuals = num_residuals;
  return system;
}

Vector FitSupport(const LeastSquaresSystem& system, const CoefficientMap& map,
                  const std::vector<int>& support, double ridge) {
  CHECK_EQ(system.num_free(), map.num_free());
  CHECK_GE(ridge, 0.0);
  Vector free = Vector::Zero(system.num_free());
  if (support.empty()) return free;
  const auto count = static_cast<Eigen::Index>(support.size());
  const Eigen::Index rows = system.A.rows();
  Matrix A = Matrix::Zero(rows + (ridge > 0.0 ? count : 0), count);
  Vector b = Vector::Zero(A.rows());
  b.head(rows) = system.b;
  std::vector<int> signs;
  for (Eigen::Index c = 0; c < count; ++c) {
    const int i = support[static_cast<size_t>(c)];
    A.col(c).head(rows) = system.A.col(i);
    if (ridge > 0.0) A(rows + c, c) = std::sqrt(ridge) * system.A.col(i).norm();
    signs.push_back(map.signs()[static_cast<size_t>(i)]);
  }
  const ActiveSetSolution solution =
      SolveActiveSet(A, b, Vector::Zero(count), signs, Vector::Zero(count));
  for (Eigen::Index c = 0; c < count; ++c) {
    free[support[static_cast<size_t>(c)]] = solution.z[c];
  }
  return free;
}

}  // namespace pinode
