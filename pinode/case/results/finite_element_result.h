// Results of an identification for the finite-element program.

#ifndef PINODE_CASE_RESULTS_FINITE_ELEMENT_RESULT_H_
#define PINODE_CASE_RESULTS_FINITE_ELEMENT_RESULT_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Writes to `folder`, for cases with a finite-element model:
//
// - M_full.mtx, K_full.mtx and, unless the damping is given in ratios or for
//   the coordinates alone, C_full.mtx: the exported matrices (or Rayleigh's
//   damping of them) with the groups at the identified values. They are
//   symmetric, in the export's order of DOFs and with its sparsity (a spring
//   between DOFs that the export does not couple adds its entries);
// - dofs_full.txt: names of the DOFs;
// - element_factors.csv: factor of each element set's property;
// - modes_full.csv: undamped mode shapes of the updated model at all these
//   DOFs, Phi' M Phi = I in its coordinates, under a line with their
//   frequencies in Hz;
// - response_full_<record>.csv, if the case asks for it: displacements of the
//   simulation at these DOFs in the model's unit.
//
// Groups that follow time or a covariate are unchanged.
[[nodiscard]] bool WriteFiniteElementResult(
    const Case& c, const IdentificationSummary& summary,
    const IdentifiedModel& model, const std::string& folder,
    std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_FINITE_ELEMENT_RESULT_H_
