#include <ceres/jet.h>

#include <utility>
#include <vector>

#include "pinode/dynamics/described_term.h"
#include "pinode/dynamics/products.h"
#include "pinode/dynamics/unknown_force.h"

namespace pinode {
namespace {

struct LinearizedForce : TermLinearization {
  ForceHistory::Local local;  // times the force's input
};

class UnknownForceDynamics final
    : public ColumnTerm<UnknownForceDynamics, UnknownForceTerm,
                        &UnknownForceTerm::parameters> {
 public:
  using ColumnTerm::ColumnTerm;

  TermKind kind() const override { return TermKind::kUnknownForce; }

  bool IsValid(const StructuralModel& model, int num_inputs,
               std::string* error) const override {
    const UnknownForceTerm& term = description_;
    if (term.history == nullptr) {
      *error = "'" + term.name + "' has no history";
      return false;
    }
    if (term.outputs.size() != model.num_dofs() ||
        term.parameters.size() != term.history->num_parameters()) {
      *error = "'" + term.name +
               "': numbers of DOFs or parameters do not fit the force";
      return false;
    }
    if (!term.outputs.allFinite()) {
      *error = "'" + term.name + "': its outputs are not finite";
      return false;
    }
    if (term.input < -1 || term.input >= num_inputs) {
      *error = "'" + term.name + "' uses an input that does not exist";
      return false;
    }
    if (!term.prior.IsValid(term.parameters.size(), num_free(), error)) {
      *error = "'" + term.name + "': " + *error;
      return false;
    }
    return term.parameters.IsValid(error);
  }

  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* /*parameters*/) const override {
    auto prepared = std::make_unique<TermPrepared>();
    prepared->output_map = linear.mass_inverse * description_.outputs;
    return prepared;
  }

  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& /*place*/) const override {
    return std::make_unique<LinearizedForce>();
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* scratch) const override {
    ForceHistory::Local& local = static_cast<LinearizedForce*>(scratch)->local;
    local = ForceHistory::Local();
    const double factor = Switch(at.input);
    if (factor == 0.0) return;
    local = description_.history->Evaluate(at.time, at.parameters);
    local.value *= factor;
    for (double& derivative : local.derivatives) derivative *= factor;
    AddForce(prepared, local.value, rate);
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override {
    const double factor = Switch(at.input);
    if (factor == 0.0) return;
    const WideJet value =
        factor * description_.history->Evaluate(at.time, at.parameters);
    AddForce(prepared, value, rate);
  }

  // The term does not depend on the state.
  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* /*jacobian*/,
                 TermLinearization* kept) const override {
    AddRate(prepared, at, rate, kept);
  }

  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& prepared,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* scratch,
                            double* result) const override {
    if (num_free() == 0) return;
    for (int s = 0; s < num_stages; ++s) {
      const ForceHistory::Local& local =
          static_cast<const LinearizedForce&>(*stages[s]).local;
      if (local.count == 0) continue;
      const Vector& mapped =
          MapColumn(place, *lefts[s], prepared.output_map.col(0), scratch);
      for (int p = 0; p < local.count; ++p) {
        AddToColumn(local.first + p, mapped, local.derivatives[p], result);
      }
    }
  }

 private:
  double Switch(const double* input) const {
    return description_.input < 0 ? 1.0 : input[description_.input];
  }

  template <typename T>
  void AddForce(const TermPrepared& prepared, const T& value,
                TermRate<T>* rate) const {
    AddScaled(prepared.output_map.col(0), value, rate->acceleration);
    AddScaled(prepared.output_map.col(0), value, rate->force_acceleration);
  }
};

}  // namespace

std::unique_ptr<Term> MakeTerm(UnknownForceTerm force) {
  return std::make_unique<UnknownForceDynamics>(std::move(force));
}

}  // namespace pinode
