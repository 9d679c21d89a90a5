// One solve by Ceres, for given noise levels, decays and multipliers.

#ifndef PINODE_ESTIMATE_FIT_SOLVE_H_
#define PINODE_ESTIMATE_FIT_SOLVE_H_

#include "pinode/estimate/objective/fit_log.h"
#include "pinode/estimate/objective/fit_state.h"
#include "pinode/problem/progress.h"

namespace pinode {

// Levenberg-Marquardt on trajectories, priors and modes, each a residual block
// over the free parameters within their bounds. The radius of the trust region
// goes on from solve to solve.
class Solver {
 public:
  // All must outlive this object.
  Solver(const FitContext& context, FitLog* log, Progress* progress);

  // Begins again with the first radius.
  void ResetRadius();

  // What ends a solve.
  struct Limits {
    int iterations = 0;
    double function_tolerance = 0.0;  // a share of the cost
    // RMS of the residuals in units of their noise levels; 0: none is too
    // small.
    double residual = 0.0;
    // Share of the cost: several steps in a row that change it by no more end
    // the solve; 0: any number may.
    double crawl = 0.0;
  };

  // From state->free, until an iteration changes the cost by less than the
  // tolerance, or none promises to, or residuals are below their limit, or the
  // fit crawls (*converged), or the iterations are used up, those that the
  // options grant in all included. The steps of networks bend (BentCost).
  // Leaves the objective linearised at the solution. False, with the summary's
  // message, where the cost cannot be had at the point of departure.
  [[nodiscard]] bool Solve(const Limits& limits, FitState* state,
                           bool* converged);

  // Whether the residuals at `free`, where the objective is linearised, are
  // below this RMS.
  bool IsBelow(double residual, const Vector& free) const;

  // From a converged point: full steps of the quadratic model, while each does
  // lower the cost. An iteration that hardly changes the cost leaves the
  // unknowns off by the root of that. False as Solve.
  [[nodiscard]] bool Polish(FitState* state);

 private:
  class Callback;

  // Whether residuals are small enough, or the best step within the bounds
  // promises less than the tolerance. Ceres finds that out by another
  // evaluation, and takes no step then. Networks go on whatever they are
  // promised, which is more than their valleys hold.
  bool IsSettled(const Vector& free, const CondensedSystem& system,
                 const Limits& limits) const;
  // Notes a point at which there is nothing to do.
  void Settle(const CondensedSystem& system, double gradient_norm,
              FitState* state);

  const FitContext& context_;
  FitLog* log_;
  Progress* progress_;
  double radius_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_SOLVE_H_
