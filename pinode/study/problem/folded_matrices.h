// Linear networks as matrices.

#ifndef PINODE_STUDY_PROBLEM_FOLDED_MATRICES_H_
#define PINODE_STUDY_PROBLEM_FOLDED_MATRICES_H_

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Stiffness and damping with the linear parts of the networks folded in, after
// eq. (17) of Lai et al. (2021). Let a network's linear part be
//
//   g = W_x x + W_v v + ...,   W_x = W F_x,  W_v = W F_v,
//
// F_x and F_v its features as maps of x and v, and S its outputs. Then
//
//   as an acceleration   K - M S W_x,   C - M S W_v,
//   as a force           K + S W_x,     C + S W_v
//
// (a force resists, an acceleration drives). M, C and K are those corrected by
// the groups. The matrices are as learned: nothing makes them symmetric.
struct FoldedMatrices {
  // True if some network has a linear part (a linear network or a skip path).
  bool any = false;
  // True if the networks have no other part, except for constants.
  bool complete = true;
  Matrix stiffness;
  Matrix damping;
};

// `theta` has one value per parameter of the dynamics.
FoldedMatrices FoldNetworks(const StructuralDynamics& dynamics,
                            const Vector& theta);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_FOLDED_MATRICES_H_
