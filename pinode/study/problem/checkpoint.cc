#include "pinode/study/problem/checkpoint.h"

#include <cstdint>

#include "pinode/base/fnv.h"
#include "pinode/dynamics/memory_network.h"

namespace pinode {
namespace {

class Hash {
 public:
  void Add(const void* data, size_t size) {
    state_ = Fnv1a(data, size, state_);
  }
  void Add(const std::string& text) {
    Add(static_cast<std::int64_t>(text.size()));
    Add(text.data(), text.size());
  }
  void Add(std::int64_t value) { Add(&value, sizeof(value)); }
  void Add(double value) { Add(&value, sizeof(value)); }
  void Add(const Matrix& matrix) {
    Add(static_cast<std::int64_t>(matrix.rows()));
    Add(static_cast<std::int64_t>(matrix.cols()));
    Add(matrix.data(), sizeof(double) * static_cast<size_t>(matrix.size()));
  }
  void Add(const ParameterBlock& block) {
    Add(block.name);
    Add(static_cast<std::int64_t>(block.size()));
    // Initial weights of a network depend on a seed, which may change.
    if (!block.named) return;
    for (const Parameter& p : block.parameters) {
      Add(p.name);
      for (const double value :
           {p.value, p.lower, p.upper, p.prior_mean, p.prior_sigma}) {
        Add(value);
      }
      Add(static_cast<std::int64_t>(p.free));
      if (p.IsTied()) {
        Add(p.tie);
        Add(p.tie_factor);
      }
    }
  }

  std::string Text() const {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (int shift = 60; shift >= 0; shift -= 4) {
      text += kDigits[(state_ >> shift) & 15];
    }
    return text;
  }

 private:
  std::uint64_t state_ = kFnvStart;
};

void Add(const StructuralDynamics& dynamics, Hash* hash) {
  const StructuralModel& model = dynamics.model();
  for (const std::string& name : model.dof_names) hash->Add(name);
  hash->Add(model.mass);
  hash->Add(model.damping);
  hash->Add(model.stiffness);
  hash->Add(model.influence);
  hash->Add(model.support_mass_coupling);
  for (const GroupTerm& term : dynamics.groups()) {
    hash->Add(static_cast<std::int64_t>(term.group.target));
    hash->Add(term.group.matrix);
    if (term.follows == GroupTerm::Follows::kNothing) continue;
    hash->Add(static_cast<std::int64_t>(term.follows));
    hash->Add(static_cast<std::int64_t>(term.input));
    hash->Add(term.reference);
  }
  for (const LawTerm& term : dynamics.laws()) {
    hash->Add(term.type);
    if (!term.identity.empty()) hash->Add(term.identity);
    hash->Add(term.outputs);
    hash->Add(static_cast<std::int64_t>(term.acts_as));
    const MemoryNetwork* network = AsMemoryNetwork(term);
    if (network == nullptr) continue;
    // The weights are relative to these.
    hash->Add(network->scaled_shape().deformation);
    hash->Add(network->scaled_shape().rate);
    hash->Add(network->scaled_shape().force);
  }
  for (const UnknownForceTerm& term : dynamics.unknown_forces()) {
    hash->Add(term.history->Description());
    hash->Add(Matrix(term.outputs));
    hash->Add(static_cast<std::int64_t>(term.input));
    for (const CombinationPrior::Combination& c : term.prior.combinations) {
      hash->Add(static_cast<std::int64_t>(c.group));
      hash->Add(Matrix(c.weights));
    }
    for (const double precision : term.prior.precisions) hash->Add(precision);
  }
  for (const GroupCurve& curve : dynamics.group_curves()) {
    hash->Add(curve.name);
    for (const double knot : curve.knots) hash->Add(knot);
    hash->Add(static_cast<std::int64_t>(curve.input));
    hash->Add(static_cast<std::int64_t>(curve.reference));
    for (const CombinationPrior::Combination& c : curve.prior.combinations) {
      hash->Add(Matrix(c.weights));
    }
    for (const double precision : curve.prior.precisions) hash->Add(precision);
  }
  for (const ForceScaleTerm& term : dynamics.force_scales()) {
    for (const ForceScaleTerm::Force& force : term.forces) {
      hash->Add(static_cast<std::int64_t>(force.input));
      hash->Add(static_cast<std::int64_t>(force.record_switch));
    }
  }
  for (const NetworkTerm& term : dynamics.networks()) {
    const NetworkArchitecture& architecture = term.network->architecture();
    for (const int width : architecture.hidden_widths) {
      hash->Add(static_cast<std::int64_t>(width));
    }
    hash->Add(static_cast<std::int64_t>(architecture.activation));
    hash->Add(static_cast<std::int64_t>(architecture.gauge));
    hash->Add(term.outputs);
    for (const Vector* scale :
         {&architecture.input_scale, &architecture.output_scale}) {
      // An empty scale means ones, and is read back as ones.
      if (scale->size() > 0 && (scale->array() != 1.0).any()) {
        hash->Add(Matrix(*scale));
      }
    }
  }
  for (const ParameterBlock& block : dynamics.blocks()) {
    hash->Add(block);
  }
}

void Add(const IdentificationRecord& record, Hash* hash) {
  hash->Add(record.name);
  hash->Add(static_cast<std::int64_t>(record.role));
  hash->Add(static_cast<std::int64_t>(record.start));
  // Chosen steps are chosen again, and refined at the fit.
  if (!record.substeps_chosen) {
    hash->Add(static_cast<std::int64_t>(record.substeps));
  }
  if (record.integrator.has_value()) {
    hash->Add(IntegratorName(*record.integrator));
  }
  if (record.exponential_steps > 0 && !record.substeps_chosen) {
    hash->Add(static_cast<std::int64_t>(record.exponential_steps));
  }
  hash->Add(record.sampling_step());
  hash->Add(record.excitation->samples());
  for (const MeasuredChannel& channel : record.channels) {
    hash->Add(channel.observation.name);
    hash->Add(static_cast<std::int64_t>(channel.observation.quantity));
    hash->Add(Matrix(channel.observation.weights));
    hash->Add(Matrix(channel.values));
    hash->Add(channel.sigma);
    hash->Add(static_cast<std::int64_t>(channel.fit));
  }
}

void Add(const ModalData& modal, Hash* hash) {
  if (!modal.empty()) {
    hash->Add(static_cast<std::int64_t>(modal.form));
    if (modal.inputs.size() > 0) hash->Add(Matrix(modal.inputs));
  }
  for (const MeasuredMode& mode : modal.modes) {
    hash->Add(mode.name);
    for (const double value :
         {mode.frequency, mode.frequency_sigma, mode.frequency_weight,
          mode.shape_sigma, mode.shape_weight, mode.residual_weight}) {
      hash->Add(value);
    }
    for (const int dof : mode.dofs) hash->Add(static_cast<std::int64_t>(dof));
    hash->Add(Matrix(mode.shape));
    if (mode.shape_covariance.size() > 0) hash->Add(mode.shape_covariance);
    if (mode.frequency_shape_covariance.size() > 0) {
      hash->Add(Matrix(mode.frequency_shape_covariance));
    }
  }
}

void Add(const AmbientRecord& record, Hash* hash) {
  hash->Add(record.name);
  hash->Add(record.sampling_step);
  for (const Observation& channel : record.channels) {
    hash->Add(channel.name);
    hash->Add(static_cast<std::int64_t>(channel.quantity));
    hash->Add(Matrix(channel.weights));
  }
  hash->Add(record.samples);
  hash->Add(record.loads);
  if (record.base.size() > 0) hash->Add(record.base);
  if (record.inputs.has_value()) {
    hash->Add(record.inputs->start_time());
    hash->Add(record.inputs->samples());
    hash->Add(static_cast<std::int64_t>(record.inputs->interpolation()));
  }
  for (const double value :
       {record.correlated ? 1.0 : 0.0, static_cast<double>(record.knots),
        record.lowest_frequency, record.highest_frequency}) {
    hash->Add(value);
  }
}

void Add(const FrfRecord& record, Hash* hash) {
  hash->Add(record.name);
  hash->Add(Matrix(record.frequencies));
  for (const Observation& response : record.responses) {
    hash->Add(response.name);
    hash->Add(static_cast<std::int64_t>(response.quantity));
    hash->Add(Matrix(response.weights));
  }
  hash->Add(record.references);
  hash->Add(Matrix(record.values.real()));
  hash->Add(Matrix(record.values.imag()));
  hash->Add(record.variances);
  hash->Add(Matrix(record.sigma));
  hash->Add(static_cast<std::int64_t>(record.loss_factor));
  for (const std::vector<int>* indices : {&record.gains, &record.delays}) {
    for (const int index : *indices) {
      hash->Add(static_cast<std::int64_t>(index));
    }
  }
}

}  // namespace

std::string ProblemHash(const IdentificationProblem& problem) {
  Hash hash;
  Add(*problem.dynamics, &hash);
  hash.Add(problem.sensors);
  for (const IdentificationRecord& record : problem.records) {
    Add(record, &hash);
  }
  Add(problem.modal, &hash);
  for (const AmbientRecord& record : problem.ambient) Add(record, &hash);
  for (const FrfRecord& record : problem.frfs) Add(record, &hash);
  return hash.Text();
}

std::string ProblemIdentity(const IdentificationProblem& problem) {
  const std::string& known_as = problem.description.known_as;
  return known_as.empty() ? ProblemHash(problem) : known_as;
}

}  // namespace pinode
