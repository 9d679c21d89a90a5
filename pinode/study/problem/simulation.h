// Simulated sensor values of a model under the excitations of its records.

#ifndef PINODE_STUDY_PROBLEM_SIMULATION_H_
#define PINODE_STUDY_PROBLEM_SIMULATION_H_

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Sensor noise: Gaussian numbers that are the same with every standard library.
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
  // True if all of the response is finite. If not, the first sample that is
  // not.
  bool finite = false;
  Eigen::Index first_not_finite = 0;
  // Sensor values without noise: channels x samples, in the units of the
  // record's file.
  Matrix sensors;
  Matrix states;  // num_states x samples, in the model's units
  // Remark if the response begins at rest because no other start is known; else
  // empty.
  std::string remark;
};

// Returns the standard deviation of a channel's noise, as the case gives it, in
// per cent of that of `values`, which are in the units of its file; 0 if either
// is 0.
double OwnNoisePercent(const MeasuredChannel& channel, const Vector& values);

// Computes the response to the excitation of a record. It begins at the known
// start, else at the steady state if the excitation is periodic, else at rest.
// `parameters`: all of the problem's (ParameterLayout). The problem must be
// valid, except that it may have no free parameters or measurements.
SimulatedResponse SimulateRecord(const IdentificationProblem& problem,
                                 int record, const Vector& parameters);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_SIMULATION_H_
