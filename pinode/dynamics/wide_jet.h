// WideJet: the only Jet type that virtual functions take.

#ifndef PINODE_DYNAMICS_WIDE_JET_H_
#define PINODE_DYNAMICS_WIDE_JET_H_

namespace ceres {
template <typename T, int N>
struct Jet;
}  // namespace ceres

namespace pinode {

// Jet (number with derivatives) that `derivatives = "jets"` uses: eight
// derivatives in one pass. Code that computes with it must include
// <ceres/jet.h>.
using WideJet = ceres::Jet<double, 8>;

}  // namespace pinode

#endif  // PINODE_DYNAMICS_WIDE_JET_H_
