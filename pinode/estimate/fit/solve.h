// One solve by Ceres, for given noise levels, decays and multipliers.

#ifndef PINODE_ESTIMATE_FIT_SOLVE_H_
#define PINODE_ESTIMATE_FIT_SOLVE_H_

#include "pinode/estimate/fit/fit_log.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Runs Levenberg-Marquardt on trajectories, priors and modes, each a residual
// block over the free parameters within their bounds. Keeps the radius of the
// trust region from solve to solve.
class Solver {
 public:
  // Keeps references to all arguments, which must outlive this object.
  Solver(const FitContext& context, FitLog* log);

  // Resets the radius to the initial one.
  void ResetRadius();

  // Limits that end a solve.
  struct Limits {
    int iterations = 0;
    double function_tolerance = 0.0;  // a share of the cost
    // RMS of the residuals in units of their noise levels. 0: no limit.
    double residual = 0.0;
    // Share of the cost: several steps in a row that change it by no more end
    // the solve. 0: no limit.
    double crawl = 0.0;
    // The same for costs above 1e4, but for 50 steps in a row that each save
    // less than one: they are a valley without an end, and the solve has not
    // converged. 0: no limit.
    double valley = 0.0;
  };

  // Solves from state->free. *converged is true if an iteration changes the
  // cost by less than the tolerance, or none promises more, or residuals are
  // below their limit, or the fit crawls. The solve also ends when the
  // iterations, or those of the options in total, are used up. The steps of
  // networks bend (BentCost). Leaves the objective linearised at the solution.
  // Returns false, with the summary's message, if the cost cannot be evaluated
  // at the start.
  [[nodiscard]] bool Solve(const Limits& limits, FitState* state,
                           bool* converged);

  // True if the last solve ended in a valley.
  bool is_in_valley() const { return is_in_valley_; }

  // True if the residuals at `free`, where the objective is linearised, are
  // below this RMS.
  bool IsBelow(double residual, const Vector& free) const;

  // Takes full steps of the quadratic model from a converged point, while each
  // lowers the cost. An iteration that hardly changes the cost leaves an error
  // in the unknowns of the order of its square root. Returns false as Solve
  // does.
  [[nodiscard]] bool Polish(FitState* state);

 private:
  class Callback;

  // True if residuals are small enough, or the best step within the bounds
  // promises less than the tolerance. Ceres needs another evaluation to find
  // this, and takes no step then. Networks continue regardless of the promise,
  // which exceeds the real gain in their valleys.
  bool IsSettled(const Vector& free, const CondensedSystem& system,
                 const Limits& limits) const;
  // Records a point that needs no step.
  void Settle(const CondensedSystem& system, double gradient_norm,
              FitState* state);

  const FitContext& context_;
  FitLog* log_;
  bool is_in_valley_ = false;
  double radius_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_SOLVE_H_
