// The response of a model to the excitations of its records, as sensors would
// show it.

#ifndef PINODE_STUDY_PROBLEM_SIMULATION_H_
#define PINODE_STUDY_PROBLEM_SIMULATION_H_

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Noise of sensors: Gaussian numbers that are the same with every standard
// library.
class SensorNoise {
 public:
  explicit SensorNoise(std::uint64_t seed) : random_(seed) {}
  // Adds `percent` of the standard deviation of `values` to each.
  void AddTo(double percent, Vector* values);

 private:
  double Gaussian();
  double Uniform();
  std::mt19937_64 random_;
};

struct SimulatedResponse {
  // Whether all of it is; where not, the sample from which on it is not.
  bool finite = false;
  Eigen::Index first_not_finite = 0;
  // What the sensors show without noise: channels x samples, in the units of
  // the record's file.
  Matrix sensors;
  Matrix states;  // num_states x samples, in the model's units
  // Where it begins at rest for want of something better; else empty.
  std::string remark;
};

// The standard deviation of a channel's noise, as the case gives it, in per
// cent of that of `values`, which are in the units of its file; 0 where either
// is 0.
double OwnNoisePercent(const MeasuredChannel& channel, const Vector& values);

// The response to the excitation of a record from its known start, else from
// the steady state where the excitation is periodic and from rest where not.
// `parameters`: all of the problem's (ParameterLayout). The problem is valid
// but that nothing need be free or measured.
SimulatedResponse SimulateRecord(const IdentificationProblem& problem,
                                 int record, const Vector& parameters);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_SIMULATION_H_
