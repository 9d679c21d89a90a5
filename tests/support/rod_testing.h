// A finite-element model small enough for closed forms.

#ifndef TESTS_SUPPORT_ROD_TESTING_H_
#define TESTS_SUPPORT_ROD_TESTING_H_

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

inline constexpr int kNodes = 8;
inline constexpr double kSpring = 5000.0;

// Returns a rod of seven springs over eight nodes, "1.1" to "8.1". The case
// fixes the first node (remove_dofs). `lower` and `upper` multiply the first
// four and the last three springs.
inline SparseMatrix Rod(double lower, double upper) {
  Matrix stiffness = Matrix::Zero(kNodes, kNodes);
  for (int i = 0; i + 1 < kNodes; ++i) {
    const double k = kSpring * (i < 4 ? lower : upper);
    stiffness(i, i) += k;
    stiffness(i + 1, i + 1) += k;
    stiffness(i, i + 1) -= k;
    stiffness(i + 1, i) -= k;
  }
  return stiffness.sparseView();
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_ROD_TESTING_H_
