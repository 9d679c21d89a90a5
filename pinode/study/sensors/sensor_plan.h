// Sensor placement: finds the sensors with the most information about chosen
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

// Options of PlanSensors.
struct SensorPlanOptions {
  // Quantity that the plan minimises.
  enum class Criterion {
    // Volume of the targets' confidence region. The determinant of their
    // information is then largest (D-optimal design, V. V. Fedorov 1972).
    kDeterminant,
    // Standard deviation of the least certain target.
    kWorstDeviation,
  };
  int num_sensors = 1;
  Criterion criterion = Criterion::kDeterminant;
  // Names of the free parameters to be determined. Empty: the free groups of
  // stiffness and mass that follow no covariate, or all free named parameters
  // if there are none. All other unknowns count as unknown, but their
  // uncertainty does not matter.
  std::vector<std::string> targets;
  // True: the problem's own sensors stay, and further ones are chosen.
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
  // Durations of records, in the model's unit of time.
  std::vector<double> durations;
};

// Result of PlanSensors.
struct SensorPlan {
  std::vector<std::string> targets;
  // Expected standard deviations of the targets after adding one sensor. Those
  // of groups are absolute. Those of other targets are relative to |initial
  // value|, or to the prior's standard deviation. 10 means unknown.
  struct Step {
    int candidate = -1;      // index of the added sensor; -1: none
    double typical = 0.0;    // geometric mean of the semi-axes
    double worst = 0.0;      // largest standard deviation
    std::string worst_name;  // target with this deviation
  };
  Step without;             // only the sensors that stay
  std::vector<Step> steps;  // most informative sensor first
  Step next;                // with one more than requested
  Step own;                 // with the problem's own sensors
  int num_exchanges = 0;    // number of exchanges
  // Expected standard deviations of all free named parameters except those of
  // sensors: with the problem's own sensors, with the planned ones, and with
  // all candidates.
  std::vector<ExpectedDeviation> by_own, by_plan, by_all;
  // Combinations of parameters that the own and the planned sensors do not
  // determine, see ProblemAssessment::undetermined.
  std::vector<std::string> undetermined_by_own, undetermined_by_plan;
  // Information from which the plan was made.
  PlanningInformation information;
};

// Plans sensors. First adds one sensor after the other, each time the one that
// improves the criterion most. Then exchanges single sensors, the best exchange
// first, until no exchange improves the criterion (V. V. Fedorov, Theory of
// Optimal Experiments, 1972). The plan uses one linearisation
// (LinearizeSensors) and no fit.
//
// Returns false, with a sentence in *error, if LinearizeSensors fails or there
// are fewer candidates than requested sensors. Also returns false if a target
// is not a free named parameter of the dynamics.
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

// Expected standard deviations from the planned sensors if each training record
// is cut to a duration.
struct PlannedDuration {
  double duration = 0.0;  // in the model's unit of time
  SensorPlan::Step reached;
};

// Computes the expected standard deviations with the planned sensors, and the
// own ones that stay, for records that are cut to `durations`. *reached has one
// entry per duration. Returns false, with a sentence in *error, if a duration
// is longer than a training record or shorter than one sampling step.
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
