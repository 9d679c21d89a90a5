// Builds a mode from the poles of a cluster.

#ifndef PINODE_MODAL_MODE_ESTIMATE_H_
#define PINODE_MODAL_MODE_ESTIMATE_H_

#include <vector>

#include "pinode/modal/identify_modes.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Returns the mode of a cluster, with its shape in displacements. `scales` are
// the divisors of the channels' samples. `window_seconds` as in
// FindPoleMoments.
IdentifiedMode MakeMode(const ResponseRecord& record, const Vector& scales,
                        double sampling_step, const PoleCluster& cluster,
                        int max_order, double window_seconds);

// Returns true if two estimates, from different rates, belong to one mode.
bool IsSameMode(const IdentifiedMode& a, const IdentifiedMode& b);

// Sets the check values of the mode from another method's poles: medians over
// the orders that see it, if these are as many as a mode needs.
void CheckMode(const PoleCluster& cluster,
               const std::vector<SubspacePole>& poles, int max_order,
               const StabilisationOptions& options, IdentifiedMode* mode);

}  // namespace pinode

#endif  // PINODE_MODAL_MODE_ESTIMATE_H_
