// Optimal assignment of rows to columns.

#ifndef PINODE_WATCH_ASSIGNMENT_H_
#define PINODE_WATCH_ASSIGNMENT_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Assigns each row of `costs` (finite, at least as many columns as rows) to a
// column of its own, so that the sum of the costs is smallest: the Hungarian
// method (H. W. Kuhn 1955, J. Munkres 1957) by shortest augmenting paths.
// Returns the column of each row.
std::vector<int> AssignRows(const Matrix& costs);

}  // namespace pinode

#endif  // PINODE_WATCH_ASSIGNMENT_H_
