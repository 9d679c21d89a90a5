// State of a fit, and the view of it that its parts share.

#ifndef PINODE_ESTIMATE_OBJECTIVE_FIT_STATE_H_
#define PINODE_ESTIMATE_OBJECTIVE_FIT_STATE_H_

#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/solver/optimality.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Everything that a stage changes, to be kept or rolled back.
struct FitState {
  Vector free;
  std::vector<Vector> sigmas;  // per training record
  Vector decays;
  TrajectoryOutlines trajectories;
  double free_run_error = kInfinity;
  // Share of the samples that the fit has not used up.
  double share_left = 1.0;
  double cost = kInfinity;
  Optimality optimality;  // of the last solve that has converged

  // The error to be expected of other samples of the same records, by
  // generalised cross-validation (P. Craven, G. Wahba, Numerische Mathematik 31
  // (1979) 377): a fit that follows the noise has a smaller error than the
  // truth.
  double ExpectedError() const { return free_run_error / share_left; }
};

// The view that the parts of one fit have of it; all of it outlives them. They
// read the summary. Those that write into it have a FitLog (fit_log.h).
struct FitContext {
  const IdentificationProblem& problem;
  const IdentificationOptions& options;
  const ParameterLayout& layout;
  Objective& objective;
  const FitSummary& summary;

  const Tuning& tuning() const { return options.tuning; }
  // Networks whose weights decay change how everything else is done.
  bool HasNetworks() const { return layout.HasNetworkDecay(); }
  const std::vector<int>& train_records() const {
    return objective.shooting().train_records();
  }
  const IdentificationRecord& train_record(size_t r) const {
    return problem.records[static_cast<size_t>(train_records()[r])];
  }
  bool IterationsLeft() const {
    return summary.num_iterations < options.max_num_iterations;
  }
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_FIT_STATE_H_
