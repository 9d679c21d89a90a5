// Elements that users write, in a shared library that a case names.

#ifndef PINODE_DYNAMICS_ELEMENT_LIBRARY_H_
#define PINODE_DYNAMICS_ELEMENT_LIBRARY_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/dynamics/law.h"

namespace pinode {

// One parameter of an element type.
struct ElementParameterInfo {
  std::string name;
  // Dimension of the parameter as powers of force, length and time. A stiffness
  // has 1, -1, 0.
  double force_power = 0.0;
  double length_power = 0.0;
  double time_power = 0.0;
  // Physical limits in the model's units. The case file may narrow them.
  double lower = -kInfinity;
  double upper = kInfinity;
  // Initial value if the case file gives none. NaN: the case file must give
  // one.
  double default_value = kNaN;
};

// Element types of a shared library. own_element.h shows how to write one.
class ElementLibrary {
 public:
  // Element type: its name in case files, a function that creates its law, and
  // one description per parameter of the law.
  struct Element {
    std::string type;
    std::unique_ptr<Law> (*create)();
    std::vector<ElementParameterInfo> parameters;
  };

  // Appends a type. IsValid() checks it.
  void Add(Element element) { elements_.push_back(std::move(element)); }
  const std::vector<Element>& elements() const { return elements_; }

  // Hash of the content of the library's file. Empty for elements added by
  // Add().
  const std::string& fingerprint() const { return fingerprint_; }
  void set_fingerprint(std::string fingerprint) {
    fingerprint_ = std::move(fingerprint);
  }

  // Checks that each element describes all parameters of its law, with unique
  // names and valid limits. On failure returns false and names the type and the
  // mismatch in *error.
  [[nodiscard]] bool IsValid(std::string* error) const;

  // Returns the element of this type. If there is none, returns nullptr, and
  // *error lists the known types.
  const Element* Find(const std::string& type, std::string* error) const;

 private:
  std::vector<Element> elements_;
  std::string fingerprint_;
};

// Loads the shared library at `path`. Reads the file again even if this path
// was loaded before. The code stays loaded for the life of the process.
//
// Returns false if the library cannot be loaded or has no elements. Also
// returns false if it was compiled for another version of pinode, or with flags
// that change the memory layout of Jets. *error is then one line that begins
// with the path.
[[nodiscard]] bool LoadElementLibrary(const std::string& path,
                                      ElementLibrary* library,
                                      std::string* error);

// Returns compiler flags that give Jets the same memory layout as in this
// build, for any compiler and processor. May be empty.
std::string ElementCompilerFlags();

}  // namespace pinode

#endif  // PINODE_DYNAMICS_ELEMENT_LIBRARY_H_
