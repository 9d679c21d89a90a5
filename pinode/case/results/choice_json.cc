#include "pinode/case/results/choice_json.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace pinode {

nlohmann::ordered_json ChoiceToJson(const ModelChoice& choice) {
  nlohmann::ordered_json json;
  json["candidates"] = choice.candidates;
  json["left_out"] = choice.left_out;
  json["left_out_parameters"] = choice.left_out_parameters;
  json["memory"] = choice.memory;
  json["complete"] = choice.complete;
  json["steps"] = nlohmann::ordered_json::array();
  for (const ModelChoice::Step& step : choice.steps) {
    json["steps"].push_back({{"left_out", step.left_out},
                             {"taken_in", step.taken_in},
                             {"fitted", step.fitted},
                             {"accepted", step.accepted},
                             {"deviance", step.deviance},
                             {"price", step.price},
                             {"criterion", step.criterion()}});
  }
  return json;
}

bool ChoiceFromJson(const nlohmann::ordered_json& json, ModelChoice* choice) {
  ModelChoice result;
  try {
    using Names = std::vector<std::string>;
    result.candidates = json.at("candidates").get<Names>();
    result.left_out = json.at("left_out").get<Names>();
    result.left_out_parameters = json.at("left_out_parameters").get<Names>();
    result.memory = json.at("memory").get<double>();
    result.complete = json.at("complete").get<bool>();
    for (const nlohmann::ordered_json& one : json.at("steps")) {
      ModelChoice::Step step;
      step.left_out = one.at("left_out").get<Names>();
      step.taken_in = one.at("taken_in").get<Names>();
      step.fitted = one.at("fitted").get<bool>();
      step.accepted = one.at("accepted").get<bool>();
      step.deviance = one.at("deviance").get<double>();
      step.price = one.at("price").get<double>();
      result.steps.push_back(std::move(step));
    }
  } catch (const nlohmann::ordered_json::exception&) {
    return false;
  }
  *choice = std::move(result);
  return true;
}

}  // namespace pinode
