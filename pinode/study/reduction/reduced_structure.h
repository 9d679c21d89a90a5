// A reduced finite-element model, with the data to reduce it again with another
// basis and to expand results to all of its DOFs.

#ifndef PINODE_STUDY_REDUCTION_REDUCED_STRUCTURE_H_
#define PINODE_STUDY_REDUCTION_REDUCED_STRUCTURE_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/model/damping.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/reduction.h"

namespace pinode {

// Reduction x = T r of the DOFs x of the whole model to coordinates r. T is
// computed from M and K at the basis point,
//
//   M_b = M + sum_j alpha_j M_j,   K_b = K + sum_j alpha_j K_j
//
// with the groups at values alpha (none: the exported matrices). The
// coordinates' matrices are T' M T and T' K T of the exported ones: groups
// remain shares of the export for every basis. Fill the fields in their order,
// then call SetBasisPoint, Reduce and MakeReducedModel.
struct ReducedStructure {
  // One group of the dynamics; `groups` has them in the order of the dynamics.
  struct Group {
    // Matrix over all DOFs of `exported`; 0 x 0 if the group is given for the
    // coordinates alone.
    SparseMatrix matrix;
    // Matrix in the coordinates: the same in every basis (given for them, or a
    // spring between two of them), T' A T, that of a multiple of M_b or K_b, or
    // the damping of modes of T' M_b T and T' K_b T.
    enum class InBasis { kSame, kReduced, kOfMass, kOfStiffness, kOfModes };
    InBasis in_basis = InBasis::kSame;
    double scale = 1.0;  // the multiple; kOfModes: the damping ratio
    // kOfModes: the first and the last mode, as in DampingOfModes.
    int first_mode = 1, last_mode = 0;
    // True for exports: a change alpha of the group means 1 + alpha times the
    // contribution of the element set, which can be entered in the FE program.
    bool is_element_set = false;
    std::string source;  // the export's path
  };

  FiniteElementModel exported;  // as in the files
  std::vector<int> removed_dofs;
  FiniteElementModel model;  // without these; the model to be reduced

  ReductionOptions options;
  bool is_reduced = false;  // false: all DOFs of `model` are kept
  // True: the basis is computed again at the identified values of the groups.
  bool renew_basis = false;
  // Rule for C of the coordinates if the export has none.
  std::optional<DampingRule> damping_rule;
  // Influence vectors of all DOFs of `model`, a column per direction of ground
  // motion.
  std::vector<std::string> directions;
  Matrix influence;
  // Coordinates x directions if it is given and not reduced; else 0 x 0.
  Matrix given_support_mass_coupling;
  // Positions in `exported` whose responses are output.
  std::vector<int> expanded_dofs;
  // Expected frequencies of the whole model (Hz).
  std::vector<double> expected_hz;
  // Notes on `exported` and `model`, one sentence each: special DOFs,
  // rigid-body modes, ...
  std::vector<std::string> export_notes;

  std::vector<Group> groups;

  // Set by SetBasisPoint: M_b and K_b over all DOFs of `exported`. Proportional
  // damping is proportional to these.
  SparseMatrix mass_at_basis, stiffness_at_basis;
  // Values of the groups at the basis point; empty: the exported ones.
  std::map<std::string, double> basis_at;
  // Damping without groups over all DOFs of `exported`: its own, or Rayleigh
  // damping of the two above; 0 x 0 if it is known for the coordinates alone.
  SparseMatrix damping;

  // Set by Reduce: the basis, the modes and the reduction error. Its matrices
  // are those of `model` in that basis.
  ReducedModel reduced;
  // T in the order of `exported`, with zero rows for removed DOFs.
  Matrix expansion;
  std::vector<std::string> notes;  // notes of the export and of the reduction
};

// Value of a group of mass or stiffness at the basis point.
struct GroupAtBasis {
  std::string name;
  MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
  const SparseMatrix* matrix = nullptr;  // over all DOFs of the export
  double alpha = 0.0;
};

// Computes M_b and K_b. Returns false, with *error, if the model is not valid
// there, or a matrix has another size.
[[nodiscard]] bool SetBasisPoint(const std::vector<GroupAtBasis>& groups,
                                 ReducedStructure* structure,
                                 std::string* error);

// Computes T and the quantities that follow from it. Returns false, with
// *error, if ReduceModel fails.
[[nodiscard]] bool Reduce(ReducedStructure* structure, std::string* error);

// Makes the model of the coordinates with matrices, names, damping and
// influence vectors, and sets structure->damping. Returns false, with *error,
// if the damping rule cannot be applied.
[[nodiscard]] bool MakeReducedModel(ReducedStructure* structure,
                                    StructuralModel* model, std::string* error);

// Computes the matrix of a group in the coordinates, given that of another
// basis in *matrix. For a group in proportion to M_b or K_b, also sets the
// matrix over all DOFs. Returns false, with *error, if the group is the damping
// of modes and DampingOfModes fails.
[[nodiscard]] bool GroupInBasis(const ReducedStructure& structure,
                                ReducedStructure::Group* group, Matrix* matrix,
                                std::string* error);

// Returns a spring of stiffness `scale` between two of the coordinates (-1: the
// ground) over all DOFs. Its matrix is 0 x 0 if an end is a coordinate of a
// mode. No basis is needed yet.
ReducedStructure::Group SpringGroup(const ReducedStructure& structure,
                                    double scale, int from, int to);

}  // namespace pinode

#endif  // PINODE_STUDY_REDUCTION_REDUCED_STRUCTURE_H_
