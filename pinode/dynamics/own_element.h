// Elements that users write. An element is a functor on a template scalar, as
// for AutoDiffLaw, in a source file of its own:
//
//   #include <pinode/dynamics/own_element.h>
//
//   struct Sticky {
//     // q: deformation and its rate; z: internal states; p: parameters;
//     // result: the force, then the rates of the internal states.
//     template <typename T>
//     void operator()(const T* q, const T* z, const T* p, T* result) const {
//       using std::tanh;
//       result[0] = p[0] * q[0] + p[1] * tanh(q[1] / p[2]);
//     }
//   };
//
//   PINODE_ELEMENTS(library) {
//     // Numbers of internal states and parameters. Then for each parameter:
//     // its name, its dimension as powers of force, length and time, its
//     // limits, and its default. Without a default a case must give a value.
//     pinode::AddElement<Sticky, 0, 3>(
//         "sticky", {{"k", 1, -1, 0}, {"f", 1, 0, 0}, {"v0", 0, 1, -1, 1e-9}},
//         library);
//   }
//
// Compile it into a shared library,
//
//   c++ -std=c++17 -O2 -shared -fPIC -I/usr/include/eigen3
//       -o sticky.so sticky.cc
//
// and name it in a case: `type = "sticky"`, `file = "sticky.so"`. If you
// compile for one kind of processor (-march), also pass the flags of
// ElementCompilerFlags(). The CMake target pinode::dynamics provides them.

#ifndef PINODE_DYNAMICS_OWN_ELEMENT_H_
#define PINODE_DYNAMICS_OWN_ELEMENT_H_

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/autodiff_law.h"
#include "pinode/dynamics/element_library.h"

namespace pinode {

// Returns the version of the interface between pinode and such a library,
// including the memory layout of the exchanged data. Increase it with any
// change to Law, ElementLibrary or ElementParameterInfo.
// element_library_test.cc detects a missing increase.
inline unsigned long ElementInterface() {
  constexpr unsigned long kVersion = 2;
  return 100000000 * kVersion + 10000 * sizeof(ElementParameterInfo) +
         sizeof(WideJet);
}

// Adds an element type to a library. Functor is the law, with features
// deformation and deformation rate, kInternal internal states, kParameters
// parameters and one output, the force. `parameters` has kParameters entries.
template <typename Functor, int kInternal, int kParameters>
void AddElement(const std::string& type,
                std::vector<ElementParameterInfo> parameters,
                ElementLibrary* library) {
  library->Add({type,
                []() -> std::unique_ptr<Law> {
                  return std::make_unique<
                      AutoDiffLaw<Functor, 2, kInternal, kParameters, 1>>();
                },
                std::move(parameters)});
}

}  // namespace pinode

// NOLINTNEXTLINE(bugprone-macro-parentheses): the name of a parameter.
#define PINODE_ELEMENTS(library)                                         \
  extern "C" __attribute__((visibility("default"))) unsigned long        \
  PinodeElementInterface() {                                             \
    return ::pinode::ElementInterface();                                 \
  }                                                                      \
  extern "C" __attribute__((visibility("default"))) void PinodeElements( \
      ::pinode::ElementLibrary* library)

#endif  // PINODE_DYNAMICS_OWN_ELEMENT_H_
