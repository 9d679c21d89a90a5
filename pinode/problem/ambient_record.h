// Records of a structure under loads that were not measured.

#ifndef PINODE_PROBLEM_AMBIENT_RECORD_H_
#define PINODE_PROBLEM_AMBIENT_RECORD_H_

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/record/excitation.h"
#include "pinode/record/filter.h"

namespace pinode {

// Record of the responses to random forces that are stationary over the record
// and have unknown spectral densities:
//
//   S_y(w) = H(w) S_f(w) H(w)^H + diag(noise),   S_f(w) = sum_b t_b(w) P_b.
//
// H is the transfer function from the forces in `loads` to the channels. The
// t_b are triangles over the logarithm of the frequency, one around each knot.
// The P_b are unknown, positive semidefinite covariances between the forces. A
// spectrum that is correlated between areas and falls with frequency, as that
// of wind, has this form. Measured forces may act as well: the record less the
// model's response to them, from rest, then has this density.
struct AmbientRecord {
  std::string name;
  double sampling_step = 0.0;  // model time
  std::vector<Observation> channels;
  Matrix samples;  // channels x samples, in the model's units; NaN: missing

  // Distribution of the unknown forces, num_dofs x areas, and the names of the
  // areas. If `loads` and `base` are empty, a force acts on each mode of the
  // initial model in and near the band. With more than 24 such modes, or
  // uncorrelated loads, forces act at the channels instead. Any load on the
  // structure excites its modes in the same way as such forces.
  Matrix loads;
  std::vector<std::string> areas;
  // Distribution of unmeasured accelerations of the base, num_dofs x
  // directions: displacements of the DOFs as they follow the base. Channels of
  // absolute accelerations also see the acceleration of the base itself.
  Matrix base;
  // False: forces of different areas, and motions of the base, are independent.
  bool correlated = true;
  // Number of knots of the spectrum. 1: white; 0: one per octave of the band.
  int knots = 0;

  // Measured inputs, one row per input of the dynamics, with as many samples as
  // the record. Loads need linear dynamics. Covariates that groups follow enter
  // with their mean over the record.
  std::optional<Excitation> inputs;
  // Filter that the reader already applied to `samples`. The cost applies it to
  // the response to measured loads.
  std::shared_ptr<const ZeroPhaseFilter> filter;

  // Band of the fit, in cycles per model time. Default (0): from 0.3 of the
  // lowest frequency of the initial model to 1.5 of its highest, and at most
  // 0.8 of half the sampling rate.
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;

  // Returns the rows of `inputs` that are loads and vary with time.
  Matrix MeasuredLoads(const StructuralDynamics& dynamics) const;
  bool HasMeasuredLoads(const StructuralDynamics& dynamics) const {
    return MeasuredLoads(dynamics).rows() > 0;
  }
  // Returns the dynamics with the covariates of groups at their means over the
  // record.
  StructuralDynamics AveragedDynamics(const StructuralDynamics& dynamics) const;
  // Returns the frequency (cycles per model time) of the initial model's lowest
  // mode inside the band; 0: none.
  double LowestModeInBand(const StructuralDynamics& dynamics) const;

  // Checks that channels are displacements, velocities, accelerations or
  // strains with sizes that fit the dynamics, that there are at least 200
  // samples, and that the loads exist. On failure *error says what is wrong.
  [[nodiscard]] bool IsValid(const StructuralDynamics& dynamics,
                             std::string* error) const;
};

// Evidence for the spectrum of a record's loads, in natural logarithms, see
// JudgeLoads.
struct LoadEvidence {
  // Logarithm of the likelihood, without the prior of the covariances; and the
  // evidence's price for the loads and noise that were fitted.
  double log_likelihood = 0.0;
  double price = 0.0;
  // Increases of both for a spectrum with one more knot between any two,
  // estimated before it is fitted. 0 knots: the finer spectrum was not
  // examined.
  int finer_knots = 0;
  double finer_gain = 0.0;
  double finer_price = 0.0;

  bool PromisesMore() const {
    return finer_knots > 0 && finer_gain > finer_price;
  }
};

// Scores of the fit for an ambient record.
struct AmbientScore {
  std::string name;
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;
  Eigen::Index num_lines = 0;
  int num_knots = 0;  // of the loads' spectrum
  LoadEvidence evidence;
  // Test of the whitened lines: if the model is right, each has power one, and
  // means over parts of the band deviate from one by chance alone.
  // `probability` is that of a chi^2 as large as the one found. `worst_from` to
  // `worst_to` (cycles per model time) is the part that deviates most, by
  // `worst_deviation` standard deviations.
  double chi_square = 0.0;
  Eigen::Index degrees_of_freedom = 0;
  double probability = 1.0;
  // Test of the remainder after the response to measured loads: if the model is
  // right, its correlation with that response is due to chance. Probability of
  // a chi^2 as large as the one found.
  double coherence_probability = 1.0;
  double worst_from = 0.0, worst_to = 0.0, worst_deviation = 0.0;
  // Per channel: share of its power in the band that the structure's motion
  // explains, the rest being noise; share that measured loads alone explain
  // (empty: no measured loads); standard deviation of the noise over all
  // frequencies, in the channel's unit.
  std::vector<std::string> channels;
  Vector explained;
  Vector by_measured_loads;
  Vector noise_sigma;
  // Free groups, and the share of the record's information on each (the inverse
  // of a variance) that is left when the loads are unknown.
  // `most_information_left` is the largest such share of any combination of
  // groups.
  std::vector<std::string> groups;
  Vector information_left;
  double most_information_left = 1.0;
  // Spectral densities over a grid of frequencies, channels x grid: measured
  // (means of lines, without the response to measured loads) and modelled, with
  // the number of lines.
  Vector frequencies;
  Matrix measured;
  Matrix modelled;
  Vector lines;

  // Returns the smaller probability of the two tests.
  double LeastProbability() const {
    return std::min(probability, coherence_probability);
  }
};

// Probability below which the intervals are those of a sandwich estimate.
inline constexpr double kDoubtfulAmbientProbability = 0.05;

// Largest number of unknowns of the loads' covariances, over all knots.
inline constexpr Eigen::Index kMostLoadUnknowns = 4000;

}  // namespace pinode

#endif  // PINODE_PROBLEM_AMBIENT_RECORD_H_
