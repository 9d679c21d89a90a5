// Large finite-element models made small: a few coordinates that stand for all
// DOFs, and how much that costs.

#ifndef PINODE_STRUCTURE_SPARSE_REDUCTION_H_
#define PINODE_STRUCTURE_SPARSE_REDUCTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// How the DOFs x follow the coordinates r, x = T r. With kept DOFs a and the
// others s:
enum class ReductionMethod {
  // x_s = -K_ss^-1 K_sa x_a: statically. Exact where the others have no mass.
  // R. J. Guyan, "Reduction of stiffness and mass matrices", AIAA J. 3 (1965)
  // 380.
  kGuyan,
  // x = Phi Phi_a^-1 x_a with as many modes as DOFs are kept: their frequencies
  // and shapes are exact. J. O'Callahan, P. Avitabile, R. Riemer, "System
  // equivalent reduction expansion process", Proc. 7th IMAC (1989).
  kSerep,
  // Guyan's, and modes of the others with the kept DOFs held. R. R. Craig, M.
  // C. C. Bampton, "Coupling of substructures for dynamic analyses", AIAA J. 6
  // (1968) 1313-1319.
  kCraigBampton,
  // x = Phi W r: the lowest modes and nothing else. Without kept DOFs W = I;
  // with a of them, no more than there are modes, W makes them the first a
  // coordinates, and the others are the modes of what is left while those stand
  // still, as with Craig and Bampton. With as many DOFs as modes this is SEREP.
  kModal,
};

struct ReductionOptions {
  ReductionMethod method = ReductionMethod::kCraigBampton;
  // DOFs that stay coordinates: sensors, forces, interfaces. At least one but
  // for kModal.
  std::vector<std::string> kept_dofs;
  // Modes that become coordinates (kCraigBampton), or that the coordinates have
  // in all (kModal).
  int num_modes = 0;
  // Lowest modes of the whole model that the reduced one is held against; fewer
  // if it has fewer.
  int num_compared_modes = 6;
};

struct ReducedModel {
  // Names of the kept DOFs, then q1, q2, ... of modes.
  std::vector<std::string> coordinate_names;
  // Positions of the kept DOFs in the whole model.
  std::vector<int> kept_dofs;
  // T, n x coordinates: T r gives responses and shapes at all DOFs.
  Matrix basis;
  // T' M T, T' C T (zero without C) and T' K T, exactly symmetric.
  Matrix mass;
  Matrix damping;
  Matrix stiffness;
  // Coordinates x rigid-body modes of the whole model: T times these are their
  // shapes, and K times them is zero.
  Matrix rigid_body_motions;

  // Of the whole model, at least as many as are compared where it has them, and
  // all rigid-body modes.
  SparseModes whole_modes;
  // What the reduction costs, mode by mode of the first of `whole_modes`:
  // (reduced - whole) / whole of the frequency of the mode that fits it best,
  // and the MAC of the two over all DOFs; where modes of the whole model share
  // a frequency, that of the mode and the space of all their partners. The
  // error is 0 where both are rigid-body modes, NaN where one is or w^2 < 0.
  Vector frequency_error;
  Vector mac;

  // Sentences.
  std::vector<std::string> notes;
};

// Reduces a valid model. Fails, with *reduced untouched, if a kept DOF does not
// exist or is named twice, if the options ask for nothing or too much, if the
// kept DOFs do not hold the rigid-body modes or the other DOFs can move without
// stiffness while the kept ones are held (kGuyan, kCraigBampton), if not all
// rigid-body modes are among the modes taken, or if these do not move the kept
// DOFs independently (kSerep, kModal).
[[nodiscard]] bool ReduceModel(const FiniteElementModel& model,
                               const ReductionOptions& options,
                               ReducedModel* reduced, std::string* error);

// Ground motion of a reduced model. With r the motion of all n DOFs when the
// ground moves by one (n x directions) the force on the coordinates is
// -T' M r a_g. `influence` is r at the kept DOFs, where absolute accelerations
// are measured, and zero at coordinates of modes; `support_mass_coupling` is
// T' M r - M_r influence, the rest, so that a StructuralModel with both carries
// exactly that force.
struct ReducedInfluence {
  Matrix influence;              // coordinates x directions
  Matrix support_mass_coupling;  // coordinates x directions
};
ReducedInfluence ReduceInfluence(const FiniteElementModel& model,
                                 const ReducedModel& reduced,
                                 const Matrix& influence);

// T' A T, made exactly symmetric: a correction group of the whole model in the
// coordinates of the reduced one. With rigid-body modes: rigid_body.h.
Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_REDUCTION_H_
