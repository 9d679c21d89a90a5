// Records of a structure under loads that nobody measured.

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

// Responses to random forces, stationary over the record, whose spectral
// densities are unknown:
//
//   S_y(w) = H(w) S_f(w) H(w)^H + diag(noise),   S_f(w) = sum_b t_b(w) P_b.
//
// H is the transfer function from the forces in `loads` to the channels; t_b
// are triangles over the logarithm of the frequency, one around each knot; the
// P_b are covariances between the forces, unknown, positive semidefinite. A
// spectrum that is correlated between areas and falls with frequency as that of
// wind does is of this form. Beside such forces measured ones may act: what the
// model's response to these, from rest, leaves of the record is what has that
// density.
struct AmbientRecord {
  std::string name;
  double sampling_step = 0.0;  // model time
  std::vector<Observation> channels;
  Matrix samples;  // channels x samples, in the model's units; NaN: missing

  // Where forces act, num_dofs x areas, and what they are called. Empty, with
  // an empty base: on each mode in and near the band that the model has at
  // first or, where these are more than 24 or loads are not correlated, where
  // the channels measure. Any load on the structure does to its modes what such
  // forces do.
  Matrix loads;
  std::vector<std::string> areas;
  // Where accelerations of the base act that nobody measured, num_dofs x
  // directions: displacements of the DOFs as they follow it. Channels of
  // absolute accelerations see it themselves.
  Matrix base;
  // False: forces of different areas, and motions of the base,
  // have nothing in common.
  bool correlated = true;
  // Knots of the spectrum; 1: white; 0: one an octave of the band.
  int knots = 0;

  // What was measured beside them, a row for each input of the dynamics and as
  // many samples as the record: loads, for which the dynamics must be linear,
  // and covariates that groups follow, of which the record shows the mean.
  std::optional<Excitation> inputs;
  // Applied to `samples` by whoever read them, and here to the response to
  // measured loads.
  std::shared_ptr<const ZeroPhaseFilter> filter;

  // The band that is looked at, cycles per model time. Default (0): from 0.3 of
  // the lowest frequency of the model as it is at first to 1.5 of its highest,
  // and at most 0.8 of half the sampling rate.
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;

  // The rows of `inputs` that are loads and not the same all the time.
  Matrix MeasuredLoads(const StructuralDynamics& dynamics) const;
  bool HasMeasuredLoads(const StructuralDynamics& dynamics) const {
    return MeasuredLoads(dynamics).rows() > 0;
  }
  // The dynamics with what groups follow at its mean over the record.
  StructuralDynamics AveragedDynamics(const StructuralDynamics& dynamics) const;
  // The frequency (cycles per model time) of the lowest mode inside the band,
  // of the model as it is at first; 0: none.
  double LowestModeInBand(const StructuralDynamics& dynamics) const;

  // Channels of displacements, velocities, accelerations or strains, of sizes
  // that fit the dynamics; 200 samples and more; loads that are there. On
  // failure *error says what.
  [[nodiscard]] bool IsValid(const StructuralDynamics& dynamics,
                             std::string* error) const;
};

// What the evidence says of the loads' spectrum of a record, in natural
// logarithms, see JudgeLoads.
struct LoadEvidence {
  // Of the likelihood, without what holds the covariances; and what the
  // evidence takes off it for loads and noise that were fitted.
  double log_likelihood = 0.0;
  double price = 0.0;
  // Of a spectrum with a knot between any two: by how much both would be
  // larger, as far as that can be told before it is fitted. 0 knots: it was not
  // looked at.
  int finer_knots = 0;
  double finer_gain = 0.0;
  double finer_price = 0.0;

  bool PromisesMore() const {
    return finer_knots > 0 && finer_gain > finer_price;
  }
};

// What the fit says of an ambient record.
struct AmbientScore {
  std::string name;
  double lowest_frequency = 0.0;
  double highest_frequency = 0.0;
  Eigen::Index num_lines = 0;
  int num_knots = 0;  // of the loads' spectrum
  LoadEvidence evidence;
  // Whitened by the model, a line's power is one. Over parts of the band its
  // mean deviates from that by chance alone where the model is right: the
  // probability of a chi^2 as large as the one found, and the part (cycles per
  // model time) that deviates most, in standard deviations.
  double chi_square = 0.0;
  Eigen::Index degrees_of_freedom = 0;
  double probability = 1.0;
  // What the response to measured loads leaves has nothing in common with it
  // but by chance: the probability of a chi^2 as large as the one found.
  double coherence_probability = 1.0;
  double worst_from = 0.0, worst_to = 0.0, worst_deviation = 0.0;
  // Of each channel: what part of its power in the band the structure's motion
  // explains, the rest being noise, and what part measured loads explain alone
  // (empty: there are none); the noise's standard deviation over all
  // frequencies, in the channel's unit.
  std::vector<std::string> channels;
  Vector explained;
  Vector by_measured_loads;
  Vector noise_sigma;
  // Free groups, and what part of what the record says of each (the inverse of
  // a variance) is left where the loads are unknown; the largest such part of
  // any combination of them.
  std::vector<std::string> groups;
  Vector information_left;
  double most_information_left = 1.0;
  // Spectral densities over a grid of frequencies, channels x grid: as measured
  // (means of lines; without the response to measured loads) and of the model,
  // with the number of lines.
  Vector frequencies;
  Matrix measured;
  Matrix modelled;
  Vector lines;

  // Of both tests.
  double LeastProbability() const {
    return std::min(probability, coherence_probability);
  }
};

// Below this probability the intervals of a record are those of a sandwich.
inline constexpr double kDoubtfulAmbientProbability = 0.05;

// Numbers of the loads' covariances at all knots.
inline constexpr Eigen::Index kMostLoadUnknowns = 4000;

}  // namespace pinode

#endif  // PINODE_PROBLEM_AMBIENT_RECORD_H_
