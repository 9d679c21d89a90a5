// Information about the unknowns from sensors that are only planned.

#ifndef PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_
#define PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Sensor at a possible place. Without `sigma` and `noise_share` it is as noisy
// as others of its quantity, see LinearizeSensors.
struct CandidateSensor {
  Observation observation;
  double sigma = 0.0;        // standard deviation of its noise, model units
  double noise_share = 0.0;  // or this share of the RMS of its values
};

// Sensor that a problem has already.
struct OwnSensor {
  int record = 0;            // index into the problem's records
  int channel = 0;           // of that record
  double noise_share = 0.0;  // if the channel has no sigma; 0: 5 %
};

// Returns the fitted channels of all training records.
std::vector<OwnSensor> OwnSensors(const IdentificationProblem& problem);

// Information of a sensor. With the residuals (prediction - measured) / sigma,
// whose Jacobian by the unknowns is J, it adds J'J to the information (the
// Gauss-Newton Hessian), whatever it will measure: D. C. Kammer, J. Guidance 14
// (1991) 251-259; C. Papadimitriou, J. Sound Vib. 278 (2004) 923-947.
struct SensorInformation {
  std::string name;
  double rms = 0.0;    // of its values in its records
  double sigma = 0.0;  // assumed noise
  // Per training record, J'J by the record's start (if it is unknown,
  // num_states first columns) and all free parameters; 0 x 0 if the sensor does
  // not measure in it.
  std::vector<Matrix> by_record;
};

// Information in a problem for planning sensors, linearised at the initial
// values.
struct PlanningInformation {
  // Per training record: num_states if its start is unknown, else 0.
  std::vector<int> num_starts;
  // Information without sensors, num_free x num_free: priors, measured modes,
  // and the smoothness of curves and unknown forces.
  Matrix known;
  std::vector<SensorInformation> own, candidates;
};

// Linearises the sensors by one run with its tangents through each training
// record. The run begins at rest, at a known start or (periodic) in the steady
// state. Measured responses are not used and may be missing (NaN). A candidate
// without noise of its own has the median sigma of the problem's own sensors of
// its quantity. Without any, it has 5 % of the RMS over all candidates of its
// quantity: accelerometers of one kind are equally noisy at every place. Noise
// of the excitation is not included.
//
// Returns false, with a sentence in *error, if
//
// - the problem (with these sensors in place of its own), options or a sensor
//   are not valid;
// - there is no training record;
// - there are records of unknown loads, because their information depends on
//   all channels together;
// - there is no motion in a record, or a run is not finite.
[[nodiscard]] bool LinearizeSensors(
    const IdentificationProblem& problem, const IdentificationOptions& options,
    const std::vector<OwnSensor>& own,
    const std::vector<CandidateSensor>& candidates,
    PlanningInformation* information, std::string* error);

// Sum over sensors, per record.
class SensorSum {
 public:
  SensorSum() = default;
  SensorSum(const PlanningInformation& information, int num_free);
  void Add(const SensorInformation& sensor);
  // Returns the information about the free parameters, with unknown starts
  // eliminated jointly (the Schur complement) and `known` included; num_free x
  // num_free.
  Matrix Information() const;

 private:
  const PlanningInformation* information_ = nullptr;
  int num_free_ = 0;
  std::vector<Matrix> sums_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_
