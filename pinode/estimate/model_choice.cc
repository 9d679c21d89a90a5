#include "pinode/estimate/model_choice.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// "a (-3.2), b (-7.1)" of the steps of one kind.
std::string StepsText(const std::vector<ModelChoice::Step>& steps,
                      bool taken_in, bool accepted) {
  std::vector<std::string> parts;
  for (const ModelChoice::Step& step : steps) {
    if (step.taken_in != taken_in || step.accepted != accepted) continue;
    parts.push_back(Join(step.candidates, " and ") + " (" +
                    (step.fitted ? (step.criterion() > 0.0 ? "+" : "") +
                                       FormatNumber(step.criterion(), 3)
                                 : std::string("cannot be fitted without")) +
                    ")");
  }
  return Join(parts, ", ");
}

}  // namespace

std::string ModelChoice::Sentence() const {
  std::vector<std::string> kept;
  for (const std::string& name : candidates) {
    if (std::find(left_out.begin(), left_out.end(), name) == left_out.end()) {
      kept.push_back(name);
    }
  }
  std::string text = complete ? "Model choice: " : "Model choice, cut off: ";
  text += std::to_string(candidates.size()) + " candidates, " +
          std::to_string(kept.size()) + " kept";
  if (!kept.empty()) text += " (" + Join(kept, ", ") + ")";
  text += "; left out: " + (left_out.empty() ? "none" : Join(left_out, ", "));
  const auto add = [&](const char* what, bool taken_in, bool accepted) {
    const std::string list = StepsText(steps, taken_in, accepted);
    if (!list.empty()) text += std::string("; ") + what + ": " + list;
  };
  add("change of the criterion by each that was left out", false, true);
  add("by each that was tried and stayed", false, false);
  add("by each that was taken in again", true, true);
  add("by each that was tried again and stayed out", true, false);
  return text + ".";
}

}  // namespace pinode
