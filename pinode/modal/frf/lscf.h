// Poles of frequency response functions by poly-reference least squares.

#ifndef PINODE_MODAL_FRF_LSCF_H_
#define PINODE_MODAL_FRF_LSCF_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/frf/frf_data.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Poles of several orders. `participations[i]` belongs to `poles[i]`: one entry
// for each reference, the largest is 1. The influences of a pole are its
// distance from the nearest pole of a neighbouring order, because the method
// has no model of noise.
struct LscfPoles {
  std::vector<SubspacePole> poles;
  std::vector<ComplexVector> participations;
};

// Finds the poles of orders 2, 4, ... max_order. With T = pi / (highest angular
// frequency), z = exp(i w T), and H_o the row of FRFs of output o to all
// references,
//
//   H_o(w) = (sum_r z^r b_or) (sum_r z^r A_r)^-1.
//
// The real coefficients minimise the sum over lines and outputs of the squares
// of sum_r z^r b_or - H_o(w) sum_r z^r A_r, under A_0 = I. The b_or are
// eliminated first. All sums over lines depend on differences of powers alone.
// With A_0 = I the poles that fit noise are unstable. Those are left out, so
// that few spurious poles remain (B. Cauberghe, PhD thesis, VUB 2004).
//
// Source: B. Peeters, H. Van der Auweraer, P. Guillaume, J. Leuridan, Shock and
// Vibration 11 (2004) 395.
LscfPoles FindLscfPoles(const FrfData& data, int max_order, int num_threads);

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_LSCF_H_
