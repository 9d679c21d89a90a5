// The solution of linear dynamics for inputs that are polynomials.

#ifndef PINODE_INTEGRATE_FORCED_EXPONENTIAL_H_
#define PINODE_INTEGRATE_FORCED_EXPONENTIAL_H_

#include "pinode/base/types.h"
#include "pinode/integrate/linear_rate.h"

namespace pinode {

ParameterizedMap Product(const ParameterizedMap& left,
                         const ParameterizedMap& right);

// Returns the state of dh/dt = F h + G u after `duration` T, with `rate` [F G],
// as a map of the initial state and of the inputs' derivatives d_0 ...
// d_terms-1 at the beginning, with respect to the fraction of the duration:
//
//   h(T) = e^(TF) h(0) + sum_k W_k d_k,   W_k = T phi_k+1(TF) G,
//
// num_states x (num_states + terms * inputs). These are the first rows of
//
//   exp [TF TG 0 ...; 0 0 I ...; ...]
//
// (C. F. Van Loan, IEEE Trans. Automat. Contr. 23 (1978) 395-404). They are
// computed by the exponential's series, after enough halvings to make it short,
// and by squaring. The derivatives are those of the series and of the
// squarings, for any eigenvalues.
ParameterizedMap ForcedExponential(const ParameterizedMap& rate,
                                   double duration, Eigen::Index terms);

// Does the same, and also returns the map of half the duration, with
// derivatives with respect to the fraction of that half. It is the result
// before the last squaring.
ParameterizedMap ForcedExponential(const ParameterizedMap& rate,
                                   double duration, Eigen::Index terms,
                                   ParameterizedMap* half);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_FORCED_EXPONENTIAL_H_
