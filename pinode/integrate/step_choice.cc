#include "pinode/integrate/step_choice.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Inside this radius the left half of the stability region is a half disc to
// plotting accuracy; the region's own limits are 2.785 and 2.828.
constexpr double kRadius = 2.5;

double Growth(std::complex<double> z) {
  return std::abs(1.0 +
                  z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))));
}

}  // namespace

int StableSubsteps(const Matrix& state_matrix, double sampling_step) {
  const double largest = state_matrix.eigenvalues().cwiseAbs().maxCoeff();
  return std::max(
      1, static_cast<int>(std::ceil(sampling_step * largest / kRadius)));
}

StabilityReport CheckStability(const Matrix& state_matrix, double sampling_step,
                               int substeps) {
  CHECK_GE(substeps, 1);
  StabilityReport report;
  report.substeps = substeps;
  report.step = sampling_step / substeps;
  const Eigen::VectorXcd lambda = state_matrix.eigenvalues();
  for (Eigen::Index i = 0; i < lambda.size(); ++i) {
    report.largest_eigenvalue =
        std::max(report.largest_eigenvalue, std::abs(lambda[i]));
    // Growth of such a mode comes from the structure, not from the method.
    if (lambda[i].real() > 1e-9 * std::abs(lambda[i])) continue;
    report.growth = std::max(report.growth, Growth(report.step * lambda[i]));
  }
  report.stable = report.growth <= 1.0 + 1e-9;
  return report;
}

}  // namespace pinode
