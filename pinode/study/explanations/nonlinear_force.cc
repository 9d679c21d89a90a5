#include "pinode/study/explanations/nonlinear_force.h"

#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/library_function.h"

namespace pinode {
namespace {

// Deformation and its rate, at every sample of the training records.
struct Motion {
  Vector deformation;
  Vector rate;
};

Motion MotionAt(const FitSummary& fit, int num_dofs, int from, int to) {
  Motion motion;
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
    motion.rate.tail(count) = relative(num_dofs);
  }
  return motion;
}

double Rms(const Vector& values) {
  return values.size() == 0 ? 0.0
                            : std::sqrt(values.squaredNorm() /
                                        static_cast<double>(values.size()));
}

Vector Values(const std::string& basis, const std::vector<std::string>& names,
              const Motion& motion) {
  LibraryFunction function;
  std::string error;
  CHECK(LibraryFunction::Parse(basis, names, &function, &error)) << error;
  Vector values(motion.rate.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double q[2] = {motion.deformation[i], motion.rate[i]};
    values[i] = function.Evaluate(q);
  }
  return values;
}

}  // namespace

std::vector<NonlinearForce> NonlinearForcesAt(const StructuralModel& model,
                                              const FitSummary& fit, int from,
                                              int to, double stiffness,
                                              const std::string& name) {
  const Motion motion = MotionAt(fit, model.num_dofs(), from, to);
  const double force = stiffness * Rms(motion.deformation);
  const double rate = Rms(motion.rate);
  std::vector<NonlinearForce> forces;
  if (!(force > 0.0) || !(rate > 0.0)) return forces;
  std::vector<Feature> features = {Feature::Displacement(to),
                                   Feature::Velocity(to)};
  const std::string& end = model.dof_names[static_cast<size_t>(to)];
  std::string output = end;
  if (from >= 0) {
    features = {Feature::Deformation(from, to),
                Feature::DeformationRate(from, to)};
    output += "-" + model.dof_names[static_cast<size_t>(from)];
  }
  const std::string d = features[0].Name(model.dof_names, {});
  const std::string v = features[1].Name(model.dof_names, {});
  const std::vector<std::pair<std::string, std::string>> forms = {
      {"hardening", d + "^3"},
      {"friction", "tanh(" + v + "/" + FormatNumber(0.1 * rate, 6) + ")"},
      {"opening", "abs(" + d + ")"},
      {"drag", "abs(" + v + ")*" + v}};
  for (const auto& [form, basis] : forms) {
    NonlinearForce one;
    one.form = form;
    one.unit = force / Rms(Values(basis, {d, v}, motion));
    if (!std::isfinite(one.unit)) continue;
    one.spec.name = name + "." + form;
    one.spec.features = features;
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
