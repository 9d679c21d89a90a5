// Tuning constants of the fit that were found by measurement and that studies
// vary. Constants of single algorithms stand in their files, the limits of the
// verdict in verdict_limits.h.

#ifndef PINODE_PROBLEM_TUNING_H_
#define PINODE_PROBLEM_TUNING_H_

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace pinode {

// Segment lengths of each stage (stage_schedule.h).
struct StageTuning {
  // Minimum number of samples of the first segment in a stage schedule, and its
  // maximum length as a share of the shortest record.
  int least_first_samples = 10;
  double most_first_share = 0.25;
  // Divisor of the first segment's length with networks. A model that lacks its
  // nonlinear part diverges sooner.
  int network_divisor = 3;
  // Growth of the segments from one stage to the next.
  int growth = 4;
  // Penalty on the gaps between the first segments' ends and the next starts,
  // in the search for a first trajectory. A gap of a tenth of a state's RMS
  // counts like one sigma: the model is wrong by about that much over a
  // segment.
  double first_gap_penalty = 100.0;
  // Relative increase of the expected error above which a stage is undone.
  double worse_share = 0.02;
};

// Search for the best segment starts (start_search.h).
struct StartTuning {
  // The search ends if its next step promises to lower the cost by less than
  // this fraction, or after `max_iterations`. If starts fall short of the best
  // ones, the error of the gradient is of the order of the square root of the
  // excess cost.
  double tolerance = 1e-10;
  // The search also ends if the promised decrease is less than this share of
  // the change of the record's cost since the last linearisation. That is
  // enough to judge a step of the parameters; the next linearisation takes the
  // rest into account.
  double change_tolerance = 1e-6;
  int max_iterations = 30;
  // Limits for hopeless steps. A step that ruins the trajectories costs a long
  // search for starts, only to be rejected. The search stops after
  // `hopeless_iterations` if the cost would stay above `hopeless_cost` times
  // the last linearisation's, even if it fell by `hopeless_promises` times the
  // promise of the next step. (A step uphill that is not to be rejected, as
  // with networks, costs less than that.)
  int hopeless_iterations = 4;
  double hopeless_cost = 3.0;
  double hopeless_promises = 4.0;
  // Whole records: if the starts predicted by the sensitivities cost more than
  // this multiple of the last linearisation's cost, the last starts are tried
  // as well. Steps of a fit are better made shorter. Along a bent valley the
  // starts hardly move, and the sensitivities do not predict that.
  double stray_cost = std::numeric_limits<double>::infinity();
  // Precision, in units of 1 / D^2, of the prior that keeps a free first start
  // from drifting where no channel observes it.
  double prior_precision = 1e-4;
};

// Closing of the gaps between the segments of a stage (gap_penalty.h, stage.h).
struct GapTuning {
  // Size below which gaps are closed, in units of the state's RMS.
  double closed = 1e-6;
  // Initial firmness of the gap penalty, as a share of the firmness with which
  // the data hold the starts; its growth from round to round, and its limit.
  double first_firmness = 0.01;
  double first_network_firmness = 0.1;
  double growth = 10.0;
  double most_firmness = 1e4;
  // Multiple of `closed` at which the trajectory counts as one piece: the
  // stages between this one and the last would change nothing.
  double nearly_closed = 10.0;
};

// A single solve, and the rounds of a stage (solve.h, stage.h).
struct SolveTuning {
  // Maximum number of rounds of one stage: multipliers, noise levels and decay
  // are updated between them. After half of them the stage is brought to its
  // end.
  int max_rounds = 80;
  // Growth of the cost over the rounds of a stage at which its segments have
  // diverged.
  double diverged = 1e8;
  // Iterations of a round before the last, and the change of the cost that ends
  // it. The last round runs to the user's tolerance.
  int round_iterations = 15;
  int network_round_iterations = 30;
  double round_tolerance = 1e-3;
  // With networks, while segments have gaps: a round also ends after
  // `crawling_steps` steps in a row that change the cost by at most this share.
  // The first learning only explores the networks and closes the gaps. A single
  // such change may be a step across the valley.
  double network_crawl = 0.03;
  int crawling_steps = 3;
  // Initial radii of the trust region; networks need small steps at first.
  double first_radius = 1e4;
  double first_network_radius = 30.0;
  // Limits of the radius between rounds.
  double least_radius = 1e-2;
  double most_radius = 1e8;
  // Number of uphill steps that Ceres may take before it goes back, for
  // straight steps in the bent valleys of a network. Bent steps need none:
  // uphill they lead out of the valley, to regions where only short steps are
  // possible.
  int uphill_steps = 5;
  // Change of the cost, a negative log-likelihood, in one iteration at which a
  // fit with networks has converged; and the largest such change relative to
  // the cost.
  double smallest_change = 0.03;
  double most_network_tolerance = 1e-2;
  // RMS of the residuals, in units of the noise levels, at which the fit has
  // converged as well, in any round: the remaining error is invisible.
  double smallest_residual = 0.07;
  // Number of iterations after which convergence is measured by the cost again.
  int fine_network_iterations = 50;
};

// Noise levels (noise_levels.h). All shares are relative to a channel's spread.
struct NoiseTuning {
  // First guess of noise that is to be estimated.
  double first_share = 0.05;
  // Smallest estimate of the noise, as a share of the channel's RMS.
  double smallest = 1e-8;
  // Smallest noise with networks whose decay the evidence chooses. Errors of a
  // network are misfit. A smaller noise would make the evidence buy weights
  // that do not generalise.
  double smallest_misfit = 0.002;
  // Limits of the change of noise from round to round. Early residuals mislead,
  // and a network needs time to adapt. `shrink`: largest decrease;
  // `network_step_down`: the same with networks; `growth`: largest increase.
  double shrink = 0.1;
  double network_step_down = 0.4;
  double growth = 10.0;
  // Smallest share of samples that counts as left after the parameters have
  // used up theirs: of all samples, and of one channel with an unknown force.
  double least_share_left = 0.1;
  double least_channel_left = 0.01;
  // Smallest share of a channel's samples that an unknown force leaves for the
  // estimate of its noise. Below it the likelihood has a second maximum, with
  // no noise and a force that follows every sample.
  double followed = 0.1;
  // Noise levels have settled if none would change by more than this share.
  double quiet = 0.02;
};

// Weight decay chosen by the evidence (evidence.h).
struct EvidenceTuning {
  // Initial precision of a decay, and its upper limit.
  double first_decay = 0.1;
  double most_decay = 1e8;
  // Largest factor by which a decay changes at once: a group that seems idle
  // early may be needed later.
  double most_change = 100.0;
  // Smallest number of well-determined parameters, and smallest sum of squares,
  // of a group.
  double least_determined = 1e-3;
  double least_squares = 1e-12;
  // Number of rounds for the decay of networks after the noise levels have
  // settled, before the fit runs to its tolerance.
  int rounds = 12;
  // A fit continues until the number of well-determined parameters has changed
  // by less than `quiet` in `quiet_rounds` rounds (or another `rounds` have
  // passed). A change by more than `new_evidence` means another explanation of
  // the data, which must be reduced to what is needed in turn.
  double quiet = 0.01;
  int quiet_rounds = 3;
  double new_evidence = 0.1;
  // Without networks: the decay has settled if that number changes by less than
  // this share of the parameters, and by less than this amount.
  double quiet_share = 0.01;
  double quiet_parameters = 0.1;
};

// Second learning of a network (annealing.h). The first learning, at the
// smallest noise, soon finds a good fit, but one of the many that use all
// inputs. Then the network is drawn again, close to a linear map, and the noise
// decreases step by step. The evidence first grants what the data require most,
// and unneeded inputs stay out.
struct AnnealingTuning {
  // Initial noise as a share of a channel's spread.
  double noise = 0.1;
  // Scale of the newly drawn hidden weights.
  double weights = 0.1;
  // Initial decay of the output weights, which then have to be large, as a
  // share of EvidenceTuning::first_decay.
  double output_decay = 1e-4;
  // Number of updates of the noise that measure the remainder of the first fit.
  int measuring_rounds = 3;
};

// Uncertainty bands of unknown forces (force_bands.h).
struct ForceBandTuning {
  // Range in samples within which variances of neighbourhoods are pooled.
  double pooled_samples = 2.0;
};

// Multiple starts (multistart.h).
struct MultistartTuning {
  // Relative difference of costs below which two starts have reached the same
  // minimum.
  double same_cost = 1e-3;
  // Range, in its standard deviations, within which a parameter with a prior is
  // drawn.
  double prior_deviations = 2.0;
};

// All constants of the fit, one group for each part that uses them. They are
// for studies; settings for users are options. Section 13 of pinode/theory has
// the effect of halving and doubling each (tests/cases/tuning_study_test.cc).
struct Tuning {
  StageTuning stages;
  StartTuning starts;
  GapTuning gaps;
  SolveTuning solve;
  NoiseTuning noise;
  EvidenceTuning evidence;
  AnnealingTuning annealing;
  ForceBandTuning force_bands;
  MultistartTuning multistart;
};

// One constant, by its name: "gaps.closed".
struct TuningField {
  std::string name;
  std::variant<double*, int*> value;

  double Get() const;
  // Sets the constant. Integers are rounded, and stay at least 1.
  void Set(double number) const;
};

// Returns all constants of *tuning, which must outlive them, in the order of
// their declaration.
std::vector<TuningField> TuningFields(Tuning* tuning);

}  // namespace pinode

#endif  // PINODE_PROBLEM_TUNING_H_
