// Information about the unknowns from planned sensors.

#ifndef PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_
#define PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Sensor at a possible place. If `sigma` and `noise_share` are both 0, its
// noise is that of other sensors of its quantity, see LinearizeSensors.
struct CandidateSensor {
  Observation observation;
  double sigma = 0.0;  // standard deviation of the noise, model's unit
  // Or sigma as a fraction of the RMS of the sensor's values. 0: not given.
  double noise_share = 0.0;
};

// Sensor that the problem already has.
struct OwnSensor {
  int record = 0;   // index of the record
  int channel = 0;  // index in this record
  // Noise as a fraction of the RMS, if the channel has no sigma. 0: 5 %.
  double noise_share = 0.0;
};

// Returns the fitted channels of all training records.
std::vector<OwnSensor> OwnSensors(const IdentificationProblem& problem);

// Information of a sensor. J is the Jacobian of its residuals (prediction -
// measured) / sigma with respect to the unknowns. The sensor adds J'J to the
// information (the Gauss-Newton Hessian), independent of the values that it
// will measure. Sources: D. C. Kammer, J. Guidance 14 (1991) 251-259; C.
// Papadimitriou, J. Sound Vib. 278 (2004) 923-947.
struct SensorInformation {
  std::string name;
  double rms = 0.0;    // RMS of its values
  double sigma = 0.0;  // assumed noise, same unit
  // J'J, one square matrix per training record. Columns are the record's
  // initial state (num_states, only if it is unknown) and then all free
  // parameters. 0 x 0 if the sensor does not measure in the record.
  std::vector<Matrix> by_record;
};

// Information for planning sensors, linearised at the initial values.
struct PlanningInformation {
  // Number of unknown initial states per training record: num_states or 0.
  std::vector<int> num_starts;
  // Information without sensors, num_free x num_free: priors, measured modes,
  // and the smoothness of curves and unknown forces.
  Matrix known;
  // Information of the problem's own sensors and of the candidates.
  std::vector<SensorInformation> own, candidates;
};

// Computes the information of all sensors by one simulation of each training
// record, with derivatives. It begins at rest, at a known start, or in the
// steady state of a periodic excitation. Measured responses are not used and
// may be NaN.
//
// A candidate without given noise has the median sigma of the problem's own
// sensors of its quantity. If there are none, sigma is 5 % of the RMS over all
// candidates of this quantity. Sensors of one kind thus have the same noise at
// all places. Noise of the excitation is not included.
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

// Sum of the information of several sensors, kept per record.
class SensorSum {
 public:
  SensorSum() = default;
  // Creates an empty sum. `information` must outlive it.
  SensorSum(const PlanningInformation& information, int num_free);
  void Add(const SensorInformation& sensor);
  // Returns the information about the free parameters, num_free x num_free,
  // including PlanningInformation::known. Unknown starts are eliminated by the
  // Schur complement.
  Matrix Information() const;

 private:
  const PlanningInformation* information_ = nullptr;
  int num_free_ = 0;
  std::vector<Matrix> sums_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_
