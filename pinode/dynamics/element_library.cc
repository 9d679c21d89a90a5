#include "pinode/dynamics/element_library.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>

#include "pinode/base/file.h"
#include "pinode/base/fnv.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/own_code.h"
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
               "', expected a unique name and limits";
      return false;
    }
  }
  return true;
}

std::string Fingerprint(const std::string& content) {
  return std::to_string(Fnv1a(content.data(), content.size())) + " " +
         std::to_string(content.size());
}

// Returns the code of a library with this content. Loads a private copy: for a
// path that it knows, the linker would return the old code, and overwriting a
// loaded file would destroy running code. Each content is loaded once.
void* Load(const std::string& content, const std::string& fingerprint,
           std::string* reason) {
  static std::mutex& mutex = *new std::mutex;
  static auto& loaded = *new std::map<std::string, void*>;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto known = loaded.find(fingerprint);
  if (known != loaded.end()) return known->second;
  std::error_code status;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path(status);
  std::string name =
      ((status ? std::filesystem::path("/tmp") : folder) / "pinode-XXXXXX")
          .string();
  const int file = mkstemp(name.data());
  if (file < 0) {
    *reason = "no temporary file can be made";
    return nullptr;
  }
  close(file);
  void* code = nullptr;
  if (WriteFileAtomically(name, content, reason)) {
    code = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    const char* why = code == nullptr ? dlerror() : nullptr;
    if (why != nullptr) *reason = why;
  }
  std::error_code ignored;
  std::filesystem::remove(name, ignored);
  if (code != nullptr) loaded.emplace(fingerprint, code);
  return code;
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
  if (IsOwnCodeRefused()) {
    *error = path +
             ": runs code of its own, which --no-code or PINODE_NO_CODE "
             "refuses: leave them out if you trust this file";
    return false;
  }
  std::string content;
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    *error = path + ": cannot be opened, expected a shared library";
    return false;
  }
  if (!ReadBinaryFile(path, &content, error)) return false;
  std::string reason;
  const std::string fingerprint = Fingerprint(content);
  void* code = Load(content, fingerprint, &reason);
  if (code == nullptr) {
    *error = path + ": cannot be loaded: " + reason;
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
  found.set_fingerprint(fingerprint);
  *library = std::move(found);
  return true;
}

std::string ElementCompilerFlags() { return PINODE_ELEMENT_FLAGS; }

}  // namespace pinode
