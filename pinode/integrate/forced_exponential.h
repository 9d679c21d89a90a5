// The solution of linear dynamics for inputs that are polynomials.

#ifndef PINODE_INTEGRATE_FORCED_EXPONENTIAL_H_
#define PINODE_INTEGRATE_FORCED_EXPONENTIAL_H_

#include "pinode/base/types.h"
#include "pinode/integrate/linear_rate.h"

namespace pinode {

ParameterizedMap Product(const ParameterizedMap& left,
                         const ParameterizedMap& right);

// The state after `duration` T, of dh/dt = F h + G u with `rate` [F G], as a
// map of the state before and of the inputs' derivatives d_0 ... d_terms-1 by
// the share of the duration, there,
//
//   h(T) = e^(TF) h(0) + sum_k W_k d_k,   W_k = T phi_k+1(TF) G,
//
// num_states x (num_states + terms * inputs): the first rows of
//
//   exp [TF TG 0 ...; 0 0 I ...; ...]
//
// (C. F. Van Loan, IEEE Trans. Automat. Contr. 23 (1978) 395-404), by its
// series after as many halvings as make that short. The derivatives are those
// of the series and of the squarings, whatever the eigenvalues are.
ParameterizedMap ForcedExponential(const ParameterizedMap& rate,
                                   double duration, Eigen::Index terms);

// The same, and that of half the duration in its own share of it, which comes
// before the last squaring.
ParameterizedMap ForcedExponential(const ParameterizedMap& rate,
                                   double duration, Eigen::Index terms,
                                   ParameterizedMap* half);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_FORCED_EXPONENTIAL_H_
