// A whole training record of a linear model, by its modes.

#ifndef PINODE_ESTIMATE_SHOOTING_LINEAR_RECORD_H_
#define PINODE_ESTIMATE_SHOOTING_LINEAR_RECORD_H_

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/estimate/shooting/record_sums.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/modal_response.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/robust_loss.h"

namespace pinode {

// Cost and normal equations of a record in one piece from its start s,
//
//   1/2 sum_c sum_i r_ci^2,   r_ci = (gain_c y_c(i) + offset_c - measured) /
//                                    sigma_c.
//
// With the histories Z (R x samples, see ModalResponse) channel c has the
// Jacobian T_c' Z by the start and the free parameters, so that
//
//   J'J = sum_c T_c' (Z Z') T_c,    J'r = sum_c T_c' (Z r_c):
//
// a sample costs R^2, or for few derivatives R columns channels, whichever is
// less, and nothing is kept of it. The sums are kept by channel: where the
// noise levels alone have changed, they are weighed anew. Channels that miss
// samples have a Gram matrix Z Z' of their own. The pieces of a record are
// summed side by side.
class LinearRecord {
 public:
  // nullptr where the record is not of this kind: dynamics that are not linear,
  // a filter, delays, a robust loss, or channels that miss too many different
  // samples. All must outlive the object.
  static std::unique_ptr<LinearRecord> Create(
      const IdentificationProblem& problem, const ParameterLayout& layout,
      const IdentificationRecord& record, const IntegrationGrid& grid,
      const ObservationMap& observation, RobustLoss loss);

  // Parameters, noise and start at which the record is evaluated.
  struct Point {
    const StructuralDynamics::Prepared* prepared = nullptr;
    const Vector* parameters = nullptr;  // all of the problem's
    const Vector* sigmas = nullptr;      // one a channel
    Vector start;                        // num_states
    SegmentColumns columns = SegmentColumns::kNone;
  };

  // Columns: the start where `columns` have it, then all free parameters.
  struct Equations {
    double cost = 0.0;
    Vector squares;   // of each channel, sum r^2 sigma^2
    Matrix hessian;   // J'J
    Vector gradient;  // J'r
    Vector end_state;
  };

  // With a communicator (nullptr: without) its ranks share the pieces. False
  // where the modes do not span the states or the run is not finite: such a
  // record is to be propagated step by step.
  [[nodiscard]] bool Evaluate(const Point& point, int num_threads,
                              Communicator* communicator, Equations* equations);

  // Residuals r, channels x count, and their Jacobian, (channels * count) x
  // columns, channels fastest, of consecutive samples from `first` on; zero
  // where missing or not fitted. Called by several threads at a time.
  using Visitor = std::function<void(
      Eigen::Index first, const Matrix& residuals, const Matrix& jacobian)>;
  [[nodiscard]] bool Visit(const Point& point, int num_threads,
                           const Visitor& visitor);

  // r + J step, channels x samples; `step`: one number a column, or nothing.
  [[nodiscard]] bool Residuals(const Point& point, const Vector& step,
                               int num_threads, Matrix* residuals);

  // Scores g = P' sum_i J_i' r_i of blocks of `length` samples, the last of
  // which may have fewer: adds the lower triangle of sum g g' to *products, and
  // the number of blocks to *count. P: columns x any number.
  [[nodiscard]] bool AddScores(const Point& point, const Matrix& projection,
                               Eigen::Index length, int num_threads,
                               Matrix* products, double* count);

 private:
  // Channels that miss the same samples.
  struct Pattern {
    std::vector<int> channels;
    std::vector<bool> present;  // empty: all
  };
  // A point, expressed in histories.
  struct Tables;
  // Scores of a thread's share of the record.
  struct ScoreShare;
  // The equations of each channel, whatever its noise.
  struct ByChannel {
    // The point they belong to.
    Vector parameters;
    Vector start;
    SegmentColumns columns = SegmentColumns::kNone;
    // False where there would be too many: gradients and Hessians of all
    // channels are one then, and all have their noise in them.
    bool apart = false;

    Vector costs;      // one a channel
    Matrix gradients;  // columns x channels
    std::vector<Matrix> hessians;
    Vector end_state;
  };

  LinearRecord(const IdentificationProblem& problem,
               const ParameterLayout& layout,
               const IdentificationRecord& record, const IntegrationGrid& grid,
               const ObservationMap& observation);
  bool FindPatterns();
  // In units of `sigmas`.
  bool Tabulate(const Point& point, const Vector& sigmas, int num_threads,
                Tables* tables);
  // r of consecutive samples from their histories, channels x count.
  Matrix Residuals(const Tables& tables, Eigen::Index first,
                   const Matrix& histories) const;
  void AddBlock(const Tables& tables, Eigen::Index first,
                const Matrix& histories, RecordSums* sums) const;
  void Condense(const Tables& tables, const RecordSums& sums, int num_threads,
                ByChannel* equations) const;
  // True if the equations of channels are few enough to be kept apart.
  bool KeepsApart() const;
  // True if the equations of all channels belong to this point, whatever the
  // noise.
  bool HasBeenAt(const Point& point, const ByChannel& known) const;
  // At a point where nothing is known.
  [[nodiscard]] bool Sum(const Point& point, int num_threads,
                         Communicator* communicator, ByChannel* equations);
  // False where a rank does not answer.
  [[nodiscard]] static bool AddRanks(Communicator* ranks, ByChannel* equations);
  // Sums over the pieces that this rank owns.
  RecordSums SumPieces(const Tables& tables, int num_threads,
                       const Communicator& communicator) const;

  const IdentificationProblem& problem_;
  const ParameterLayout& layout_;
  const IdentificationRecord& record_;
  const IntegrationGrid& grid_;
  const ObservationMap& observation_;
  std::vector<Pattern> patterns_;  // of the fitted channels
  ModalResponse response_;
  // Equations of the last cost alone, and of the last with derivatives: new
  // noise levels need no new sums.
  std::array<ByChannel, 2> known_;
  // A point whose cost is asked for is mostly accepted and linearised next. So
  // derivatives go along, and the histories are passed once: unless the point
  // before was not linearised.
  SegmentColumns last_columns_ = SegmentColumns::kNone;
  bool trial_is_open_ = false;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_LINEAR_RECORD_H_
