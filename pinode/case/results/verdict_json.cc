#include "pinode/case/results/verdict_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double number) {
  return std::isfinite(number) ? Json(number) : Json();
}

}  // namespace

void WriteVerdict(const Verdict& verdict, Json* json) {
  (*json)["usable"] = verdict.usable();
  (*json)["verdict"] = GradeName(verdict.grade());
  (*json)["findings"] = Json::array();
  for (const Finding& finding : verdict.findings()) {
    (*json)["findings"].push_back({{"check", finding.check},
                                   {"what", finding.what},
                                   {"grade", GradeName(finding.grade)},
                                   {"number", NumberOrNull(finding.number)},
                                   {"limit", NumberOrNull(finding.limit)},
                                   {"advice", finding.advice}});
  }
}

bool ReadUsable(const Json& json, bool* usable, std::string* error) {
  const Json verdict = json.value("verdict", Json());
  const Json value = json.value("usable", Json());
  if (!value.is_boolean()) {
    *error = "\"usable\" is missing or neither true nor false";
    return false;
  }
  *usable = value;
  if (verdict.is_null()) return true;
  for (const Grade grade :
       {Grade::kGood, Grade::kWithCare, Grade::kNotUsable}) {
    if (verdict != GradeName(grade)) continue;
    // Both must agree: where one of them was changed by hand, take neither.
    *usable = *usable && grade != Grade::kNotUsable;
    return true;
  }
  *error = "\"verdict\" is " + verdict.dump() +
           ", expected \"good\", \"with_care\" or \"not_usable\"";
  return false;
}

}  // namespace pinode
