// The only Jet type that is passed through virtual functions.

#ifndef PINODE_DYNAMICS_WIDE_JET_H_
#define PINODE_DYNAMICS_WIDE_JET_H_

namespace ceres {
template <typename T, int N>
struct Jet;
}  // namespace ceres

namespace pinode {

// A Jet wide enough that a pass through a whole step pays off, used by
// `derivatives = "jets"`. Code that computes with it includes <ceres/jet.h>.
using WideJet = ceres::Jet<double, 8>;

}  // namespace pinode

#endif  // PINODE_DYNAMICS_WIDE_JET_H_
