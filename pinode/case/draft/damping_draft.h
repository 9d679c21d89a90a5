// Damping that a drafted case leaves free.

#ifndef PINODE_CASE_DRAFT_DAMPING_DRAFT_H_
#define PINODE_CASE_DRAFT_DAMPING_DRAFT_H_

#include "pinode/case/draft/case_draft.h"

namespace pinode {

// Sets the modes whose damping ratios are free: the lowest five one by one, the
// higher ones together. Leaves out those of which the records show too little:
// the expected standard deviation exceeds half of the ratio, so that a 95 %
// interval would include no damping. Reads the records again. A draft that
// cannot be assessed keeps all of them; one that cannot be read keeps none.
void DraftDamping(CaseDraft* draft);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_DAMPING_DRAFT_H_
