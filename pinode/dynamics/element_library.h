// Elements of one's own, from a shared library that a case names.

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

// What such a library has to offer; own_element.h says how one is written.
class ElementLibrary {
 public:
  struct Element {
    std::string type;
    std::unique_ptr<Law> (*create)();
    std::vector<ElementParameterInfo> parameters;
  };

  void Add(Element element) { elements_.push_back(std::move(element)); }
  const std::vector<Element>& elements() const { return elements_; }

  // Of the library's content; empty for elements that were added by hand.
  const std::string& fingerprint() const { return fingerprint_; }
  void set_fingerprint(std::string fingerprint) {
    fingerprint_ = std::move(fingerprint);
  }

  // As many parameters as each law has, each with a name of its own and limits.
  [[nodiscard]] bool IsValid(std::string* error) const;

  // nullptr, and a sentence with the types that are there, where this is none.
  const Element* Find(const std::string& type, std::string* error) const;

 private:
  std::vector<Element> elements_;
  std::string fingerprint_;
};

// Loads the shared library at `path` as it is now, also where another one was
// loaded from there; its code stays for the life of the process. False, with
// one line in *error that begins with the path: where it cannot be loaded,
// where it has no elements, or where it was compiled for another version of
// pinode or with flags that lay out Jets differently.
[[nodiscard]] bool LoadElementLibrary(const std::string& path,
                                      ElementLibrary* library,
                                      std::string* error);

// Flags with which any compiler lays out Jets as here, whatever processor it
// compiles for; may be none.
std::string ElementCompilerFlags();

}  // namespace pinode

#endif  // PINODE_DYNAMICS_ELEMENT_LIBRARY_H_
