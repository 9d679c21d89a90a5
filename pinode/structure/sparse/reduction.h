// Reduction of large finite-element models to few coordinates, with its error.

#ifndef PINODE_STRUCTURE_SPARSE_REDUCTION_H_
#define PINODE_STRUCTURE_SPARSE_REDUCTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// Method that gives the transformation x = T r from the coordinates r to the
// DOFs x. Index a stands for the kept DOFs, s for the others. Phi are mode
// shapes.
enum class ReductionMethod {
  // Static condensation, x_s = -K_ss^-1 K_sa x_a. It is exact if the other DOFs
  // have no mass. R. J. Guyan, "Reduction of stiffness and mass matrices", AIAA
  // J. 3 (1965) 380.
  kGuyan,
  // SEREP, x = Phi Phi_a^-1 x_a, with as many modes as kept DOFs. The
  // frequencies and shapes of these modes are exact. J. O'Callahan, P.
  // Avitabile, R. Riemer, "System equivalent reduction expansion process",
  // Proc. 7th IMAC (1989).
  kSerep,
  // Static condensation, plus modes of the other DOFs with the kept DOFs fixed.
  // R. R. Craig, M. C. C. Bampton, "Coupling of substructures for dynamic
  // analyses", AIAA J. 6 (1968) 1313-1319.
  kCraigBampton,
  // Lowest modes only, x = Phi W r. Without kept DOFs W = I. With kept DOFs, W
  // makes them the first coordinates; there may be at most as many as modes.
  // The other coordinates are the modes of the remaining motion with the kept
  // DOFs fixed. With as many kept DOFs as modes this is SEREP.
  kModal,
};

// Options of ReduceModel.
struct ReductionOptions {
  ReductionMethod method = ReductionMethod::kCraigBampton;
  // Names of the DOFs that stay coordinates, such as those of sensors, forces
  // and interfaces. At least one, except for kModal.
  std::vector<std::string> kept_dofs;
  // Number of modes added to the kept DOFs (kCraigBampton), or of all modes
  // (kModal, at least 1). It must be 0 for kGuyan and kSerep.
  int num_modes = 0;
  // Number of the lowest modes of the whole model that are compared with the
  // reduced model. At least 1.
  int num_compared_modes = 6;
};

// Reduced model and its error. n is the number of DOFs of the whole model.
struct ReducedModel {
  // Names of the kept DOFs, then q1, q2, ... for the modes.
  std::vector<std::string> coordinate_names;
  // Indices of the kept DOFs in the whole model.
  std::vector<int> kept_dofs;
  // Basis T, n x coordinates. T r gives responses and shapes at all DOFs.
  Matrix basis;
  // Reduced matrices T' M T, T' C T (zero without C) and T' K T, coordinates x
  // coordinates, exactly symmetric.
  Matrix mass;
  Matrix damping;
  Matrix stiffness;
  // Rigid-body motions, coordinates x rigid-body modes of the whole model. T
  // times this matrix gives the shapes; the reduced K times it is zero.
  Matrix rigid_body_motions;

  // Modes of the whole model: all rigid-body modes, and at least as many as are
  // compared.
  SparseModes whole_modes;
  // Error of the reduction, one entry for each compared mode: (reduced - whole)
  // / whole frequency of the best-fitting reduced mode, and the MAC of both
  // over all DOFs. Modes of the whole model that share a frequency are compared
  // as one space. The frequency error is 0 if both are rigid-body modes. It is
  // NaN if only one is, or if w^2 < 0.
  Vector frequency_error;
  Vector mac;

  // Remarks for the user, one sentence each.
  std::vector<std::string> notes;
};

// Reduces a model, which must be valid. On failure returns false, sets *error,
// and leaves *reduced unchanged. It fails
//
// - if a kept DOF does not exist or is named twice;
// - if the options ask for no coordinates or for too many;
// - if the kept DOFs do not prevent the rigid-body modes, or if the other DOFs
//   can move without stiffness while the kept ones are fixed (kGuyan,
//   kCraigBampton);
// - if not all rigid-body modes are among the modes taken, or if these modes do
//   not move the kept DOFs independently (kSerep, kModal).
[[nodiscard]] bool ReduceModel(const FiniteElementModel& model,
                               const ReductionOptions& options,
                               ReducedModel* reduced, std::string* error);

// Ground motion of a reduced model, as the two members of StructuralModel. Let
// r (n x directions) be the motion of all DOFs for a unit displacement of the
// ground. The force on the coordinates is -T' M r a_g. A StructuralModel with
// these members has exactly this force.
struct ReducedInfluence {
  // r at the kept DOFs, where absolute accelerations are measured; zero at
  // modal coordinates.
  Matrix influence;  // coordinates x directions
  // Remainder T' M r - M_r influence, with M_r the reduced mass matrix.
  Matrix support_mass_coupling;  // coordinates x directions
};
// Computes the ground motion. `influence` is r, n x directions.
ReducedInfluence ReduceInfluence(const FiniteElementModel& model,
                                 const ReducedModel& reduced,
                                 const Matrix& influence);

// Returns T' A T, exactly symmetric. It expresses the matrix A of a group (n x
// n) in the coordinates of the reduced model. For models with rigid-body modes
// see rigid_body.h.
Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_REDUCTION_H_
