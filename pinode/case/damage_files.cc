#include "pinode/case/damage_files.h"

#include <nlohmann/json.hpp>

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

const char* ReasonName(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "none";
    case Reason::kBeyondThreshold:
      return "beyond_threshold";
    case Reason::kBetweenRecords:
      return "between_records";
    case Reason::kFormal:
      return "formal";
    case Reason::kUndetermined:
      return "undetermined";
  }
  return "";
}

}  // namespace

std::string DamageAsJson(const DamageResult& result) {
  Json json;
  json["schema"] = "pinode-damage-1";
  json["verdict"] = DamageVerdictName(result.judgement.verdict);
  json["message"] = result.judgement.sentence;
  json["baselines"] = result.baselines;
  json["threshold"] = result.options.threshold;
  json["false_alarm_rate"] = result.options.false_alarm_rate;
  json["has_between_records"] = result.estimate.has_between_records;
  json["groups"] = Json::array();
  for (size_t j = 0; j < result.names.size(); ++j) {
    const GroupChange& group = result.estimate.groups[j];
    json["groups"].push_back(
        {{"name", result.names[j]},
         {"target", TargetName(result.targets[j])},
         {"change", group.change},
         {"lower95", group.lower95},
         {"upper95", group.upper95},
         {"probability", group.probability},
         {"damaged", group.changed},
         {"p_value", group.p_value},
         {"reason", ReasonName(result.judgement.reasons[j])},
         {"between_records",
          result.estimate.between_records[static_cast<Eigen::Index>(j)]}});
  }
  json["unexplained"] = {
      {"chi2", result.estimate.unexplained_chi2},
      {"degrees_of_freedom", result.estimate.unexplained_degrees}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pinode
