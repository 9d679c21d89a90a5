// User-written elements from a shared library that a case names.

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
  // Dimension as powers of (force, length, time), for the unit's name.
  double force_power = 0.0;
  double length_power = 0.0;
  double time_power = 0.0;
  // Physical limits; the case file may narrow them.
  double lower = -kInfinity;
  double upper = kInfinity;
  // Used when the case file gives no initial value; NaN: must be given.
  double default_value = kNaN;
};

// Elements of a shared library. own_element.h shows how to write one.
class ElementLibrary {
 public:
  struct Element {
    std::string type;
    std::unique_ptr<Law> (*create)();
    std::vector<ElementParameterInfo> parameters;
  };

  void Add(Element element) { elements_.push_back(std::move(element)); }
  const std::vector<Element>& elements() const { return elements_; }

  // Fingerprint of the library's content. Empty for elements added by hand.
  const std::string& fingerprint() const { return fingerprint_; }
  void set_fingerprint(std::string fingerprint) {
    fingerprint_ = std::move(fingerprint);
  }

  // Checks that each element describes all parameters of its law, with unique
  // names and valid limits.
  [[nodiscard]] bool IsValid(std::string* error) const;

  // Returns the element of that type. If there is none, returns nullptr, with a
  // sentence that lists the types in *error.
  const Element* Find(const std::string& type, std::string* error) const;

 private:
  std::vector<Element> elements_;
  std::string fingerprint_;
};

// Loads the shared library at `path` in its present state, even if another one
// was loaded from there before. Its code stays loaded for the life of the
// process. Returns false, with one line in *error that begins with the path, if
// the library cannot be loaded or has no elements. Also fails if it was
// compiled for another version of pinode, or with flags that change the memory
// layout of Jets.
[[nodiscard]] bool LoadElementLibrary(const std::string& path,
                                      ElementLibrary* library,
                                      std::string* error);

// Returns flags with which any compiler uses the same memory layout of Jets as
// this build, for any processor. May be empty.
std::string ElementCompilerFlags();

}  // namespace pinode

#endif  // PINODE_DYNAMICS_ELEMENT_LIBRARY_H_
