// Shapes of poles under measured loads, and how noise moves poles and shapes.

#ifndef PINODE_MODAL_FORCED_SHAPES_H_
#define PINODE_MODAL_FORCED_SHAPES_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/forced_model.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Shape of a pole, and the rows' functionals that it is: shape_c = first
// column^T y_c + i second column^T y_c, with y_c as weighted.
struct ForcedShape {
  ComplexVector shape;  // channels, not weighted
  Matrix functionals;   // rows x 2
};

// Returns the shape of pole m: the amplitudes of decay and loads are shape
// times participation. Only what no other pole explains counts.
ForcedShape FindForcedShape(const ForcedModel& model, const ForcedFit& fit,
                            size_t m);

// Returns the poles of a fit with their influences. Each is a change of the
// whole estimate, independent of the others. Their mean square is the
// covariance by the noise, whose spectra the residuals show. If they are white,
// it is the Cramer-Rao bound; if not, noise of one frequency is independent of
// others.
std::vector<SubspacePole> EstimateForcedPoles(const ForcedModel& model,
                                              const ForcedFit& fit);

}  // namespace pinode

#endif  // PINODE_MODAL_FORCED_SHAPES_H_
