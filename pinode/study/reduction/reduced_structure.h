// A finite-element model made small, with what is needed to make it small again
// elsewhere and to go back to all of its DOFs.

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

// The DOFs x of the whole model follow the coordinates r as x = T r. T is taken
// from M and K at the basis point,
//
//   M_b = M + sum_j alpha_j M_j,   K_b = K + sum_j alpha_j K_j
//
// with the groups at values alpha (none: the exported matrices), while the
// coordinates' matrices are T' M T and T' K T of the exported ones: groups
// remain shares of the export wherever the basis is taken. To be filled in the
// order of the fields, then SetBasisPoint, Reduce and MakeReducedModel.
struct ReducedStructure {
  // One for each group of the dynamics, in their order.
  struct Group {
    // Over all DOFs of `exported`; 0 x 0 where a group is given for the
    // coordinates alone and has no such matrix.
    SparseMatrix matrix;
    // What the coordinates have of it: the same matrix in every basis (one that
    // is given for them, a spring between two of them), T' A T, or that of a
    // multiple of M_b or K_b.
    enum class InBasis { kSame, kReduced, kOfMass, kOfStiffness };
    InBasis in_basis = InBasis::kSame;
    double scale = 1.0;  // the multiple
    // From exports: a change alpha of the group means 1 + alpha times what the
    // element set contributes, which can be typed into the FE program.
    bool is_element_set = false;
    std::string source;  // the export's path
  };

  FiniteElementModel exported;  // as the files have it
  std::vector<int> removed_dofs;
  FiniteElementModel model;  // without these; what is reduced

  ReductionOptions options;
  bool is_reduced = false;  // false: all DOFs of `model` are kept
  // The basis is to be taken again where the groups are found to be.
  bool renew_basis = false;
  // Of C of the coordinates where the export has none.
  std::optional<DampingRule> damping_rule;
  // r of all DOFs of `model`, a column per direction of ground motion.
  std::vector<std::string> directions;
  Matrix influence;
  // Coordinates x directions where it is given and not reduced; else 0 x 0.
  Matrix given_support_mass_coupling;
  // Positions in `exported` whose responses are wanted.
  std::vector<int> expanded_dofs;
  // What the whole model's frequencies are expected to be (Hz).
  std::vector<double> expected_hz;
  // Special DOFs, rigid-body modes, ...: sentences about `exported` and
  // `model`.
  std::vector<std::string> export_notes;

  std::vector<Group> groups;

  // By SetBasisPoint: M_b and K_b over all DOFs of `exported`. Damping in
  // proportion to M and K is in proportion to these.
  SparseMatrix mass_at_basis, stiffness_at_basis;
  // The groups' values there; empty: they are the exported ones.
  std::map<std::string, double> basis_at;
  // Damping without groups over all DOFs of `exported`: its own, or Rayleigh's
  // of the two above; 0 x 0 where it is known for the coordinates alone.
  SparseMatrix damping;

  // By Reduce: the basis, the modes and what the reduction costs. Its matrices
  // are those of `model` in that basis.
  ReducedModel reduced;
  // T in the order of `exported`, zero rows for what was removed.
  Matrix expansion;
  std::vector<std::string> notes;  // those of the export and the reduction
};

// A value of a group of mass or stiffness at the basis point.
struct GroupAtBasis {
  std::string name;
  MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
  const SparseMatrix* matrix = nullptr;  // over all DOFs of the export
  double alpha = 0.0;
};

// M_b and K_b. False, with *error, where the model is none there, or a matrix
// is of another size.
[[nodiscard]] bool SetBasisPoint(const std::vector<GroupAtBasis>& groups,
                                 ReducedStructure* structure,
                                 std::string* error);

// T and what follows from it. False, with *error, where ReduceModel is.
[[nodiscard]] bool Reduce(ReducedStructure* structure, std::string* error);

// The coordinates with matrices, names, damping and influence vectors; and
// structure->damping. False, with *error, where the damping rule cannot be
// followed.
[[nodiscard]] bool MakeReducedModel(ReducedStructure* structure,
                                    StructuralModel* model, std::string* error);

// The matrix of a group in the coordinates, which was `before` in another
// basis. Also sets the matrix over all DOFs of a group in proportion to M_b or
// K_b.
Matrix GroupInBasis(const ReducedStructure& structure, const Matrix& before,
                    ReducedStructure::Group* group);

// A spring of stiffness `scale` between two of the coordinates (-1: the ground)
// over all DOFs; its matrix is 0 x 0 where an end is a coordinate of a mode.
// Needs no basis yet.
ReducedStructure::Group SpringGroup(const ReducedStructure& structure,
                                    double scale, int from, int to);

}  // namespace pinode

#endif  // PINODE_STUDY_REDUCTION_REDUCED_STRUCTURE_H_
