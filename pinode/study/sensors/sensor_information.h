// What sensors that are not there yet would tell about the unknowns.

#ifndef PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_
#define PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// A sensor at a place where one may be put. Without both of the last two it is
// as noisy as others of its quantity, see LinearizeSensors.
struct CandidateSensor {
  Observation observation;
  double sigma = 0.0;        // standard deviation of its noise, model units
  double noise_share = 0.0;  // or this share of what it would show, RMS
};

// One that a problem has already.
struct OwnSensor {
  int record = 0;            // index into the problem's records
  int channel = 0;           // of that record
  double noise_share = 0.0;  // where the channel has no sigma; 0: 5 %
};

// The fitted channels of all training records.
std::vector<OwnSensor> OwnSensors(const IdentificationProblem& problem);

// With the residuals (prediction - measured) / sigma, whose Jacobian by the
// unknowns is J, a sensor adds J'J to the information (the Gauss-Newton
// Hessian), whatever it will measure: D. C. Kammer, J. Guidance 14 (1991)
// 251-259; C. Papadimitriou, J. Sound Vib. 278 (2004) 923-947.
struct SensorInformation {
  std::string name;
  double rms = 0.0;    // of what it shows in its records
  double sigma = 0.0;  // noise taken
  // For each training record J'J by the record's start (where it is unknown,
  // num_states first columns) and all free parameters; 0 x 0 where it does not
  // measure.
  std::vector<Matrix> by_record;
};

// A problem as a planner of sensors sees it, linearised at the initial values.
struct PlanningInformation {
  // Of each training record: num_states where its start is unknown, else 0.
  std::vector<int> num_starts;
  // What is known without sensors, num_free x num_free: priors, measured modes,
  // what keeps curves and unknown forces smooth.
  Matrix known;
  std::vector<SensorInformation> own, candidates;
};

// One run with its tangents through each training record, from rest, a known
// start or (periodic) the steady state; responses that were measured take no
// part, and may be missing (NaN). A candidate without noise of its own has the
// median sigma of the problem's own sensors of its quantity, or, where there
// are none, 5 % of the RMS over all candidates of its quantity: accelerometers
// of one kind are equally noisy wherever they are put. Noise of the excitation
// is not counted.
//
// False, with a sentence, where the problem (with these sensors in the place of
// its own), options or a sensor are not valid, where there is no training
// record, records of unknown loads are beside it (their information hangs on
// what the channels see together), nothing moves in a record, or a run is not
// finite.
[[nodiscard]] bool LinearizeSensors(
    const IdentificationProblem& problem, const IdentificationOptions& options,
    const std::vector<OwnSensor>& own,
    const std::vector<CandidateSensor>& candidates,
    PlanningInformation* information, std::string* error);

// By record, the sum over sensors.
class SensorSum {
 public:
  SensorSum() = default;
  SensorSum(const PlanningInformation& information, int num_free);
  void Add(const SensorInformation& sensor);
  // The information about the free parameters, unknown starts eliminated
  // jointly (the Schur complement), `known` included; num_free x num_free.
  Matrix Information() const;

 private:
  const PlanningInformation* information_ = nullptr;
  int num_free_ = 0;
  std::vector<Matrix> sums_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_SENSORS_SENSOR_INFORMATION_H_
