#include "pinode/discover/active_set.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Tolerances for columns and a right-hand side of length 1.
constexpr double kOptimalityTolerance = 1e-12;
constexpr double kRankTolerance = 1e-13;
// Accepted violation of an entry that cannot be made to enter.
constexpr double kRoundingTolerance = 1e-9;

// Problem in units in which b and all columns have length 1.
struct Faces {
  Matrix A;
  Vector b;
  Vector penalty;
  std::vector<int> signs;

  Vector z;
  std::vector<int> active;
  // Sides of active entries that must not cross zero; 0: may cross.
  std::vector<int> side;

  // Returns the step of the active entries to the solution of their face. If
  // their columns depend on each other (*dependent), returns a step along which
  // the residual does not change and the penalty does not grow.
  Vector Direction(bool* dependent) const;
  // Takes the step, or the part of it after which an entry reaches zero and
  // leaves the active set; true if there was such an entry.
  bool Step(const Vector& direction, bool dependent);
  Vector Gradient() const { return A.transpose() * (b - A * z); }
  // Returns the violation of its optimality condition by entry j, at zero.
  double Violation(int j, double gradient) const {
    const int sign = signs[static_cast<size_t>(j)];
    return (sign == 0 ? std::abs(gradient) : sign * gradient) - penalty[j];
  }
};

Vector Faces::Direction(bool* dependent) const {
  const auto count = static_cast<Eigen::Index>(active.size());
  Matrix columns(A.rows(), count);
  Vector slope(count);  // of the penalty
  Vector current(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int j = active[static_cast<size_t>(i)];
    columns.col(i) = A.col(j);
    slope[i] = penalty[j] * side[static_cast<size_t>(j)];
    current[i] = z[j];
  }
  Eigen::ColPivHouseholderQR<Matrix> qr(columns);
  qr.setThreshold(kRankTolerance);
  const Eigen::Index rank = qr.rank();
  *dependent = rank < count;
  const auto upper =
      qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>();
  if (*dependent) {
    Vector null = Vector::Zero(count);
    null.head(rank) = -upper.solve(qr.matrixQR().col(rank).head(rank));
    null[rank] = 1.0;
    const Vector direction = qr.colsPermutation() * null;
    return slope.dot(direction) > 0.0 ? Vector(-direction) : direction;
  }
  // R'R z = R'Q'b - slope.
  const Vector permuted = qr.colsPermutation().transpose() * slope;
  Vector right = (qr.householderQ().transpose() * b).head(rank);
  right -= upper.transpose().solve(permuted);
  const Vector target = qr.colsPermutation() * Vector(upper.solve(right));
  return target - current;
}

bool Faces::Step(const Vector& direction, bool dependent) {
  double length = dependent ? std::numeric_limits<double>::infinity() : 1.0;
  int leaving = -1;
  // Along a dependence the entries that may cross zero leave there too: any one
  // of the columns may be removed. If the direction meets none, the opposite
  // direction, with the same penalty, does.
  for (const double sense : {1.0, -1.0}) {
    for (size_t i = 0; i < active.size(); ++i) {
      const int j = active[i];
      const double step = sense * direction[static_cast<Eigen::Index>(i)];
      const int held = side[static_cast<size_t>(j)];
      if (held == 0 && !dependent) continue;
      if (held != 0 ? held * step >= 0.0 : z[j] * step > 0.0 || step == 0.0) {
        continue;
      }
      // A full step that ends at zero exactly is no crossing.
      if (!dependent && held * (z[j] + step) >= 0.0) continue;
      const double fraction = -z[j] / step;
      if (leaving < 0 || fraction < length) {
        length = fraction;
        leaving = static_cast<int>(i);
      }
    }
    if (leaving >= 0 || !dependent) {
      length *= sense;
      break;
    }
  }
  CHECK(leaving >= 0 || !dependent) << "a dependence of no column";
  for (size_t i = 0; i < active.size(); ++i) {
    z[active[i]] += length * direction[static_cast<Eigen::Index>(i)];
  }
  if (leaving < 0) return false;
  z[active[static_cast<size_t>(leaving)]] = 0.0;
  active.erase(active.begin() + leaving);
  return true;
}

}  // namespace

ActiveSetSolution SolveActiveSet(const Matrix& A, const Vector& b,
                                 const Vector& penalty,
                                 const std::vector<int>& signs,
                                 const Vector& start) {
  const auto count = static_cast<int>(A.cols());
  CHECK_EQ(A.rows(), b.size());
  CHECK_EQ(penalty.size(), count);
  CHECK_EQ(static_cast<int>(signs.size()), count);
  CHECK_EQ(start.size(), count);
  CHECK(count == 0 || penalty.minCoeff() >= 0.0) << "negative penalty";

  ActiveSetSolution solution;
  solution.z = Vector::Zero(count);
  const double size = b.norm();
  if (size == 0.0) {
    solution.converged = true;
    return solution;
  }
  Faces faces;
  faces.A = A;
  faces.b = b / size;
  faces.penalty = penalty / size;
  faces.signs = signs;
  faces.z = Vector::Zero(count);
  faces.side.assign(static_cast<size_t>(count), 0);
  Vector norms(count);
  std::vector<bool> usable(static_cast<size_t>(count));
  for (int j = 0; j < count; ++j) {
    const size_t k = static_cast<size_t>(j);
    norms[j] = A.col(j).norm();
    usable[k] = norms[j] > 0.0;
    if (!usable[k]) norms[j] = 1.0;
    faces.A.col(j) /= norms[j];
    faces.penalty[j] /= norms[j];
    CHECK(signs[k] * start[j] >= 0.0)
        << "start " << start[j] << " of entry " << j << " has the wrong sign";
    faces.z[j] = usable[k] ? start[j] * norms[j] / size : 0.0;
    const bool crosses = faces.penalty[j] == 0.0 && signs[k] == 0;
    if (usable[k] && (faces.z[j] != 0.0 || crosses)) {
      faces.active.push_back(j);
      faces.side[k] = crosses ? 0 : (faces.z[j] > 0.0 ? 1 : -1);
    }
  }

  const int most_faces = 20 * count + 100;
  // Entries that left immediately after entering: their violation is rounding.
  std::vector<bool> blocked(static_cast<size_t>(count), false);
  int entered = -1;
  while (true) {
    bool crossing = true;
    while (crossing && !faces.active.empty()) {
      if (++solution.num_faces > most_faces) break;
      bool dependent = false;
      const Vector direction = faces.Direction(&dependent);
      crossing = faces.Step(direction, dependent);
    }
    if (solution.num_faces > most_faces) break;
    std::vector<bool> active(static_cast<size_t>(count), false);
    for (int j : faces.active) active[static_cast<size_t>(j)] = true;
    if (entered >= 0 && !active[static_cast<size_t>(entered)]) {
      blocked[static_cast<size_t>(entered)] = true;
    } else {
      std::fill(blocked.begin(), blocked.end(), false);
    }
    const Vector gradient = faces.Gradient();
    double largest = kOptimalityTolerance;
    entered = -1;
    for (int j = 0; j < count; ++j) {
      const size_t k = static_cast<size_t>(j);
      if (active[k] || blocked[k] || !usable[k]) continue;
      const double violation = faces.Violation(j, gradient[j]);
      if (violation > largest) {
        largest = violation;
        entered = j;
      }
    }
    if (entered < 0) {
      double worst = 0.0;
      for (int j = 0; j < count; ++j) {
        const size_t k = static_cast<size_t>(j);
        if (!blocked[k]) continue;
        worst = std::max(worst, faces.Violation(j, gradient[j]));
      }
      solution.converged = worst < kRoundingTolerance;
      break;
    }
    const size_t k = static_cast<size_t>(entered);
    faces.active.push_back(entered);
    const bool crosses = faces.penalty[entered] == 0.0 && signs[k] == 0;
    faces.side[k] = crosses ? 0 : (gradient[entered] > 0.0 ? 1 : -1);
  }
  for (int j = 0; j < count; ++j) {
    solution.z[j] = faces.z[j] * size / norms[j];
  }
  solution.active = faces.active;
  std::sort(solution.active.begin(), solution.active.end());
  return solution;
}

}  // namespace pinode
