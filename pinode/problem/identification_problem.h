// The identification problem: dynamics with unknowns, records and measured
// modes.

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

// Measured values of a sensor, and the observation that predicts them,
//
//   y(t) = gain * observation(t - delay) + offset + noise.
struct MeasuredChannel {
  Observation observation;
  // One value per sample in the model's units; NaN where missing.
  Vector values;
  // Standard deviation of the noise in the model's units; 0: estimate it.
  double sigma = 0.0;
  // False: predicted and scored, but not fitted.
  bool fit = true;
  // Indices into IdentificationProblem::sensors, -1 for an ideal sensor.
  int gain = -1;
  int offset = -1;
  int delay = -1;
  ChannelDescription description;
};

struct IdentificationRecord {
  enum class Role { kTrain, kHoldout };
  enum class Start { kRest, kKnown, kFree };

  std::string name;
  Role role = Role::kTrain;
  // Inputs of the dynamics, one row each, in their order (no rows if there are
  // none). They have as many samples as the record.
  std::optional<Excitation> excitation;
  // Standard deviation of the noise of each input (empty: none). It enters the
  // intervals, see InputNoise in pinode/theory/intervals.md.
  Vector input_sigma;
  Start start = Start::kFree;
  Vector known_start;  // num_states, for kKnown
  // Number of first samples that a free start is found from. They are not
  // scored in a hold-out record; 0 there means a twentieth of the record. In a
  // training record, PrepareProblem makes the start known; 0 there makes it an
  // unknown of the fit.
  Eigen::Index start_samples = 0;
  std::vector<MeasuredChannel> channels;
  // Filter that the reader already applied to `values`. It is applied to the
  // prediction too.
  std::shared_ptr<const ZeroPhaseFilter> filter;
  // Runge-Kutta steps per sample. 0: PrepareProblem chooses them.
  int substeps = 0;
  // True if PrepareProblem chose `substeps` for the dynamics.
  bool substeps_chosen = false;
  // Integrator of the record. Not given: see IntegratorOf.
  std::optional<Integrator> integrator;
  // Steps of ExponentialStep per sample, set by PrepareProblem. 0: it is not
  // used.
  int exponential_steps = 0;
  RecordDescription description;

  // Returns the indices of the inputs that have noise.
  std::vector<int> NoisyInputs() const;

  // Returns the observations of the channels, in their order.
  std::vector<Observation> Observations() const;

  Eigen::Index num_samples() const { return excitation->num_samples(); }
  double sampling_step() const { return excitation->step(); }
};

struct IdentificationProblem {
  // Dynamics; initial values, bounds, priors and free flags are those of its
  // blocks.
  std::shared_ptr<const StructuralDynamics> dynamics;
  std::vector<IdentificationRecord> records;
  // Measured modes, with the records or alone.
  ModalData modal;
  // Records under loads that were not measured, with the others or alone.
  std::vector<AmbientRecord> ambient;
  // Gains (initially 1), offsets (the channel's unit) and delays (s).
  ParameterBlock sensors;
  // Description for reports and result files; takes no part in the fit.
  ProblemDescription description;

  int num_train_records() const;

  // True if the ground, a force or an actuator drives the structure in a
  // record. Covariates and switches do not drive it.
  bool IsDriven(const IdentificationRecord& record) const;

  // Returns the channel's initial gain. It is 1 without a gain, or if the
  // initial gain is zero.
  double InitialGain(const MeasuredChannel& channel) const;
  // Returns the record that ideal sensors would give, by these gains.
  IdentificationRecord AsSeenByIdealSensors(
      const IdentificationRecord& record) const;

  // Return the unit of the channel's original values, and where it measures.
  std::string UnitOf(const MeasuredChannel& channel) const;
  std::string LocationOf(const MeasuredChannel& channel) const;

  // Checks everything that a caller can get wrong, so that code for valid
  // problems need not check sizes and numbers again:
  //
  // - the mass matrix can be inverted;
  // - at least one parameter is free; without a training record it is that of
  //   a group;
  // - there is a training record with a fitted channel, a mode or an ambient
  //   record;
  // - each record has at least two samples, finite excitations and chosen
  //   steps;
  // - sizes and indices of channels, sensors, starts and input noise fit the
  //   dynamics, and no deviation is negative.
  //
  // On failure *error names the record, channel or mode, and what was expected.
  // Functions that take a problem call this first, and abort on none.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_PROBLEM_H_
