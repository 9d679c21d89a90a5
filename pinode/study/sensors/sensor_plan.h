// Sensor placement: the sensors with the most information about chosen
// unknowns.

#ifndef PINODE_STUDY_SENSORS_SENSOR_PLAN_H_
#define PINODE_STUDY_SENSORS_SENSOR_PLAN_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/sensors/sensor_information.h"

namespace pinode {

struct SensorPlanOptions {
  enum class Criterion {
    // Smallest volume of the targets' confidence region: the largest
    // determinant of their information (D-optimal).
    kDeterminant,
    // Smallest standard deviation of the least certain target.
    kWorstDeviation,
  };
  int num_sensors = 1;
  Criterion criterion = Criterion::kDeterminant;
  // Free parameters to be determined. Empty: the groups of stiffness and mass
  // that follow no covariate or, without any, the other free named parameters.
  // All other unknowns are also free, but do not affect the choice otherwise.
  std::vector<std::string> targets;
  // True: the problem's own sensors stay, and more are chosen.
  bool keep_own = false;
};

// Possible sensors to choose from, as in [plan] of a case.
struct SensorRequest {
  // Options of the plan; the program sets `num_sensors`.
  SensorPlanOptions options;
  std::vector<OwnSensor> own;
  std::vector<CandidateSensor> candidates;
  // DOFs at which a force could act.
  std::vector<std::string> excite;
  // Lengths of records, model time.
  std::vector<double> durations;
};

struct SensorPlan {
  std::vector<std::string> targets;
  // Result with one more sensor. Deviations of groups are absolute, those of
  // other targets relative to |initial value| (or to the prior's deviation). An
  // undetermined target counts as 10, which means unknown.
  struct Step {
    int candidate = -1;      // index into the candidates; -1: there is none
    double typical = 0.0;    // geometric mean over the axes of the region
    double worst = 0.0;      // largest standard deviation
    std::string worst_name;  // name of that target
  };
  Step without;             // before the first: the sensors that stay
  std::vector<Step> steps;  // the most informative first
  Step next;                // with one more sensor
  Step own;                 // the problem's own sensors, for comparison
  int num_exchanges = 0;    // after the greedy choice
  // Deviations of all free named parameters except those of sensors, with the
  // problem's own sensors, the planned ones, and all candidates at once.
  std::vector<ExpectedDeviation> by_own, by_plan, by_all;
  // Directions that they do not determine, as in ProblemAssessment.
  std::vector<std::string> undetermined_by_own, undetermined_by_plan;
  PlanningInformation information;
};

// Plans sensors. Chooses one sensor after the other, each the best in addition
// to the previous ones. Then exchanges chosen for other sensors as long as that
// is better (V. V. Fedorov, Theory of Optimal Experiments, 1972; the best
// single exchange at a time). Uses a single linearisation (LinearizeSensors)
// and no fit.
//
// Returns false, with a sentence in *error, if LinearizeSensors fails, if there
// are fewer candidates than requested sensors, or if a target is not a free
// named parameter of the dynamics.
[[nodiscard]] bool PlanSensors(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const std::vector<OwnSensor>& own,
                               const std::vector<CandidateSensor>& candidates,
                               const SensorPlanOptions& plan_options,
                               SensorPlan* plan, std::string* error);

// Plan for a force at one DOF.
struct PlannedExcitation {
  std::string dof;
  SensorPlan plan;
};

// Result of chosen sensors with only the first part of each training record.
struct PlannedDuration {
  double duration = 0.0;  // model time
  SensorPlan::Step reached;
};

// Computes the results of the planned sensors (and own ones that stay) for
// records cut to these durations, in the order given. Returns false, with a
// sentence in *error, if a duration is longer than a training record or shorter
// than its second sample.
[[nodiscard]] bool PlanDurations(const IdentificationProblem& problem,
                                 const IdentificationOptions& options,
                                 const std::vector<OwnSensor>& own,
                                 const std::vector<CandidateSensor>& candidates,
                                 const SensorPlanOptions& plan_options,
                                 const SensorPlan& plan,
                                 const std::vector<double>& durations,
                                 std::vector<PlannedDuration>* reached,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_SENSORS_SENSOR_PLAN_H_
