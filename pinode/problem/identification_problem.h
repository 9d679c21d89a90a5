// What is identified from what: the dynamics with its unknowns, records and
// measured modes.

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

// A sensor's record beside what the model predicts for it,
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
  // One row per input of the dynamics, in their order (no rows where there are
  // none). Its samples are those of the record.
  std::optional<Excitation> excitation;
  // Standard deviation of the noise of each input (empty: none). It enters the
  // intervals, see InputNoise in pinode/theory.md.
  Vector input_sigma;
  Start start = Start::kFree;
  Vector known_start;  // num_states, for kKnown
  // Of a free start: the first samples, which it is found from; of a hold-out
  // they are not scored, 0: a twentieth of the record. Of a training record
  // PrepareProblem makes it a known start, 0: it is an unknown of the fit.
  Eigen::Index start_samples = 0;
  std::vector<MeasuredChannel> channels;
  // Applied to `values` by whoever read them, and to the prediction here.
  std::shared_ptr<const ZeroPhaseFilter> filter;
  // Runge-Kutta steps per sample; 0: not chosen yet, see PrepareProblem.
  int substeps = 0;
  // By PrepareProblem for the dynamics as they are, rather than given.
  bool substeps_chosen = false;
  // How it is integrated; not given: see IntegratorOf.
  std::optional<Integrator> integrator;
  // Steps of ExponentialStep per sample, by PrepareProblem; 0: these are not
  // taken.
  int exponential_steps = 0;
  RecordDescription description;

  // Indices of the inputs that have noise.
  std::vector<int> NoisyInputs() const;

  // What its channels see, in their order.
  std::vector<Observation> Observations() const;

  Eigen::Index num_samples() const { return excitation->num_samples(); }
  double sampling_step() const { return excitation->step(); }
};

struct IdentificationProblem {
  // Initial values, bounds, priors and free flags are those of its blocks.
  std::shared_ptr<const StructuralDynamics> dynamics;
  std::vector<IdentificationRecord> records;
  // Measured modes beside the records, or alone.
  ModalData modal;
  // Records of loads that nobody measured, beside the others or alone.
  std::vector<AmbientRecord> ambient;
  // Gains (initially 1), offsets (the channel's unit) and delays (s).
  ParameterBlock sensors;
  // For reports and result files; takes no part in the fit.
  ProblemDescription description;

  int num_train_records() const;

  // Whether the ground, a force or an actuator drives the structure in a
  // record; covariates and switches do not.
  bool IsDriven(const IdentificationRecord& record) const;

  // By its initial value; 1 of a sensor without one, or where that is zero and
  // says nothing.
  double InitialGain(const MeasuredChannel& channel) const;
  // The record as ideal sensors would show it by these gains.
  IdentificationRecord AsSeenByIdealSensors(
      const IdentificationRecord& record) const;

  // What a channel's values came in, and where it measures.
  std::string UnitOf(const MeasuredChannel& channel) const;
  std::string LocationOf(const MeasuredChannel& channel) const;

  // Everything that a caller can get wrong, so that what works on a valid
  // problem needs no further look at sizes and numbers: a mass matrix that can
  // be inverted; at least one free parameter, which without a training record
  // must be a group's; at least one training record with a fitted channel, one
  // mode or one ambient record; and of each record two samples, finite
  // excitations, steps that are chosen, sizes and indices of channels, sensors,
  // starts and input noise that fit the dynamics, no negative deviation. On
  // failure *error names the record, channel or mode, and what was expected.
  // What takes a problem asks this first, and aborts on none.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_PROBLEM_H_
