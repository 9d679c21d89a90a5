#include "pinode/estimate/shooting/trajectory_outline.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/integrate/free_run.h"

namespace pinode {
namespace {

// Runs a record's pieces at one point.
class PieceRunner {
 public:
  // `shooting` must outlive this object.
  explicit PieceRunner(const MultipleShooting& shooting)
      : shooting_(shooting), nothing_(*problem().dynamics, {}) {}

  [[nodiscard]] bool SetPoint(const Vector& free) {
    return shooting_.sweep().PreparePoint(free, &point_);
  }

  // Runs from each of `samples` to the next; `take` gets the first sample of
  // each piece, and how many are its own. False where one is not finite.
  using Take = std::function<void(Eigen::Index first, Eigen::Index count,
                                  Trajectory* piece)>;
  [[nodiscard]] bool Run(size_t record,
                         const std::vector<Eigen::Index>& samples,
                         const Matrix& starts, Keep keep,
                         const Take& take) const {
    for (size_t k = 0; k + 1 < samples.size(); ++k) {
      Trajectory piece;
      if (!FreeRun(*problem().dynamics, point_.prepared, nothing_,
                   shooting_.record(record).grid(),
                   starts.col(static_cast<Eigen::Index>(k)), samples[k],
                   samples[k + 1], &piece, keep,
                   shooting_.sweep().options().num_threads)) {
        return false;
      }
      const bool last = k + 2 == samples.size();
      take(samples[k], samples[k + 1] - samples[k] + (last ? 1 : 0), &piece);
    }
    return true;
  }

  // States at every sample of the record.
  [[nodiscard]] bool RunStates(size_t record,
                               const std::vector<Eigen::Index>& samples,
                               const Matrix& starts, Matrix* states) const {
    const bool whole = samples.size() == 2;
    if (!whole) {
      states->resize(problem().dynamics->num_states(),
                     shooting_.record(record).grid().num_samples());
    }
    return Run(record, samples, starts, Keep::kAll,
               [&](Eigen::Index first, Eigen::Index count, Trajectory* piece) {
                 if (whole) {
                   *states = std::move(piece->states);
                   return;
                 }
                 states->middleCols(first, count) =
                     piece->states.leftCols(count);
               });
  }

 private:
  const IdentificationProblem& problem() const {
    return shooting_.sweep().problem();
  }

  const MultipleShooting& shooting_;
  const ObservationMap nothing_;
  ShootingPoint point_;
};

}  // namespace

bool RunTrajectories(const MultipleShooting& shooting, const Vector& free,
                     std::vector<Matrix>* states) {
  PieceRunner runner(shooting);
  if (!runner.SetPoint(free)) return false;
  states->assign(shooting.train_records().size(), Matrix());
  for (size_t r = 0; r < states->size(); ++r) {
    if (!runner.RunStates(r, shooting.record(r).boundaries(),
                          shooting.starts()[r], &(*states)[r])) {
      return false;
    }
  }
  return true;
}

bool RunTrajectories(const MultipleShooting& shooting,
                     const TrajectoryOutlines& outlines,
                     std::vector<Matrix>* states) {
  PieceRunner runner(shooting);
  if (!runner.SetPoint(outlines.free)) return false;
  states->assign(shooting.train_records().size(), Matrix());
  for (size_t r = 0; r < states->size(); ++r) {
    const TrajectoryOutline& outline = outlines.records[r];
    if (!runner.RunStates(r, outline.samples, outline.starts, &(*states)[r])) {
      return false;
    }
  }
  return true;
}

bool OutlineTrajectories(const MultipleShooting& shooting, const Vector& free,
                         TrajectoryOutlines* outlines) {
  PieceRunner runner(shooting);
  if (!runner.SetPoint(free)) return false;
  outlines->free = free;
  outlines->records.resize(shooting.train_records().size());
  for (size_t r = 0; r < outlines->records.size(); ++r) {
    TrajectoryOutline& outline = outlines->records[r];
    outline.samples = shooting.record(r).boundaries();
    outline.starts = shooting.starts()[r];
    Vector squares = Vector::Zero(outline.starts.rows());
    if (!runner.Run(r, outline.samples, outline.starts, Keep::kMeanSquares,
                    [&](Eigen::Index, Eigen::Index count, Trajectory* piece) {
                      squares += piece->mean_squares *
                                 static_cast<double>(piece->num_samples());
                      // The next piece's first sample is this one's last.
                      if (count < piece->num_samples()) {
                        squares -= piece->states.col(0).cwiseAbs2();
                      }
                    })) {
      return false;
    }
    outline.mean_squares =
        squares.cwiseMax(0.0) /
        static_cast<double>(shooting.record(r).grid().num_samples());
  }
  return true;
}

bool SetSegmentsAlong(Eigen::Index samples, const TrajectoryOutlines& outlines,
                      MultipleShooting* shooting) {
  CHECK_EQ(outlines.records.size(), shooting->train_records().size())
      << "one outline per training record";
  const auto find = [&](size_t r, Eigen::Index sample) {
    const std::vector<Eigen::Index>& known = outlines.records[r].samples;
    const auto found = std::lower_bound(known.begin(), known.end() - 1, sample);
    return found != known.end() - 1 && *found == sample
               ? static_cast<int>(found - known.begin())
               : -1;
  };
  bool all_known = true;
  shooting->Cut(samples, [&](size_t r, Eigen::Index sample) {
    const int k = find(r, sample);
    all_known = all_known && k >= 0;
    return Vector(outlines.records[r].starts.col(std::max(0, k)));
  });
  std::vector<Matrix> trajectories;
  if (all_known) return true;
  if (!RunTrajectories(*shooting, outlines, &trajectories)) return false;
  SetSegments(samples, trajectories, shooting);
  return true;
}

}  // namespace pinode
