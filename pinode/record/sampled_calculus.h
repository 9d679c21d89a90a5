// Derivatives and integrals of sampled histories.

#ifndef PINODE_RECORD_SAMPLED_CALCULUS_H_
#define PINODE_RECORD_SAMPLED_CALCULUS_H_

#include "pinode/base/types.h"
#include "pinode/record/excitation.h"

namespace pinode {

// Returns d values / dt at the samples: central differences of the fourth
// order, of the second order at the ends.
Vector Differentiate(const Vector& values, double step);

// Returns the displacement of the ground at the samples, at rest before the
// first. It is the exact double integral of the acceleration with
// `interpolation` between samples.
Vector IntegrateTwice(const Vector& acceleration, double step,
                      Interpolation interpolation);

}  // namespace pinode

#endif  // PINODE_RECORD_SAMPLED_CALCULUS_H_
