// Choice among candidate terms in JSON.

#ifndef PINODE_CASE_RESULTS_CHOICE_JSON_H_
#define PINODE_CASE_RESULTS_CHOICE_JSON_H_

#include <nlohmann/json_fwd.hpp>

#include "pinode/problem/model_choice.h"

namespace pinode {

// {"candidates": [...], "left_out": [...], "left_out_parameters": [...],
//  "memory", "complete", "steps": [{"left_out": [...], "taken_in": [...],
//  "fitted", "accepted", "deviance", "price", "criterion"}]}
nlohmann::ordered_json ChoiceToJson(const ModelChoice& choice);

// Reads a choice. Returns false, with *choice untouched, if a key is missing or
// has another type.
[[nodiscard]] bool ChoiceFromJson(const nlohmann::ordered_json& json,
                                  ModelChoice* choice);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CHOICE_JSON_H_
