#include "pinode/case/sections/feature_text.h"

#include <algorithm>

#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {
namespace {

bool UnknownInput(const TomlTable& table, const std::string& key,
                  const std::string& text) {
  return table.Fail(key, "'" + text +
                             "' is not an input of a term, expected "
                             "x[dof], v[dof], d[a,b], w[a,b], t or "
                             "input[name]");
}

}  // namespace

std::vector<std::string> InputNames(const StructuralDynamics& dynamics) {
  std::vector<std::string> names;
  for (const InputSpec& input : dynamics.inputs()) names.push_back(input.name);
  return names;
}

bool ParseFeature(const TomlTable& table, const std::string& key,
                  const StructuralDynamics& dynamics, const std::string& text,
                  Feature* feature) {
  if (text == "t") {
    *feature = Feature::Time();
    return true;
  }
  const size_t open = text.find('[');
  if (open == std::string::npos || text.back() != ']') {
    return UnknownInput(table, key, text);
  }
  const std::string head = text.substr(0, open);
  const std::string inner = text.substr(open + 1, text.size() - open - 2);
  const StructuralModel& model = dynamics.model();
  if (head == "input") {
    const std::vector<std::string> names = InputNames(dynamics);
    const auto found = std::find(names.begin(), names.end(), inner);
    if (found == names.end()) {
      return table.Fail(key, "no record has an input '" + inner + "'" +
                                 NameHint(inner, names));
    }
    *feature = Feature::Input(static_cast<int>(found - names.begin()));
    return true;
  }
  int a = -1;
  int b = -1;
  if (head == "x" || head == "v") {
    if (!FindDof(model, table, key, inner, false, &a)) return false;
    *feature = head == "x" ? Feature::Displacement(a) : Feature::Velocity(a);
    return true;
  }
  const size_t comma = inner.find(',');
  if ((head != "d" && head != "w") || comma == std::string::npos) {
    return UnknownInput(table, key, text);
  }
  const std::string first(StripBlanks(inner.substr(0, comma)));
  const std::string second(StripBlanks(inner.substr(comma + 1)));
  if (!FindDof(model, table, key, first, true, &a) ||
      !FindDof(model, table, key, second, true, &b)) {
    return false;
  }
  if (a == b) return UnknownInput(table, key, text);
  *feature =
      head == "d" ? Feature::Deformation(a, b) : Feature::DeformationRate(a, b);
  return true;
}

bool ParseOutput(const TomlTable& table, const std::string& key,
                 const StructuralModel& model, const std::string& text,
                 Vector* column) {
  if (OutputColumn(model, text, column)) return true;
  return table.Fail(key, "'" + text +
                             "' is neither a DOF of the model nor a "
                             "pair such as \"a-b\"" +
                             NameHint(text, model.dof_names));
}

}  // namespace pinode
