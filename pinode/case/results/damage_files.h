// Result files of a comparison with baselines.

#ifndef PINODE_CASE_RESULTS_DAMAGE_FILES_H_
#define PINODE_CASE_RESULTS_DAMAGE_FILES_H_

#include <string>

#include "pinode/study/damage/damage_analysis.h"

namespace pinode {

// {"schema": "pinode-damage-1", "verdict", "message", "baselines", "threshold",
//  "false_alarm_rate", "has_between_records",
//  "groups": [{"name", "target", "change", "lower95", "upper95", "probability",
//              "damaged", "p_value", "reason", "between_records"}],
//  "nonlinearity": {"detected", "place", "dof", "force_share",
//                   "terms": [{"basis", "share", "lower95", "upper95"}]},
//  "masses": [{"place", "change", "lower95", "upper95", "reason"}],
//  "rivals": [{"found", "other", "loss"}],
//  "looked_for": [], "remarks": [],
//  "unexplained": {"chi2", "degrees_of_freedom"}}
std::string DamageAsJson(const DamageResult& result);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_DAMAGE_FILES_H_
