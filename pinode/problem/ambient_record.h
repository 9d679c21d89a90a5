// Records in the frequency domain: ambient records, which are responses to
// loads that were not measured, and frequency response functions.

#ifndef PINODE_PROBLEM_AMBIENT_RECORD_H_
#define PINODE_PROBLEM_AMBIENT_RECORD_H_

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/record/excitation.h"
#include "pinode/record/filter.h"

namespace pinode {

// Record of the responses to random forces with unknown spectral densities. The
// forces are stationary over the record. The responses have the spectral
// density
//
//   S_y(w) = H(w) S_f(w) H(w)^H + diag(noise),   S_f(w) = sum_b t_b(w) P_b.
//
// at the angular frequency w. H is the transfer function from the forces in
// `loads` to the channels. t_b is a triangle over the logarithm of the
// frequency around knot b. P_b is the unknown, positive semidefinite covariance
// of the forces at this knot. The spectrum of wind has this form: it is
// correlated between areas and falls with frequency.
//
// Measured forces may act as well. The record minus the model's response to
// them, from rest, then has this density. The source of the likelihood is in
// pinode/theory/ambient.md.
struct AmbientRecord {
  std::string name;
  double sampling_step = 0.0;  // in the model's unit of time
  std::vector<Observation> channels;
  Matrix samples;  // channels x samples, in the model's units; NaN: missing

  // Distribution of the unknown forces, num_dofs x areas, and the names of the
  // areas. Each column has the forces at the DOFs for a unit load on one area.
  //
  // If `loads` and `base` are empty, a force acts on each mode of the initial
  // model in and near the band. These forces can represent any load on the
  // structure, because a load acts on its modes. With more than 24 such modes,
  // or uncorrelated loads, forces act at the channels instead.
  Matrix loads;
  std::vector<std::string> areas;
  // Distribution of unmeasured accelerations of the base, num_dofs x
  // directions. Each column has the displacements of the DOFs for a unit
  // displacement of the base in one direction. Channels of absolute
  // acceleration also measure the acceleration of the base itself.
  Matrix base;
  // False: the forces of different areas, and the motions of the base, are
  // independent, so that each P_b is diagonal.
  bool correlated = true;
  // Number of knots of the spectrum. 1: white noise. 0: one knot per octave of
  // the band.
  int knots = 0;

  // Measured inputs, one row per input of the dynamics, with as many samples as
  // the record. Measured loads need linear dynamics. Covariates that groups
  // follow are replaced by their mean over the record.
  std::optional<Excitation> inputs;
  // Filter that was already applied to `samples`; null: none. The fit applies
  // it to the response to measured loads.
  std::shared_ptr<const ZeroPhaseFilter> filter;

  // Band of the fit, in cycles per unit of the model's time. Default (0): from
  // 0.3 times the lowest frequency of the initial model to 1.5 times its
  // highest, and at most 0.4 times the sampling rate.
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;

  // Returns the rows of `inputs` that are loads and vary with time, loads x
  // samples.
  Matrix MeasuredLoads(const StructuralDynamics& dynamics) const;
  bool HasMeasuredLoads(const StructuralDynamics& dynamics) const {
    return MeasuredLoads(dynamics).rows() > 0;
  }
  // Returns the dynamics with each covariate of a group at its mean over the
  // record.
  StructuralDynamics AveragedDynamics(const StructuralDynamics& dynamics) const;
  // Returns the frequency of the initial model's lowest mode inside the band,
  // in cycles per unit of the model's time. 0: none.
  double LowestModeInBand(const StructuralDynamics& dynamics) const;

  // Checks the record: channels are displacements, velocities, accelerations or
  // strains; sizes fit the dynamics; there are at least 200 samples; the loads
  // exist. On failure returns false, with a sentence in *error.
  [[nodiscard]] bool IsValid(const StructuralDynamics& dynamics,
                             std::string* error) const;
};

// Evidence for the fitted spectrum of the loads, in natural logarithms (R. E.
// Kass and L. Wasserman 1995; see JudgeLoads).
struct LoadEvidence {
  // Logarithm of the likelihood, without the prior of the covariances, and the
  // price of the fitted loads and noise. The evidence is their difference.
  double log_likelihood = 0.0;
  double price = 0.0;
  // Number of knots of a finer spectrum, with one more knot between any two,
  // and the increases of likelihood and price that it would bring. They are
  // estimated without a fit. 0 knots: no finer spectrum was examined.
  int finer_knots = 0;
  double finer_gain = 0.0;
  double finer_price = 0.0;

  // True if the finer spectrum is worth its price.
  bool PromisesMore() const {
    return finer_knots > 0 && finer_gain > finer_price;
  }
};

// Scores of the fit for an ambient record.
struct AmbientScore {
  std::string name;
  // Band of the fit, in cycles per unit of the model's time.
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;
  // Number of lines (discrete frequencies) in the band.
  Eigen::Index num_lines = 0;
  int num_knots = 0;  // of the spectrum of the loads
  LoadEvidence evidence;
  // Test of the model by whitened lines. If the model is right, each line has
  // the power 1, and means over parts of the band deviate from 1 by chance
  // only. `probability` is the probability of a chi^2 at least as large as the
  // one found.
  double chi_square = 0.0;
  Eigen::Index degrees_of_freedom = 0;
  double probability = 1.0;
  // Test of the record minus the response to measured loads. If the model is
  // right, it correlates with that response by chance only. The value is the
  // probability of a chi^2 at least as large as the one found.
  double coherence_probability = 1.0;
  // Part of the band that deviates most, in cycles per unit of the model's
  // time, and its deviation from 1 in standard deviations.
  double worst_from = 0.0, worst_to = 0.0, worst_deviation = 0.0;
  // Results per channel. `explained` is the fraction of its power in the band
  // that the motion of the structure explains; the rest is noise.
  // `by_measured_loads` is the fraction that measured loads alone explain;
  // empty: no measured loads. `noise_sigma` is the standard deviation of the
  // noise over all frequencies, in the channel's unit.
  std::vector<std::string> channels;
  Vector explained;
  Vector by_measured_loads;
  Vector noise_sigma;
  // Names of the free groups. `information_left` has for each the fraction of
  // the record's information (1 / variance) that is left because the loads are
  // unknown. `most_information_left` is the largest such fraction of any
  // combination of groups.
  std::vector<std::string> groups;
  Vector information_left;
  double most_information_left = 1.0;
  // One-sided spectral densities of the channels, channels x frequencies,
  // measured and modelled, in the channel's unit squared times the model's unit
  // of time. `frequencies` are in cycles per unit of the model's time.
  // Measured values are means over `lines` lines, without the response to
  // measured loads.
  Vector frequencies;
  Matrix measured;
  Matrix modelled;
  Vector lines;

  // Returns the smaller probability of the two tests.
  double LeastProbability() const {
    return std::min(probability, coherence_probability);
  }
};

// Measured frequency response functions (FRFs) h of responses to references,
//
//   h(w) = gain e^(-i w delay) (i w)^d S Z(w)^-1 L + noise,
//   Z(w) = (1 + i loss_factor) K + i w C - w^2 M,
//
// at the angular frequency w. S are the weights of a response, L the forces of
// a reference, and d is the order of the derivative that the response measures.
// The real and the imaginary part of the noise are independent from line to
// line and have equal variances.
struct FrfRecord {
  std::string name;
  // Lines in use, in cycles per unit of the model's time, positive and
  // ascending.
  Vector frequencies;
  // Displacements, velocities or relative accelerations.
  std::vector<Observation> responses;
  // Forces on the DOFs for a unit force at each reference, num_dofs x
  // references, and the names of the references.
  Matrix references;
  std::vector<std::string> reference_names;
  // Measured values, lines x pairs, in the model's units. Column `response +
  // responses.size() * reference` is one pair. NaN: not measured.
  ComplexMatrix values;
  // Variances of the lines relative to the others of the same pair, lines x
  // pairs. Empty: equal.
  Matrix variances;
  // Standard deviation of the real and of the imaginary part of each pair, in
  // the model's units, where the relative variance is 1. Empty: estimated from
  // the residuals.
  Vector sigma;
  // Indices of the gain and the delay of each response, and of the loss factor,
  // in IdentificationProblem::sensors. Empty, or -1: the ideal value (1, 0, 0).
  std::vector<int> gains, delays;
  int loss_factor = -1;

  Eigen::Index num_lines() const { return frequencies.size(); }
  Eigen::Index num_responses() const {
    return static_cast<Eigen::Index>(responses.size());
  }
  Eigen::Index num_references() const { return references.cols(); }
  Eigen::Index num_pairs() const { return num_responses() * num_references(); }
  // Returns "response/reference".
  std::string PairName(Eigen::Index pair) const;

  // Checks sizes, numbers and quantities, and that the dynamics are linear
  // without terms for records of time. `num_sensors` is the number of the
  // problem's sensor parameters. On failure returns false, with a sentence in
  // *error.
  [[nodiscard]] bool IsValid(const StructuralDynamics& dynamics,
                             int num_sensors, std::string* error) const;
};

// Scores of the fit for FRFs. Vectors have one entry per pair.
struct FrfScore {
  std::string name;
  // Band of the lines, in cycles per unit of the model's time.
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;
  Eigen::Index num_lines = 0;
  std::vector<std::string> pairs;
  // Norm of the weighted error divided by the norm of the weighted FRF, for the
  // fitted model and for the initial one (`prior_errors`).
  Vector errors;
  Vector prior_errors;
  // The same of the part of the error that noise does not explain: it has a
  // memory from line to line, or it is larger where the FRF is larger.
  Vector unexplained;
  // Standard deviation of the noise, as given or as estimated.
  Vector sigma;
  // Root mean square of the error in multiples of the given noise; empty if it
  // was estimated.
  Vector noise_ratios;
  // p-value of the test that all errors are noise, corrected for the number of
  // pairs. A small value means that the model is incomplete.
  double probability = 1.0;
  // Logarithm of the likelihood, up to a constant of the data, and the memory
  // of the errors in lines: that of white noise is 1.
  double log_likelihood = 0.0;
  double memory = 1.0;
  // Lines of the report, in cycles per unit of the model's time, and values
  // there, pairs x lines.
  Vector frequencies;
  Matrix measured_real, measured_imaginary;
  Matrix modelled_real, modelled_imaginary;

  // Largest entries over the pairs.
  double WorstError() const { return Largest(errors); }
  double WorstUnexplained() const { return Largest(unexplained); }

 private:
  static double Largest(const Vector& values) {
    return values.size() > 0 ? values.maxCoeff() : 0.0;
  }
};

// Value of FrfScore::probability below which intervals come from a sandwich
// estimate of the covariance.
inline constexpr double kDoubtfulFrfProbability = 0.01;

// Value of LeastProbability() below which intervals come from a sandwich
// estimate of the covariance.
inline constexpr double kDoubtfulAmbientProbability = 0.05;

// Largest allowed number of unknowns in the P_b of all knots together.
inline constexpr Eigen::Index kMostLoadUnknowns = 4000;

}  // namespace pinode

#endif  // PINODE_PROBLEM_AMBIENT_RECORD_H_
