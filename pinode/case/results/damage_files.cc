#include "pinode/case/results/damage_files.h"

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
    case Reason::kAmbiguous:
      return "ambiguous";
    case Reason::kUnexplained:
      return "unexplained";
    case Reason::kModelError:
      return "model_error";
    case Reason::kOtherLevel:
      return "other_level";
    case Reason::kOtherExplanation:
      return "other_explanation";
  }
  return "";
}

bool Counts(Reason reason) {
  return reason == Reason::kBeyondThreshold ||
         reason == Reason::kBetweenRecords;
}

// Returns the place with the largest share of the force, if a nonlinear force
// was found.
Json NonlinearityAsJson(const DamageResult& result) {
  const ChangeSubject* largest = nullptr;
  bool detected = false;
  for (size_t j = 0; j < result.subjects.size(); ++j) {
    const ChangeSubject& subject = result.subjects[j];
    if (subject.kind != ChangeKind::kNonlinear ||
        !result.estimate.groups[j].changed) {
      continue;
    }
    detected = detected || Counts(result.judgement.reasons[j]);
    if (largest == nullptr || subject.force_share > largest->force_share) {
      largest = &subject;
    }
  }
  if (largest == nullptr) {
    return {{"detected", false}, {"dof", nullptr}, {"force_share", 0.0}};
  }
  Json json = {{"detected", detected},
               {"place", largest->place},
               {"dof", largest->dof},
               {"force_share", largest->force_share},
               {"terms", Json::array()}};
  for (size_t j = 0; j < result.subjects.size(); ++j) {
    const GroupChange& change = result.estimate.groups[j];
    if (result.subjects[j].kind != ChangeKind::kNonlinear || !change.changed) {
      continue;
    }
    json["terms"].push_back({{"name", result.subjects[j].name},
                             {"share", change.change},
                             {"lower95", change.lower95},
                             {"upper95", change.upper95}});
  }
  return json;
}

Json ExplanationsAsJson(const DamageResult& result) {
  Json all = Json::array();
  for (const ChangeExplanation& explanation : result.estimate.explanations) {
    Json changes = Json::array();
    for (size_t k = 0; k < explanation.changed.size(); ++k) {
      const ChangeSubject& subject =
          result.subjects[static_cast<size_t>(explanation.changed[k])];
      const GroupChange& change = explanation.changes[k];
      changes.push_back({{"name", subject.name},
                         {"target", ChangeKindName(subject.kind)},
                         {"change", change.change},
                         {"lower95", change.lower95},
                         {"upper95", change.upper95},
                         {"p_value", change.p_value}});
    }
    all.push_back({{"probability", explanation.probability},
                   {"log_odds", explanation.log_odds},
                   {"changes", std::move(changes)}});
  }
  return all;
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
  json["nonlinearity"] = NonlinearityAsJson(result);
  json["masses"] = Json::array();
  json["dampings"] = Json::array();
  for (size_t j = 0; j < result.subjects.size(); ++j) {
    const ChangeSubject& subject = result.subjects[j];
    const GroupChange& change = result.estimate.groups[j];
    const char* reason = ReasonName(result.judgement.reasons[j]);
    if (subject.place.empty()) {
      json["groups"].push_back(
          {{"name", subject.name},
           {"target", ChangeKindName(subject.kind)},
           {"change", change.change},
           {"lower95", change.lower95},
           {"upper95", change.upper95},
           {"probability", change.probability},
           {"damaged", change.changed},
           {"p_value", change.p_value},
           {"reason", reason},
           {"between_records",
            result.estimate.between_records[static_cast<Eigen::Index>(j)]}});
    } else if (subject.kind != ChangeKind::kNonlinear && change.changed) {
      const bool is_mass = subject.kind == ChangeKind::kMass;
      json[is_mass ? "masses" : "dampings"].push_back(
          {{"place", subject.place},
           {"change", change.change},
           {"lower95", change.lower95},
           {"upper95", change.upper95},
           {"reason", reason}});
    }
  }
  json["rivals"] = Json::array();
  for (const RivalChange& rival : result.estimate.rivals) {
    json["rivals"].push_back(
        {{"found", result.subjects[static_cast<size_t>(rival.found)].name},
         {"other", result.subjects[static_cast<size_t>(rival.other)].name},
         {"loss", rival.loss}});
  }
  json["explanations"] = ExplanationsAsJson(result);
  json["looked_for"] = result.places;
  json["remarks"] = result.remarks;
  json["unexplained"] = {
      {"chi2", result.estimate.unexplained_chi2},
      {"degrees_of_freedom", result.estimate.unexplained_degrees}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pinode
