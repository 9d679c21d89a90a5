// Groups of structures, for tests.

#ifndef TESTS_SUPPORT_GROUP_TESTING_H_
#define TESTS_SUPPORT_GROUP_TESTING_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/dynamics/group_term.h"

namespace pinode::testing {

// Returns the correction alpha * matrix, with a free alpha.
inline GroupTerm MakeGroupTerm(const std::string& name,
                               MatrixGroup::Target target, const Matrix& matrix,
                               double alpha = 0.0) {
  GroupTerm term;
  term.group.name = name;
  term.group.target = target;
  term.group.matrix = matrix;
  term.alpha.name = name;
  term.alpha.value = alpha;
  return term;
}

}  // namespace pinode::testing

#endif  // TESTS_SUPPORT_GROUP_TESTING_H_
