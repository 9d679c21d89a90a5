// A verdict in JSON.

#ifndef PINODE_CASE_RESULTS_VERDICT_JSON_H_
#define PINODE_CASE_RESULTS_VERDICT_JSON_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pinode/problem/verdict.h"

namespace pinode {

// Sets in *json the keys
//   "usable": true or false, "verdict": GradeName,
//   "findings": [{"check", "what", "grade", "number", "limit", "advice"}]
// Numbers and limits that a check does not have are null.
void WriteVerdict(const Verdict& verdict, nlohmann::ordered_json* json);

// Reads "verdict", or "usable" from results of versions without one. False,
// with *error, for any other value.
[[nodiscard]] bool ReadUsable(const nlohmann::ordered_json& json, bool* usable,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_VERDICT_JSON_H_
