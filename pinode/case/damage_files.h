// What a comparison with healthy states leaves on disk.

#ifndef PINODE_CASE_DAMAGE_FILES_H_
#define PINODE_CASE_DAMAGE_FILES_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"

namespace pinode {

// What pinode_damage has found.
struct DamageResult {
  std::vector<std::string> baselines;  // folders
  std::vector<std::string> names;      // of the groups
  std::vector<MatrixGroup::Target> targets;
  ChangeOptions options;
  ChangeEstimate estimate;
  Judgement judgement;
};

// {"schema": "pinode-damage-1", "verdict", "message", "baselines", "threshold",
//  "false_alarm_rate", "between_records",
//  "groups": [{"name", "target", "change", "lower95", "upper95", "probability",
//              "damaged", "p_value", "reason", "between_records"}],
//  "unexplained": {"chi2", "degrees_of_freedom"}}
std::string DamageAsJson(const DamageResult& result);

}  // namespace pinode

#endif  // PINODE_CASE_DAMAGE_FILES_H_
