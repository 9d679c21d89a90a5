// The model before an identification, beside the one that it found.

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

// Of `model` where it has a value per parameter. Nothing is compared of a
// problem that is not valid.
PriorComparison CompareWithPrior(const IdentificationProblem& problem,
                                 const IdentifiedModel& model);

// Free runs of the model before, made when they are asked for: all sensors of
// all records together may be more than memory holds.
class PriorRuns {
 public:
  // Starts that are to be found are weighed by the noise of `model`, where it
  // has any. Both must outlive the object.
  PriorRuns(const IdentificationProblem& problem, const IdentifiedModel& model);

  // What the record's sensors `channels` show, channels.size() x samples; empty
  // where the run is not finite or the problem is not valid.
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
