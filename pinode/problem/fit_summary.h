// Results of one fit, without a verdict.

#ifndef PINODE_PROBLEM_FIT_SUMMARY_H_
#define PINODE_PROBLEM_FIT_SUMMARY_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/measured_mode.h"

namespace pinode {

// Reason for which a fit has ended.
enum class Termination {
  kFailure,        // not started, or no finite trajectory to start from
  kConverged,      // changes are below the tolerances
  kNoConvergence,  // max_num_iterations was reached
  kInterrupted,    // the callback returned false
};
// Returns the name as in result.json.
const char* TerminationName(Termination termination);

// Comparison of a channel's simulation over the whole record with its
// measurement.
struct ChannelScore {
  std::string name;
  bool fitted = true;        // MeasuredChannel::fit
  double rmse = 0.0;         // RMS error, model's units
  double nrmse = 0.0;        // |y - simulation| / |y - mean(y)|
  double prior_nrmse = 0.0;  // nrmse of the initial model
  double sigma = 0.0;        // standard deviation of the noise
  // Share of the error's mean square that is uncorrelated from sample to
  // sample, and so is noise and not motion. NaN: unknown.
  double noise_share = kNaN;
  // Fraction of the scored samples inside the 95 % band that follows from
  // RecordScore::deviations. NaN: there is no band.
  double band_coverage = kNaN;
};

// Comparison of a record's simulation with its measurement.
struct RecordScore {
  std::string name;
  IdentificationRecord::Role role = IdentificationRecord::Role::kTrain;
  // False: the simulation diverged.
  bool finite = false;
  // Index of the first sample that is scored. It is above 0 if the first
  // samples were used to find the initial state.
  Eigen::Index first_scored_sample = 0;
  // Error |y - simulation| / |y - mean(y)| over all channels together, each
  // divided by its scale. prior_nrmse is that of the initial model.
  double nrmse = 0.0;
  double prior_nrmse = 0.0;
  std::vector<ChannelScore> channels;
  Vector start;  // initial state, num_states entries
  // Simulated values, channels x samples, with the sensors' gains, offsets and
  // delays. In a fit by several ranks, only the first rank has this and
  // `deviations`.
  Matrix prediction;
  // Simulated states, num_states x samples. Empty without
  // IdentificationOptions::keep_states.
  Matrix states;
  // Mean square of each state over all samples, num_states entries.
  Vector state_mean_squares;
  // Standard deviations of measured values from `prediction`, channels x
  // samples, see PredictionDeviations. Empty: unknown. NaN for a channel whose
  // noise is unknown.
  Matrix deviations;
};

// Estimate of one named parameter. All numbers are in `unit`.
struct ParameterEstimate {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double value = 0.0;
  double sigma = 0.0;
  // 95 % interval. If the model is incomplete (Grade::kWithCare), it is widened
  // to include the values under other explanations. It then need not be centred
  // on `value`.
  double lower95 = 0.0;
  double upper95 = 0.0;
  // Half width of the 95 % interval that assumes a complete model.
  double half_width95 = 0.0;
  bool free = false;
  // True if the value has ended at a bound.
  bool at_bound = false;
  // Name of the parameter that this one follows, see Parameter::tie, and the
  // factor. Empty: not tied.
  std::string tie = {};
  double tie_factor = 1.0;
};

// Sets values and intervals of tied parameters from those of their sources.
void FollowSources(std::vector<ParameterEstimate>* parameters);

// Measured mode and its partners in the initial and the updated model. A mode
// that the fit did not use has no partner: ModeMatch::mode is -1 and the rest
// NaN.
struct ModeScore {
  std::string name;
  double frequency = 0.0;  // see MeasuredMode::frequency
  ModeMatch initial;
  ModeMatch updated;

  // True if the fit used the mode.
  bool InUse() const { return updated.mode >= 0; }
};

// Unknown force over the record in which it acts, at every integration step.
// For a force that acts in all records, this is the first training record.
// Vectors have one entry per step, in the model's units. A positive value
// pushes in the positive direction of the DOF. For a network it is minus the
// output.
struct ForceEstimate {
  std::string name;
  int record = -1;  // index into the problem's records
  Vector times;
  Vector value;
  Vector sigma;  // infinite if there is no covariance
  Vector lower95, upper95;
};

// One Levenberg-Marquardt iteration.
struct IterationRecord {
  // Stage, length of its longest segment in samples, and number of the
  // iteration over all stages.
  int stage = 0;
  Eigen::Index segment_samples = 0;
  int iteration = 0;
  // Values as in ceres::IterationSummary. The largest gap between segments is
  // in units of the state's RMS.
  double cost = 0.0;
  double gradient_norm = 0.0;
  double step_norm = 0.0;
  double trust_region_radius = 0.0;
  double largest_gap = 0.0;
  bool accepted = false;
  double seconds = 0.0;
};

// One stage of multiple shooting.
struct StageRecord {
  Eigen::Index segment_samples = 0;
  int num_segments = 0;
  int iterations = 0;
  // Error of the training records' simulations after the stage (nrmse), and the
  // largest gap between segments in units of the state's RMS.
  double free_run_error = 0.0;
  double largest_gap = 0.0;
  // True if the stage made the fit worse and its result was discarded.
  bool rolled_back = false;
};

// Result of one fit. It has no verdict: Identify (pinode/study/identify) adds
// one from the findings of all checks.
struct FitSummary {
  // Reason for the end of the fit, and a sentence about it.
  Termination termination = Termination::kFailure;
  std::string message = "the identification has not been started";

  std::vector<RecordScore> records;           // in the problem's order
  std::vector<ParameterEstimate> parameters;  // only named ones
  // Scores of the measured modes, in the problem's order. Empty if the model
  // has no modes.
  std::vector<ModeScore> modes;
  int num_model_modes = 0;            // number of modes of the model
  std::vector<AmbientScore> ambient;  // one per ambient record
  std::vector<FrfScore> frfs;         // one per IdentificationProblem::frfs
  // Half the sum of squares of the modal residuals, before and after the fit.
  double initial_modal_cost = 0.0;
  double final_modal_cost = 0.0;
  // Number of starts of the multistart, and number of those that reached the
  // best cost within 0.1 %.
  int num_starts = 1;
  int num_starts_at_best = 1;
  // Values from another start that fits nearly as well with other stiffness
  // groups, such as "k1 -0.09 (0.17 here)". Empty: none.
  std::string other_solution;
  // Unknown forces in the dynamics' order. Then one entry per output of each
  // network that depends on time alone and acts as a force.
  std::vector<ForceEstimate> forces;
  // Covariance of the free named parameters, and their names, in the order of
  // `parameters`. Square, as many rows as names.
  std::vector<std::string> covariance_names;
  Matrix covariance;
  // Method of the covariance, see CovarianceEstimate::method.
  std::string covariance_method;
  // Combinations of named parameters that the data do not determine, one text
  // each.
  std::vector<std::string> undetermined;

  // Stages and iterations of the fit, in their order.
  std::vector<StageRecord> stages;
  std::vector<IterationRecord> iterations;
  // Cost (negative log-likelihood with priors) before and after the fit.
  double initial_cost = 0.0;
  double final_cost = 0.0;
  // Measures of the distance from a minimum within the bounds, both 0 at a
  // minimum. gradient_cosine: largest cosine of the angle between the residuals
  // and a column of their Jacobian. promised_share: fraction of the cost that
  // the next step promises to save. See Optimality.
  double gradient_cosine = 0.0;
  double promised_share = 0.0;
  // True if the solver could not proceed although no minimum was reached.
  bool stalled = false;
  // Smallest damping ratio of the model's modes before and after the fit, as a
  // fraction of critical. NaN: the model has no modes.
  // `negative_damping_allowed` is true if the bounds of the case allow a
  // negative ratio.
  double initial_damping = 0.0;
  double final_damping = 0.0;
  bool negative_damping_allowed = false;
  // True if a network learns a force from states.
  bool learns_force = false;
  // Sequence of fits that led to this one, in words. Empty: one fit in stages.
  std::string way;
  // Error (nrmse) of the training records' simulations with the linear terms
  // alone, from a fit on the way. Infinite: there was no such fit.
  double linear_error = kInfinity;
  // Largest gap between segments at the end, in units of the state's RMS.
  double largest_gap = 0.0;
  // True if each record was one segment in the last stage.
  bool single_shooting = false;
  // Numbers of iterations, of steps that were rejected, and of evaluations that
  // were not finite.
  int num_iterations = 0;
  int rejected_steps = 0;
  int failed_evaluations = 0;
  // Number of parameters that the data determine (gamma of D. J. C. MacKay
  // 1992), and the precision of each decay group.
  double effective_parameters = 0.0;
  std::vector<double> decays;  // see ParameterLayout
  // Record and channel that an unknown force follows nearly sample by sample,
  // so that the channel's noise cannot be estimated. Empty: none.
  std::string followed_record, followed_channel;
  // Remarks on the result for the user, one sentence each.
  std::vector<std::string> remarks;
  // Description of a motion that grows without limit with the identified
  // matrices, and advice to prevent it. Empty: no simulation diverged.
  std::string growing_motion, growing_motion_advice;

  double seconds = 0.0;
  double jacobian_seconds = 0.0;
  double linear_solver_seconds = 0.0;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_FIT_SUMMARY_H_
