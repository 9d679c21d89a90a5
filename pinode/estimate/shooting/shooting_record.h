// One training record cut into segments, and the results of these.

#ifndef PINODE_ESTIMATE_SHOOTING_SHOOTING_RECORD_H_
#define PINODE_ESTIMATE_SHOOTING_SHOOTING_RECORD_H_

#include <functional>
#include <memory>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/base/types.h"
#include "pinode/estimate/shooting/gap_penalty.h"
#include "pinode/estimate/shooting/residual_rows.h"
#include "pinode/estimate/shooting/start_equations.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Contribution of one segment to the normal equations.
struct SegmentResult {
  bool ok = false;
  double cost = 0.0;
  // sum r^2 sigma^2 of each channel, with the robust weights.
  Vector squares;
  Matrix start_hessian;  // J_s' J_s
  Vector start_gradient;
  Matrix cross;            // J_theta' J_s, num_free x num_states
  Matrix end_sensitivity;  // num_states x (num_states [+ num_free])
  Eigen::Index failed_sample = -1;
  int failed_state = -1;
};

// Results of a record's segments at the last evaluation. Segments may be
// written by different threads.
struct SegmentResults {
  std::vector<SegmentResult> segments;
  Matrix ends;  // states at the segments' ends, num_states x segments
  // Rows of a record in one piece, where they were to be kept.
  SegmentRows kept_rows;

  SegmentResult& of(int segment) {
    return segments[static_cast<size_t>(segment)];
  }
  const SegmentResult& of(int segment) const {
    return segments[static_cast<size_t>(segment)];
  }
};

// A training record: its data, the cut into segments, the weights of its
// residuals and gaps, and what the last evaluation of its segments gave.
class ShootingRecord {
 public:
  // `index` of a record of `problem` (valid), which must outlive this object.
  // `start_precision`: kappa, see StartEquations.
  ShootingRecord(const IdentificationProblem& problem, int index,
                 double start_precision);

  int index() const { return index_; }
  const IdentificationRecord& data() const { return *data_; }
  const IntegrationGrid& grid() const { return grid_; }
  const ObservationMap& observation() const { return observation_; }
  // Statistics of each channel's measured values.
  const std::vector<SeriesStatistics>& measured() const { return measured_; }

  // Cuts the record into segments of nearly equal length, about `samples`
  // samples each, 0: one. Returns their starts, num_states x segments, from the
  // states that `state_at` gives. Resets multipliers to zero.
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
  // True if there is a start to be found, be it that of a later segment alone.
  bool HasFreeStarts() const { return start_is_free_ || num_segments() > 1; }

  void set_sigmas(const Vector& sigmas) { sigmas_ = sigmas; }
  const Vector& sigmas() const { return sigmas_; }
  GapPenalty& gaps() { return gaps_; }
  const GapPenalty& gaps() const { return gaps_; }

  SegmentResults& results() { return results_; }
  const SegmentResults& results() const { return results_; }
  // Normal equations of the starts of this cut.
  StartEquations& equations() { return *equations_; }
  const StartEquations& equations() const { return *equations_; }

 private:
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
  SegmentResults results_;
  std::unique_ptr<StartEquations> equations_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SHOOTING_RECORD_H_
