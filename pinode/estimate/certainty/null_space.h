// Words for what the data do not determine.

#ifndef PINODE_ESTIMATE_CERTAINTY_NULL_SPACE_H_
#define PINODE_ESTIMATE_CERTAINTY_NULL_SPACE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// One sentence fragment per direction in which named parameters take part by
// more than a tenth, such as "k1 - 0.98 k2", largest parts first. `directions`:
// num_free x count, unit columns.
std::vector<std::string> DescribeNullSpace(const ParameterLayout& layout,
                                           const Matrix& directions);

// `directions` and, as unit vectors, the groups whose factor the data leave
// with a standard deviation of more than ten times what is there: rounding
// alone, or noise, holds these, though not by so little that the numbers show
// it. A factor that is itself ten times as large as its deviation is known,
// whatever there was. `free`: the free parameters' values, by which the data
// were linearised; `covariance`: num_free x num_free.
Matrix WithUnseenGroups(const IdentificationProblem& problem,
                        const ParameterLayout& layout, const Vector& free,
                        const Matrix& covariance, const Matrix& directions);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_NULL_SPACE_H_
