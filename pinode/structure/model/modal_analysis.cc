#include "pinode/structure/model/modal_analysis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/stable_norm.h"
#include "pinode/structure/model/assignment.h"

namespace pinode {
namespace {

// Eigenvalues of the damped structure, and the participation of each undamped
// mode in each of them.
struct DampedEigenvalues {
  ComplexVector values;  // 2 n; conjugates are neighbours
  Matrix participation;  // 2 n x n, rows sum to one
};

// Computes the eigenvalues in modal coordinates x = Phi q, with w = sqrt|w^2|
// and the state (w q, dq/dt),
//
//   d/dt [w q; q'] = [0, W; -sign W, -Phi' C Phi] [w q; q'].
//
// The squares of its two halves are twice the strain and the kinetic energy.
// The matrix is nearly skew, so its eigenvalues are well conditioned.
bool ComputeDampedEigenvalues(const UndampedModes& undamped,
                              const Matrix& damping, DampedEigenvalues* damped,
                              std::string* error) {
  const Eigen::Index n = undamped.eigenvalues.size();
  const Vector w = undamped.eigenvalues.cwiseAbs().cwiseSqrt();
  Matrix state = Matrix::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n) = w.asDiagonal();
  state.bottomLeftCorner(n, n) =
      (-undamped.eigenvalues.array().sign() * w.array()).matrix().asDiagonal();
  state.bottomRightCorner(n, n) =
      -undamped.shapes.transpose() * damping * undamped.shapes;
  const Eigen::EigenSolver<Matrix> solver(state);
  if (solver.info() != Eigen::Success) {
    *error =
        "the complex eigenvalues of the damped structure did not converge; "
        "check the matrices for extreme entries";
    return false;
  }
  damped->values = solver.eigenvalues();
  const Matrix energy = solver.eigenvectors().cwiseAbs2();
  damped->participation =
      (energy.topRows(n) + energy.bottomRows(n)).transpose();
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    damped->participation.row(k) /= damped->participation.row(k).sum();
  }
  return true;
}

// Returns the two eigenvalues of each undamped mode. A conjugate pair stays
// together. The modes without a pair share the real eigenvalues.
std::vector<std::pair<std::complex<double>, std::complex<double>>>
PairEigenvalues(const DampedEigenvalues& damped) {
  const int n = static_cast<int>(damped.participation.cols());
  std::vector<int> oscillating;  // one of each conjugate pair
  std::vector<int> real;
  for (int k = 0; k < 2 * n; ++k) {
    if (damped.values[k].imag() > 0.0) oscillating.push_back(k);
    if (damped.values[k].imag() == 0.0) real.push_back(k);
  }
  const int num_oscillating = static_cast<int>(oscillating.size());
  const int num_overdamped = n - num_oscillating;
  CHECK_EQ(static_cast<int>(real.size()), 2 * num_overdamped)
      << "complex eigenvalues of a real matrix come in conjugate pairs";

  // Finds the modes that oscillate. Every conjugate pair is a candidate for
  // every mode. So is "a pair of the real ones", with half of their total
  // participation in the mode.
  Matrix profit(n, n);
  Vector of_real = Vector::Zero(n);
  for (const int k : real) of_real += 0.5 * damped.participation.row(k);
  for (int row = 0; row < num_oscillating; ++row) {
    profit.row(row) = damped.participation.row(oscillating[row]);
  }
  profit.bottomRows(num_overdamped).rowwise() = of_real.transpose();
  const std::vector<int> mode_of_row = MaximumProfitAssignment(profit);
  std::vector<std::pair<std::complex<double>, std::complex<double>>> pairs(n);
  for (int row = 0; row < num_oscillating; ++row) {
    const std::complex<double> value = damped.values[oscillating[row]];
    pairs[mode_of_row[row]] = {value, std::conj(value)};
  }

  // Two places in each of the other modes.
  Matrix real_profit(2 * num_overdamped, 2 * num_overdamped);
  for (int row = 0; row < 2 * num_overdamped; ++row) {
    for (int place = 0; place < 2 * num_overdamped; ++place) {
      const int mode = mode_of_row[num_oscillating + place / 2];
      real_profit(row, place) = damped.participation(real[row], mode);
    }
  }
  const std::vector<int> place_of_row = MaximumProfitAssignment(real_profit);
  for (int row = 0; row < 2 * num_overdamped; ++row) {
    const int place = place_of_row[row];
    auto& pair = pairs[mode_of_row[num_oscillating + place / 2]];
    (place % 2 == 0 ? pair.first : pair.second) = damped.values[real[row]];
  }
  return pairs;
}

// Returns the damping ratio of two real eigenvalues, NaN if they do not have
// one.
double OverdampedRatio(double first, double second) {
  if (!(first * second > 0.0)) return kNaN;
  // The geometric mean, with each root separately: the product may overflow or
  // underflow.
  const double frequency =
      std::sqrt(std::abs(first)) * std::sqrt(std::abs(second));
  return -0.5 * (first + second) / frequency;
}

void CheckSizes(const Matrix& mass, const Matrix& damping,
                const Matrix& stiffness) {
  const Eigen::Index n = mass.rows();
  CHECK(n > 0 && mass.cols() == n && damping.rows() == n &&
        damping.cols() == n && stiffness.rows() == n && stiffness.cols() == n)
      << "M is " << mass.rows() << " x " << mass.cols() << ", C "
      << damping.rows() << " x " << damping.cols() << ", K " << stiffness.rows()
      << " x " << stiffness.cols()
      << "; all must be square, of the same size and not empty";
}

}  // namespace

bool ComputeUndampedModes(const Matrix& mass, const Matrix& stiffness,
                          UndampedModes* modes, std::string* error) {
  // A unit diagonal of M makes the result independent of units, also for
  // rotations and translations together.
  if ((mass.diagonal().array() <= 0.0).any()) {
    *error = "the mass matrix is not positive definite: a DOF has no mass";
    return false;
  }
  const Vector scale = mass.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled_mass = scale.asDiagonal() * mass * scale.asDiagonal();
  const Eigen::LLT<Matrix> cholesky(scaled_mass);
  if (cholesky.info() != Eigen::Success) {
    *error = "the mass matrix is not positive definite";
    return false;
  }
  const Matrix scaled_stiffness =
      scale.asDiagonal() * stiffness * scale.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(
      scaled_stiffness, scaled_mass);
  if (solver.info() != Eigen::Success) {
    *error =
        "the eigenvalues of (K, M) did not converge; check the matrices for "
        "extreme entries";
    return false;
  }
  modes->eigenvalues = solver.eigenvalues();
  modes->shapes = scale.asDiagonal() * solver.eigenvectors();

  const Eigen::Index n = mass.rows();
  // Dense eigenvalues have an error of a few roundings of the largest one.
  // Smaller values cannot be distinguished from zero.
  const double rounding = 8.0 * static_cast<double>(n) *
                          std::numeric_limits<double>::epsilon() *
                          modes->eigenvalues.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::abs(modes->eigenvalues[i]) <= rounding) {
      modes->eigenvalues[i] = 0.0;
    }
    Eigen::Index largest = 0;
    modes->shapes.col(i).cwiseAbs().maxCoeff(&largest);
    if (modes->shapes(largest, i) < 0.0) modes->shapes.col(i) *= -1.0;
  }
  return true;
}

bool ComputeModes(const Matrix& mass, const Matrix& damping,
                  const Matrix& stiffness, ModalProperties* modes,
                  std::string* error) {
  CHECK(modes != nullptr);
  CHECK(error != nullptr);
  CheckSizes(mass, damping, stiffness);
  if (!mass.allFinite() || !damping.allFinite() || !stiffness.allFinite()) {
    *error = "modal analysis: M, C or K has an entry that is not finite";
    return false;
  }
  UndampedModes undamped;
  DampedEigenvalues damped;
  if (!ComputeUndampedModes(mass, stiffness, &undamped, error) ||
      !ComputeDampedEigenvalues(undamped, damping, &damped, error)) {
    *error = "modal analysis: " + *error;
    return false;
  }
  const auto pairs = PairEigenvalues(damped);

  const int n = static_cast<int>(mass.rows());
  const double at_rest_below =
      std::sqrt(8.0 * n * std::numeric_limits<double>::epsilon()) *
      damped.values.cwiseAbs().maxCoeff();
  modes->frequency_hz.resize(n);
  modes->damped_frequency_hz.resize(n);
  modes->damping_ratio.resize(n);
  for (int i = 0; i < n; ++i) {
    const double eigenvalue = undamped.eigenvalues[i];
    modes->frequency_hz[i] =
        eigenvalue < 0.0 ? kNaN : std::sqrt(eigenvalue) / kTwoPi;
    const std::complex<double> s = pairs[i].first;
    // Rounding separates a double eigenvalue zero by the root of the rounding
    // error.
    const bool at_rest = eigenvalue == 0.0 && std::abs(s) <= at_rest_below;
    modes->damped_frequency_hz[i] = at_rest ? 0.0 : std::abs(s.imag()) / kTwoPi;
    if (at_rest) {
      modes->damping_ratio[i] = kNaN;
    } else if (s.imag() != 0.0) {
      modes->damping_ratio[i] = -s.real() / std::abs(s);
    } else if (eigenvalue == 0.0) {
      modes->damping_ratio[i] = kNaN;
    } else {
      modes->damping_ratio[i] =
          OverdampedRatio(s.real(), pairs[i].second.real());
    }
  }
  modes->mode_shapes = std::move(undamped.shapes);
  return true;
}

Eigen::VectorXcd StateEigenvalues(const Matrix& mass, const Matrix& damping,
                                  const Matrix& stiffness) {
  CheckSizes(mass, damping, stiffness);
  const Eigen::Index n = mass.rows();
  const Eigen::LLT<Matrix> cholesky(mass);
  CHECK(mass.allFinite() && cholesky.info() == Eigen::Success)
      << "the mass matrix is not positive definite; check the model with "
         "StructuralModel::IsValid first";
  CHECK(damping.allFinite() && stiffness.allFinite())
      << "C or K has an entry that is not finite";
  // y = L' x with M = L L' keeps symmetric matrices symmetric, and velocities
  // measured in units of the highest frequency balance the two halves of the
  // state; EigenSolver does not balance by itself.
  const auto normalise = [&cholesky](const Matrix& matrix) -> Matrix {
    const Matrix half = cholesky.matrixL().solve(matrix);
    return cholesky.matrixL().solve(half.transpose()).transpose();
  };
  const Matrix normal_stiffness = normalise(stiffness);
  const double norm = normal_stiffness.norm();
  const double w = norm > 0.0 ? std::sqrt(norm) : 1.0;
  Matrix state = Matrix::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n).diagonal().setConstant(w);
  state.bottomLeftCorner(n, n) = -normal_stiffness / w;
  state.bottomRightCorner(n, n) = -normalise(damping);
  const Eigen::EigenSolver<Matrix> solver(state, /*computeEigenvectors=*/false);
  CHECK(solver.info() == Eigen::Success)
      << "the eigenvalues of a state matrix with norm " << state.norm()
      << " did not converge";
  return solver.eigenvalues();
}

double LargestStateEigenvalue(const Matrix& mass, const Matrix& damping,
                              const Matrix& stiffness) {
  return StateEigenvalues(mass, damping, stiffness).cwiseAbs().maxCoeff();
}

double Mac(const Vector& a, const Vector& b) {
  CHECK_EQ(a.size(), b.size()) << "both shapes need the same DOFs";
  // Scaled on the way: shapes may come in any units.
  const double norm_a = StableNorm(a);
  const double norm_b = StableNorm(b);
  if (norm_a == 0.0 || norm_b == 0.0) return 0.0;
  const double cosine = (a / norm_a).dot(b / norm_b);
  return std::min(cosine * cosine, 1.0);
}

Matrix MacMatrix(const Matrix& shapes_a, const Matrix& shapes_b) {
  CHECK_EQ(shapes_a.rows(), shapes_b.rows())
      << "both sets of shapes need the same DOFs as rows";
  Matrix mac(shapes_a.cols(), shapes_b.cols());
  for (Eigen::Index j = 0; j < mac.cols(); ++j) {
    for (Eigen::Index i = 0; i < mac.rows(); ++i) {
      mac(i, j) = Mac(shapes_a.col(i), shapes_b.col(j));
    }
  }
  return mac;
}

std::vector<int> PairModes(const Matrix& shapes_a, const Matrix& shapes_b) {
  return MaximumProfitAssignment(MacMatrix(shapes_a, shapes_b));
}

}  // namespace pinode
