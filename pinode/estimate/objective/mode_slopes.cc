#include "pinode/estimate/objective/mode_slopes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace pinode {
namespace {

// Frequencies that differ by less than this (relative, in w^2) count as equal:
// shapes carry the rounding of the matrices divided by it.
constexpr double kSameFrequency = 1e-8;
// Coupling of two modes that counts as zero, as a share of the matrix's effect
// on either.
constexpr double kUncoupled = 1e-8;

}  // namespace

bool PartsOfSlope(const UndampedModes& modes, int j,
                  const std::vector<int>& left_out, const Matrix& matrix,
                  bool on_mass, Vector* parts, std::string* error) {
  const int n = static_cast<int>(modes.eigenvalues.size());
  const double rounding = 8.0 * n * std::numeric_limits<double>::epsilon() *
                          modes.eigenvalues.cwiseAbs().maxCoeff();
  const double eigenvalue = modes.eigenvalues[j];
  const double factor = on_mass ? -eigenvalue : 1.0;
  *parts = modes.shapes.transpose() * (factor * (matrix * modes.shapes.col(j)));
  const double own = std::abs((*parts)[j]);
  for (const int k : left_out) (*parts)[k] = 0.0;
  (*parts)[j] = 0.0;
  for (int k = 0; k < n; ++k) {
    double& part = (*parts)[k];
    if (part == 0.0) continue;
    const double distance = eigenvalue - modes.eigenvalues[k];
    if (std::abs(distance) > rounding + kSameFrequency * std::abs(eigenvalue)) {
      part /= distance;
      continue;
    }
    const auto other = modes.shapes.col(k);
    const double size =
        std::max(own, std::abs(factor * other.dot(matrix * other)));
    if (std::abs(part) > kUncoupled * size) {
      std::ostringstream message;
      message << "modes " << std::min(j, k) + 1 << " and " << std::max(j, k) + 1
              << " of the model have the same frequency, and a free group "
                 "mixes their shapes. Derivatives do not exist. Start from "
                 "slightly different values of the groups";
      *error = message.str();
      return false;
    }
    part = 0.0;
  }
  return true;
}

bool DifferentiateMode(const UndampedModes& modes, int j,
                       const std::vector<int>& dofs, const Matrix& matrix,
                       bool on_mass, int column, ModeSlopes* slopes,
                       std::string* error) {
  Vector parts;
  if (!PartsOfSlope(modes, j, {}, matrix, on_mass, &parts, error)) return false;
  const auto shape = modes.shapes.col(j);
  slopes->eigenvalue[column] =
      (on_mass ? -modes.eigenvalues[j] : 1.0) * shape.dot(matrix * shape);
  slopes->shape.col(column) = modes.shapes(dofs, Eigen::all) * parts;
  return true;
}

}  // namespace pinode
