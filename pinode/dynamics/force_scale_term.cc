#include "pinode/dynamics/force_scale_term.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pinode/dynamics/described_term.h"
#include "pinode/dynamics/products.h"

namespace pinode {
namespace {

struct LinearizedScale : TermLinearization {
  Vector acceleration;  // num_dofs: by the forces at scale 1
};

class ForceScaleDynamics final
    : public ColumnTerm<ForceScaleDynamics, ForceScaleTerm,
                        &ForceScaleTerm::parameters> {
 public:
  ForceScaleDynamics(ForceScaleTerm scale, std::vector<int> dofs)
      : ColumnTerm(std::move(scale)), dofs_(std::move(dofs)) {}

  TermKind kind() const override { return TermKind::kForceScale; }

  bool IsValid(const StructuralModel& model, int num_inputs,
               std::string* error) const override {
    const ForceScaleTerm& term = description_;
    if (term.parameters.size() != 1) {
      *error = "'" + term.name + "' has " +
               std::to_string(term.parameters.size()) +
               " parameters, expected only its scale";
      return false;
    }
    for (size_t i = 0; i < term.forces.size(); ++i) {
      const ForceScaleTerm::Force& force = term.forces[i];
      if (force.input >= num_inputs || force.record_switch < -1 ||
          force.record_switch >= num_inputs || dofs_[i] >= model.num_dofs()) {
        *error =
            "'" + term.name + "' uses an input or a DOF that does not exist";
        return false;
      }
    }
    return term.parameters.IsValid(error);
  }

  // Computes the acceleration for a unit of each force.
  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* /*parameters*/) const override {
    auto prepared = std::make_unique<TermPrepared>();
    prepared->output_map.resize(linear.mass_inverse.rows(),
                                static_cast<Eigen::Index>(dofs_.size()));
    for (size_t i = 0; i < dofs_.size(); ++i) {
      prepared->output_map.col(static_cast<Eigen::Index>(i)) =
          linear.mass_inverse.col(dofs_[i]);
    }
    return prepared;
  }

  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const override {
    auto linearization = std::make_unique<LinearizedScale>();
    linearization->acceleration = Vector::Zero(place.num_dofs);
    return linearization;
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* scratch) const override {
    Vector& unscaled = static_cast<LinearizedScale*>(scratch)->acceleration;
    SetUnscaled(prepared, at.input, &unscaled);
    AddForces(unscaled, at.parameters[0] - 1.0, rate);
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override {
    Vector unscaled(at.place.num_dofs);
    SetUnscaled(prepared, at.input, &unscaled);
    AddForces(unscaled, WideJet(at.parameters[0] - 1.0), rate);
  }

  // The term does not depend on the state.
  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* /*jacobian*/,
                 TermLinearization* kept) const override {
    AddRate(prepared, at, rate, kept);
  }

  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& /*prepared*/,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* scratch,
                            double* result) const override {
    if (num_free() == 0) return;
    for (int s = 0; s < num_stages; ++s) {
      const auto& kept = static_cast<const LinearizedScale&>(*stages[s]);
      AddToColumn(0, MapColumn(place, *lefts[s], kept.acceleration, scratch),
                  1.0, result);
    }
  }

 private:
  // Sets *acceleration to the effect of the forces at scale 1.
  void SetUnscaled(const TermPrepared& prepared, const double* input,
                   Vector* acceleration) const {
    acceleration->setZero();
    for (size_t i = 0; i < dofs_.size(); ++i) {
      const ForceScaleTerm::Force& force = description_.forces[i];
      const double on =
          force.record_switch < 0 ? 1.0 : input[force.record_switch];
      if (on == 0.0) continue;
      AddScaled(prepared.output_map.col(static_cast<Eigen::Index>(i)),
                on * input[force.input], acceleration->data());
    }
  }

  template <typename T>
  void AddForces(const Vector& unscaled, const T& factor,
                 TermRate<T>* rate) const {
    AddScaled(unscaled, factor, rate->acceleration);
    AddScaled(unscaled, factor, rate->force_acceleration);
  }

  std::vector<int> dofs_;  // at which each force acts
};

}  // namespace

std::unique_ptr<Term> MakeTerm(ForceScaleTerm scale,
                               const std::vector<InputSpec>& inputs,
                               std::string* error) {
  std::vector<int> dofs;
  for (const ForceScaleTerm::Force& force : scale.forces) {
    if (force.input < 0 || force.input >= static_cast<int>(inputs.size()) ||
        inputs[static_cast<size_t>(force.input)].kind !=
            InputSpec::Kind::kForce) {
      *error = "'" + scale.name + "' is the scale of input " +
               std::to_string(force.input) + ", which is not a measured force";
      return nullptr;
    }
    dofs.push_back(inputs[static_cast<size_t>(force.input)].index);
  }
  if (dofs.empty()) {
    *error = "'" + scale.name + "' is the scale of no force";
    return nullptr;
  }
  return std::make_unique<ForceScaleDynamics>(std::move(scale),
                                              std::move(dofs));
}

}  // namespace pinode
