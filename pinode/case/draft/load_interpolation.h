// Interpolation of a measured load between its samples, as the record tells.

#ifndef PINODE_CASE_DRAFT_LOAD_INTERPOLATION_H_
#define PINODE_CASE_DRAFT_LOAD_INTERPOLATION_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

struct LoadInterpolation {
  // True for cubic, false for linear.
  bool is_cubic = true;
  // Errors of both over all loads, as fractions of their RMS: each sample is
  // predicted from its neighbours at odd distances.
  double linear_error = 0.0;
  double cubic_error = 0.0;
};

// Finds how well a straight line through two neighbours, and a cubic through
// four, predict the sample between them. A load that the sampling resolves is
// smooth: the cubic is much better, and so it is between the samples. One with
// much content near half the sampling rate is not predicted by either; there
// straight lines add least. Loads without motion say nothing: cubic.
LoadInterpolation FindLoadInterpolation(const std::vector<Vector>& loads);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_LOAD_INTERPOLATION_H_
