// What an identification gives back to the finite-element program.

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

// By what to multiply an element set's property: (present + alpha) / present.
struct ElementFactor {
  std::string group;
  MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
  double factor = 1.0;
  double sigma = 0.0;  // NaN where it is not known, as the interval
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

// The exported matrices (or Rayleigh's damping of them) with the groups at the
// values of `dynamics`, in the export's order of DOFs and with its sparsity (a
// spring between DOFs that the export does not couple adds its entries),
// exactly symmetric; no damping where it is known for the coordinates alone.
// Groups that follow time or a covariate are as they were. `dynamics` has the
// structure's groups.
FiniteElementModel UpdatedExport(const ReducedStructure& structure,
                                 const StructuralDynamics& dynamics);

// Of the groups that are element sets, but for those that follow something.
std::vector<ElementFactor> ElementFactors(const ReducedStructure& structure,
                                          const StructuralDynamics& dynamics,
                                          const FitSummary& summary);

// T times the undamped modes of the coordinates with the groups at the values
// of `dynamics`. False, with *error, where ComputeUndampedModes is.
[[nodiscard]] bool ModesOfWhole(const ReducedStructure& structure,
                                const StructuralDynamics& dynamics,
                                WholeModes* modes, std::string* error);

// Displacements at structure.expanded_dofs along a free run, DOFs x samples, in
// the model's unit. `states` are those of a dynamics of the coordinates.
Matrix ExpandedResponse(const ReducedStructure& structure,
                        const Matrix& states);

}  // namespace pinode

#endif  // PINODE_STUDY_REDUCTION_FINITE_ELEMENT_RESULT_H_
