#include "pinode/problem/model_choice.h"

#include <algorithm>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Returns "without a, b -3.2", or "without c +7.1 (refused)" if the step was
// not accepted.
std::string StepText(const ModelChoice::Step& step) {
  std::string text;
  if (!step.left_out.empty()) text += "without " + Join(step.left_out, ", ");
  if (!step.taken_in.empty()) {
    text += (text.empty() ? "with " : " and with ") +
            Join(step.taken_in, ", ") + " again";
  }
  if (!step.fitted) return text + " no fit (refused)";
  text +=
      (step.criterion() > 0.0 ? " +" : " ") + FormatNumber(step.criterion(), 3);
  return step.accepted ? text : text + " (refused)";
}

}  // namespace

std::string ModelChoice::Sentence() const {
  std::vector<std::string> kept;
  for (const std::string& name : candidates) {
    if (std::find(left_out.begin(), left_out.end(), name) == left_out.end()) {
      kept.push_back(name);
    }
  }
  std::string text =
      complete ? "Model choice: " : "Model choice (interrupted): ";
  text += std::to_string(candidates.size()) +
          (candidates.size() == 1 ? " candidate, " : " candidates, ") +
          std::to_string(kept.size()) + " kept";
  if (!kept.empty()) text += " (" + Join(kept, ", ") + ")";
  text +=
      ". Left out: " + (left_out.empty() ? "none" : Join(left_out, ", ")) + ".";
  if (steps.empty()) return text;
  std::vector<std::string> parts;
  for (const Step& step : steps) parts.push_back(StepText(step));
  return text + " Change of the criterion by each step: " + Join(parts, "; ") +
         ".";
}

}  // namespace pinode
