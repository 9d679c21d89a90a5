// The linear assignment problem.

#ifndef PINODE_STRUCTURE_MODEL_ASSIGNMENT_H_
#define PINODE_STRUCTURE_MODEL_ASSIGNMENT_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Pairs rows with columns, one to one, so that the sum of the paired entries of
// `profit` (finite, any shape) is as large as possible. The method is the
// Hungarian method with shortest augmenting paths, O(n^3) for n = max(rows,
// columns). H. W. Kuhn, "The Hungarian method for the assignment problem",
// Naval Research Logistics Quarterly 2 (1955); R. Jonker and A. Volgenant,
// Computing 38 (1987).
//
// Entry i of the result is the column of row i. It is -1 if there are more rows
// than columns and row i has no column. As many pairs as possible are made,
// even if their profit is negative.
std::vector<int> MaximumProfitAssignment(const Matrix& profit);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_ASSIGNMENT_H_
