#include "pinode/case/sections/named_dofs.h"

#include <set>
#include <utility>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

class Collector {
 public:
  explicit Collector(const std::function<bool(const std::string&)>& is_dof)
      : is_dof_(is_dof) {}

  void Walk(const TomlValue& value, int line) {
    if (value.line > 0) line = value.line;
    for (const TomlValue& element : value.elements) Walk(element, line);
    for (const auto& [key, child] : value.entries) {
      const int at = child.line > 0 ? child.line : line;
      if (key == "dof" || key == "between") {
        ForEachText(child, at, &Collector::AddName);
      } else if (key == "combination") {
        for (const auto& [name, weight] : child.entries) {
          AddName(name, weight.line > 0 ? weight.line : at);
        }
      } else if (key == "frf") {
        for (const TomlValue& section : child.elements) AddFrfPlaces(section);
      } else if (key == "inputs" || key == "features") {
        ForEachText(child, at, &Collector::AddFeature);
      } else if (key == "outputs" ||
                 // [[discover.output]] are tables.
                 (key == "output" && !child.IsArrayOfTables())) {
        ForEachText(child, at, &Collector::AddOutput);
      } else {
        Walk(child, at);
      }
    }
  }

  std::vector<NamedDof> Take() { return std::move(dofs_); }

 private:
  void ForEachText(const TomlValue& value, int line,
                   void (Collector::*add)(const std::string&, int)) {
    if (value.type == TomlValue::Type::kString) (this->*add)(value.text, line);
    for (const TomlValue& element : value.elements) {
      ForEachText(element, element.line > 0 ? element.line : line, add);
    }
  }

  void AddName(const std::string& name, int line) {
    if (name == "ground" || !seen_.insert(name).second) return;
    dofs_.push_back({name, line});
  }

  // Adds the places of [[frf]]: values of `dofs`, and names that are DOFs, both
  // with or without a sign.
  void AddFrfPlaces(const TomlValue& section) {
    const auto add = [this](std::string name, int line) {
      if (!name.empty() && name[0] == '-') name.erase(0, 1);
      if (is_dof_(name)) AddName(name, line);
    };
    for (const auto& [key, child] : section.entries) {
      if (key == "dofs") {
        for (const auto& [place, dof] : child.entries) {
          add(dof.text, dof.line > 0 ? dof.line : child.line);
        }
      } else if (key == "responses" || key == "references") {
        for (const TomlValue& name : child.elements) {
          add(name.text, name.line > 0 ? name.line : child.line);
        }
      }
    }
  }

  void AddFeature(const std::string& text, int line) {
    const size_t open = text.find('[');
    if (open != 1 || text.back() != ']') return;
    const std::string inner = text.substr(2, text.size() - 3);
    if (text[0] == 'x' || text[0] == 'v') AddName(inner, line);
    const size_t comma = inner.find(',');
    if ((text[0] != 'd' && text[0] != 'w') || comma == std::string::npos) {
      return;
    }
    AddName(std::string(StripBlanks(inner.substr(0, comma))), line);
    AddName(std::string(StripBlanks(inner.substr(comma + 1))), line);
  }

  void AddOutput(const std::string& text, int line) {
    if (!is_dof_(text)) {
      for (size_t dash = text.find('-'); dash != std::string::npos;
           dash = text.find('-', dash + 1)) {
        const std::string a = text.substr(0, dash);
        const std::string b = text.substr(dash + 1);
        if (!is_dof_(a) || !is_dof_(b)) continue;
        AddName(a, line);
        AddName(b, line);
        return;
      }
    }
    AddName(text, line);
  }

  const std::function<bool(const std::string&)>& is_dof_;
  std::set<std::string> seen_;
  std::vector<NamedDof> dofs_;
};

}  // namespace

std::vector<NamedDof> NamedDofs(
    const std::vector<TomlValue::Entry>& root,
    const std::function<bool(const std::string&)>& is_dof) {
  Collector collector(is_dof);
  for (const auto& [key, value] : root) {
    // The model's own `dofs` and its references to them do not count as uses.
    if (key != "model") collector.Walk(value, value.line);
  }
  return collector.Take();
}

}  // namespace pinode
