// Lowest modes of a large finite-element model.

#ifndef PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_
#define PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Lowest modes of K phi = w^2 M phi, without damping, ascending by w^2.
struct SparseModes {
  // Eigenvalues w^2 in 1 / time^2; negative for negative stiffness. For a
  // rigid-body mode the value is set to 0. A mode counts as rigid if its
  // stiffness is at most 1e-12 of the terms that cancel in it, or 1e-14 if K is
  // positive definite. A negative w^2 also counts if it is within the accuracy
  // of the digits of a file.
  Vector eigenvalues;
  // Frequencies in cycles per unit of time: 0 for rigid-body modes, NaN for w^2
  // < 0.
  Vector frequency_hz;
  // Mode shapes, n x modes, mass-normalised: Phi' M Phi = I. The entry of
  // largest magnitude in each column is positive.
  Matrix mode_shapes;
  // Error bounds, one per mode. An eigenvalue of the model lies within
  // error_bounds[i] * |w_i^2| of w_i^2. 0 for rigid-body modes.
  Vector error_bounds;
  // First shift of the inverse iteration. 0 if K is positive definite.
  double shift = 0.0;
  // Number of rigid-body modes among these modes.
  int num_rigid_body_modes = 0;
  // Remarks for the user, one sentence each. They name missing modes, and
  // frequencies that depend on the last digits of the file.
  std::vector<std::string> notes;
};

// Computes the `num_modes` lowest modes of a valid model, or all modes if there
// are fewer. `mass` and `stiffness` are n x n and symmetric. Massless DOFs add
// no modes. Aborts if the sizes differ.
//
// The method is block Lanczos on the inverse of K - shift M. Small models,
// and requests for more than a quarter of all modes, use a dense solver of the
// same inverted pair. M and K may both be singular. shift is 0 for positive
// definite K, otherwise below all eigenvalues.
//
// Small models may have stiff links and light masses: the dense solver shifts
// along the spectrum, and factors of up to 400 DOFs are computed with 32 digits
// where 16 do not suffice. Of 600 random models with links of 1e3 to 1e12 times
// the softest spring and masses over up to 1e8 none had a frequency that was
// wrong by more than 1e-8.
//
// The result is checked. Rayleigh's quotient with 32 digits is the eigenvalue,
// and its residual bounds the error, which must be at most 1e-8. In large
// models the inertia of K - s M, with s above the last mode, gives the number
// of eigenvalues below s. So no mode of a cluster is missed (Sylvester's law of
// inertia; B. N. Parlett, The Symmetric Eigenvalue Problem, SIAM 1998, section
// 3.3). Models whose factors take more than 2e9 operations, or have no digits
// left, are not counted. There the iteration is repeated from another random
// start with all modes found left out, and must find no mode below the last.
//
// On failure returns false, sets *error, and leaves *modes unchanged. It fails
// if a motion has neither mass nor stiffness, if the precision does not
// suffice, or if a large model would need the dense solver.
[[nodiscard]] bool ComputeLowestModes(const SparseMatrix& mass,
                                      const SparseMatrix& stiffness,
                                      int num_modes, SparseModes* modes,
                                      std::string* error);

// Checks that the first modes above 0 Hz have the expected frequencies, for
// example those that the finite-element program has printed. `expected` is
// ascending, in the unit of the modes. Returns false if a frequency differs by
// more than the relative `tolerance`; *error then names the first one. Also
// returns false if there are fewer modes than frequencies.
[[nodiscard]] bool CheckExpectedFrequencies(const SparseModes& modes,
                                            const std::vector<double>& expected,
                                            double tolerance,
                                            std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SPARSE_MODES_H_
