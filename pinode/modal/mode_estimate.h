// From the poles of a mode to the mode.

#ifndef PINODE_MODAL_MODE_ESTIMATE_H_
#define PINODE_MODAL_MODE_ESTIMATE_H_

#include <vector>

#include "pinode/modal/identify_modes.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Its shape in displacements; `scales` are what the channels' samples were
// divided by, window_seconds as in FindPoleMoments.
IdentifiedMode MakeMode(const ResponseRecord& record, const Vector& scales,
                        double sampling_step, const PoleCluster& cluster,
                        int max_order, double window_seconds);

// Whether two estimates, of different rates, are of one mode.
bool IsSameMode(const IdentifiedMode& a, const IdentifiedMode& b);

// Sets what another method's poles say of the mode: medians over the orders
// that see it, if they are as many as a mode needs.
void CheckMode(const PoleCluster& cluster,
               const std::vector<SubspacePole>& poles, int max_order,
               const StabilisationOptions& options, IdentifiedMode* mode);

}  // namespace pinode

#endif  // PINODE_MODAL_MODE_ESTIMATE_H_
