// Results of an identification for the finite-element program.

#ifndef PINODE_STUDY_REDUCTION_FINITE_ELEMENT_RESULT_H_
#define PINODE_STUDY_REDUCTION_FINITE_ELEMENT_RESULT_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {

// Factor for an element set's property: (present + alpha) / present.
struct ElementFactor {
  std::string group;
  MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
  double factor = 1.0;
  double sigma = 0.0;  // NaN if unknown, as the interval
  double lower95 = 0.0;
  double upper95 = 0.0;
  bool free = false;
  std::string source;  // the export's path
};

// Mode shapes at all DOFs of the export.
struct WholeModes {
  Vector frequency_hz;  // in cycles per model time, ascending
  Matrix shapes;        // DOFs x modes; Phi' M Phi = I in the coordinates
};

// Returns the exported matrices (or their Rayleigh damping) with the groups at
// the values of `dynamics`, exactly symmetric. They have the export's order of
// DOFs and its sparsity; a spring between DOFs that the export does not couple
// adds its entries. There is no damping if it is known for the coordinates
// alone. Groups that follow time or a covariate are unchanged. `dynamics` has
// the structure's groups.
FiniteElementModel UpdatedExport(const ReducedStructure& structure,
                                 const StructuralDynamics& dynamics);

// Returns the factors of the groups that are element sets, except those that
// follow time or a covariate.
std::vector<ElementFactor> ElementFactors(const ReducedStructure& structure,
                                          const StructuralDynamics& dynamics,
                                          const FitSummary& summary);

// Computes T times the undamped modes of the coordinates with the groups at the
// values of `dynamics`. Returns false, with *error, if ComputeUndampedModes
// fails.
[[nodiscard]] bool ModesOfWhole(const ReducedStructure& structure,
                                const StructuralDynamics& dynamics,
                                WholeModes* modes, std::string* error);

// Returns the displacements at structure.expanded_dofs along a simulation, DOFs
// x samples, in the model's unit. `states` are those of a dynamics of the
// coordinates.
Matrix ExpandedResponse(const ReducedStructure& structure,
                        const Matrix& states);

}  // namespace pinode

#endif  // PINODE_STUDY_REDUCTION_FINITE_ELEMENT_RESULT_H_
