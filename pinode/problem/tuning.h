// Every number of the fit that was found by measuring, in one place.

#ifndef PINODE_PROBLEM_TUNING_H_
#define PINODE_PROBLEM_TUNING_H_

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace pinode {

// Lengths of the segments of each stage (stage_schedule.h).
struct StageTuning {
  // The first segment of a stage schedule has at least so many samples, and is
  // at most this share of the shortest record.
  int least_first_samples = 10;
  double most_first_share = 0.25;
  // A model that lacks its nonlinear part goes astray sooner: with networks the
  // first segment is shorter by this factor.
  int network_divisor = 3;
  // From one stage to the next.
  int growth = 4;
  // Between the first segments' ends and the next starts, in the search for a
  // first trajectory: a gap of a tenth of a state's RMS counts like one sigma,
  // for the model is wrong by about that much over a segment.
  double first_gap_penalty = 100.0;
  // A stage that makes the error to be expected larger by this share is undone.
  double worse_share = 0.02;
};

// The search for the best segment starts (start_search.h).
struct StartTuning {
  // It ends when its next step promises to lower the cost by less than this
  // fraction, or after so many steps. Starts that are short of the best ones
  // leave in the gradient an error of the order of the square root of what they
  // cost.
  double tolerance = 1e-10;
  // Or by less than this share of the change of the record's cost since the
  // last linearisation: that is enough to judge a step of the parameters, and
  // the next linearisation takes the rest into account.
  double change_tolerance = 1e-6;
  int max_iterations = 30;
  // A step that ruins the trajectories costs a long search for starts, only to
  // be rejected. So the search gives up, after this many iterations, where the
  // cost would stay above this multiple of the last linearisation's even if it
  // fell by this multiple of what the next step promises. (A step uphill that
  // is not to be rejected, as with networks, costs less than that.)
  int hopeless_iterations = 4;
  double hopeless_cost = 3.0;
  double hopeless_promises = 4.0;
  // Whole records: where the starts that the sensitivities predict come to more
  // than this multiple of the last linearisation's cost, the last starts are
  // tried as well. Steps of a fit are better made shorter; along a valley that
  // is bent the starts hardly move, and the sensitivities do not know.
  double stray_cost = std::numeric_limits<double>::infinity();
  // Precision, in units of 1 / D^2, of the prior that keeps a free first start
  // from drifting where no channel sees it.
  double prior_precision = 1e-4;
};

// How a stage closes the gaps between its segments (gap_penalty.h, stage.h).
struct GapTuning {
  // Gaps are closed when they are below this, in units of the state's RMS.
  double closed = 1e-6;
  // How firmly gaps are closed at first, as a share of how firmly the data hold
  // the starts; by what it grows from round to round, and up to what.
  double first_firmness = 0.01;
  double first_network_firmness = 0.1;
  double growth = 10.0;
  double most_firmness = 1e4;
  // With gaps this many times as large as closed ones the trajectory is one
  // piece: the stages between this one and the last would change nothing.
  double nearly_closed = 10.0;
};

// One solve, and the rounds of a stage (solve.h, stage.h).
struct SolveTuning {
  // Rounds of one stage: multipliers, noise levels and decay are updated
  // between them. From half of them on a stage is brought to its end.
  int max_rounds = 80;
  // Growth of the cost over the rounds of a stage at which its segments have
  // flown apart.
  double diverged = 1e8;
  // Iterations of a round, and the change of the cost that ends it, before the
  // last round, which runs to the tolerance that the user asked for.
  int round_iterations = 15;
  int network_round_iterations = 30;
  double round_tolerance = 1e-3;
  // With networks, while segments have gaps, a round ends as well after so many
  // steps in a row that change the cost by no more than this share: that first
  // learning is to find out what they can do and to close the gaps, no more.
  // One such change may be a step across the valley.
  double network_crawl = 0.03;
  int crawling_steps = 3;
  // First radii of the trust region; networks need small steps at first.
  double first_radius = 1e4;
  double first_network_radius = 30.0;
  // Between rounds it stays within these.
  double least_radius = 1e-2;
  double most_radius = 1e8;
  // Steps that Ceres may take uphill before it goes back, where steps are
  // straight and the valleys, those of a network, bend. A step that bends needs
  // none: uphill it leads out of the valley, to where nothing but short steps
  // is left.
  int uphill_steps = 5;
  // Change of the cost, a negative logarithm of likelihood, in one iteration at
  // which a fit with networks has converged; and the largest such change in
  // units of the cost.
  double smallest_change = 0.03;
  double most_network_tolerance = 1e-2;
  // RMS of the residuals, in units of the noise levels, at which it has
  // converged as well, in any round: nobody can see the rest.
  double smallest_residual = 0.07;
  // Iterations after which that is measured by the cost anew.
  int fine_network_iterations = 50;
};

// Noise levels (noise_levels.h). All shares are of a channel's spread.
struct NoiseTuning {
  // A first guess of noise that is to be estimated.
  double first_share = 0.05;
  // No estimate goes below this share of the channel's RMS.
  double smallest = 1e-8;
  // With networks whose decay the evidence chooses the noise is never taken to
  // be below this share: what a network leaves over is misfit, and trusting it
  // further makes the evidence buy weights for it that do not generalise.
  double smallest_misfit = 0.002;
  // Noise changes from round to round by no more than these factors: early
  // residuals mislead, and a network needs time to find out what it can do
  // without. Down to this share; with networks down by this one.
  double shrink = 0.1;
  double network_step_down = 0.4;
  double growth = 10.0;
  // Of all samples, at least this share is taken to be left after what the
  // parameters have used up, and of one channel beside an unknown force.
  double least_share_left = 0.1;
  double least_channel_left = 0.01;
  // A noise level is estimated from what an unknown force leaves of a channel.
  // Below this share of its samples there is a second maximum of the
  // likelihood, with no noise and a force that follows every sample.
  double followed = 0.1;
  // Levels are quiet where none would change by more than this share.
  double quiet = 0.02;
};

// Weight decay by the evidence (evidence.h).
struct EvidenceTuning {
  // First precision of a decay, and its upper limit.
  double first_decay = 0.1;
  double most_decay = 1e8;
  // No decay changes more than this at once: a group that seems idle early may
  // be needed later.
  double most_change = 100.0;
  // Least well-determined parameters and sum of squares of a group.
  double least_determined = 1e-3;
  double least_squares = 1e-12;
  // Rounds for the decay of networks after the noise levels have settled,
  // before the fit runs to its tolerance.
  int rounds = 12;
  // A fit has not ended before the number of well-determined parameters has
  // changed by less than this share in so many rounds (or `rounds` have passed
  // again). Where it changes by more than `new_evidence` the fit has found
  // another way to explain the data, which is to fade down to what is needed in
  // turn.
  double quiet = 0.01;
  int quiet_rounds = 3;
  double new_evidence = 0.1;
  // Without networks: quiet where that number changes by less than this share
  // of the parameters, and by this much.
  double quiet_share = 0.01;
  double quiet_parameters = 0.1;
};

// The second learning of a network (annealing.h). The first, at the smallest
// noise, finds a good fit soon, but one of the many that bring in all inputs.
// Then the network is drawn anew, close to a linear map, and the noise comes
// down step by step: the evidence grants what the data ask for most before the
// rest, and inputs that are not needed stay out.
struct AnnealingTuning {
  // Share of a channel's spread at which its noise begins.
  double noise = 0.1;
  // Scale of the hidden weights drawn anew.
  double weights = 0.1;
  // First decay of the output weights, which then have to be large, as a share
  // of EvidenceTuning::first_decay.
  double output_decay = 1e-4;
  // Updates of the noise that measure what the first fit has left over.
  int measuring_rounds = 3;
};

// Bands of unknown forces (force_bands.h).
struct ForceBandTuning {
  // Variances of neighbourhoods are pooled within so many samples.
  double pooled_samples = 2.0;
};

// Several starts (multistart.h).
struct MultistartTuning {
  // Starts whose costs differ by less than this share have reached the same
  // minimum.
  double same_cost = 1e-3;
  // A parameter with a prior is drawn within so many of its deviations.
  double prior_deviations = 2.0;
};

// The constants of the fit, a group for each part that uses them. For studies:
// what a user needs is an option. What halving and doubling each of
// them does stands in theory.md, section 13 (tests/cases/tuning_study_test.cc).
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

// One of the constants, by its name: "gaps.closed".
struct TuningField {
  std::string name;
  std::variant<double*, int*> value;

  double Get() const;
  // Integers are rounded, and stay at least 1.
  void Set(double number) const;
};

// All constants of *tuning, which must outlive them, in the order in which they
// are declared.
std::vector<TuningField> TuningFields(Tuning* tuning);

}  // namespace pinode

#endif  // PINODE_PROBLEM_TUNING_H_
