// Response of an identified model to a harmonic load of slowly varied
// frequency.

#ifndef PINODE_STUDY_PROBLEM_HARMONIC_SWEEP_H_
#define PINODE_STUDY_PROBLEM_HARMONIC_SWEEP_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Harmonic load amplitude * cos(2 pi f t) on one input.
struct HarmonicLoad {
  // Name of a measured force or of a ground acceleration of the problem.
  std::string input;
  // Amplitude in the model's units, positive.
  double amplitude = 1.0;
  // First and last frequency in Hz, both positive and not equal.
  double from_hz = 0.0;
  double to_hz = 0.0;
  // Number of points if the curve does not turn back, from 2 to 100000.
  int num_points = 200;
};

// Periodic response at one frequency.
struct SweepPoint {
  double frequency_hz = 0.0;
  // One entry per channel, in the units of the record's file: half of the range
  // from the smallest to the largest value, and amplitude and phase (rad) of
  // the part with the load's frequency. A phase of 0 is in phase with the load.
  Vector half_range;
  Vector amplitude;
  Vector phase;
  // Largest modulus of the Floquet multipliers; NaN: not known. A structure
  // shows the response only if it is stable. See IsUnstable().
  double largest_multiplier = 0.0;
  // Number of harmonics, and relative size of those that were left out.
  int num_harmonics = 0;
  double neglected = 0.0;

  // True if the multiplier is above 1, that of motion without damping.
  bool IsUnstable() const { return largest_multiplier > 1.0 + 1e-6; }
};

// Computes the periodic responses of a record's channels. Other loads are zero;
// covariates keep their mean over the record. A channel has its gain, but not
// its offset and delay. `parameters` has the values of all parameters in the
// order of ParameterLayout. `go_on` may be empty; it is called after each point
// with its frequency in Hz, and ends the sweep by returning false. Returns
// false with a sentence in *error if the load or the model does not allow it,
// or if the curve could not be finished; *points then has what was found.
[[nodiscard]] bool SweepRecord(const IdentificationProblem& problem, int record,
                               const Vector& parameters,
                               const HarmonicLoad& load,
                               const std::function<bool(double)>& go_on,
                               std::vector<SweepPoint>* points,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_HARMONIC_SWEEP_H_
