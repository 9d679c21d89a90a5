// Frequency response functions as the search for modes uses them.

#ifndef PINODE_MODAL_FRF_FRF_DATA_H_
#define PINODE_MODAL_FRF_FRF_DATA_H_

#include "pinode/base/types.h"

namespace pinode {

// FRFs of outputs to references. Reciprocity allows to exchange responses and
// references: the outputs are the larger set.
struct FrfData {
  Vector angular;    // of the lines, 1 / s, positive and ascending
  ComplexMatrix h;   // lines x pairs; column output + outputs * reference
  Matrix variances;  // of h, relative to the others of a pair; no rows: unknown
  Eigen::Index outputs = 0;
  Eigen::Index references = 0;
  int derivative = 2;  // 0: receptance, 1: mobility, 2: accelerance
  // Rate by which an exponential window raises the decay of each pole, 1 / s.
  double decay_rate = 0.0;

  Eigen::Index num_lines() const { return angular.size(); }
};

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_FRF_DATA_H_
