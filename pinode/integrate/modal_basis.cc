#include "pinode/integrate/modal_basis.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

#include "pinode/integrate/exact_forcing.h"
#include "pinode/integrate/linear_rate.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// |V| |V^-1| in the Frobenius norm: digits that are lost.
constexpr double kLargestCondition = 1e7;

// A fit asks for the modes at one point again and again: for its search, its
// scores, its bands, each with another grid or none of the others' tables. The
// last few are remembered: what is smaller costs nothing, what is larger too
// much memory (40 ns^2 bytes each).
constexpr Eigen::Index kLeastRemembered = 16;
constexpr Eigen::Index kMostRemembered = 512;
constexpr size_t kNumRemembered = 3;

struct Decomposition {
  Matrix state_matrix;
  ComplexVector eigenvalues;
  ComplexMatrix modes;
  ComplexMatrix inverse_modes;
};
std::mutex recent_mutex;
std::deque<std::shared_ptr<const Decomposition>> recent;

// Of a Runge-Kutta step of dz/dt = lambda z + u, with x = step * lambda:
// z_next = R(x) z + step * sum_node a_node(x) u_node, and derivatives by x.
struct ScalarStep {
  explicit ScalarStep(Complex x)
      : growth(1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0)))),
        growth_slope(1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0))) {
    node[0] = (1.0 + x * (1.0 + x * (0.5 + 0.25 * x))) / 6.0;
    node[1] = (4.0 + x * (2.0 + 0.5 * x)) / 6.0;
    node[2] = 1.0 / 6.0;
    node_slope[0] = (1.0 + x * (1.0 + 0.75 * x)) / 6.0;
    node_slope[1] = (2.0 + x) / 6.0;
    node_slope[2] = 0.0;
  }
  Complex growth, growth_slope;
  Complex node[3], node_slope[3];
};

// V^-1 of modes that are real or, one behind the other, conjugate pairs: with a
// pair's real and imaginary parts as columns V is real, and a real inverse is
// a quarter of the work.
ComplexMatrix InverseOfPairs(const ComplexMatrix& modes) {
  const Eigen::Index ns = modes.rows();
  const auto begins_pair = [&modes](Eigen::Index m) {
    return !modes.col(m).imag().isZero(0.0);
  };
  Matrix parts = modes.real();
  for (Eigen::Index m = 0; m < ns; ++m) {
    if (!begins_pair(m)) continue;
    parts.col(m + 1) = modes.col(m).imag();
    ++m;
  }
  const Matrix inverse = Eigen::PartialPivLU<Matrix>(parts).inverse();
  ComplexMatrix result(ns, ns);
  for (Eigen::Index m = 0; m < ns; ++m) {
    if (!begins_pair(m)) {
      result.row(m) = inverse.row(m).cast<Complex>();
      continue;
    }
    // v = a + i b beside a - i b: their rows are (a' - i b') / 2 and its
    // conjugate, a' and b' those of a and b.
    result.row(m).real() = 0.5 * inverse.row(m);
    result.row(m).imag() = -0.5 * inverse.row(m + 1);
    result.row(m + 1) = result.row(m).conjugate();
    ++m;
  }
  return result;
}

}  // namespace

bool ModalBasis::Compute(const Matrix& state_matrix,
                         const IntegrationGrid& grid) {
  if (!Recall(state_matrix)) {
    if (!Decompose(state_matrix)) return false;
    Remember(state_matrix);
  }
  kept_.clear();
  std::vector<double> weights;
  for (Eigen::Index m = 0; m < eigenvalues_.size(); ++m) {
    if (eigenvalues_[m].imag() < 0.0) continue;
    kept_.push_back(static_cast<int>(m));
    weights.push_back(eigenvalues_[m].imag() > 0.0 ? 2.0 : 1.0);
  }
  weights_ = Eigen::Map<const Vector>(
      weights.data(), static_cast<Eigen::Index>(weights.size()));
  advance_.resize(num_kept());
  advance_slope_.resize(num_kept());
  forcing_.resize(num_kept(), 3 * grid.substeps());
  forcing_slope_.resize(num_kept(), 3 * grid.substeps());
  if (grid.integrator() == Integrator::kExact) {
    ComputeExactly(grid.sampling_step(), grid.substeps());
  } else {
    ComputeSteps(grid.step(), grid.substeps());
  }
  return advance_.allFinite() && forcing_.allFinite();
}

bool ModalBasis::Decompose(const Matrix& state_matrix) {
  const Eigen::Index ns = state_matrix.rows();
  const Vector units = VelocityUnits(state_matrix);
  const Eigen::EigenSolver<Matrix> solver(units.asDiagonal() * state_matrix *
                                          units.cwiseInverse().asDiagonal());
  if (solver.info() != Eigen::Success) return false;
  eigenvalues_ = solver.eigenvalues();
  modes_ = solver.eigenvectors();
  if (!eigenvalues_.allFinite() || !modes_.allFinite()) return false;
  inverse_modes_ = InverseOfPairs(modes_);
  if (!inverse_modes_.allFinite()) return false;
  double square = 0.0;  // of |V| |V^-1| with modes of length 1
  for (Eigen::Index m = 0; m < ns; ++m) {
    square += static_cast<double>(ns) * modes_.col(m).squaredNorm() *
              inverse_modes_.row(m).squaredNorm();
  }
  if (!(std::sqrt(square) < kLargestCondition)) return false;
  modes_ = units.cwiseInverse().asDiagonal() * modes_;
  inverse_modes_ = inverse_modes_ * units.asDiagonal();
  return true;
}

bool ModalBasis::Recall(const Matrix& state_matrix) {
  std::shared_ptr<const Decomposition> known;
  {
    const std::lock_guard<std::mutex> lock(recent_mutex);
    for (const auto& one : recent) {
      if (one->state_matrix.rows() == state_matrix.rows() &&
          one->state_matrix == state_matrix) {
        known = one;
      }
    }
  }
  if (known == nullptr) return false;
  eigenvalues_ = known->eigenvalues;
  modes_ = known->modes;
  inverse_modes_ = known->inverse_modes;
  return true;
}

void ModalBasis::Remember(const Matrix& state_matrix) const {
  const Eigen::Index ns = state_matrix.rows();
  if (ns < kLeastRemembered || ns > kMostRemembered) return;
  auto known = std::make_shared<const Decomposition>(
      Decomposition{state_matrix, eigenvalues_, modes_, inverse_modes_});
  const std::lock_guard<std::mutex> lock(recent_mutex);
  recent.push_back(std::move(known));
  if (recent.size() > kNumRemembered) recent.pop_front();
}

void ModalBasis::ComputeSteps(double step, int substeps) {
  for (int m = 0; m < num_kept(); ++m) {
    const ScalarStep one(step * eigenvalues_[kept_[static_cast<size_t>(m)]]);
    // R^i and its derivative by x, i the steps behind the one whose inputs
    // these are.
    Complex power = 1.0;
    Complex slope = 0.0;
    for (int s = substeps - 1; s >= 0; --s) {
      for (int node = 0; node < 3; ++node) {
        forcing_(m, 3 * s + node) = step * power * one.node[node];
        forcing_slope_(m, 3 * s + node) =
            step * step *
            (slope * one.node[node] + power * one.node_slope[node]);
      }
      slope = slope * one.growth + power * one.growth_slope;
      power *= one.growth;
    }
    advance_[m] = power;
    advance_slope_[m] = step * slope;
  }
}

void ModalBasis::ComputeExactly(double sampling_step, int substeps) {
  const Matrix polynomial = NodePolynomial(substeps);
  for (int m = 0; m < num_kept(); ++m) {
    const ExactStep exact(eigenvalues_[kept_[static_cast<size_t>(m)]],
                          sampling_step, polynomial);
    advance_[m] = exact.advance;
    advance_slope_[m] = exact.advance_slope;
    forcing_.row(m) = exact.forcing.transpose();
    forcing_slope_.row(m) = exact.forcing_slope.transpose();
  }
}

}  // namespace pinode
