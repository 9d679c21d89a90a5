// Tuning constants of the fit. Their values were found by measurement, and
// studies vary them. Constants of single algorithms are in the files of these
// algorithms. The limits of the verdict are in verdict_limits.h.

#ifndef PINODE_PROBLEM_TUNING_H_
#define PINODE_PROBLEM_TUNING_H_

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace pinode {

// Segment lengths of each stage (stage_schedule.h).
struct StageTuning {
  // Smallest length of the segments of the first stage in samples, and largest
  // length as a fraction of the shortest record.
  int least_first_samples = 10;
  double most_first_share = 0.25;
  // Divisor of the first stage's segment length for models with networks. An
  // untrained network makes simulations diverge sooner.
  int network_divisor = 3;
  // Factor by which segments grow from one stage to the next.
  int growth = 4;
  // Penalty on the gaps between segments in the search for a first trajectory.
  // With 100, a gap of a tenth of a state's RMS counts like one sigma. The
  // error of a model over a segment is about that large.
  double first_gap_penalty = 100.0;
  // Relative increase of the expected error above which the result of a stage
  // is discarded.
  double worse_share = 0.02;
};

// Search for the best starts of the segments (start_search.h).
struct StartTuning {
  // Fraction of the cost: the search ends if its next step promises to save
  // less. It also ends after max_iterations. An excess of the cost leaves an
  // error in its gradient, of the order of the square root of the excess.
  double tolerance = 1e-10;
  // Fraction of the change of the record's cost since the last linearisation:
  // the search also ends if its next step promises to save less. A step of the
  // parameters can then be judged. The next linearisation includes the rest.
  double change_tolerance = 1e-6;
  int max_iterations = 30;
  // Limits for hopeless steps. A step of the parameters that ruins the
  // trajectories leads to a long search for starts, and is then rejected. After
  // hopeless_iterations the search predicts the cost, less hopeless_promises
  // times the saving that the next step promises. It stops if this is above
  // hopeless_cost times the cost of the last linearisation. Uphill steps that
  // are to be accepted, as with networks, cost less.
  int hopeless_iterations = 4;
  double hopeless_cost = 3.0;
  double hopeless_promises = 4.0;
  // Limit for predicted starts, for records in one segment. Sensitivities
  // predict the starts after a step. If these cost more than this multiple of
  // the last linearisation's cost, the last starts are tried as well. In a
  // curved valley of the cost the prediction may be wrong, because the starts
  // hardly move. By default the step of the fit is made shorter instead.
  double stray_cost = std::numeric_limits<double>::infinity();
  // Precision of a prior that limits a free initial state in directions that no
  // channel observes. Its unit is 1 / D^2, with D the RMS of the state.
  double prior_precision = 1e-4;
};

// Closing of the gaps between segments (gap_penalty.h, fit.h).
struct GapTuning {
  // Size below which a gap counts as closed, in units of the state's RMS.
  double closed = 1e-6;
  // Firmness of the gap penalty: its initial value without and with networks,
  // its growth from round to round, and its limit. 1 is the firmness with which
  // the data determine the starts.
  double first_firmness = 0.01;
  double first_network_firmness = 0.1;
  double growth = 10.0;
  double most_firmness = 1e4;
  // Multiple of `closed` below which the trajectory counts as one piece. The
  // stages between this one and the last are then skipped.
  double nearly_closed = 10.0;
};

// Single solves, and the rounds of a stage (solve.h, fit.h).
struct SolveTuning {
  // Largest number of rounds of one stage. Multipliers, noise levels and decay
  // are updated between rounds. After half of the rounds the stage is brought
  // to its end.
  int max_rounds = 80;
  // Growth of the cost over the rounds of a stage, or beyond the cost of the
  // stages before it, above which its segments count as diverged.
  double diverged = 1e8;
  // Largest number of iterations of a round without and with networks, and the
  // relative change of the cost that ends it. The last round runs to the user's
  // tolerance.
  int round_iterations = 15;
  int network_round_iterations = 30;
  double round_tolerance = 1e-3;
  // Limit for slow rounds, with networks and gaps between segments. A round
  // also ends after crawling_steps steps in a row that change the cost by at
  // most this fraction. At that time the networks only explore and close the
  // gaps. A single small change does not count, because it may be a step across
  // a valley.
  double network_crawl = 0.03;
  int crawling_steps = 3;
  // Initial radius of the trust region without and with networks. Networks need
  // small steps at first.
  double first_radius = 1e4;
  double first_network_radius = 30.0;
  // Limits of this radius at the beginning of a round.
  double least_radius = 1e-2;
  double most_radius = 1e8;
  // Number of uphill steps that Ceres may take before it goes back. They help
  // straight steps in the curved valleys of a network. Curved steps do without:
  // uphill they leave the valley, for regions in which only short steps are
  // possible.
  int uphill_steps = 5;
  // Change of the cost in one iteration below which a fit with networks has
  // converged, and its largest value relative to the cost. The cost is a
  // negative log-likelihood.
  double smallest_change = 0.03;
  double most_network_tolerance = 1e-2;
  // RMS of the residuals, in units of the noise levels, below which a fit has
  // converged in any round. The remaining error is far below the noise.
  double smallest_residual = 0.07;
  // Number of iterations after which the relative change of the cost decides on
  // convergence again.
  int fine_network_iterations = 50;
};

// Noise levels (reweighting.h). Shares are fractions of the standard deviation
// of a channel's samples, unless stated.
struct NoiseTuning {
  // First guess of a noise that is estimated.
  double first_share = 0.05;
  // Smallest estimate of the noise, as a share of the channel's RMS.
  double smallest = 1e-8;
  // Smallest noise with networks whose decay the evidence chooses. The error of
  // a network is not noise. With a smaller noise the evidence would prefer
  // weights that do not generalise.
  double smallest_misfit = 0.002;
  // Limits of the change of noise from round to round. Early residuals mislead,
  // and a network needs time to adapt. `shrink`: smallest factor.
  // `network_step_down`: largest relative decrease with networks. `growth`:
  // largest factor.
  double shrink = 0.1;
  double network_step_down = 0.4;
  double growth = 10.0;
  // Smallest fraction of samples that remains for the estimate of noise after
  // subtracting one per determined parameter. least_share_left applies to all
  // samples, least_channel_left to one channel with an unknown force.
  double least_share_left = 0.1;
  double least_channel_left = 0.01;
  // Smallest fraction of a channel's samples that an unknown force leaves for
  // the estimate of its noise. With less, the likelihood has a second maximum,
  // with no noise and a force that follows every sample.
  double followed = 0.1;
  // Relative change below which noise levels have settled.
  double quiet = 0.02;
};

// Weight decay chosen by the evidence (D. J. C. MacKay 1992; evidence.h). A
// decay is the precision of the prior of a group of parameters.
struct EvidenceTuning {
  // Initial precision of a decay, and its upper limit.
  double first_decay = 0.1;
  double most_decay = 1e8;
  // Largest factor by which a decay changes at once. A group that seems idle
  // early may be needed later.
  double most_change = 100.0;
  // Smallest number of well-determined parameters, and smallest sum of squares,
  // of a group.
  double least_determined = 1e-3;
  double least_squares = 1e-12;
  // Number of rounds for the decay of networks after the noise levels have
  // settled. The fit then runs to its tolerance.
  int rounds = 12;
  // Limits for the end of a fit. It ends when the number of well-determined
  // parameters has changed by less than the fraction `quiet` in quiet_rounds
  // rounds. It also ends after `rounds` more rounds. A change above
  // new_evidence shows another explanation of the data. Its unneeded weights
  // must then shrink in turn.
  double quiet = 0.01;
  int quiet_rounds = 3;
  double new_evidence = 0.1;
  // Limits without networks: the decay has settled if that number changes by
  // less than this fraction of the parameters, and by less than this amount.
  double quiet_share = 0.01;
  double quiet_parameters = 0.1;
};

// Second training of a network, by annealing (annealing.h). The first training,
// at the smallest noise, soon finds a good fit, but one that uses all inputs.
// For the second, the network is drawn again, close to a linear map, and the
// noise decreases step by step. The evidence then first admits the inputs that
// the data require most. Unneeded inputs stay out.
struct AnnealingTuning {
  // Initial noise, as a fraction of the standard deviation of a channel's
  // samples.
  double noise = 0.1;
  // Scale of the hidden weights that are drawn again.
  double weights = 0.1;
  // Initial decay of the output weights as a fraction of
  // EvidenceTuning::first_decay. It is small because these weights have to be
  // large.
  double output_decay = 1e-4;
  // Number of updates of the noise that measure the remaining error of the
  // first fit.
  int measuring_rounds = 3;
};

// Uncertainty bands of unknown forces (force_bands.h).
struct ForceBandTuning {
  // Range, in samples, over which the variances of neighbouring knots are
  // pooled.
  double pooled_samples = 2.0;
};

// Multiple starts (multistart.h).
struct MultistartTuning {
  // Relative difference of costs below which two starts count as at the same
  // minimum.
  double same_cost = 1e-3;
  // Range from the mean, in standard deviations of the prior, within which a
  // parameter with a prior is drawn.
  double prior_deviations = 2.0;
};

// Tuning constants of the fit, one group for each part that uses them. They are
// for studies; settings for users are in IdentificationOptions. Section 13 in
// pinode/theory/noise_and_decay.md shows the effect of halving and doubling
// each (tests/cases/tuning_study_test.cc).
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

// One constant with its name, such as "gaps.closed".
struct TuningField {
  std::string name;
  std::variant<double*, int*> value;

  double Get() const;
  // Sets the constant. Integers are rounded, and stay at least 1.
  void Set(double number) const;
};

// Returns all constants of *tuning in the order of their declaration. *tuning
// must outlive them.
std::vector<TuningField> TuningFields(Tuning* tuning);

}  // namespace pinode

#endif  // PINODE_PROBLEM_TUNING_H_
