// Results of one fit, before anything judges them.

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

enum class Termination {
  kFailure,        // not started, or no finite trajectory to start from
  kConverged,      // changes fell below the tolerances
  kNoConvergence,  // the iterations ran out
  kInterrupted,    // the callback said stop
};
const char* TerminationName(Termination termination);

// Free run of one channel over a whole record against its measurement.
struct ChannelScore {
  std::string name;
  bool fitted = true;        // MeasuredChannel::fit
  double rmse = 0.0;         // model units
  double nrmse = 0.0;        // |y - yhat| / |y - mean(y)|
  double prior_nrmse = 0.0;  // of the initial model
  double sigma = 0.0;        // estimated or given noise
  // Share of the residual's energy that has no memory from sample to sample and
  // can therefore be no motion. NaN: unknown. See NoiseShare.
  double noise_share = kNaN;
  // Share of the scored samples within the 95 % band of RecordScore's
  // deviations. NaN: there is no band.
  double band_coverage = kNaN;
};

struct RecordScore {
  std::string name;
  IdentificationRecord::Role role = IdentificationRecord::Role::kTrain;
  bool finite = false;
  // First sample that is scored; later than 0 where the start was smoothed.
  Eigen::Index first_scored_sample = 0;
  double nrmse = 0.0;  // over all channels, each in units of its scale
  double prior_nrmse = 0.0;
  std::vector<ChannelScore> channels;
  Vector start;  // num_states
  // channels x samples, of the sensors as they are; of several ranks' fit on
  // the first one alone, as `deviations`.
  Matrix prediction;
  // num_states x samples; empty without IdentificationOptions::keep_states.
  Matrix states;
  Vector state_mean_squares;  // over all samples
  // Standard deviations of what the sensors read about the prediction, channels
  // x samples, see PredictionDeviations; empty: not known; NaN of a channel
  // whose noise is not.
  Matrix deviations;
};

struct ParameterEstimate {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double value = 0.0;
  double sigma = 0.0;
  // 95 % interval. Where the model lacks something (Grade::kWithCare) it
  // reaches as far as other explanations do, and need not be centred on the
  // value.
  double lower95 = 0.0;
  double upper95 = 0.0;
  // Half width of the interval that presumes that the model lacks nothing.
  double half_width95 = 0.0;
  bool free = false;
  bool at_bound = false;
};

// A measured mode and its partners in the initial and the updated model. A mode
// that the fit did not use has none (ModeMatch::mode -1, the rest NaN).
struct ModeScore {
  std::string name;
  double frequency = 0.0;  // measured, as MeasuredMode::frequency
  ModeMatch initial;
  ModeMatch updated;

  bool InUse() const { return updated.mode >= 0; }
};

// An unknown force over the record in which it acts (the first training record
// where it acts in all), at every integration step.
struct ForceEstimate {
  std::string name;
  int record = -1;  // index into the problem's records
  Vector times;
  Vector value;
  Vector sigma;  // infinite where there is no covariance
  Vector lower95, upper95;
};

struct IterationRecord {
  int stage = 0;
  Eigen::Index segment_samples = 0;
  int iteration = 0;
  double cost = 0.0;
  double gradient_norm = 0.0;
  double step_norm = 0.0;
  double trust_region_radius = 0.0;
  double largest_gap = 0.0;
  bool accepted = false;
  double seconds = 0.0;
};

struct StageRecord {
  Eigen::Index segment_samples = 0;
  int num_segments = 0;
  int iterations = 0;
  double free_run_error = 0.0;
  double largest_gap = 0.0;
  bool rolled_back = false;
};

// Outcome of one fit. It has no verdict: Identify (study/identify) makes one
// from the findings of all checks.
struct FitSummary {
  Termination termination = Termination::kFailure;
  std::string message = "the identification has not been started";

  std::vector<RecordScore> records;           // in the problem's order
  std::vector<ParameterEstimate> parameters;  // named ones
  // One entry per mode of the problem, in its order. Empty if the model has
  // none.
  std::vector<ModeScore> modes;
  int num_model_modes = 0;            // modes of the model they are paired with
  std::vector<AmbientScore> ambient;  // one per ambient record
  // Half the sum of squares of the modal residuals, before and after.
  double initial_modal_cost = 0.0;
  double final_modal_cost = 0.0;
  // Starts of a multistart, and those of them that reached the best cost (to a
  // thousandth).
  int num_starts = 1;
  int num_starts_at_best = 1;
  // Another start that ended at other stiffness groups and fits nearly as well:
  // "k1 -0.09 (0.17 here)". Empty: none.
  std::string other_solution;
  // Unknown forces in the dynamics' order, then networks that depend on time
  // alone and act as forces, an entry per output.
  std::vector<ForceEstimate> forces;
  // Covariance of the free named parameters, in the order of `parameters`.
  std::vector<std::string> covariance_names;
  Matrix covariance;
  std::string covariance_method;  // as CovarianceEstimate::method
  // Directions of the named parameters that the data do not determine.
  std::vector<std::string> undetermined;

  std::vector<StageRecord> stages;
  std::vector<IterationRecord> iterations;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  // Distance from a minimum within the bounds at the end, see Optimality.
  double gradient_cosine = 0.0;
  double promised_share = 0.0;
  // The solver could do no more, but at no minimum.
  bool stalled = false;
  // Least damping ratio of the modes of the matrices, before and after; NaN
  // where there are none. Whether bounds of free dampings, given by somebody,
  // allow it to be negative.
  double initial_damping = 0.0;
  double final_damping = 0.0;
  bool negative_damping_allowed = false;
  // True if a network learns a force from states.
  bool learns_force = false;
  // The way by which the fit was reached, in words. Empty: by its stages alone.
  std::string way;
  // The error of the training records' free runs by the linear terms alone,
  // fitted on the way; infinite where they were not.
  double linear_error = kInfinity;
  double largest_gap = 0.0;      // in units of the state's RMS
  bool single_shooting = false;  // the last stage was one segment a record
  int num_iterations = 0;
  int rejected_steps = 0;
  int failed_evaluations = 0;
  double effective_parameters = 0.0;
  std::vector<double> decays;  // per decay group of the parameter layout
  // A channel whose noise was to be estimated and which an unknown force
  // follows nearly sample by sample; empty: there is none.
  std::string followed_record, followed_channel;
  // Remarks on the outcome for the user, one sentence each.
  std::vector<std::string> remarks;
  // A motion that the identified matrices let grow, where a free run is not
  // finite, and what can prevent it. Empty: none.
  std::string growing_motion, growing_motion_advice;

  double seconds = 0.0;
  double jacobian_seconds = 0.0;
  double linear_solver_seconds = 0.0;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_FIT_SUMMARY_H_
