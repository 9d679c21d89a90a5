// The one Jet type that crosses virtual functions.

#ifndef PINODE_DYNAMICS_WIDE_JET_H_
#define PINODE_DYNAMICS_WIDE_JET_H_

namespace ceres {
template <typename T, int N>
struct Jet;
}  // namespace ceres

namespace pinode {

// Wide enough to pay for a pass through a whole step, used by
// `derivatives = "jets"`. Whoever computes with it includes <ceres/jet.h>.
using WideJet = ceres::Jet<double, 8>;

}  // namespace pinode

#endif  // PINODE_DYNAMICS_WIDE_JET_H_
