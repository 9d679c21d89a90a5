// One training record cut into segments, and the normal equations of their
// starts.

#ifndef PINODE_ESTIMATE_SHOOTING_SHOOTING_RECORD_H_
#define PINODE_ESTIMATE_SHOOTING_SHOOTING_RECORD_H_

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/base/types.h"
#include "pinode/estimate/shooting/block_tridiagonal.h"
#include "pinode/estimate/shooting/gap_penalty.h"
#include "pinode/estimate/shooting/residual_rows.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Equations of the free parameters, a dense symmetric matrix and a gradient.
// The matrix holds its lower triangle alone while it is being summed.
struct FreeEquations {
  Matrix hessian;   // num_free x num_free
  Vector gradient;  // num_free
};

// What one segment contributes to the normal equations.
struct SegmentResult {
  bool ok = false;
  double cost = 0.0;
  // Of each channel, sum r^2 sigma^2 with the robust weights.
  Vector squares;
  Matrix start_hessian;  // J_s' J_s
  Vector start_gradient;
  Matrix cross;            // J_theta' J_s, num_free x num_states
  Matrix end_sensitivity;  // num_states x (num_states [+ num_free])
  Eigen::Index failed_sample = -1;
  int failed_state = -1;
};

// A record's part of
//
//   F(s, theta) = 1/2 |r(s, theta)|^2 + (the gaps' penalty)
//               + kappa/2 |D^-1 s_0|^2        (where its first start is free),
//
// block tridiagonal in the starts s.
class ShootingRecord {
 public:
  // `index`: of a record of `problem` (valid), which must outlive this object.
  // `start_precision`: kappa.
  ShootingRecord(const IdentificationProblem& problem, int index,
                 double start_precision);

  int index() const { return index_; }
  const IdentificationRecord& data() const { return *data_; }
  const IntegrationGrid& grid() const { return grid_; }
  const ObservationMap& observation() const { return observation_; }
  // What each channel's values are like.
  const std::vector<SeriesStatistics>& measured() const { return measured_; }

  // Segments of nearly equal length, about `samples` samples each, 0: one; and
  // their starts, num_states x segments, from what `state_at` says of a sample.
  // Multipliers are reset to zero.
  Matrix Cut(Eigen::Index samples,
             const std::function<Vector(Eigen::Index sample)>& state_at);
  int num_segments() const { return static_cast<int>(boundaries_.size()) - 1; }
  // First samples of the segments, then the record's last sample.
  const std::vector<Eigen::Index>& boundaries() const { return boundaries_; }
  Eigen::Index first_sample(int segment) const {
    return boundaries_[static_cast<size_t>(segment)];
  }
  Eigen::Index last_sample(int segment) const {
    return boundaries_[static_cast<size_t>(segment) + 1];
  }
  bool HasFreeStarts() const { return start_is_free_ || num_segments() > 1; }

  void set_sigmas(const Vector& sigmas) { sigmas_ = sigmas; }
  const Vector& sigmas() const { return sigmas_; }
  GapPenalty& gaps() { return gaps_; }
  const GapPenalty& gaps() const { return gaps_; }
  const Vector& scales() const { return gaps_.scales(); }

  // Of the last evaluation; segments may be written by different threads.
  SegmentResult& result(int segment) {
    return results_[static_cast<size_t>(segment)];
  }
  const SegmentResult& result(int segment) const {
    return results_[static_cast<size_t>(segment)];
  }
  // Of a record in one piece, where they were to be kept.
  SegmentRows& kept_rows() { return kept_rows_; }
  // States at the segments' ends, num_states x segments.
  Matrix& ends() { return ends_; }
  const Matrix& ends() const { return ends_; }

  // Of the segments' results and the penalty.
  double Cost(double mu, const Matrix& starts) const;

  // Fills system() with the normal equations of the starts, and *right with
  // their coupling to the free parameters, negative (num_free rows, 0 to leave
  // them out), and, in the last row, their gradient.
  void Assemble(double mu, const Matrix& starts, int num_free, Matrix* right);
  BlockTridiagonal& system() { return *system_; }

  // Adds the gaps' part to the equations of the free parameters and takes the
  // starts out of them. False where their matrix is singular.
  bool Eliminate(double mu, const Matrix& starts, FreeEquations* equations);
  // d starts / d free after that, (num_states * segments) x num_free; empty
  // after Cut.
  auto start_sensitivity() const {
    return right_.topRows(std::max<Eigen::Index>(0, right_.rows() - 1))
        .transpose();
  }

  // Sum over segments of the mean of diag(D J_s'J_s D).
  double DataCurvature() const;

  // Cost at the last evaluation, and at the last linearisation.
  double cost = 0.0;
  double linearized_cost = 0.0;

 private:
  // To the equations of the free parameters.
  void AddGaps(double mu, const Matrix& starts, FreeEquations* equations);

  int index_ = -1;
  const IdentificationRecord* data_ = nullptr;
  int num_states_ = 0;
  double start_precision_ = 0.0;
  IntegrationGrid grid_;
  ObservationMap observation_;
  std::vector<SeriesStatistics> measured_;
  bool start_is_free_ = false;
  Vector fixed_start_;
  std::vector<Eigen::Index> boundaries_;
  Vector sigmas_;
  GapPenalty gaps_;
  std::vector<SegmentResult> results_;
  SegmentRows kept_rows_;
  Matrix ends_;
  std::unique_ptr<BlockTridiagonal> system_;
  // What Eliminate makes of Assemble's: in its first num_free rows the
  // transposed start_sensitivity(). Kept, it is too large to be asked for anew.
  Matrix right_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SHOOTING_RECORD_H_
