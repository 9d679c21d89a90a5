#include "pinode/structure/model/damping.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
Matrix RayleighDamping(const Matrix& mass, const Matrix& stiffness,
                       const RayleighCoefficients& coefficients) {
  CHECK(mass.rows() == stiffness.rows() && mass.cols() == stiffness.cols())
      << "M is " << mass.rows() << " x " << mass.cols() << ", K "
      << stiffness.rows() << " x " << stiffness.cols()
      << "; both must have the same size";
  return coefficients.mass * mass + coefficients.stiffness * stiffness;
}

bool RayleighFromRatios(double frequency_a_hz, double ratio_a,
                        double frequency_b_hz, double ratio_b,
                        RayleighCoefficients* coefficients,
                        std::string* error) {
  CHECK(coefficients != nullptr);
  CHECK(error != nullptr);
  for (const double frequency : {frequency_a_hz, frequency_b_hz}) {
    if (std::isfinite(frequency) && frequency > 0.0) continue;
    *error = "Rayleigh damping: the frequency is " +
             FormatNumber(frequency, 6) + " Hz, expected a positive number";
    return false;
  }
  for (const double ratio : {ratio_a, ratio_b}) {
    if (std::isfinite(ratio) && ratio >= 0.0) continue;
    *error = "Rayleigh damping: the damping ratio is " +
             FormatNumber(ratio, 6) + ", expected zero or more";
    return false;
  }
  if (frequency_a_hz == frequency_b_hz) {
    *error = "Rayleigh damping: both frequencies are " +
             FormatNumber(frequency_a_hz, 6) +
             " Hz, expected two different ones";
    return false;
  }
  // zeta = a0 / (2 w) + a1 w / 2 at both frequencies, by Cramer's rule.
  const double w_a = kTwoPi * frequency_a_hz;
  const double w_b = kTwoPi * frequency_b_hz;
  const double determinant = w_b * w_b - w_a * w_a;
  const double a0 =
      2.0 * w_a * w_b * (ratio_a * w_b - ratio_b * w_a) / determinant;
  const double a1 = 2.0 * (ratio_b * w_b - ratio_a * w_a) / determinant;
  if (!std::isfinite(a0) || !std::isfinite(a1)) {
    *error = "Rayleigh damping: no coefficients for " +
             FormatNumber(frequency_a_hz, 6) + " Hz and " +
             FormatNumber(frequency_b_hz, 6) +
             " Hz; frequencies of the structure's modes were expected";
    return false;
  }
  // Exactly mass- or stiffness-proportional damping must not be refused because
  // of rounding.
  const double rounding = 1e-14 * (ratio_a + ratio_b);
  if (a0 < -rounding * (w_a + w_b) || a1 < -rounding / (w_a + w_b)) {
    *error = std::string("Rayleigh damping: the ") +
             (a0 < 0.0 ? "mass" : "stiffness") +
             " coefficient comes out negative (a0 = " + FormatNumber(a0, 6) +
             ", a1 = " + FormatNumber(a1, 6) + "), so modes " +
             (a0 < 0.0 ? "below" : "above") +
             " the two frequencies could gain energy; choose ratios that "
             "differ less, or modal damping ratios";
    return false;
  }
  coefficients->mass = std::max(a0, 0.0);
  coefficients->stiffness = std::max(a1, 0.0);
  return true;
}

bool ModalDamping(const Matrix& mass, const Matrix& stiffness,
                  const Vector& ratios, Matrix* damping, std::string* error) {
  CHECK(damping != nullptr);
  CHECK(error != nullptr);
  const Eigen::Index n = mass.rows();
  if (ratios.size() == 0 || ratios.size() > n) {
    *error = "modal damping: " + std::to_string(ratios.size()) +
             " damping ratios, expected 1 to " + std::to_string(n) +
             ", one a mode";
    return false;
  }
  for (Eigen::Index i = 0; i < ratios.size(); ++i) {
    if (std::isfinite(ratios[i]) && ratios[i] >= 0.0) continue;
    *error = "modal damping: ratio " + std::to_string(i + 1) + " is " +
             FormatNumber(ratios[i], 6) + ", expected zero or more";
    return false;
  }
  ModalProperties modes;
  if (!ComputeModes(mass, Matrix::Zero(n, n), stiffness, &modes, error)) {
    return false;
  }
  Vector modal_damping(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::isnan(modes.frequency_hz[i])) {
      *error = "the stiffness matrix is not positive semidefinite: mode " +
               std::to_string(i + 1) +
               " has a negative stiffness, so modal damping has no frequency. "
               "Check its entries, or give a damping matrix";
      return false;
    }
    modal_damping[i] = 2.0 * ratios[std::min(i, ratios.size() - 1)] * kTwoPi *
                       modes.frequency_hz[i];
  }
  const Matrix mass_times_shapes = mass * modes.mode_shapes;
  const Matrix product = mass_times_shapes * modal_damping.asDiagonal() *
                         mass_times_shapes.transpose();
  // Equal up to rounding; exactly, so that files of it are symmetric.
  *damping = 0.5 * (product + product.transpose());
  return true;
}

bool DampingOfModes(const Matrix& mass, const Matrix& stiffness, int first,
                    int last, double ratio, Matrix* damping,
                    std::string* error) {
  const int n = static_cast<int>(mass.rows());
  if (last == 0) last = n;
  if (first < 1 || first > last || last > n) {
    *error = "modal damping: no mode " +
             std::to_string(first < 1 || first > n ? first : last) +
             ", expected 1 to " + std::to_string(n);
    return false;
  }
  Vector ratios = Vector::Zero(n);
  ratios.segment(first - 1, last - first + 1).setConstant(ratio);
  return ModalDamping(mass, stiffness, ratios, damping, error);
}

bool DampingBy(const DampingRule& rule, const Matrix& mass,
               const Matrix& stiffness, Matrix* damping, std::string* error) {
  switch (rule.kind) {
    case DampingRule::Kind::kNone:
      *damping = Matrix::Zero(mass.rows(), mass.cols());
      return true;
    case DampingRule::Kind::kRayleigh:
      *damping = RayleighDamping(mass, stiffness, rule.rayleigh);
      return true;
    case DampingRule::Kind::kRatios:
      return ModalDamping(mass, stiffness, rule.ratios, damping, error);
    case DampingRule::Kind::kMatrix:
      break;
  }
  if (rule.matrix.rows() != mass.rows() || rule.matrix.cols() != mass.cols()) {
    *error = "the damping matrix is " + std::to_string(rule.matrix.rows()) +
             " x " + std::to_string(rule.matrix.cols()) + ", expected " +
             std::to_string(mass.rows()) + " x " + std::to_string(mass.cols());
    return false;
  }
  *damping = rule.matrix;
  return true;
}

}  // namespace pinode
