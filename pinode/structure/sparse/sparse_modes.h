// The lowest modes of a large finite-element model.

#ifndef PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_
#define PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// The lowest modes of K phi = w^2 M phi, undamped, ascending by w^2.
struct SparseModes {
  // w^2 in 1 / time^2. Exactly 0 for rigid-body modes: w^2 below the rounding
  // of K, or negative and below the accuracy of a file's digits. Negative for
  // negative stiffness.
  Vector eigenvalues;
  // Frequencies in cycles per unit of time. 0 for rigid-body modes, NaN for w^2
  // < 0.
  Vector frequency_hz;
  // Mode shapes, n x modes, mass-normalised: Phi' M Phi = I. The entry of
  // largest magnitude in each column is positive.
  Matrix mode_shapes;
  // Error bounds: some eigenvalue of the model lies within error_bounds[i] *
  // |w_i^2 - shift| of w_i^2. `shift` is 0 if K is positive definite.
  Vector error_bounds;
  double shift = 0.0;
  // Number of rigid-body modes among the reported modes.
  int num_rigid_body_modes = 0;
  // Remarks for the user: fewer modes than requested, or frequencies that
  // depend on the last digits of the file. Sentences.
  std::vector<std::string> notes;
};

// Computes the `num_modes` lowest modes of a valid model (CHECKed: sizes), or
// all if there are fewer: massless DOFs have no modes.
//
// The method is Lanczos (Spectra) on the inverse of K - shift M. Small models,
// and requests for more than a quarter of all modes, use a dense solver of the
// same inverted pair. M and K may both be singular. shift is 0 for positive
// definite K, otherwise below all eigenvalues.
//
// The result is checked. Each mode's residual bounds its error (at most 1e-8,
// or the function fails). The inertia of K - s M with s above the last mode
// counts the eigenvalues below s, so that no mode of a cluster is missed
// (Sylvester; B. N. Parlett, The Symmetric Eigenvalue Problem, SIAM 1998,
// section 3.3).
//
// Fails, with *modes unchanged, if some motion has neither mass nor stiffness,
// or if the precision is insufficient for a factorisation. Fails too if a large
// model would need the dense solver.
[[nodiscard]] bool ComputeLowestModes(const SparseMatrix& mass,
                                      const SparseMatrix& stiffness,
                                      int num_modes, SparseModes* modes,
                                      std::string* error);

// Compares the first modes above 0 Hz with frequencies that the user expects
// (ascending, in the modes' unit), for example from the FE program's own run.
// Returns false, with the first frequency that differs by more than `tolerance`
// (relative) in *error, or if there are fewer modes than frequencies.
[[nodiscard]] bool CheckExpectedFrequencies(const SparseModes& modes,
                                            const std::vector<double>& expected,
                                            double tolerance,
                                            std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_
