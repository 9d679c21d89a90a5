// Text for directions that the data do not determine.

#ifndef PINODE_ESTIMATE_CERTAINTY_NULL_SPACE_H_
#define PINODE_ESTIMATE_CERTAINTY_NULL_SPACE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Returns one sentence fragment per direction, such as "k1 - 0.98 k2", of the
// named parameters that take part by more than a tenth, largest parts first.
// `directions`: num_free x count, unit columns.
std::vector<std::string> DescribeNullSpace(const ParameterLayout& layout,
                                           const Matrix& directions);

// Returns `directions` and, as unit vectors, the groups whose factor has a
// standard deviation of more than ten times its present size. Only rounding or
// noise holds these, though the numbers do not show it. A factor that is itself
// ten times as large as its deviation is determined, whatever its present size.
// `free`: values of the free parameters at which the data were linearised.
// `covariance`: num_free x num_free.
Matrix WithUnseenGroups(const IdentificationProblem& problem,
                        const ParameterLayout& layout, const Vector& free,
                        const Matrix& covariance, const Matrix& directions);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_NULL_SPACE_H_
