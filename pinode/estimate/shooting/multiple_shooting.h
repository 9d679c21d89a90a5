// The cost of a set of parameters, with the best segment starts for them.

#ifndef PINODE_ESTIMATE_SHOOTING_MULTIPLE_SHOOTING_H_
#define PINODE_ESTIMATE_SHOOTING_MULTIPLE_SHOOTING_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/estimate/shooting/look_ahead.h"
#include "pinode/estimate/shooting/segment_sweep.h"
#include "pinode/estimate/shooting/shooting_record.h"
#include "pinode/estimate/shooting/start_search.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/integrate/free_run.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/robust_loss.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Where a trajectory stopped being finite.
struct Divergence {
  int record = -1;  // index into the problem's records
  int segment = -1;
  Eigen::Index sample = -1;
  int state = -1;
  bool Happened() const { return record >= 0; }
};

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
// Gauss-Newton on a block tridiagonal system (shooting_record.h). What is left,
// f(theta) = min_s F(s, theta), is what Ceres sees: variable projection (G. H.
// Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432) with the
// Gauss-Newton Hessian of the projected problem, that is, the Schur complement
// of the starts.
//
// The cost of an evaluation grows linearly with the record's length.
class MultipleShooting final : public CostPart {
 public:
  struct Options {
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
    RobustLoss loss = RobustLoss::kNone;
    double loss_scale = 3.0;  // in units of sigma
    StartTuning starts;
    int num_threads = 1;
    // Whether most points that are evaluated will be linearised: derivatives
    // are found along with the cost where that saves time.
    bool looks_ahead = true;
    // Ranks that share the work of evaluations, all at the same points;
    // nullptr: a single process.
    Communicator* communicator = nullptr;
  };

  // `problem` (valid) and `layout` must outlive this object.
  MultipleShooting(const IdentificationProblem& problem,
                   const ParameterLayout& layout, const Options& options);
  ~MultipleShooting() override;

  // Training records, as indices into the problem's records. The vectors below
  // have one entry for each of them.
  const std::vector<int>& train_records() const { return train_records_; }

  // Cuts every training record into segments of about `samples` samples; 0:
  // one segment a record. Starts are taken from the trajectories given (states
  // at every sample of each record, num_states x samples). Multipliers are
  // reset to zero.
  void SetSegments(Eigen::Index samples,
                   const std::vector<Matrix>& trajectories);
  // The same from trajectories of which an outline was kept, which are run
  // again where starts lie between those of the outline; false where they are
  // not finite.
  [[nodiscard]] bool SetSegmentsAlong(Eigen::Index samples,
                                      const TrajectoryOutlines& outlines);
  // All starts at rest.
  void SetSegmentsAtRest(Eigen::Index samples);
  // One segment a record, from these starts.
  void SetWholeRecords(const std::vector<Vector>& starts);
  int num_segments(int train_record) const;
  bool IsSingleShooting() const;
  // Of any record, be it of a later segment alone.
  bool HasFreeStarts() const;
  // Whether residuals are those of free runs as they are: records in one piece,
  // no robust loss.
  bool HasFreeRuns() const {
    return IsSingleShooting() && options_.loss == RobustLoss::kNone;
  }
  int num_threads() const { return options_.num_threads; }

  // D, one scale per state and record; positive.
  void SetStateScales(const std::vector<Vector>& scales);
  // sigma, one per channel and record.
  void SetSigmas(const std::vector<Vector>& sigmas);
  // What the channels' values of a training record are like.
  const std::vector<SeriesStatistics>& measured(size_t train_record) const {
    return records_[train_record]->measured();
  }
  const Vector& sigmas(size_t train_record) const {
    return records_[train_record]->sigmas();
  }
  void SetGapPenalty(double mu) {
    gap_penalty_ = mu;
    CostHasChanged();
  }
  double gap_penalty() const { return gap_penalty_; }
  // lambda_k += D^-1 gap_k, at the parameters of the last evaluation.
  void UpdateMultipliers();
  // After a change of mu: mu * lambda is what must stay.
  void RescaleMultipliers(double factor);

  // f(free) by the smoother started from the last linearisation. False where a
  // trajectory is not finite, see divergence().
  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;

  // The same, and gradient and Hessian. Starts stay those found here for the
  // next evaluations. Asked again at the same point, before anything else has
  // been evaluated or changed, it answers without propagating.
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;

  // Linearize keeps what BendAlong needs, samples x unknowns, where it comes to
  // less than a GiB and records are in one piece. Returns whether it does;
  // otherwise nothing is kept any more.
  bool KeepRows(bool keep);
  // J'r'' at the last Linearize: r'' is the second derivative of the weighted
  // residuals along `step`, with the starts following, from a run a tenth of it
  // away. False where it cannot be had: nothing was kept, or not finite. What
  // was evaluated last is forgotten.
  [[nodiscard]] bool BendAlong(const Vector& step, Vector* projected);

  const Divergence& divergence() const { return divergence_; }

  // Record, segment, time and state where the trajectory stopped being finite.
  std::string Failure() const override;

  // Of the last successful evaluation:
  // Starts, num_states x segments per training record.
  const std::vector<Matrix>& starts() const { return starts_; }
  // max |D^-1 gap|.
  double LargestGap() const;
  // States at every sample, from the starts, per training record.
  bool Trajectories(const Vector& free, std::vector<Matrix>* states);
  // The same of an outline, whatever was evaluated.
  bool Trajectories(const TrajectoryOutlines& outlines,
                    std::vector<Matrix>* states);
  // What there is to keep of them.
  [[nodiscard]] bool Outline(const Vector& free, TrajectoryOutlines* outlines);
  // Sums of squares of each channel's residuals in the sensors' units (weights
  // of a robust loss included), per training record, where the last evaluation
  // was a linearisation at `free`; nullptr where it was not.
  const std::vector<Vector>* SquaresAt(const Vector& free) const;
  // Weighted residuals (yhat - y) / sigma, robust weights included, zero where
  // missing or not fitted: channels x samples per training record. With
  // `with_jacobian` also their derivative by the free parameters with the
  // starts following as at the last Linearize, (channels * samples) x
  // num_free, channels fastest. False where a trajectory is not finite.
  bool WeightedResiduals(const Vector& free, bool with_jacobian,
                         std::vector<Matrix>* residuals,
                         std::vector<Matrix>* jacobians);
  // The same piece by piece, for what does not need all of it at once: in
  // order, or, with several threads, in any order and several at a time.
  using Visitor = SegmentSweep::Visitor;
  bool VisitWeightedResiduals(const Vector& free, bool with_jacobian,
                              const Visitor& visitor, int num_threads = 1);
  // J'J of the same, at the last Linearize.
  Matrix Information() const;
  // Whether all records are linear and in one piece, so that what follows need
  // not look at each sample's derivatives.
  bool IsByModes() const;
  // r + J step, channels x samples per training record; J, the Jacobian that
  // WeightedResiduals has.
  [[nodiscard]] bool MovedResiduals(const Vector& free, const Vector& step,
                                    std::vector<Matrix>* residuals);
  // The lower triangle of sum g g', g = J'r of each block of so many samples of
  // each training record, and how many blocks there are.
  [[nodiscard]] bool AddScores(const Vector& free,
                               const std::vector<Eigen::Index>& lengths,
                               Matrix* products, double* count);
  // Mean over segments and states of D^2 J'J of the data: how firmly the data
  // alone hold a start, beside mu.
  double DataCurvature() const { return data_curvature_; }
  // Samples propagated so far, each times the tangents that went along.
  int64_t work() const { return sweep_.work(); }

 private:
  using Task = SegmentSweep::Task;

  [[nodiscard]] bool PrepareDynamics(const Vector& free);
  // Runs pieces of a record, from each of `samples` to the next; `take` gets
  // the first sample of each, and how many are its own. False where one is not
  // finite.
  using Take = std::function<void(Eigen::Index first, Eigen::Index count,
                                  Trajectory* piece)>;
  [[nodiscard]] bool RunPieces(size_t record,
                               const std::vector<Eigen::Index>& samples,
                               const Matrix& starts, Keep keep,
                               const Take& take);
  [[nodiscard]] bool RunRecord(size_t record,
                               const std::vector<Eigen::Index>& samples,
                               const Matrix& starts, Matrix* states);
  // Cuts all records at what `state_at` says of a record and a sample.
  void CutRecords(Eigen::Index samples,
                  const std::function<Vector(size_t, Eigen::Index)>& state_at);
  // Whether all of them are finite; where not, notes the first one.
  bool AllFinite(const ShootingRecord& record);
  void CostHasChanged() {
    last_free_.resize(0);
    has_columns_ = false;
    look_ahead_.Forget();
    is_linearized_ = false;
    linearized_cost_ = std::numeric_limits<double>::infinity();
  }
  // Where the last linearisation's tangent leads.
  Matrix PredictStarts(size_t record, const Vector& free) const;
  // From these starts, one matrix for each record.
  bool SolveStarts(const std::vector<Matrix>& from, double* cost);
  bool SolveStartsFor(const Vector& free, double* cost);

  const IdentificationProblem& problem_;
  const ParameterLayout& layout_;
  Options options_;
  std::vector<int> train_records_;
  SegmentSweep::Records records_;
  SegmentSweep sweep_;
  double gap_penalty_ = 1.0;
  double data_curvature_ = 0.0;

  StructuralDynamics::Prepared prepared_;
  Vector parameters_;  // of prepared_, all
  // The point of the last evaluation, and of the last linearisation.
  Vector last_free_, linearized_free_;
  std::vector<Matrix> starts_, linearized_starts_;
  double linearized_cost_ = std::numeric_limits<double>::infinity();
  double last_cost_ = 0.0;
  // Whether the last evaluation was this linearisation, at linearized_free_.
  bool is_linearized_ = false;
  bool keeps_rows_ = false;
  // Whether the last evaluation has found the derivatives at its starts.
  bool has_columns_ = false;
  LookAhead look_ahead_;
  CondensedSystem linearized_;
  // Where squares_ are of; empty: nowhere.
  Vector squares_free_;
  std::vector<Vector> squares_;
  bool failed_ = false;
  Divergence divergence_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_MULTIPLE_SHOOTING_H_
