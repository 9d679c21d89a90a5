// Problem to be identified: dynamics with unknowns, records and measured modes.

#ifndef PINODE_PROBLEM_IDENTIFICATION_PROBLEM_H_
#define PINODE_PROBLEM_IDENTIFICATION_PROBLEM_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/problem/problem_description.h"
#include "pinode/record/excitation.h"
#include "pinode/record/filter.h"

namespace pinode {

// Measured values y of a sensor, and the observation that predicts them:
//
//   y(t) = gain * observation(t - delay) + offset + noise.
struct MeasuredChannel {
  Observation observation;
  // Measured values in the model's units, one per sample. NaN: missing.
  Vector values;
  // Standard deviation of the noise in the model's units; 0: estimate it.
  double sigma = 0.0;
  // False: the channel is predicted and scored, but not fitted.
  bool fit = true;
  // Indices of gain, offset and delay in IdentificationProblem::sensors. -1:
  // the ideal value (1, 0, 0).
  int gain = -1;
  int offset = -1;
  int delay = -1;
  ChannelDescription description;
};

// Record: inputs and measured channels over the same samples.
struct IdentificationRecord {
  // kTrain: fitted. kHoldout: only predicted and scored.
  enum class Role { kTrain, kHoldout };
  // Initial state. kRest: zero. kKnown: known_start. kFree: found from the
  // record.
  enum class Start { kRest, kKnown, kFree };

  std::string name;
  Role role = Role::kTrain;
  // Inputs of the dynamics, one row each in their order, with as many samples
  // as the record. Required also without inputs: it then has no rows, but the
  // step and the number of samples.
  std::optional<Excitation> excitation;
  // Standard deviation of the noise of each input, in its unit. Empty: no
  // noise. It widens the intervals, see "Input noise" in
  // pinode/theory/intervals.md.
  Vector input_sigma;
  Start start = Start::kFree;
  Vector known_start;  // num_states entries, for kKnown
  // Number of samples at the begin from which a free start is found. In a
  // hold-out record these samples are not scored; 0 stands for 5 % of the
  // record. In a training record PrepareProblem finds the start, which is then
  // known; 0 makes it an unknown of the fit.
  Eigen::Index start_samples = 0;
  std::vector<MeasuredChannel> channels;
  // Filter that was already applied to the values of the channels; null: none.
  // The fit applies it to the prediction too.
  std::shared_ptr<const ZeroPhaseFilter> filter;
  // Runge-Kutta steps per sample. 0: PrepareProblem chooses them.
  int substeps = 0;
  // True if PrepareProblem chose `substeps` for the dynamics.
  bool substeps_chosen = false;
  // Integrator of the record. No value: IntegratorOf chooses it.
  std::optional<Integrator> integrator;
  // Steps of the exponential integrator per sample, set by PrepareProblem. 0:
  // this integrator is not used.
  int exponential_steps = 0;
  RecordDescription description;

  // Returns the indices of the inputs that have noise.
  std::vector<int> NoisyInputs() const;

  // Returns the observations of the channels, in their order.
  std::vector<Observation> Observations() const;

  // Number of samples, and time between them in the model's unit. `excitation`
  // must be set.
  Eigen::Index num_samples() const { return excitation->num_samples(); }
  double sampling_step() const { return excitation->step(); }
};

// Problem to be identified.
struct IdentificationProblem {
  // Dynamics. Its parameter blocks hold the initial values, bounds, priors and
  // the flags of free parameters.
  std::shared_ptr<const StructuralDynamics> dynamics;
  std::vector<IdentificationRecord> records;
  // Measured modes, with or without records.
  ModalData modal;
  // Records under loads that were not measured, with or without other records.
  std::vector<AmbientRecord> ambient;
  // Frequency response functions, with or without other data.
  std::vector<FrfRecord> frfs;
  // Unknowns of sensors: gains (dimensionless, initially 1), offsets (in the
  // channel's model unit) and delays (in the model's unit of time).
  ParameterBlock sensors;
  // Description for reports and result files. It does not affect the fit.
  ProblemDescription description;

  // Blocks of all parameters, first those of the dynamics, then of sensors.
  std::vector<const ParameterBlock*> ParameterBlocks() const;
  // Returns false, with the tied unknown and what is wrong, if a tie is not
  // valid. An unknown of the model cannot follow one of a sensor: the equation
  // of motion knows no sensors.
  [[nodiscard]] bool HasValidTies(std::string* parameter,
                                  std::string* error) const;

  // Number of training records, without ambient ones.
  int num_train_records() const;
  // True if there are ambient records or FRFs.
  bool HasSpectra() const { return !ambient.empty() || !frfs.empty(); }

  // True if ground motion, a force or an actuator drives the structure in this
  // record. Covariates and switches do not drive it.
  bool IsDriven(const IdentificationRecord& record) const;

  // Returns the initial gain of a channel. Returns 1 for a channel without a
  // gain, or if its initial gain is 0.
  double InitialGain(const MeasuredChannel& channel) const;
  // Returns the record that ideal sensors would give: values divided by the
  // initial gains.
  IdentificationRecord AsSeenByIdealSensors(
      const IdentificationRecord& record) const;

  // Return the unit of the channel's original values, and the place of the
  // sensor.
  std::string UnitOf(const MeasuredChannel& channel) const;
  std::string LocationOf(const MeasuredChannel& channel) const;

  // Checks everything that a caller can get wrong, so that code for valid
  // problems need not check sizes and numbers again:
  //
  // - the mass matrix can be inverted;
  // - each tied parameter names an existing parameter that is not tied itself;
  // - at least one parameter is free; without a training record it is that of
  //   a group;
  // - there is a training record with a fitted channel, a mode, an ambient
  //   record or an FRF;
  // - each record has at least two samples, finite excitations and chosen
  //   steps;
  // - sizes and indices of channels, sensors, starts and input noise fit the
  //   dynamics, and no standard deviation is negative.
  //
  // On failure returns false, and *error names the record, channel or mode, and
  // the expected value. Functions that take a problem call this first, and fail
  // instead of aborting.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_PROBLEM_H_
