// Whether a result may be used.

#ifndef PINODE_ESTIMATE_USABLE_H_
#define PINODE_ESTIMATE_USABLE_H_

#include "pinode/estimate/identification_summary.h"
#include "pinode/estimate/tuning.h"

namespace pinode {

// Sets summary->usable, and the message where it is not: usable is what has
// converged, and to a minimum, with its gaps closed, whose free runs are finite
// and better than no motion at all, which predicts training records better than
// the model before and hold-out records not worse, leaves of each training
// record at most 40 % that is no noise, beside which no other solution does
// about as well (a multistart), and whose modes lose energy unless bounds allow
// otherwise, whose modes are still like the measured ones
// that they are held against (35 % in frequency, a MAC of a half), at least
// half of them (or of the model's, where that has fewer) being like any, and
// none of whose frequencies is far off that was met before; where modes stand
// alone, what meets them better. A summary that has failed or was interrupted
// says why already.
void JudgeUsable(const GapTuning& tuning, IdentificationSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_USABLE_H_
