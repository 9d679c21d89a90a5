#include "pinode/study/problem/substeps.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/observation.h"
#include "pinode/integrate/exponential_step.h"
#include "pinode/integrate/free_run.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/step_choice.h"
#include "pinode/problem/record_grid.h"

namespace pinode {
namespace {

constexpr double kLargestPhase = 0.35;  // step * max|lambda|
constexpr double kSigmaShare = 0.1;
constexpr double kRmsShare = 1e-4;
// Largest refinement. A simulation that six halvings do not bring to its limit
// is chaotic, or grows without bound. Smaller steps do not help then.
constexpr int kLargestRefinement = 64;
// Number of states from which on a product of state size dominates the cost of
// a step.
constexpr int kManyStates = 16;

// Finds the state at the first sample, as far as a simulation needs one.
// Returns false if the record does not determine it.
bool FindStart(const StructuralDynamics& dynamics,
               const IdentificationRecord& record, Vector* start) {
  const int n = dynamics.num_dofs();
  *start = Vector::Zero(dynamics.num_states());
  if (record.start == IdentificationRecord::Start::kRest) return true;
  if (record.start == IdentificationRecord::Start::kKnown) {
    *start = record.known_start;
    return true;
  }
  // Solves y(0) = [W_x 0; 0 W_v] [x; v] over the channels that measure the
  // state itself.
  std::vector<RowVector> rows;
  std::vector<double> values;
  for (const MeasuredChannel& channel : record.channels) {
    const Quantity quantity = channel.observation.quantity;
    if (channel.values.size() == 0 || !std::isfinite(channel.values[0]) ||
        (quantity != Quantity::kDisplacement && quantity != Quantity::kStrain &&
         quantity != Quantity::kVelocity)) {
      continue;
    }
    RowVector row = RowVector::Zero(2 * n);
    row.segment(quantity == Quantity::kVelocity ? n : 0, n) =
        channel.observation.weights.transpose();
    rows.push_back(row);
    values.push_back(channel.values[0]);
  }
  // The response to the excitation does not depend on the start.
  const bool excited = !record.excitation->samples().isZero(0.0);
  if (static_cast<int>(rows.size()) < 2 * n) return excited;
  Matrix map(static_cast<Eigen::Index>(rows.size()), 2 * n);
  Vector measured(map.rows());
  for (Eigen::Index i = 0; i < map.rows(); ++i) {
    map.row(i) = rows[static_cast<size_t>(i)];
    measured[i] = values[static_cast<size_t>(i)];
  }
  const Eigen::ColPivHouseholderQR<Matrix> factor(map);
  if (factor.rank() < 2 * n) return excited;
  start->head(2 * n) = factor.solve(measured);
  return true;
}

// Simulation of the initial model with a given number of steps.
class Prior {
 public:
  // Prepares the simulation; false without a start.
  bool Init(const StructuralDynamics& dynamics,
            const StructuralDynamics::Prepared& prepared,
            const IdentificationRecord& record) {
    dynamics_ = &dynamics;
    prepared_ = &prepared;
    record_ = &record;
    std::vector<Observation> observations;
    for (const MeasuredChannel& channel : record.channels) {
      observations.push_back(channel.observation);
    }
    observation_ = ObservationMap(dynamics, observations);
    return FindStart(dynamics, record, &start_);
  }

  // Simulates, channels x samples; false if the run does not stay finite.
  bool Run(int substeps, Matrix* channels,
           Integrator integrator = Integrator::kRungeKutta) const {
    Trajectory trajectory;
    const IntegrationGrid grid(*record_->excitation, substeps, integrator);
    if (!FreeRun(*dynamics_, *prepared_, observation_, grid, start_, 0,
                 record_->num_samples() - 1, &trajectory, Keep::kChannels)) {
      return false;
    }
    *channels = std::move(trajectory.channels);
    return true;
  }

 private:
  const StructuralDynamics* dynamics_ = nullptr;
  const StructuralDynamics::Prepared* prepared_ = nullptr;
  const IdentificationRecord* record_ = nullptr;
  ObservationMap observation_;
  Vector start_;
};

double RowRms(const RowVector& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

// Finds the channel whose change is largest relative to its limit. Returns true
// if all are within their limits.
bool CompareChannels(const IdentificationRecord& record, const Matrix& coarse,
                     const Matrix& fine, SubstepChoice* choice) {
  double worst = -1.0;
  for (size_t c = 0; c < record.channels.size(); ++c) {
    const MeasuredChannel& channel = record.channels[c];
    if (!channel.fit) continue;
    const Eigen::Index row = static_cast<Eigen::Index>(c);
    // A simulation has no measurement to compare with.
    const double measured_rms = RmsOfPresent(channel.values);
    const double rms =
        std::isfinite(measured_rms) ? measured_rms : RowRms(fine.row(row));
    const double limit =
        channel.sigma > 0.0 ? kSigmaShare * channel.sigma : kRmsShare * rms;
    if (limit == 0.0) continue;  // a dead channel says nothing
    const double error = RowRms(fine.row(row) - coarse.row(row));
    const double ratio = error / limit;
    if (ratio > worst) {
      worst = ratio;
      choice->error = error;
      choice->error_limit = limit;
      choice->channel = channel.observation.name;
    }
  }
  return worst <= 1.0;
}

bool TooCoarse(double needed, const StabilityReport& stability,
               std::string* error) {
  *error = "its sampling is too coarse for the model's highest mode (" +
           FormatNumber(stability.largest_eigenvalue, 4) +
           " rad per unit of time): " + FormatNumber(needed, 4) +
           " Runge-Kutta steps per sample are needed, and at most " +
           std::to_string(kMaxSubsteps) +
           " are possible. Condense the model to fewer degrees of freedom, or "
           "check its units";
  return false;
}

}  // namespace

Matrix StateMatrixAtRest(const StructuralDynamics& dynamics,
                         const IdentificationRecord& record) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  if (!dynamics.Prepare(dynamics.Parameters(), &prepared, &error)) {
    return Matrix::Zero(dynamics.num_states(), dynamics.num_states());
  }
  StructuralDynamics::Linearization stage = dynamics.MakeLinearization();
  const Vector rest = Vector::Zero(dynamics.num_states());
  Vector input(dynamics.num_inputs());
  record.excitation->Evaluate(0, 0.0, input.data());
  dynamics.Linearize(prepared, record.excitation->start_time(), input.data(),
                     rest.data(), &stage);
  return stage.jacobian.allFinite() ? stage.jacobian
                                    : prepared.linear.state_jacobian;
}

bool ChooseSubsteps(const StructuralDynamics& dynamics,
                    const IdentificationRecord& record, SubstepChoice* choice,
                    std::string* error) {
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(dynamics.Parameters(), &prepared, error)) return false;
  const Matrix state_matrix = StateMatrixAtRest(dynamics, record);
  const double step = record.sampling_step();
  const StabilityReport one_step = CheckStability(state_matrix, step, 1);
  const double stable_estimate = one_step.largest_eigenvalue * step;
  if (!(stable_estimate < kMaxSubsteps)) {
    return TooCoarse(stable_estimate, one_step, error);
  }
  *choice = SubstepChoice();
  choice->error = choice->error_limit = kNaN;
  int substeps = StableSubsteps(state_matrix, step);
  const int most = std::min(kMaxSubsteps, kLargestRefinement * substeps);

  Prior prior;
  Matrix coarse;
  Matrix fine;
  bool have_coarse = false;
  const bool have_start = prior.Init(dynamics, prepared, record);
  bool accurate = false;
  while (have_start && !accurate && substeps <= most) {
    if (!have_coarse) have_coarse = prior.Run(substeps, &coarse);
    if (!prior.Run(2 * substeps, &fine)) break;
    accurate = have_coarse && CompareChannels(record, coarse, fine, choice);
    if (accurate) break;
    std::swap(coarse, fine);
    have_coarse = true;
    substeps *= 2;
  }
  if (accurate && substeps > 1) {
    // The error falls with the fourth power: fewer steps than after the last
    // doubling may do.
    const double ratio = choice->error / choice->error_limit;
    const int fewer = static_cast<int>(
        std::ceil(1.02 * substeps * std::sqrt(std::sqrt(ratio))));
    SubstepChoice candidate;
    if (fewer < substeps && fewer >= StableSubsteps(state_matrix, step) &&
        prior.Run(fewer, &coarse) && prior.Run(2 * fewer, &fine) &&
        CompareChannels(record, coarse, fine, &candidate)) {
      *choice = candidate;
      substeps = fewer;
    }
  }
  if (!accurate) {
    // No start, or an initial model that diverges with any step.
    choice->error = choice->error_limit = kNaN;
    choice->channel.clear();
    const double needed = std::max(
        1.0, std::ceil(one_step.largest_eigenvalue * step / kLargestPhase));
    if (needed > kMaxSubsteps) return TooCoarse(needed, one_step, error);
    substeps = static_cast<int>(needed);
  }
  choice->substeps = substeps;
  choice->stability = CheckStability(state_matrix, step, substeps);
  return true;
}

bool CheckSubsteps(const StructuralDynamics& dynamics,
                   const IdentificationRecord& record, int substeps,
                   SubstepChoice* choice, std::string* error) {
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(dynamics.Parameters(), &prepared, error)) return false;
  const Matrix state_matrix = StateMatrixAtRest(dynamics, record);
  *choice = SubstepChoice();
  choice->substeps = substeps;
  choice->error = choice->error_limit = kNaN;
  choice->stability =
      CheckStability(state_matrix, record.sampling_step(), substeps);
  if (!choice->stability.stable) {
    *error =
        "its sampling is too coarse for the model's highest mode (" +
        FormatNumber(choice->stability.largest_eigenvalue, 4) +
        " rad per unit of time) with substeps = " + std::to_string(substeps) +
        ", expected at least " +
        std::to_string(StableSubsteps(state_matrix, record.sampling_step())) +
        ", or 0 to have them chosen";
    return false;
  }
  Prior prior;
  Matrix coarse;
  Matrix fine;
  if (prior.Init(dynamics, prepared, record) && prior.Run(substeps, &coarse) &&
      prior.Run(2 * substeps, &fine)) {
    CompareChannels(record, coarse, fine, choice);
  }
  return true;
}

namespace {

// Makes records follow the training records. A model carries the error of the
// steps of its fit: if a training record has a number of Runge-Kutta steps, no
// record is solved exactly.
void FollowTraining(IdentificationProblem* problem) {
  bool stepped = false;
  for (const IdentificationRecord& record : problem->records) {
    stepped = stepped || (record.role == IdentificationRecord::Role::kTrain &&
                          record.substeps > 0 && !record.substeps_chosen &&
                          !record.integrator.has_value());
  }
  for (IdentificationRecord& record : problem->records) {
    if (stepped && !record.integrator.has_value()) {
      record.integrator = Integrator::kRungeKutta;
    }
  }
}

// Returns the exponential steps per sample for the initial model's simulation
// as in ChooseSubsteps, at most `most`; 0 if it does not determine them.
int ChooseExponentialSteps(const StructuralDynamics& dynamics,
                           const IdentificationRecord& record, int most,
                           SubstepChoice* choice) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  Prior prior;
  Matrix coarse;
  Matrix fine;
  if (!dynamics.Prepare(dynamics.Parameters(), &prepared, &error) ||
      !prior.Init(dynamics, prepared, record)) {
    return 0;
  }
  const auto run = [&prior](int steps, Matrix* channels) {
    return prior.Run(steps, channels, Integrator::kExponential);
  };
  bool have_coarse = most >= 1 && run(1, &coarse);
  for (int steps = 1; steps <= most; steps *= 2) {
    if (!run(2 * steps, &fine)) return 0;
    if (have_coarse && CompareChannels(record, coarse, fine, choice)) {
      return steps;
    }
    std::swap(coarse, fine);
    have_coarse = true;
  }
  return 0;
}

// Sets the record's exponential steps if they are requested, or if they suit
// and save work: half as many as Runge-Kutta needs to be stable, or as many if
// there are many states.
bool SetExponentialSteps(const StructuralDynamics& dynamics,
                         const IdentificationRecord& ideal,
                         IdentificationRecord* record, SubstepChoice* choice,
                         std::string* error) {
  const bool asked = record->integrator == Integrator::kExponential;
  const bool suits = ExponentialStep::Suits(dynamics);
  const int given = record->substeps_chosen         ? 0
                    : record->exponential_steps > 0 ? record->exponential_steps
                                                    : record->substeps;
  record->exponential_steps = 0;
  if (asked && !suits) {
    *error =
        "integrator = \"exponential\" needs elements or libraries, and groups "
        "that follow nothing. Without elements use \"exact\", with other terms "
        "\"rk4\"";
    return false;
  }
  if (!suits || (!asked && (given > 0 || record->integrator.has_value()))) {
    return true;
  }
  SubstepChoice found;
  if (given > 0) {
    record->exponential_steps = given;
    found.error = found.error_limit = kNaN;
  } else {
    const Matrix state_matrix = StateMatrixAtRest(dynamics, ideal);
    const double step = ideal.sampling_step();
    const double phase =
        CheckStability(state_matrix, step, 1).largest_eigenvalue * step;
    const int stable = phase < kMaxSubsteps ? StableSubsteps(state_matrix, step)
                                            : kMaxSubsteps;
    const int most = asked                                  ? kMaxSubsteps
                     : dynamics.num_states() >= kManyStates ? stable
                                                            : stable / 2;
    record->exponential_steps =
        ChooseExponentialSteps(dynamics, ideal, most, &found);
    if (asked && record->exponential_steps == 0) {
      *error =
          "the initial model has no finite simulation to choose the number of "
          "exponential steps; give substeps";
      return false;
    }
  }
  if (record->exponential_steps > 0) *choice = found;
  return true;
}

// Matches exponential steps. A model carries the error of its steps:
// exponential ones are taken in all records or in none, and none is integrated
// more coarsely than the finest training record.
void MatchExponentialSteps(IdentificationProblem* problem) {
  double finest = kInfinity;
  bool all = true;
  for (const IdentificationRecord& record : problem->records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (record.exponential_steps == 0) {
      all = false;
      break;
    }
    finest =
        std::min(finest, record.sampling_step() / record.exponential_steps);
  }
  for (IdentificationRecord& record : problem->records) {
    const bool asked = record.integrator == Integrator::kExponential;
    if (!all && !asked) record.exponential_steps = 0;
    if (!all || finest == kInfinity || !record.substeps_chosen ||
        record.integrator.has_value()) {
      continue;
    }
    record.exponential_steps =
        std::max(record.exponential_steps,
                 static_cast<int>(std::ceil(record.sampling_step() / finest *
                                            (1.0 - 1e-9))));
  }
}

// Finds the number of Runge-Kutta steps, for the few functions that linearise
// step by step.
bool StepsBesideTheExactSolution(const StructuralDynamics& dynamics,
                                 const IdentificationRecord& record,
                                 SubstepChoice* choice, std::string* error) {
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(dynamics.Parameters(), &prepared, error)) return false;
  const Matrix state_matrix = StateMatrixAtRest(dynamics, record);
  const double step = record.sampling_step();
  const double largest =
      CheckStability(state_matrix, step, 1).largest_eigenvalue;
  const double smallest = state_matrix.eigenvalues().cwiseAbs().minCoeff();
  if (!(smallest * step < kMaxSubsteps)) {
    *error = "its sampling is too coarse even for the model's lowest mode (" +
             FormatNumber(smallest, 4) +
             " rad per unit of time). Check the units of the model and of the "
             "record's time";
    return false;
  }
  choice->substeps =
      static_cast<int>(std::clamp(std::ceil(largest * step / kLargestPhase),
                                  1.0, static_cast<double>(kMaxSubsteps)));
  choice->stability = CheckStability(state_matrix, step, choice->substeps);
  return true;
}

void RefineToTraining(IdentificationProblem* problem,
                      std::vector<SubstepChoice>* choices) {
  double finest = kInfinity;
  for (const IdentificationRecord& record : problem->records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    finest = std::min(finest, record.sampling_step() / record.substeps);
  }
  for (size_t r = 0; r < problem->records.size(); ++r) {
    IdentificationRecord& record = problem->records[r];
    SubstepChoice& choice = (*choices)[r];
    const double needed =
        std::ceil(record.sampling_step() / finest * (1.0 - 1e-9));
    if (!record.substeps_chosen || !(needed > record.substeps) ||
        needed > kMaxSubsteps || choice.integrator != Integrator::kRungeKutta) {
      continue;
    }
    record.substeps = choice.substeps = static_cast<int>(needed);
    choice.stability =
        CheckStability(StateMatrixAtRest(*problem->dynamics, record),
                       record.sampling_step(), record.substeps);
  }
}

}  // namespace

bool SetSubsteps(IdentificationProblem* problem,
                 std::vector<SubstepChoice>* choices, int* failed,
                 std::string* error) {
  choices->assign(problem->records.size(), SubstepChoice());
  FollowTraining(problem);
  const StructuralDynamics& dynamics = *problem->dynamics;
  for (size_t r = 0; r < problem->records.size(); ++r) {
    IdentificationRecord& record = problem->records[r];
    if (record.substeps == 0) record.substeps_chosen = true;
    if (dynamics.IsLinear()) {
      record.exponential_steps = 0;
    } else if (!SetExponentialSteps(dynamics,
                                    problem->AsSeenByIdealSensors(record),
                                    &record, &(*choices)[r], error)) {
      *failed = static_cast<int>(r);
      return false;
    }
  }
  MatchExponentialSteps(problem);
  for (size_t r = 0; r < problem->records.size(); ++r) {
    IdentificationRecord& record = problem->records[r];
    SubstepChoice& choice = (*choices)[r];
    const IdentificationRecord ideal = problem->AsSeenByIdealSensors(record);
    choice.integrator = IntegratorOf(dynamics, record);
    bool good = true;
    if (choice.integrator == Integrator::kExponential) {
      SubstepChoice beside;
      good = StepsBesideTheExactSolution(dynamics, ideal, &beside, error);
      choice.substeps = beside.substeps;
      choice.stability = beside.stability;
    } else if (record.integrator == Integrator::kExact &&
               choice.integrator != Integrator::kExact) {
      *error =
          "integrator = \"exact\" needs a linear model with constant matrices: "
          "no elements, networks or other terms, and groups that follow "
          "nothing. With elements use \"exponential\"";
      good = false;
    } else if (choice.integrator == Integrator::kExact) {
      good = StepsBesideTheExactSolution(dynamics, ideal, &choice, error);
      choice.error = choice.error_limit = kNaN;
    } else if (record.substeps > 0) {
      good = CheckSubsteps(dynamics, ideal, record.substeps, &choice, error);
    } else {
      good = ChooseSubsteps(dynamics, ideal, &choice, error);
    }
    if (!good) {
      *failed = static_cast<int>(r);
      return false;
    }
    record.substeps = choice.substeps;
  }
  RefineToTraining(problem, choices);
  return true;
}

}  // namespace pinode
