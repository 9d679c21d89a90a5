#include "pinode/study/problem/make_problem.h"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/study/problem/network_scales.h"
#include "pinode/study/problem/substeps.h"

namespace pinode {
namespace {

bool IsInputOf(const StructuralModel& model, const InputSpec& input,
               std::string* error) {
  int size = 0;
  bool dof = false;
  switch (input.kind) {
    case InputSpec::Kind::kGroundAcceleration:
    case InputSpec::Kind::kGroundDisplacement:
      size = model.num_directions();
      break;
    case InputSpec::Kind::kForce:
    case InputSpec::Kind::kPrescribedDisplacement:
    case InputSpec::Kind::kPrescribedVelocity:
    case InputSpec::Kind::kPrescribedAcceleration:
      dof = true;
      size = model.num_dofs();
      break;
    case InputSpec::Kind::kCovariate:
    case InputSpec::Kind::kRecordSwitch:
      return true;
  }
  if (input.index >= 0 && input.index < size) return true;
  *error = "input '" + input.name + "': the model has no " +
           std::string(dof ? "DOF" : "direction") + " " +
           std::to_string(input.index) + ", expected 0 to " +
           std::to_string(size - 1);
  return false;
}

// Fields of a record that SetSubsteps changes.
struct Steps {
  int substeps;
  bool chosen;
  std::optional<Integrator> integrator;
  int exponential_steps;
};

bool Prepare(IdentificationProblem* problem, std::string* error) {
  // A problem is valid only with steps, and steps are chosen for valid
  // problems.
  std::vector<size_t> to_choose;
  for (size_t r = 0; r < problem->records.size(); ++r) {
    if (problem->records[r].substeps != 0) continue;
    to_choose.push_back(r);
    problem->records[r].substeps = 1;
  }
  if (!problem->IsValid(error)) return false;
  for (const size_t r : to_choose) problem->records[r].substeps = 0;
  std::vector<SubstepChoice> choices;
  int failed = 0;
  if (SetSubsteps(problem, &choices, &failed, error)) {
    if (HasNetworksToScale(*problem->dynamics)) {
      auto scaled = std::make_shared<StructuralDynamics>(*problem->dynamics);
      ScaleNetworks(*problem, scaled.get());
      problem->dynamics = std::move(scaled);
    }
    FixTrainingStarts(problem);
    return true;
  }
  *error = "record '" + problem->records[static_cast<size_t>(failed)].name +
           "': " + *error;
  return false;
}

}  // namespace

GroupTerm MakeFreeGroup(const std::string& name, MatrixGroup::Target target,
                        const Matrix& matrix) {
  GroupTerm term;
  term.group = {name, target, matrix};
  term.alpha.name = name;
  return term;
}

MeasuredChannel MakeMeasuredChannel(const std::string& name, Quantity quantity,
                                    const Vector& weights,
                                    const Vector& values) {
  MeasuredChannel channel;
  channel.observation = {name, quantity, weights};
  channel.values = values;
  return channel;
}

std::vector<MeasuredChannel> MakeChannels(const std::string& prefix,
                                          Quantity quantity,
                                          const Matrix& values) {
  std::vector<MeasuredChannel> channels;
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    channels.push_back(
        MakeMeasuredChannel(prefix + std::to_string(i + 1), quantity,
                            Vector::Unit(values.cols(), i), values.col(i)));
  }
  return channels;
}

std::vector<InputSpec> GroundMotion(const StructuralModel& model) {
  std::vector<InputSpec> inputs;
  for (int i = 0; i < model.num_directions(); ++i) {
    inputs.push_back({InputSpec::Kind::kGroundAcceleration, i,
                      "ground_" + model.directions[static_cast<size_t>(i)]});
  }
  return inputs;
}

bool MakeProblem(const StructuralModel& model,
                 const std::vector<InputSpec>& inputs,
                 const StructureTerms& terms, IdentificationProblem* problem,
                 std::string* error) {
  CHECK(problem != nullptr);
  if (!model.IsValid(error)) return false;
  for (const InputSpec& input : inputs) {
    if (!IsInputOf(model, input, error)) return false;
  }
  IdentificationProblem result;
  if (!Assemble(model, inputs, terms, &result.dynamics, error)) return false;
  result.sensors.name = "sensors";
  *problem = std::move(result);
  return true;
}

bool AddRecord(const std::string& name, double step, const Matrix& inputs,
               Interpolation interpolation,
               const std::vector<MeasuredChannel>& channels,
               IdentificationProblem* problem, std::string* error) {
  CHECK(problem != nullptr);
  const std::string prefix = "record '" + name + "': ";
  if (problem->dynamics == nullptr) {
    *error = prefix + "there is no model yet";
    return false;
  }
  if (inputs.rows() != problem->dynamics->num_inputs() || inputs.cols() < 2) {
    *error = prefix + "its inputs are " + std::to_string(inputs.rows()) +
             " x " + std::to_string(inputs.cols()) + ", expected " +
             std::to_string(problem->dynamics->num_inputs()) +
             " rows and at least two samples";
    return false;
  }
  if (!(step > 0.0) || !std::isfinite(step) || !inputs.allFinite()) {
    *error = prefix + "its step is not positive, or an input not finite";
    return false;
  }
  IdentificationRecord record;
  record.name = name;
  record.excitation.emplace(0.0, step, inputs, interpolation);
  record.start = IdentificationRecord::Start::kRest;
  record.channels = channels;
  problem->records.push_back(std::move(record));
  return true;
}

bool PrepareProblem(IdentificationProblem* problem, std::string* error) {
  CHECK(problem != nullptr);
  CHECK(error != nullptr);
  std::vector<Steps> before;
  for (const IdentificationRecord& record : problem->records) {
    before.push_back({record.substeps, record.substeps_chosen,
                      record.integrator, record.exponential_steps});
  }
  if (Prepare(problem, error)) return true;
  for (size_t r = 0; r < before.size(); ++r) {
    problem->records[r].substeps = before[r].substeps;
    problem->records[r].substeps_chosen = before[r].chosen;
    problem->records[r].integrator = before[r].integrator;
    problem->records[r].exponential_steps = before[r].exponential_steps;
  }
  return false;
}

}  // namespace pinode
