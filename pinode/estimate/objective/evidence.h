// Evidence: the number of parameters that the data determine, and the decay
// precisions that follow.

#ifndef PINODE_ESTIMATE_OBJECTIVE_EVIDENCE_H_
#define PINODE_ESTIMATE_OBJECTIVE_EVIDENCE_H_

#include "pinode/base/types.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Evidence at a point of the fit, with Gauss-Newton Hessian H including priors
// and decay.
struct Evidence {
  // R^-1, H = R'R; upper triangular.
  Matrix inverse_root;
  // Number of well-determined parameters: num_free less, for each prior and
  // decay row, the share of its direction's variance that is its own.
  double effective = 0.0;
  // Per decay group, gamma_g = sum (1 - alpha_g (w' H^-1 w)), and the sum of
  // squares of what decays.
  Vector determined;
  Vector squares;
};

// Measures the evidence. `decays`: alpha per decay group. Returns false if H
// has no root.
[[nodiscard]] bool MeasureEvidence(const ParameterLayout& layout,
                                   const Matrix& hessian, const Vector& decays,
                                   const Vector& free, Evidence* evidence);

// Returns the initial decays of a fit: given ones, those of `initial` (may be
// nullptr), or the first guess of `tuning`.
Vector FirstDecays(const ParameterLayout& layout, const EvidenceTuning& tuning,
                   const IdentifiedModel* initial);

// Updates alpha_g <- gamma_g / squares_g, where it is not given, within the
// limits of `tuning`. This is MacKay's rule (Neural Computation 4 (1992)
// 415-447) with the Gauss-Newton Hessian (F. D. Foresee and M. T. Hagan, ICNN
// 1997), per group. For combinations of parameters it applies as in
// CombinationPrior.
void UpdateDecays(const ParameterLayout& layout, const EvidenceTuning& tuning,
                  const Evidence& evidence, Vector* decays);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_EVIDENCE_H_
