// [[reference_curve]]: known force curves to draw with those of the terms.

#ifndef PINODE_CASE_SECTIONS_REFERENCE_CURVE_SECTION_H_
#define PINODE_CASE_SECTIONS_REFERENCE_CURVE_SECTION_H_

#include <string>
#include <vector>

#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/problem_description.h"

namespace pinode {

// Reads the section. `dynamics` has all its terms. A term that acts as an
// acceleration must drive one DOF whose mass is not coupled to others;
// otherwise it has no force.
[[nodiscard]] bool ReadReferenceCurves(const TomlTable& root,
                                       const StructuralDynamics& dynamics,
                                       std::vector<ReferenceCurve>* curves);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_REFERENCE_CURVE_SECTION_H_
