// The evidence of the loads' spectrum of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_EVIDENCE_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_EVIDENCE_H_

#include "pinode/base/types.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/ambient_record.h"

namespace pinode {

// Judges whether the loads' spectrum has as many knots as the record supports.
// Sets the point of `cost`. The logarithm of the evidence is that of the
// likelihood, less
//
//   1/2 log det(1 + I_0^-1 I).
//
// I is the information on loads and noise. I_0 is the information of two lines
// that see the loads themselves. So each number that the record determines
// costs half the logarithm of how many such lines determine it as well, and a
// number that the record does not determine costs nothing. Finer loads also
// leave less information on the groups; that does not count in their favour.
//
// The gain of a knot between any two is that of one step of scoring from the
// point where they change nothing, groups free: 1/2 g^T I^-1 g, apart from the
// prior. (C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50; evidence with the
// information of a few data for the prior's: R. E. Kass and L. Wasserman, J.
// Amer. Statist. Assoc. 90 (1995) 928.)
LoadEvidence JudgeLoads(const Vector& free, AmbientCost* cost);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_EVIDENCE_H_
