// Limits of the checks that decide a verdict, each with the measurement or the
// reason that set it. No other file holds a limit of the verdict.

#ifndef PINODE_PROBLEM_VERDICT_LIMITS_H_
#define PINODE_PROBLEM_VERDICT_LIMITS_H_

namespace pinode::limits {

// Prediction of records. nrmse = |y - yhat| / |y - mean(y)| of the free run.

// A training record must be predicted better than this; no motion at all has 1.
// Fits of pure noise end just below 1, down to 0.98.
constexpr double kNoMotion = 0.98;
// The same of a hold-out record, which no fit has adapted to.
constexpr double kNoMotionOfHoldout = 1.0;
// Largest unexplained motion of a training record, beyond its noise. With the
// wrong load, a load at the wrong place or time, exchanged sensors or a third
// of the damping, fits of a frame's storeys ended at 0.47 to 0.87. All
// predicted better than the initial model, with intervals tens of their widths
// off. A third would refuse a measured frame with stiff storeys, of which a
// shear model with the published frequencies misses some 40 %.
constexpr double kUnexplained = 0.4;
// Above this the model lacks something: intervals that presume that it lacks
// nothing are too narrow, and the result is usable with care.
constexpr double kLittleUnexplained = 0.05;
// Largest unexplained motion that a network which learns a force may leave: it
// can be any force of its inputs, so that more shows a force of other inputs,
// or a poor minimum.
constexpr double kUnexplainedByNetwork = 0.1;
// Largest unexplained motion that unknown forces may leave, and the largest
// that needs no care: they take over most of what a model lacks. Under a swept
// sine on a frame of three storeys (data/three_storey_force) with three
// accelerometers, 19 % were left by a mass off by 15 % and 20 % by the wrong
// storey, with forces off by 100 and 90 %; 5 % by a storey off by 11 % (force
// off by 21 %); 1.2 % by a missing cubic spring (force off by 5 %).
constexpr double kUnexplainedByForce = 0.1;
constexpr double kLittleUnexplainedByForce = 0.02;
// Remarked below that limit: friction of a tenth of a storey's force left 0.05,
// and intervals that excluded the truth.
constexpr double kNotedUnexplained = 0.02;
// Remarked even where most of the error is noise.
constexpr double kMuchUnexplained = 0.1;
// Hold-out records. The result does not carry over where the error is above
// both kHoldoutError and kHoldoutGrowth times the training error, or where the
// unexplained motion is above kUnexplainedOfHoldout: the record belongs to
// another structure, or the model is wrong.
constexpr double kHoldoutError = 0.5;
constexpr double kHoldoutGrowth = 3.0;
constexpr double kUnexplainedOfHoldout = 0.7;
// The linear terms alone may predict the training records as well, up to
// rounding of the free runs.
constexpr double kLinearTermsTolerance = 1.001;

// Measured modes.

// Probability of errors as large as those of measured modes, by their standard
// deviations (chi^2), below which the model or the deviations are wrong. A mode
// misread by 5 %, a mass off by 30 % and the like left 6 to 37 times the
// degrees of freedom.
constexpr double kModesProbability = 1e-4;

// Largest distance of a measured mode from its partner: the logarithm of the
// ratio of frequencies (35 %), and the MAC.
constexpr double kModeDistance = 0.3;
constexpr double kModeMac = 0.5;
// MAC that each measured shape should have with a mode of the updated model.
// Without standard deviations, one entry of the wrong sign left a MAC of 0.51
// and 0.66 in chains of storeys, and intervals that presume small errors.
// Right models of them, with errors of 0.01, have 0.999. Known standard
// deviations of a shape lower the limit.
constexpr double kShapeMet = 0.9;
// The worst frequency may be off by this, or by this many times the initial
// model's error. More of both means that shapes have driven it there.
constexpr double kFrequencyMet = 0.02;
constexpr double kFrequencyGrowth = 2.0;
// Largest error of a frequency of any updated model. Sensors in another order
// ended at 0.16 and 0.20, one upside down at 0.12.
constexpr double kFrequencyError = 0.1;
// Largest root mean square error of frequencies that were fitted alone, in
// their standard deviations, if the worst is also off by more than
// kFrequencyMet. A free plate whose start was off by a factor of two ended at
// 30 in a wrong valley, with an interval that excluded the truth.
constexpr double kFrequencyDeviations = 10.0;
// Largest common factor between the measured frequencies and the initial
// model's. A model is not nine times too soft; radians per second in place of
// cycles give 6.3, wrong units of mass or length the root of their factor.
constexpr double kFrequencyScale = 3.0;

// Ambient records.

// Smallest probability that the difference between a record's spectra and the
// model's, or its coherence with measured loads, is chance: one false alarm in
// ten thousand records of a right model.
constexpr double kSpectrumProbability = 1e-4;
// Smallest share of all information on the groups that the unmeasured loads
// must leave: less, and they explain all that a record shows.
constexpr double kAnyInformationLeft = 0.01;
// Smallest share of the information on a group that the unmeasured loads must
// leave. Where less is left, as in bands beside all modes, so little of the
// cost is quadratic that 95 % intervals, however narrow, held the truth in 50
// to 90 of 100 records.
constexpr double kInformationLeft = 0.1;
// Widest half interval of a group that counts as determined, in multiples of 1
// or of its value.
constexpr double kWidestInterval = 1.0;

// Frequency response functions.

// Largest part of an FRF's norm that the model may leave unexplained beyond
// noise. Of a chain of three masses with noise of 1 % and three springs free, a
// mass off by 30 % left 1.2, by 10 % 0.22, and twice the damping 0.4; springs
// were off by up to 0.3, tens of their widths. A mass off by 2 % left 0.05:
// springs were off by 0.02, and the intervals that allow for the explanation
// held the truth.
constexpr double kFrfUnexplained = 0.1;
// Smallest probability that residuals which are not alike noise are chance. The
// right model of that chain had 0.4 to 1, a mass off by half a per cent 1e-109,
// damping off by a tenth 0.
constexpr double kFrfProbability = 1e-4;
// Fewest lines of FRFs that can tell a wrong model by its residuals. Of 25
// wrong models of a chain with six modes in the band, up to a quarter left
// residuals alike noise at 10 to 20 lines, and none at 24 to 60. 100 lines are
// enough for as many lines a mode with 25 modes.
constexpr int kFewFrfLines = 100;
// A fit may raise the error of FRFs by this factor, because pairs with little
// noise count more.
constexpr double kFrfErrorGrowth = 1.05;
// Error of exact data, as a share of the FRF.
constexpr double kFrfRounding = 1e-5;

// Sensors and unknowns against what the problem says of them.

// Two channels are a copy of each other if 1 minus the size of their
// correlation is below this: noise of a ten-thousandth in one of them is more.
constexpr double kCopy = 1e-9;
// Largest error of a channel in multiples of its given noise. Correct noise
// gives 1; a model that lacks a little, somewhat more. Far above it the
// intervals, which follow from the given noise, mean nothing.
constexpr double kGivenNoise = 1.5;
constexpr double kGivenNoiseFar = 5.0;
// Largest distance of an unknown from its prior, in the prior's deviations.
constexpr double kPriorContradicted = 4.0;
// Largest size of a stiffness or mass group in multiples of what the model has:
// doubtful, and beyond belief. A copied channel drove a storey to 13.6, wrong
// masses drove a tower's spring to 15.7.
constexpr double kGroupSize = 4.0;
constexpr double kGroupSizeFar = 10.0;

// Damping ratio above which a mode is doubtful, and beyond belief, where the
// initial model's is less than half. A shear model of a stiff frame that sways
// and twists met 25 and 40 Hz by one mode pair of 21 Hz with 0.49.
constexpr double kModeDamping = 0.2;
constexpr double kModeDampingFar = 0.4;
// Size of the least eigenvalue of a damping matrix that drives motion, as a
// share of the largest. Three dampers of a tower whose model lacked a mass were
// negative.
constexpr double kNegativeDamper = 0.01;

// Other explanations.

// Logarithm of the odds above which another explanation counts: odds of 20 (R.
// E. Kass and A. E. Raftery, J. Amer. Statist. Assoc. 90 (1995) 773-795).
constexpr double kLogOdds = 2.995732273553991;
// It matters if it moves a named parameter by more than this many half-widths
// of the 95 % interval.
constexpr double kShiftByExplanation = 1.0;

// Parts of the records.

// A part of the records contradicts the whole where it moves an unknown out of
// its interval, by a hundredth of the value at least (of 1 for groups), and by
// this many standard deviations. On the 11 structures of
// tests/benchmarks/verdicts with nothing wrong (seeds 1001 to 1040) none does.
constexpr double kBlockDeviations = 4.0;
constexpr double kBlockShare = 0.01;

// The solution.

// A damping ratio below minus this is negative by more than rounding.
constexpr double kDamping = 1e-6;
// The matrices must not let a motion grow e-fold within a record. Less makes no
// free run infinite, and rounding makes rigid bodies grow a little.
constexpr double kGrowth = 1.0;
// Largest shift of a parameter, in its standard deviations, by halving the
// integration step, if it is also a hundredth of the value (of 1 for groups).
// Half of a deviation is remarked.
constexpr double kStepShift = 2.0;
constexpr double kStepShare = 0.01;
constexpr double kNotedStepShift = 0.5;

}  // namespace pinode::limits

#endif  // PINODE_PROBLEM_VERDICT_LIMITS_H_
