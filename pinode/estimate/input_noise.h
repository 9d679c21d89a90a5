// What noise on a measured excitation does to a fit.

#ifndef PINODE_ESTIMATE_INPUT_NOISE_H_
#define PINODE_ESTIMATE_INPUT_NOISE_H_

#include "pinode/base/types.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/parameter_layout.h"

namespace pinode {

// Backward (adjoint) run along the trajectory of one record: for every input
// sample i and every column p of `weights`,
//
//   v(p, i) = sum_j weights(j, p) d y_j / d u_i,
//
// where j runs over samples and channels, channels fastest. `weights` is
// (channels * samples) x columns; `states` the trajectory, num_states x
// samples; `parameters` all of the problem's. Sensor gains count, delays do
// not. The noise is taken to be interpolated linearly (held for a held input).
// Returns one matrix (columns x samples) for the given input.
Matrix InputSensitivity(const IdentificationProblem& problem,
                        const ParameterLayout& layout, int record, int input,
                        const Vector& parameters, const Matrix& states,
                        const Matrix& weights);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_INPUT_NOISE_H_
