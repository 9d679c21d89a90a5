// The cost of a set of parameters, with the best segment starts for them.

#ifndef PINODE_ESTIMATE_SHOOTING_MULTIPLE_SHOOTING_H_
#define PINODE_ESTIMATE_SHOOTING_MULTIPLE_SHOOTING_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/estimate/shooting/segment_sweep.h"
#include "pinode/estimate/shooting/shooting_record.h"
#include "pinode/estimate/shooting/shooting_state.h"
#include "pinode/estimate/shooting/start_search.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/robust_loss.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Multiple shooting with the segment starts projected out: the trajectories'
// part of the cost.
//
// Every training record is cut into segments; s_k is the state at the start of
// segment k and phi_k(s_k, theta) the state at its end. For given theta the
// starts minimise
//
//   F(s, theta) = 1/2 sum_i rho(|y_i - yhat_i(s, theta)|^2 / sigma_i^2)
//               + mu/2 sum_k |D^-1 (phi_k(s_k, theta) - s_{k+1}) + lambda_k|^2,
//
// an augmented Lagrangian for closed gaps (J. Nocedal and S. Wright, Numerical
// Optimization, ch. 17) with scaled multipliers lambda and state scales D. The
// minimisation is an iterated Rauch-Tung-Striebel smoother (start_search.h):
// Gauss-Newton on a block tridiagonal system (start_equations.h). What is left,
// f(theta) = min_s F(s, theta), is what Ceres sees: variable projection (G. H.
// Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432) with the
// Gauss-Newton Hessian of the projected problem, that is, the Schur complement
// of the starts.
//
// The cost of an evaluation grows linearly with the record's length.
//
// This class propagates segments. Functions beside it read the results:
// trajectory_outline.h (trajectories), residual_statistics.h (residuals and
// their products) and score.h (errors of free runs).
class MultipleShooting final : public CostPart {
 public:
  struct Options {
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
    RobustLoss loss = RobustLoss::kNone;
    double loss_scale = 3.0;  // in units of sigma
    StartTuning starts;
    int num_threads = 1;
    // Set this where most points that are evaluated will be linearised:
    // derivatives are found along with the cost where that saves time.
    bool looks_ahead = true;
    // Ranks that share the work of evaluations, all at the same points;
    // nullptr: a single process.
    Communicator* communicator = nullptr;
  };

  // `problem` (valid) and `layout` must outlive this object.
  MultipleShooting(const IdentificationProblem& problem,
                   const ParameterLayout& layout, const Options& options);

  // Training records, as indices into the problem's records. The vectors below
  // have one entry for each of them.
  const std::vector<int>& train_records() const { return train_records_; }
  // Segments, weights and results of a training record.
  const ShootingRecord& record(size_t train_record) const {
    return *records_[train_record];
  }

  // Cuts every training record into segments of about `samples` samples; 0:
  // one segment a record. `state_at` gives the state of a training record at a
  // sample, from which the starts are taken. Resets multipliers to zero.
  using StateAt =
      std::function<Vector(size_t train_record, Eigen::Index sample)>;
  void Cut(Eigen::Index samples, const StateAt& state_at);
  // One segment a record, from these starts.
  void SetWholeRecords(const std::vector<Vector>& starts);

  // D, one scale per state and record; positive.
  void SetStateScales(const std::vector<Vector>& scales);
  // sigma, one per channel and record.
  void SetSigmas(const std::vector<Vector>& sigmas);

  // mu, positive. Multipliers are scaled so that mu * lambda stays.
  void SetGapPenalty(double mu);
  double gap_penalty() const { return gap_penalty_; }
  // lambda_k += D^-1 gap_k, at the parameters of the last evaluation.
  void UpdateMultipliers();
  // max |D^-1 gap| at the last evaluation.
  double LargestGap() const;

  // f(free) by the smoother started from the last linearisation. False where a
  // trajectory is not finite, see state().divergence().
  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;

  // The same, and gradient and Hessian. Starts stay those found here for the
  // next evaluations. Asked again at the same point, before anything else has
  // been evaluated or changed, it answers without propagating.
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;

  // Record, segment, time and state where the trajectory stopped being finite.
  std::string Failure() const override;

  // Linearize keeps what BendAlong needs, samples x unknowns, where it comes to
  // less than a GiB and records are in one piece. Returns true if it does;
  // otherwise nothing is kept any more.
  bool KeepRows(bool keep);
  // J'r'' at the last Linearize: r'' is the second derivative of the weighted
  // residuals along `step`, with the starts following, from a run a tenth of it
  // away. False where it cannot be had: nothing was kept, or not finite. What
  // was evaluated last is forgotten.
  [[nodiscard]] bool BendAlong(const Vector& step, Vector* projected);

  // Weighted residuals (yhat - y) / sigma, robust weights included, zero where
  // missing or not fitted, from the starts of the last evaluation. With
  // `with_jacobian` also their derivative by the free parameters with the
  // starts following as at the last Linearize. Piece by piece: in order, or,
  // with several threads, in any order and several at a time. False where a
  // trajectory is not finite.
  using Visitor = SegmentSweep::Visitor;
  bool VisitWeightedResiduals(const Vector& free, bool with_jacobian,
                              const Visitor& visitor, int num_threads = 1);

  // Starts of the last successful evaluation, num_states x segments per
  // training record.
  const std::vector<Matrix>& starts() const { return starts_; }
  // Says what has been propagated, and where.
  const ShootingState& state() const { return state_; }
  // Problem, options and sums of the segments.
  const SegmentSweep& sweep() const { return sweep_; }

 private:
  using Task = SegmentSweep::Task;

  // Result of a search for starts; they are in starts_.
  struct StartsFound {
    double cost = 0.0;
    bool with_derivatives = false;  // by the parameters, at these starts
    Divergence divergence;          // where no finite trajectory was found
  };

  [[nodiscard]] bool PrepareAt(const Vector& free);
  // True if all segments of the record are finite; otherwise notes the first
  // one that is not.
  static bool AllFinite(const ShootingRecord& record, Divergence* divergence);
  bool Fail(const Divergence& divergence);
  void CostHasChanged();
  // Starts at `free` on the tangent of the last linearisation.
  Matrix PredictStarts(size_t record, const Vector& free) const;
  // From these starts, one matrix for each record.
  bool SolveStarts(const std::vector<Matrix>& from, StartsFound* found);
  bool SolveStartsFor(const Vector& free, StartsFound* found);
  // Propagates all segments with their derivatives from starts_.
  [[nodiscard]] bool FindDerivatives();
  // Takes the starts out of the summed equations. False where these are
  // singular.
  [[nodiscard]] bool Condense(const Vector& free, double cost,
                              CondensedSystem* system);

  const IdentificationProblem& problem_;
  const ParameterLayout& layout_;
  Options options_;
  std::vector<int> train_records_;
  SegmentSweep::Records records_;
  SegmentSweep sweep_;
  double gap_penalty_ = 1.0;
  ShootingPoint point_;  // at which sweep_ propagates
  std::vector<Matrix> starts_;
  ShootingState state_;
  LookAhead look_ahead_;
};

// Cuts every training record into segments of about `samples` samples; 0: one
// segment a record. Starts are taken from the trajectories given (states at
// every sample of each record, num_states x samples).
void SetSegments(Eigen::Index samples, const std::vector<Matrix>& trajectories,
                 MultipleShooting* shooting);
// The same with all starts at rest.
void SetSegmentsAtRest(Eigen::Index samples, MultipleShooting* shooting);

// True if every record is in one piece.
bool IsSingleShooting(const MultipleShooting& shooting);
// True if any record has a start to be found, be it that of a later segment
// alone.
bool HasFreeStarts(const MultipleShooting& shooting);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_MULTIPLE_SHOOTING_H_
