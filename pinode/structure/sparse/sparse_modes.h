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
  // w^2 in 1 / time^2. Exactly 0 for rigid-body modes (w^2 below what the
  // rounding of K leaves, or negative and below what the digits of a file
  // leave); negative for negative stiffness.
  Vector eigenvalues;
  // Cycles per unit of time; 0 for rigid-body modes, NaN for w^2 < 0.
  Vector frequency_hz;
  // n x modes, mass-normalised: Phi' M Phi = I. The entry of largest magnitude
  // in each column is positive.
  Matrix mode_shapes;
  // Some eigenvalue of the model lies within error_bounds[i] * |w_i^2 - shift|
  // of w_i^2; `shift` is 0 where K is positive definite.
  Vector error_bounds;
  double shift = 0.0;
  // Of the modes reported.
  int num_rigid_body_modes = 0;
  // What the user should know: fewer modes than asked for, frequencies that
  // hang on the last digits of the file. Sentences.
  std::vector<std::string> notes;
};

// Computes the `num_modes` lowest modes of a valid model (CHECKed: sizes), or
// all where there are fewer: massless DOFs add none.
//
// Lanczos (Spectra) on the inverse of K - shift M, or, for small models and for
// more than a quarter of all modes, a dense solver of the same inverted pair;
// M and K may both be singular. shift is 0 for positive definite K, otherwise
// below all eigenvalues. The result is held to account: each mode's residual
// bounds its error (at most 1e-8 or the function fails), and the inertia of
// K - s M with s above the last mode counts the eigenvalues below s (Sylvester;
// B. N. Parlett, The Symmetric Eigenvalue Problem, SIAM 1998, section 3.3), so
// that no mode of a cluster is missed.
//
// Fails, with *modes untouched, if some motion has neither mass nor stiffness,
// if the numbers do not suffice for a factorisation, or if the dense solver
// would be needed for a large model.
[[nodiscard]] bool ComputeLowestModes(const SparseMatrix& mass,
                                      const SparseMatrix& stiffness,
                                      int num_modes, SparseModes* modes,
                                      std::string* error);

// Compares the first modes above 0 Hz with frequencies that the user expects
// (ascending, in the modes' unit), say from the FE program's own run. False,
// with the first that differs by more than `tolerance` (relative) in *error, or
// if there are fewer modes than frequencies.
[[nodiscard]] bool CheckExpectedFrequencies(const SparseModes& modes,
                                            const std::vector<double>& expected,
                                            double tolerance,
                                            std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_
