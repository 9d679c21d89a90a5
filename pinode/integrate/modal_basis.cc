#include "pinode/integrate/modal_basis.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>

namespace pinode {
namespace {

using Complex = std::complex<double>;

// |V| |V^-1| in the Frobenius norm: digits that are lost.
constexpr double kLargestCondition = 1e7;

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

}  // namespace

bool ModalBasis::Compute(const Matrix& state_matrix, double step,
                         int substeps) {
  const Eigen::Index ns = state_matrix.rows();
  const Eigen::EigenSolver<Matrix> solver(state_matrix);
  if (solver.info() != Eigen::Success) return false;
  eigenvalues_ = solver.eigenvalues();
  modes_ = solver.eigenvectors();
  if (!eigenvalues_.allFinite() || !modes_.allFinite()) return false;
  const Eigen::PartialPivLU<ComplexMatrix> lu(modes_);
  inverse_modes_ = lu.inverse();
  if (!inverse_modes_.allFinite()) return false;
  // Displacements and velocities in one unit: a mode's own frequency.
  const double frequency = eigenvalues_.cwiseAbs().maxCoeff();
  const Eigen::Index n = ns / 2;
  double sum = 0.0;  // of |V|^2 |V^-1|^2 with modes of length 1
  for (Eigen::Index m = 0; m < ns; ++m) {
    const double length =
        std::sqrt(frequency * frequency * modes_.col(m).head(n).squaredNorm() +
                  modes_.col(m).tail(ns - n).squaredNorm());
    sum +=
        static_cast<double>(ns) * length * length *
        (inverse_modes_.row(m).head(n).squaredNorm() / (frequency * frequency) +
         inverse_modes_.row(m).tail(ns - n).squaredNorm());
  }
  if (!(std::sqrt(sum) < kLargestCondition)) return false;

  kept_.clear();
  std::vector<double> weights;
  for (Eigen::Index m = 0; m < ns; ++m) {
    if (eigenvalues_[m].imag() < 0.0) continue;
    kept_.push_back(static_cast<int>(m));
    weights.push_back(eigenvalues_[m].imag() > 0.0 ? 2.0 : 1.0);
  }
  weights_ = Eigen::Map<const Vector>(
      weights.data(), static_cast<Eigen::Index>(weights.size()));
  ComputeSteps(step, substeps);
  return advance_.allFinite() && forcing_.allFinite();
}

void ModalBasis::ComputeSteps(double step, int substeps) {
  const int count = num_kept();
  advance_.resize(count);
  advance_slope_.resize(count);
  forcing_.resize(count, 3 * substeps);
  forcing_slope_.resize(count, 3 * substeps);
  for (int m = 0; m < count; ++m) {
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

}  // namespace pinode
