// Simulation of sensor values under the excitation of a record.

#ifndef PINODE_STUDY_PROBLEM_SIMULATION_H_
#define PINODE_STUDY_PROBLEM_SIMULATION_H_

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Gaussian sensor noise. The same seed gives the same numbers with every
// standard library.
class SensorNoise {
 public:
  explicit SensorNoise(std::uint64_t seed) : random_(seed) {}
  // Adds noise to each value. Its standard deviation is `percent` per cent of
  // the standard deviation of `values`.
  void AddTo(double percent, Vector* values);

 private:
  double Gaussian();
  double Uniform();
  std::mt19937_64 random_;
};

// Result of SimulateRecord.
struct SimulatedResponse {
  // True if all values are finite. If not, first_not_finite is the index of the
  // first sample that is not.
  bool finite = false;
  Eigen::Index first_not_finite = 0;
  // Sensor values without noise, channels x samples, in the units of the
  // record's file.
  Matrix sensors;
  Matrix states;  // num_states x samples, in the model's units
  // Remark if the response begins at rest because no other start is known.
  // Otherwise empty.
  std::string remark;
};

// Returns MeasuredChannel::sigma in per cent of the standard deviation of
// `values`, which are in the units of the file. 0 if one of them is 0.
double OwnNoisePercent(const MeasuredChannel& channel, const Vector& values);

// Computes the response to the excitation of a record, given by its index. It
// begins at the known start. Without one, it begins in the steady state of a
// periodic excitation, else at rest. `parameters` has the values of all
// parameters in the order of ParameterLayout. The problem must be valid, but
// needs no free parameters and no measurements.
SimulatedResponse SimulateRecord(const IdentificationProblem& problem,
                                 int record, const Vector& parameters);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_SIMULATION_H_
