// Reductions of finite-element models whose basis follows the parameters.

#ifndef PINODE_CASE_RENEWED_BASIS_H_
#define PINODE_CASE_RENEWED_BASIS_H_

#include <string>

#include "pinode/case/case_file.h"
#include "pinode/case/grown_case.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// Whether the case asks for it ([model.reduction] renew = true).
bool RenewsBasis(const Case& c);

// The case with the basis of its reduction taken from M and K with the groups
// at their values in `model`, and damping in proportion to these; *begin is
// `model` for it. Groups mean what they meant: shares of the exported matrices.
// False, with *error, where the model has no modes there.
[[nodiscard]] bool RenewBasis(const Case& c, const IdentifiedModel& model,
                              Case* renewed, IdentifiedModel* begin,
                              std::string* error);

// After a usable fit of a case that renews its basis: renews it and fits again
// until no group of mass or stiffness moves by more than 0.3 of its standard
// error, at most five times. *c, *summary and *model are then those of
// the last fit; a remark of the case says how often, and what is left. Where a
// fit is interrupted, they are as they were, but for the termination.
void RenewBasisUntilSettled(const FitFunction& fit, Case* c,
                            IdentificationSummary* summary,
                            IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_CASE_RENEWED_BASIS_H_
