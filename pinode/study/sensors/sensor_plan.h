// Where to put sensors: those of many that tell most about chosen unknowns.

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
    // The smallest volume of the targets' confidence region: the largest
    // determinant of their information (D-optimal).
    kDeterminant,
    // The smallest standard deviation of the target that is found worst.
    kWorstDeviation,
  };
  int num_sensors = 1;
  Criterion criterion = Criterion::kDeterminant;
  // Free parameters that are to be found; empty: the groups of stiffness and
  // mass that follow nothing, without any the other free named parameters. All
  // other unknowns are unknown too, and are not what the choice is for.
  std::vector<std::string> targets;
  // The problem's own sensors stay, and more are chosen.
  bool keep_own = false;
};

// Sensors to choose from, as [plan] of a case has them.
struct SensorRequest {
  // `num_sensors` is for the program to say.
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
  // What is reached with one sensor more. Deviations are those of groups, and,
  // of other targets, over |initial value| (or that of the prior). Where
  // sensors leave a target undetermined it counts as 10, which is no knowledge
  // at all of a group.
  struct Step {
    int candidate = -1;      // index into the candidates; -1: there is none
    double typical = 0.0;    // geometric mean over the axes of the region
    double worst = 0.0;      // largest standard deviation
    std::string worst_name;  // and whose it is
  };
  Step without;             // before the first: the sensors that stay
  std::vector<Step> steps;  // the most telling first
  Step next;                // what one more would bring
  Step own;                 // the problem's own sensors, for comparison
  int num_exchanges = 0;    // after the greedy choice
  // Of all free named parameters but those of sensors, with the problem's own
  // sensors, the planned ones, and all candidates at once.
  std::vector<ExpectedDeviation> by_own, by_plan, by_all;
  // What they leave undetermined, as ProblemAssessment has it.
  std::vector<std::string> undetermined_by_own, undetermined_by_plan;
  PlanningInformation information;
};

// Chooses one sensor after the other, each the best beside those that are
// there, and then exchanges chosen for other ones as long as that is better (V.
// V. Fedorov, Theory of Optimal Experiments, 1972; the best single exchange at
// a time). A single linearisation (LinearizeSensors); no fit.
//
// False, with a sentence, where LinearizeSensors is, where there are fewer
// candidates than sensors are asked for, or where a target is not a free named
// parameter of the dynamics.
[[nodiscard]] bool PlanSensors(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const std::vector<OwnSensor>& own,
                               const std::vector<CandidateSensor>& candidates,
                               const SensorPlanOptions& plan_options,
                               SensorPlan* plan, std::string* error);

// A plan for a force at one DOF.
struct PlannedExcitation {
  std::string dof;
  SensorPlan plan;
};

// What chosen sensors reach with the first part of each training record alone.
struct PlannedDuration {
  double duration = 0.0;  // model time
  SensorPlan::Step reached;
};

// With the planned sensors (and own ones that stay), of records cut to these
// durations, in the order given. False, with a sentence, where a duration is
// longer than a training record or shorter than its second sample.
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
