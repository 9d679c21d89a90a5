// The catalogue of named elements: one-dimensional laws between two points.

#ifndef PINODE_DYNAMICS_ELEMENTS_H_
#define PINODE_DYNAMICS_ELEMENTS_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/law.h"
#include "pinode/dynamics/law_term.h"

namespace pinode {

// Type names in the order of the table in pinode/case/README.md. All elements
// take two features, the deformation d and its rate w, and give one force,
// positive when it resists positive deformation:
//
//   linear               k d + c w
//   cubic                k3 d^3
//   quadratic_stiffness  k2 |d| d
//   amplitude_damping    c2 |d| w
//   bilinear             k (d - clamp(d, -gap, gap)), k of either sign
//   coulomb              f tanh(w / v0)
//   power_damper         c |w|^p sign(w)
//   bouc_wen             k z,  dz/dt = a w - beta (b |w| |z|^(n-1) z
//                                                  + g w |z|^n)
//                        (Wen 1976, without the elastic part)
//   backlash_friction    k (z - clamp(z, -gap, gap)), a slider behind a spring
//                        and a play of 2 gap: dz/dt = w while |z| grows no
//                        further than where the force is f,
//                        dz/dt = w (1 - H(w z) (|z| / (gap + f / k))^n)
//   play                 k (r(x - gap) - r(-x - gap)), x = d - centre,
//                        r(x) = (x + sqrt(x^2 + width^2)) / 2
//   maxwell              k z,  dz/dt = w - k z / c
//   lugre                k z + c1 dz/dt + c w,  dz/dt = w - k |w| z / g,
//                        g = f (1 + rise exp(-(w / v0)^2))
//                        (Canudas de Wit et al. 1995)
//   iwan                 sum k_m z_m, sliders behind springs in parallel whose
//                        limits have the density of Segalman (2005)
//   baber_noori          f z, Bouc-Wen with degradation and pinching by the
//                        energy e; memory_laws.h has its equation
//                        (Baber and Noori 1985)
std::vector<std::string> ElementTypes();

// Creates the law of a type. Returns nullptr, with the nearest known type in
// *error, if `type` is unknown.
std::unique_ptr<Law> CreateElement(const std::string& type, std::string* error);

// Returns one entry per parameter of the law, in its order. `type` must be
// known.
std::vector<ElementParameterInfo> ElementParameters(const std::string& type);

// Creates the element between the points `from` and `to` (DOFs, or
// Feature::kGround) of a structure with num_dofs DOFs, for
// StructuralDynamics::AddLaw. Its force resists d = x[to] - x[from] at both
// ends. `values` has one number per entry of ElementParameters(type). The
// parameters "<name>.<entry's name>" are free within the element's physical
// limits. Trailing values with a default, except the first value, may be left
// out; these parameters are fixed at their defaults. Returns false with a
// sentence in *error if type, points or values do not fit. *term is then
// unchanged.
[[nodiscard]] bool MakeElement(const std::string& name, const std::string& type,
                               int num_dofs, int from, int to,
                               const std::vector<double>& values, LawTerm* term,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_ELEMENTS_H_
