// Comparison of the initial model with the identified one.

#ifndef PINODE_STUDY_PROBLEM_PRIOR_COMPARISON_H_
#define PINODE_STUDY_PROBLEM_PRIOR_COMPARISON_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/structure/model/mode_comparison.h"

namespace pinode {

// Compares with `model` if it has a value per parameter. The result is empty
// for a problem that is not valid.
PriorComparison CompareWithPrior(const IdentificationProblem& problem,
                                 const IdentifiedModel& model);

// Simulations of the initial model, made on request: all sensors of all records
// together may exceed the memory.
class PriorRuns {
 public:
  // Keeps references to both arguments, which must outlive the object. Unknown
  // starts are weighted by the noise of `model`, if it has any.
  PriorRuns(const IdentificationProblem& problem, const IdentifiedModel& model);

  // Returns the values of the record's sensors `channels`, channels.size() x
  // samples; empty if the run is not finite or the problem is not valid.
  Matrix Run(int record, const std::vector<int>& channels);

 private:
  const Vector& StartOf(int record);

  const IdentificationProblem& problem_;
  const IdentifiedModel& model_;
  bool valid_;
  Vector prior_;                  // all parameters
  std::map<int, Vector> starts_;  // of the records run so far
};

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_PRIOR_COMPARISON_H_
