// Whether a result may be used.

#ifndef PINODE_ESTIMATE_FIT_USABLE_H_
#define PINODE_ESTIMATE_FIT_USABLE_H_

#include "pinode/problem/identification_summary.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Sets summary->usable, and the message where it is not. Usable is what has
// converged, and to a minimum, with its gaps closed, beside which no other
// solution does about as well (a multistart), whose modes lose energy unless
// bounds allow otherwise, and
//
// - whose free runs are finite and better than no motion at all, predict
//   training records better than the model before and hold-out records not
//   worse, and leave of a training record at most 40 %, of a hold-out record
//   70 % that is no noise;
// - whose modes are still like the measured ones that they are held against
//   (35 % in frequency, a MAC of a half), more than half of which (or as many
//   as the model has) are like any of the model before, at a third to three
//   times its frequencies; and whose frequencies are met within a tenth, and
//   none far off that was met before. Where modes stand alone, what meets them
//   better.
//
// A summary that has failed or was interrupted says why already.
void JudgeUsable(const GapTuning& tuning, IdentificationSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_USABLE_H_
