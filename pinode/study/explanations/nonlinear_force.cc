#include "pinode/study/explanations/nonlinear_force.h"

#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/library_function.h"

namespace pinode {

std::vector<Feature> FeaturesOfSpring(int from, int to) {
  if (from < 0) return {Feature::Displacement(to), Feature::Velocity(to)};
  return {Feature::Deformation(from, to), Feature::DeformationRate(from, to)};
}

SpringMotion MotionOfSpring(const StructuralModel& model, const FitSummary& fit,
                            int from, int to) {
  SpringMotion motion;
  for (const Feature& feature : FeaturesOfSpring(from, to)) {
    motion.names.push_back(feature.Name(model.dof_names, {}));
  }
  for (const RecordScore& record : fit.records) {
    if (record.role != IdentificationRecord::Role::kTrain || !record.finite) {
      continue;
    }
    const auto relative = [&](int offset) {
      Vector value = record.states.row(offset + to).transpose();
      if (from >= 0) value -= record.states.row(offset + from).transpose();
      return value;
    };
    const Eigen::Index before = motion.rate.size();
    const Eigen::Index count = record.states.cols();
    motion.deformation.conservativeResize(before + count);
    motion.rate.conservativeResize(before + count);
    motion.deformation.tail(count) = relative(0);
    motion.rate.tail(count) = relative(model.num_dofs());
  }
  return motion;
}

Vector SpringMotion::Values(const std::string& basis) const {
  LibraryFunction function;
  std::string error;
  CHECK(LibraryFunction::Parse(basis, names, &function, &error)) << error;
  Vector values(rate.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double q[2] = {deformation[i], rate[i]};
    values[i] = function.Evaluate(q);
  }
  return values;
}

std::vector<NonlinearForce> NonlinearForcesAt(const StructuralModel& model,
                                              const FitSummary& fit, int from,
                                              int to, double stiffness,
                                              const std::string& name) {
  const SpringMotion motion = MotionOfSpring(model, fit, from, to);
  const double force = stiffness * RmsOfPresent(motion.deformation);
  const double rate = RmsOfPresent(motion.rate);
  std::vector<NonlinearForce> forces;
  if (!(force > 0.0) || !(rate > 0.0)) return forces;
  std::string output = model.dof_names[static_cast<size_t>(to)];
  if (from >= 0) output += "-" + model.dof_names[static_cast<size_t>(from)];
  const std::string& d = motion.names[0];
  const std::string& v = motion.names[1];
  const std::vector<std::pair<std::string, std::string>> forms = {
      {"opening", "abs(" + d + ")"},
      {"hardening", d + "^3"},
      {"friction", "tanh(" + v + "/" + FormatNumber(0.1 * rate, 6) + ")"},
      {"drag", "abs(" + v + ")*" + v}};
  for (const auto& [form, basis] : forms) {
    NonlinearForce one;
    one.form = form;
    one.unit = force / RmsOfPresent(motion.Values(basis));
    if (!std::isfinite(one.unit)) continue;
    one.spec.name = name + "." + form;
    one.spec.features = FeaturesOfSpring(from, to);
    one.spec.output = output;
    one.spec.acts_as = ActsAs::kForce;
    one.spec.coefficients.resize(1);
    one.spec.coefficients[0].basis = basis;
    one.spec.coefficients[0].parameter.prior_sigma = one.unit;
    forces.push_back(std::move(one));
  }
  return forces;
}

}  // namespace pinode
