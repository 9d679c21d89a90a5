// Levenberg-Marquardt on a cost that comes as normal equations.

#ifndef PINODE_ESTIMATE_LEVENBERG_MARQUARDT_H_
#define PINODE_ESTIMATE_LEVENBERG_MARQUARDT_H_

#include <functional>
#include <string>

#include "pinode/base/types.h"
#include "pinode/estimate/cost_part.h"
#include "pinode/estimate/parameter_layout.h"

namespace pinode {

// What Ceres does with a dense problem (J. J. More, "The Levenberg-Marquardt
// algorithm", 1978; steps uphill: L. Grippo, F. Lampariello, S. Lucidi, SIAM J.
// Numer. Anal. 23 (1986) 707-716), on g and H as they are. For hundreds of
// unknowns that is three times as fast as to give Ceres a root of H, which it
// squares again: one Cholesky factorisation a step is all that is left. Steps
// keep within the bounds, by their active set (bounded_step.h).
//
//   (H + diag(H) / radius) step = -g
class LevenbergMarquardt {
 public:
  struct Options {
    int max_iterations = 100;
    // Converged where a step would change the cost by less than this share, or
    // the unknowns by less than that.
    double function_tolerance = 1e-6;
    double parameter_tolerance = 1e-14;
    double radius = 1e4;
    // Steps that it may take uphill in search of a lower cost before it goes
    // back.
    int uphill_steps = 0;
    // Steps one after the other to points at which there is no cost.
    int most_invalid_steps = 50;
  };

  struct Iteration {
    int number = 0;  // 0: the start
    double cost = 0.0;
    double gradient_norm = 0.0;
    double step_norm = 0.0;
    double radius = 0.0;
    bool accepted = true;
  };
  // After each iteration, with the point where it ended and the cost's
  // derivatives there. False: stop.
  using Callback =
      std::function<bool(const Iteration& iteration,
                         const CondensedSystem& system, const Vector& free)>;

  enum class End { kConverged, kIterations, kStopped, kNoCost };
  struct Outcome {
    // kNoCost: there is none at the start.
    End end = End::kNoCost;
    int iterations = 0;
    int failed_evaluations = 0;
    double cost_seconds = 0.0;
    double solver_seconds = 0.0;
  };

  // `layout` and `cost` must outlive this object.
  LevenbergMarquardt(const ParameterLayout& layout, const Options& options,
                     CostPart* cost);

  // From *free to the best point found.
  Outcome Run(const Callback& callback, Vector* free);

 private:
  // What a step uphill is judged by: as far as the cost may rise above the
  // lowest, and how it was promised to fall since then.
  struct Reference {
    double cost = 0.0;
    double promised = 0.0;
  };

  bool Linearize(const Vector& free, CondensedSystem* system);
  bool Evaluate(const Vector& free, double* cost);
  // By how much the cost is promised to fall; false where there is no step.
  bool FindStep(const Vector& free, double* promise);
  double Quality(double cost, double promise) const;
  void Accept(double cost, double promise, double quality);
  void Reject();

  const ParameterLayout& layout_;
  const Options options_;
  CostPart* cost_;
  bool bounded_ = false;

  CondensedSystem system_, next_;
  Vector floor_;  // of the diagonal
  Matrix factor_;
  Vector step_;
  double radius_ = 0.0;
  double shrink_ = 2.0;

  double lowest_ = 0.0;
  int uphill_ = 0;
  Reference reference_, candidate_;
  Outcome outcome_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_LEVENBERG_MARQUARDT_H_
