// All segments of a problem's training records at one point.

#ifndef PINODE_ESTIMATE_SHOOTING_SEGMENT_SWEEP_H_
#define PINODE_ESTIMATE_SHOOTING_SEGMENT_SWEEP_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/shooting/linear_record.h"
#include "pinode/estimate/shooting/ordered_sums.h"
#include "pinode/estimate/shooting/shooting_record.h"
#include "pinode/integrate/parallel_segment.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/robust_loss.h"

namespace pinode {

// The point at which segments are propagated: values of the parameters, and the
// dynamics prepared for them.
struct ShootingPoint {
  StructuralDynamics::Prepared prepared;
  Vector parameters;  // all of the problem's
};

// Propagates segments from given starts, weighs their residuals and sums their
// normal equations: on several threads, and on the ranks of a communicator.
// Where records are linear and in one piece, LinearRecord has them; the rest
// goes step by step.
class SegmentSweep {
 public:
  struct Options {
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
    RobustLoss loss = RobustLoss::kNone;
    double loss_scale = 3.0;  // in units of sigma
    int num_threads = 1;
    Communicator* communicator = nullptr;  // nullptr: a single process
  };
  using Records = std::vector<std::unique_ptr<ShootingRecord>>;
  // A record and its segment, as indices into the records.
  using Task = std::pair<int, int>;

  // All must outlive this object.
  SegmentSweep(const IdentificationProblem& problem,
               const ParameterLayout& layout, const Options& options,
               const Records& records);
  ~SegmentSweep();

  // Fills *point from the free parameters. False where a parameter is not
  // finite or the dynamics cannot be prepared for these values.
  [[nodiscard]] bool PreparePoint(const Vector& free,
                                  ShootingPoint* point) const;
  // The point at which segments are propagated from now on; it must outlive
  // what follows.
  void SetPoint(const ShootingPoint* point) { point_ = point; }

  const IdentificationProblem& problem() const { return problem_; }
  const ParameterLayout& layout() const { return layout_; }
  const Options& options() const { return options_; }

  // All segments of the records for which it is true.
  std::vector<Task> SegmentsOf(const std::vector<bool>& wanted) const;

  // From `starts`, one matrix for each record: fills results and ends of the
  // segments' records, and sum() with `with_parameters`. The ranks share the
  // segments, and pieces of linear records where these are fewer; afterwards
  // each has all results. False where a rank does not answer.
  [[nodiscard]] bool Evaluate(const std::vector<Task>& tasks,
                              const std::vector<const Matrix*>& starts,
                              bool with_parameters);
  // Lower triangle and gradient of the last evaluation with parameters.
  const FreeEquations& sum() const { return sum_; }

  // Makes evaluations with parameters keep the rows of records in one piece
  // that go step by step.
  void set_keeps_rows(bool keeps) { keeps_rows_ = keeps; }
  bool keeps_rows() const { return keeps_rows_; }
  // J'r'' of the rows kept, the sum over all records, J with the starts
  // following: r'' is the second derivative of the residuals along `step`, of
  // which `share` has been gone to `starts` and to the point set. False where
  // rows were not kept, or a trajectory is not finite.
  [[nodiscard]] bool Bend(const std::vector<Matrix>& starts, const Vector& step,
                          double share, Vector* projected);

  // Weighted residuals of consecutive samples of a record, from `first` on,
  // channels x count, and their derivative by the free parameters with the
  // starts following as the record's start_sensitivity() says, (channels *
  // count) x num_free; no columns without `with_jacobian`.
  using Visitor =
      std::function<void(size_t record, Eigen::Index first,
                         const Matrix& residuals, const Matrix& jacobian)>;
  // All of a record, piece by piece, in this process; with several threads in
  // any order and several at a time. False where a trajectory is not finite.
  [[nodiscard]] bool Visit(size_t record, const Matrix& starts,
                           bool with_jacobian, int num_threads,
                           const Visitor& visitor);

  // True if LinearRecord has all records. Then the two functions that follow
  // may be called, at any point: see residual_statistics.h.
  bool IsByModes() const;
  [[nodiscard]] bool MovedResiduals(const ShootingPoint& point, size_t record,
                                    const Matrix& starts, const Vector& step,
                                    Matrix* residuals) const;
  [[nodiscard]] bool AddScores(const ShootingPoint& point, size_t record,
                               const Matrix& starts, Eigen::Index length,
                               Matrix* products, double* count) const;

  // Samples propagated so far, each times the tangents that went along.
  int64_t work() const { return work_; }

 private:
  struct Thread;

  // Bend of one record.
  bool BendRecord(size_t record, const Vector& start, const Vector& step,
                  double share, Thread* thread, Eigen::Ref<Vector> projected);
  SegmentColumns ColumnsOf(const ShootingRecord& record,
                           bool with_parameters) const;
  // True if LinearRecord is to be asked.
  bool IsWholeAndLinear(size_t record) const;
  LinearRecord::Point PointOf(const ShootingPoint& point, size_t record,
                              const Matrix& starts,
                              SegmentColumns columns) const;
  // A record in one piece, where LinearRecord can have it; `together` with the
  // other ranks.
  bool EvaluateWhole(size_t record, const Matrix& starts, bool with_parameters,
                     int num_threads, bool together, Matrix* sum);
  // One segment step by step; `alone`: with all threads, where that is worth
  // while. `sum`: nullptr where nothing is to be summed.
  bool EvaluateSegment(size_t record, int segment, const Matrix& starts,
                       bool with_parameters, bool alone, Thread* thread,
                       Matrix* sum);
  // EvaluateLinear returns which of the tasks LinearRecord has done;
  // EvaluateSteps does the others.
  std::vector<char> EvaluateLinear(const std::vector<Task>& tasks,
                                   const std::vector<const Matrix*>& starts,
                                   bool with_parameters);
  void EvaluateSteps(const std::vector<Task>& tasks,
                     const std::vector<const Matrix*>& starts,
                     bool with_parameters);
  bool VisitWhole(size_t record, const Matrix& starts, bool with_jacobian,
                  int num_threads, const Visitor& visitor);
  // Derivative of LinearRecord's columns by the free parameters, with which the
  // start goes along.
  Matrix ColumnsByFree(size_t record) const;
  bool VisitSegment(size_t record, int segment, const Matrix& starts,
                    bool with_jacobian, const Visitor& visitor);

  const IdentificationProblem& problem_;
  const ParameterLayout& layout_;
  const Options options_;
  const Records& records_;
  Communicator& communicator_;
  std::vector<std::unique_ptr<LinearRecord>> linear_;  // nullptr: not linear
  std::vector<std::unique_ptr<Thread>> threads_;
  ParallelSegment parallel_;
  const ShootingPoint* point_ = nullptr;
  OrderedSums sums_;
  FreeEquations sum_;
  bool keeps_rows_ = false;
  bool answered_ = true;  // by all ranks
  int64_t work_ = 0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SEGMENT_SWEEP_H_
