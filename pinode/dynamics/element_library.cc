#include "pinode/dynamics/element_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "pinode/base/strings.h"
#include "pinode/dynamics/own_element.h"

namespace pinode {
namespace {

using InterfaceFunction = unsigned long (*)();
using ElementsFunction = void (*)(ElementLibrary*);

bool IsSound(const ElementLibrary::Element& element, std::string* error) {
  const std::unique_ptr<Law> law = element.create();
  const std::string where = "element '" + element.type + "' ";
  if (static_cast<int>(element.parameters.size()) != law->num_parameters()) {
    *error = where + "has " + std::to_string(law->num_parameters()) +
             " parameters and describes " +
             std::to_string(element.parameters.size());
    return false;
  }
  for (const ElementParameterInfo& parameter : element.parameters) {
    const auto same = [&parameter](const ElementParameterInfo& other) {
      return other.name == parameter.name;
    };
    if (parameter.name.empty() || !(parameter.lower < parameter.upper) ||
        std::count_if(element.parameters.begin(), element.parameters.end(),
                      same) != 1) {
      *error = where + "has a parameter '" + parameter.name +
               "', expected a name of its own and limits";
      return false;
    }
  }
  return true;
}

}  // namespace

bool ElementLibrary::IsValid(std::string* error) const {
  return std::all_of(
      elements_.begin(), elements_.end(),
      [error](const Element& element) { return IsSound(element, error); });
}

const ElementLibrary::Element* ElementLibrary::Find(const std::string& type,
                                                    std::string* error) const {
  std::vector<std::string> types;
  for (const Element& element : elements_) {
    if (element.type == type) return &element;
    types.push_back("'" + element.type + "'");
  }
  *error = "there is no element '" + type + "', expected one of " +
           Join(types, ", ");
  return nullptr;
}

bool LoadElementLibrary(const std::string& path, ElementLibrary* library,
                        std::string* error) {
  std::error_code status;
  const std::filesystem::path whole = std::filesystem::absolute(path, status);
  if (status || !std::filesystem::is_regular_file(whole, status)) {
    *error = path + ": cannot be opened, expected a shared library";
    return false;
  }
  void* code = dlopen(whole.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (code == nullptr) {
    const char* reason = dlerror();
    *error = path + ": cannot be loaded: " +
             (reason == nullptr ? "no reason given" : reason);
    return false;
  }
  const auto interface = reinterpret_cast<InterfaceFunction>(
      dlsym(code, "PinodeElementInterface"));
  const auto elements =
      reinterpret_cast<ElementsFunction>(dlsym(code, "PinodeElements"));
  if (interface == nullptr || elements == nullptr) {
    *error = path + ": has no elements, expected PINODE_ELEMENTS in its source";
    return false;
  }
  if (interface() != ElementInterface()) {
    const std::string flags = ElementCompilerFlags();
    *error = path +
             ": was compiled for another version of pinode, or for one "
             "kind of processor without " +
             (flags.empty() ? "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16" : flags);
    return false;
  }
  ElementLibrary found;
  elements(&found);
  if (!found.IsValid(error)) {
    *error = path + ": " + *error;
    return false;
  }
  *library = std::move(found);
  return true;
}

std::string ElementCompilerFlags() { return PINODE_ELEMENT_FLAGS; }

}  // namespace pinode
