// What an identification gives back to the finite-element program.

#ifndef PINODE_CASE_FINITE_ELEMENT_RESULT_H_
#define PINODE_CASE_FINITE_ELEMENT_RESULT_H_

#include <string>

#include "pinode/case/case_file.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// Writes to `folder`, for cases with a finite-element model and nothing for
// others: M_full.mtx, K_full.mtx and, where the export has damping, C_full.mtx,
// the exported matrices with the groups at the values found, in the export's
// order of DOFs and with its sparsity (a spring between DOFs that the export
// does not couple adds its entries), symmetric; dofs_full.txt, their names; and
// element_factors.csv, by what to multiply each element set's property. Groups
// that follow time or a covariate are as they were.
[[nodiscard]] bool WriteFiniteElementResult(
    const Case& c, const IdentificationSummary& summary,
    const IdentifiedModel& model, const std::string& folder,
    std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_FINITE_ELEMENT_RESULT_H_
