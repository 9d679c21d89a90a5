// Whether a fit of healthy records is of the structure of a case.

#ifndef PINODE_CASE_RESULTS_SAME_STRUCTURE_H_
#define PINODE_CASE_RESULTS_SAME_STRUCTURE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/study/damage/baseline.h"

namespace pinode {

// A matrix of the model that a baseline is held against: of the coordinates,
// or, where their basis follows the parameters and differs from case to case
// (RenewsBasis), of the finite-element model.
struct ComparedMatrix {
  MatrixGroup::Target target;
  SparseMatrix matrix;
  // One per group of the dynamics; 0 x 0 for those of another target.
  std::vector<SparseMatrix> groups;
};

std::vector<ComparedMatrix> ComparedMatrices(const Case& c);

// By how much each group of the case, `dynamics`, would have to change for the
// case's matrix to be `own`, that of the baseline's own case before its groups;
// `offsets`, one for each of `names`, keeps what others have found. False, with
// *error, where no change of groups makes it so; `what`: the baseline's matrix
// in words.
[[nodiscard]] bool FindOffsets(const std::string& what, const SparseMatrix& own,
                               const StructuralDynamics& dynamics,
                               const ComparedMatrix& compared,
                               const std::vector<std::string>& names,
                               Vector* offsets, std::string* error);

// Whether the offsets of the groups are what both cases say that their matrices
// hold of them: `present`, beyond once, in the baseline's own case. Values of
// groups cannot be compared otherwise.
[[nodiscard]] bool IsAsPresent(const std::string& what,
                               const StructuralDynamics& dynamics,
                               const std::vector<std::string>& names,
                               const Vector& present, const Vector& offsets,
                               std::string* error);

// Of a baseline from a fit of `healthy` (BaselineFrom): sets its offsets.
// False, with *error, where its matrices, or those of its groups, are not those
// of the case `now`.
[[nodiscard]] bool CompareWithCase(const Case& healthy, const Case& now,
                                   Baseline* baseline, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_SAME_STRUCTURE_H_
