#include "pinode/case/grown_case.h"

#include <utility>

#include "pinode/base/logging.h"
#include "pinode/estimate/parameter_layout.h"

namespace pinode {

std::string TermName(std::string text) {
  for (char& c : text) {
    if (std::string("/\\:*?\"'<>|&;%$#@!~`^(){}=").find(c) !=
        std::string::npos) {
      c = '_';
    }
  }
  return text;
}

bool RebuildCase(const Case& c, const TomlValue& tree, Case* result,
                 std::string* error) {
  Case grown;
  if (!ReadCaseTree(tree, c.path, &grown, error)) return false;
  grown.options = c.options;
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    const IdentificationRecord& from = c.problem.records[r];
    IdentificationRecord& to = grown.problem.records[r];
    CHECK_EQ(from.channels.size(), to.channels.size());
    to.excitation = from.excitation;
    for (size_t k = 0; k < from.channels.size(); ++k) {
      to.channels[k].values = from.channels[k].values;
    }
  }
  *result = std::move(grown);
  return true;
}

std::map<std::string, double> ParametersByName(
    const IdentificationProblem& problem, const IdentifiedModel& model) {
  const ParameterLayout layout(problem);
  CHECK_EQ(model.parameters.size(), layout.num_parameters());
  std::map<std::string, double> values;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    values[layout.parameter(i).name] = model.parameters[i];
  }
  return values;
}

void BeginNearTheEnd(IdentificationOptions* options) {
  options->shooting = IdentificationOptions::Shooting::kSingle;
}

IdentifiedModel BeginFrom(const std::map<std::string, double>& values,
                          const IdentifiedModel& model,
                          const IdentificationProblem& problem) {
  const ParameterLayout layout(problem);
  IdentifiedModel start;
  start.parameters = layout.InitialValues();
  for (int i = 0; i < layout.num_parameters(); ++i) {
    const auto found = values.find(layout.parameter(i).name);
    if (found != values.end()) start.parameters[i] = found->second;
  }
  start.sigmas = model.sigmas;
  start.starts = model.starts;
  return start;
}

}  // namespace pinode
