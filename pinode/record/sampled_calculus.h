// Derivatives and integrals of sampled histories.

#ifndef PINODE_RECORD_SAMPLED_CALCULUS_H_
#define PINODE_RECORD_SAMPLED_CALCULUS_H_

#include "pinode/base/types.h"
#include "pinode/record/excitation.h"

namespace pinode {

// d values / dt at the samples: central differences of the fourth order, of the
// second at the ends.
Vector Differentiate(const Vector& values, double step);

// Displacement of the ground at the samples, at rest before the first: the
// exact double integral of the acceleration as `interpolation` has it between
// samples.
Vector IntegrateTwice(const Vector& acceleration, double step,
                      Interpolation interpolation);

}  // namespace pinode

#endif  // PINODE_RECORD_SAMPLED_CALCULUS_H_
