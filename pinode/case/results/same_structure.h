// Comparison of the structures of a baseline and of a case.

#ifndef PINODE_CASE_RESULTS_SAME_STRUCTURE_H_
#define PINODE_CASE_RESULTS_SAME_STRUCTURE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/study/damage/baseline.h"

namespace pinode {

// Matrix of the model that is compared with the baseline's. It is that of the
// coordinates or, if their basis follows the parameters and differs between
// cases (RenewsBasis), of the finite-element model.
struct ComparedMatrix {
  MatrixGroup::Target target;
  SparseMatrix matrix;
  // One matrix per group of the dynamics; 0 x 0 for groups of another target.
  std::vector<SparseMatrix> groups;
};

std::vector<ComparedMatrix> ComparedMatrices(const Case& c);

// Finds the change of each group of the case, `dynamics`, for which the case's
// matrix equals `own`, that of the baseline's own case without its groups.
// `offsets`, one for each of `names`, keeps the values from other matrices.
// Returns false, with *error, if no change of groups does so. `what`: the
// baseline's matrix in words.
[[nodiscard]] bool FindOffsets(const std::string& what, const SparseMatrix& own,
                               const StructuralDynamics& dynamics,
                               const ComparedMatrix& compared,
                               const std::vector<std::string>& names,
                               Vector* offsets, std::string* error);

// Checks that the offsets of the groups agree with the shares of the groups in
// the matrices of both cases: `present`, minus one, in the baseline's own case.
// Otherwise values of groups cannot be compared.
[[nodiscard]] bool IsAsPresent(const std::string& what,
                               const StructuralDynamics& dynamics,
                               const std::vector<std::string>& names,
                               const Vector& present, const Vector& offsets,
                               std::string* error);

// Sets the offsets of a baseline from a fit of `healthy` (BaselineFrom).
// Returns false, with *error, if its matrices, or those of its groups, differ
// from those of the case `now`.
[[nodiscard]] bool CompareWithCase(const Case& healthy, const Case& now,
                                   Baseline* baseline, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_SAME_STRUCTURE_H_
