#include "pinode/problem/problem_description.h"

#include <cmath>

#include "pinode/base/strings.h"

namespace pinode {

double ProblemDescription::HzPerModelFrequency() const {
  double factor = 1.0;
  std::string error;
  return UnitFactor("s", Dimension::kTime, units, &factor, &error) ? factor
                                                                   : 1.0;
}

bool ProblemDescription::IsValid(std::string* error) const {
  if (!units.IsValid(error)) return false;
  for (const ForceTruth& truth : force_truths) {
    if (truth.values.size() != truth.times.size() ||
        !truth.values.allFinite() || !truth.times.allFinite()) {
      *error = "the truth of force '" + truth.name +
               "' needs as many finite values as times";
      return false;
    }
  }
  for (const ReferenceCurve& curve : reference_curves) {
    if (curve.force.size() != curve.deformation.size() ||
        !curve.force.allFinite() || !curve.deformation.allFinite()) {
      *error = "the curve '" + curve.name +
               "' needs as many finite forces as deformations";
      return false;
    }
  }
  return true;
}

Dimension DimensionOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::kDisplacement:
    case Quantity::kAbsoluteDisplacement:
      return Dimension::kLength;
    case Quantity::kVelocity:
      return Dimension::kVelocity;
    case Quantity::kRelativeAcceleration:
    case Quantity::kAbsoluteAcceleration:
      return Dimension::kAcceleration;
    case Quantity::kForce:
      return Dimension::kForce;
    case Quantity::kStrain:
      return Dimension::kNumber;
  }
  return Dimension::kNumber;
}

std::string LocationText(const Vector& weights,
                         const std::vector<std::string>& dof_names) {
  std::string text;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const double weight = weights[i];
    if (weight == 0.0) continue;
    if (!text.empty()) {
      text += weight < 0.0 ? " - " : " + ";
    } else if (weight < 0.0) {
      text += "-";
    }
    if (std::abs(weight) != 1.0) {
      text += FormatNumber(std::abs(weight), 4) + " ";
    }
    text += dof_names.at(static_cast<size_t>(i));
  }
  return text;
}

}  // namespace pinode
