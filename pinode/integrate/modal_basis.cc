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

// Largest condition |V| |V^-1| in the Frobenius norm, a measure of the lost
// digits.
constexpr double kLargestCondition = 1e7;

// Limits of the cache of modes. A fit needs the modes at one point repeatedly:
// for its search, its scores and its bands, each with another grid or without
// the others' tables. The last few are cached. Smaller matrices are cheap to
// decompose again, and larger ones need too much memory (40 ns^2 bytes each).
constexpr Eigen::Index kLeastRemembered = 16;
constexpr Eigen::Index kMostRemembered = 512;
constexpr size_t kNumRemembered = 3;

std::mutex recent_mutex;
std::deque<std::shared_ptr<const ModalBasis::Spectrum>> recent;

// Runge-Kutta step of dz/dt = lambda z + u, with x = step * lambda: z_next =
// R(x) z + step * sum_node a_node(x) u_node. Also has the derivatives with
// respect to x.
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

// Returns V^-1 of modes that are real or adjacent conjugate pairs. With a
// pair's real and imaginary parts as columns V is real, and a real inverse
// takes a quarter of the work.
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

// Computes the modes. Returns nullptr if they do not span the states.
std::shared_ptr<const ModalBasis::Spectrum> Decompose(
    const Matrix& state_matrix) {
  const Eigen::Index ns = state_matrix.rows();
  const Vector units = VelocityUnits(state_matrix);
  const Eigen::EigenSolver<Matrix> solver(Matrix(
      units.asDiagonal() * state_matrix * units.cwiseInverse().asDiagonal()));
  if (solver.info() != Eigen::Success) return nullptr;
  auto result = std::make_shared<ModalBasis::Spectrum>();
  result->eigenvalues = solver.eigenvalues();
  ComplexMatrix& modes = result->modes;
  modes = solver.eigenvectors();
  if (!result->eigenvalues.allFinite() || !modes.allFinite()) return nullptr;
  ComplexMatrix& inverse = result->inverse_modes;
  inverse = InverseOfPairs(modes);
  if (!inverse.allFinite()) return nullptr;
  double square = 0.0;  // of |V| |V^-1| with modes of length 1
  for (Eigen::Index m = 0; m < ns; ++m) {
    square += static_cast<double>(ns) * modes.col(m).squaredNorm() *
              inverse.row(m).squaredNorm();
  }
  if (!(std::sqrt(square) < kLargestCondition)) return nullptr;
  modes.array().colwise() /= units.array().cast<Complex>();
  inverse.array().rowwise() *= units.array().cast<Complex>().transpose();
  result->state_matrix = state_matrix;
  return result;
}

}  // namespace

std::shared_ptr<const ModalBasis::Spectrum> ModalBasis::FindSpectrum(
    const Matrix& state_matrix) {
  const Eigen::Index ns = state_matrix.rows();
  if (ns < kLeastRemembered || ns > kMostRemembered) {
    return Decompose(state_matrix);
  }
  // The result may be known already.
  {
    const std::lock_guard<std::mutex> lock(recent_mutex);
    for (const auto& known : recent) {
      if (known->state_matrix.rows() == ns &&
          known->state_matrix == state_matrix) {
        return known;
      }
    }
  }
  std::shared_ptr<const ModalBasis::Spectrum> found = Decompose(state_matrix);
  if (found == nullptr) return nullptr;
  const std::lock_guard<std::mutex> lock(recent_mutex);
  recent.push_back(found);
  if (recent.size() > kNumRemembered) recent.pop_front();
  return found;
}

bool ModalBasis::Compute(const Matrix& state_matrix,
                         const IntegrationGrid& grid) {
  spectrum_ = FindSpectrum(state_matrix);
  if (spectrum_ == nullptr) return false;
  kept_.clear();
  std::vector<double> weights;
  for (Eigen::Index m = 0; m < num_states(); ++m) {
    if (eigenvalues()[m].imag() < 0.0) continue;
    kept_.push_back(static_cast<int>(m));
    weights.push_back(eigenvalues()[m].imag() > 0.0 ? 2.0 : 1.0);
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

void ModalBasis::ComputeSteps(double step, int substeps) {
  for (int m = 0; m < num_kept(); ++m) {
    const ScalarStep one(step * eigenvalues()[kept_[static_cast<size_t>(m)]]);
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
    const ExactStep exact(eigenvalues()[kept_[static_cast<size_t>(m)]],
                          sampling_step, polynomial);
    advance_[m] = exact.advance;
    advance_slope_[m] = exact.advance_slope;
    forcing_.row(m) = exact.forcing.transpose();
    forcing_slope_.row(m) = exact.forcing_slope.transpose();
  }
}

}  // namespace pinode
