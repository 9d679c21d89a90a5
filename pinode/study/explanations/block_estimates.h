// Estimates from parts of the records, beside those of a fit to all of them.

#ifndef PINODE_STUDY_EXPLANATIONS_BLOCK_ESTIMATES_H_
#define PINODE_STUDY_EXPLANATIONS_BLOCK_ESTIMATES_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"

namespace pinode {

// Part of a training record.
struct RecordBlock {
  int record = -1;  // index into the problem's records
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
  // Root mean square of the predicted motion relative to that of the whole
  // record, over fitted channels.
  double level = 1.0;
};

// Estimate of the unknowns of a fit from one block alone.
struct BlockEstimate {
  RecordBlock block;
  // One per free unknown, in the order of ParameterLayout::free(). Change from
  // the fit, and standard deviation.
  Vector shifts;
  Vector deviations;
};

struct BlockEstimates {
  std::vector<BlockEstimate> blocks;
  Vector deviations;  // of the fit to all blocks, likewise
};

// Cuts the training records into four blocks or more of the same energy of the
// predicted motion each. Returns nothing for records that are too short.
std::vector<RecordBlock> CutIntoBlocks(const IdentificationProblem& problem,
                                       const FitSummary& fit);

// Finds what each block says by one Gauss-Newton step from the fit with the
// samples of all other blocks left out. Deviations are those by the noise of
// the sensors alone: what has no memory in the residuals. Returns false if a
// cost is not finite.
[[nodiscard]] bool EstimateBlocks(const IdentificationProblem& problem,
                                  const FitSummary& fit,
                                  const IdentifiedModel& model, int num_threads,
                                  BlockEstimates* estimates);

// Widens the intervals by the names of the fit's unknowns so that each holds
// what every block says, to within the deviation of that block, and the 95 %
// interval of the mean over blocks that differ at random.
void WidenByBlocks(const BlockEstimates& estimates, const FitSummary& fit,
                   const IdentificationProblem& problem,
                   std::vector<ExplainedValue>* intervals);

// Returns a finding where a block contradicts the interval of an unknown.
std::vector<Finding> CheckBlocks(const BlockEstimates& estimates,
                                 const FitSummary& fit,
                                 const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_BLOCK_ESTIMATES_H_
