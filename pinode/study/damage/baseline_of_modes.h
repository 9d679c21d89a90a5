// A baseline of measured modes alone, linearised at other values than its own.

#ifndef PINODE_STUDY_DAMAGE_BASELINE_OF_MODES_H_
#define PINODE_STUDY_DAMAGE_BASELINE_OF_MODES_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/damage/baseline.h"

namespace pinode {

// Returns the factor between the variances of measured modes and those that
// their residuals show at the parameters `free`, the minimum of a fit to modes
// alone. 1 where standard deviations are given and chance allows the residuals
// (as for intervals, modal_outcome.h).
double VarianceOfModes(const IdentificationProblem& problem,
                       const ParameterLayout& layout, const Vector& free);

// Evidence of a baseline of modes about its groups. A few frequencies leave
// most groups to their priors. Over the width of a prior frequencies are not
// linear in the groups, so that the covariance at the baseline's own values is
// too narrow elsewhere.
class BaselineOfModes {
 public:
  // Returns true if `baseline` has the modes, and no records.
  static bool IsOne(const Baseline& baseline);

  // `baseline` and `groups` must outlive this object.
  BaselineOfModes(const Baseline& baseline,
                  const std::vector<std::string>& groups);

  // Finds the groups' values and covariance after one Gauss-Newton step from
  // `values` (as Baseline::groups), with the cost there. Returns false if the
  // cost is not finite.
  [[nodiscard]] bool Near(const Vector& values, PooledBaselines* pooled) const;

 private:
  // Free parameters of the baseline with these values of the groups.
  Vector FreeAt(const Vector& values) const;

  const std::vector<std::string>& groups_;
  const IdentificationProblem& problem_;
  const ParameterLayout layout_;
  std::map<std::string, double> parameters_;
  double variance_ = 1.0;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_BASELINE_OF_MODES_H_
