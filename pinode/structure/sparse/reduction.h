// Reduction of large finite-element models to a few coordinates, and the error
// that it causes.

#ifndef PINODE_STRUCTURE_SPARSE_REDUCTION_H_
#define PINODE_STRUCTURE_SPARSE_REDUCTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// Transformation x = T r from the coordinates r to the DOFs x. The kept DOFs
// are a, and the others are s:
enum class ReductionMethod {
  // x_s = -K_ss^-1 K_sa x_a: static condensation. Exact if the other DOFs have
  // no mass. R. J. Guyan, "Reduction of stiffness and mass matrices", AIAA J. 3
  // (1965) 380.
  kGuyan,
  // x = Phi Phi_a^-1 x_a with as many modes as DOFs are kept: their frequencies
  // and shapes are exact. J. O'Callahan, P. Avitabile, R. Riemer, "System
  // equivalent reduction expansion process", Proc. 7th IMAC (1989).
  kSerep,
  // Guyan's coordinates, and modes of the other DOFs with the kept DOFs fixed.
  // R. R. Craig, M. C. C. Bampton, "Coupling of substructures for dynamic
  // analyses", AIAA J. 6 (1968) 1313-1319.
  kCraigBampton,
  // x = Phi W r: only the lowest modes. Without kept DOFs W = I. With a kept
  // DOFs, at most as many as modes, W makes them the first a coordinates. The
  // other coordinates are the modes of the remaining motion with the kept DOFs
  // fixed, as with Craig and Bampton. With as many DOFs as modes this is SEREP.
  kModal,
};

struct ReductionOptions {
  ReductionMethod method = ReductionMethod::kCraigBampton;
  // DOFs that stay coordinates: sensors, forces, interfaces. At least one,
  // except for kModal.
  std::vector<std::string> kept_dofs;
  // Number of modes that become coordinates (kCraigBampton), or total number of
  // modes in the coordinates (kModal).
  int num_modes = 0;
  // Number of the lowest modes of the whole model that are compared with the
  // reduced one. Fewer if the model has fewer.
  int num_compared_modes = 6;
};

struct ReducedModel {
  // Names of the kept DOFs, then q1, q2, ... for the modes.
  std::vector<std::string> coordinate_names;
  // Positions of the kept DOFs in the whole model.
  std::vector<int> kept_dofs;
  // T, n x coordinates: T r gives responses and shapes at all DOFs.
  Matrix basis;
  // Reduced matrices T' M T, T' C T (zero without C) and T' K T, exactly
  // symmetric.
  Matrix mass;
  Matrix damping;
  Matrix stiffness;
  // Rigid-body motions, coordinates x rigid-body modes of the whole model. T
  // times these gives their shapes, and K times these is zero.
  Matrix rigid_body_motions;

  // Modes of the whole model: at least as many as are compared, if it has them,
  // and all rigid-body modes.
  SparseModes whole_modes;
  // Error of the reduction, for each of the first modes in `whole_modes`:
  // (reduced - whole) / whole of the frequency of the best-fitting reduced
  // mode, and the MAC of the two over all DOFs. If modes of the whole model
  // share a frequency, the mode is compared with the space of all its partners.
  // The frequency error is 0 if both are rigid-body modes, and NaN if only one
  // is or if w^2 < 0.
  Vector frequency_error;
  Vector mac;

  // Remarks for the user; sentences.
  std::vector<std::string> notes;
};

// Reduces a valid model. Fails, with *reduced unchanged,
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

// Ground motion of a reduced model. Let r be the motion of all n DOFs when the
// ground moves by one (n x directions). The force on the coordinates is -T' M r
// a_g. `influence` is r at the kept DOFs, where absolute accelerations are
// measured, and zero at modal coordinates. `support_mass_coupling` is the
// remainder T' M r - M_r influence. A StructuralModel with both has exactly
// that force.
struct ReducedInfluence {
  Matrix influence;              // coordinates x directions
  Matrix support_mass_coupling;  // coordinates x directions
};
ReducedInfluence ReduceInfluence(const FiniteElementModel& model,
                                 const ReducedModel& reduced,
                                 const Matrix& influence);

// Returns T' A T, made exactly symmetric: a correction group of the whole model
// in the coordinates of the reduced one. For models with rigid-body modes see
// rigid_body.h.
Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_REDUCTION_H_
