#include "pinode/estimate/shooting/multiple_shooting.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pinode/base/logging.h"
#include "pinode/integrate/free_run.h"

namespace pinode {

namespace {

SegmentSweep::Records TrainRecords(const IdentificationProblem& problem,
                                   double start_precision) {
  SegmentSweep::Records records;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].role != IdentificationRecord::Role::kTrain) continue;
    records.push_back(std::make_unique<ShootingRecord>(
        problem, static_cast<int>(r), start_precision));
  }
  return records;
}

std::vector<StartProgress> ProgressOf(
    const std::vector<StartSearch>& searches) {
  std::vector<StartProgress> progress;
  for (const StartSearch& search : searches) {
    progress.push_back(search.progress());
  }
  return progress;
}

// Whether derivatives by the parameters cost about what starts cost anyway.
bool GoesWithFirstSweeps(const IdentificationProblem& problem,
                         const ParameterLayout& layout,
                         const SegmentSweep::Records& records) {
  // A linearisation of the laws takes about as long as so many columns.
  constexpr int kLinearization = 10;
  return std::any_of(records.begin(), records.end(),
                     [](const auto& r) { return r->HasFreeStarts(); }) &&
         layout.num_free() <=
             2 * (kLinearization + problem.dynamics->num_states());
}

}  // namespace

MultipleShooting::MultipleShooting(const IdentificationProblem& problem,
                                   const ParameterLayout& layout,
                                   const Options& options)
    : problem_(problem),
      layout_(layout),
      options_(options),
      records_(TrainRecords(problem, options.starts.prior_precision)),
      sweep_(problem, layout,
             {options.derivatives, options.loss, options.loss_scale,
              options.num_threads, options.communicator},
             records_),
      look_ahead_(GoesWithFirstSweeps(problem, layout, records_)) {
  for (const auto& record : records_) train_records_.push_back(record->index());
  starts_.resize(records_.size());
  sweep_.SetPoint(&prepared_, &parameters_);
}

MultipleShooting::~MultipleShooting() = default;

void MultipleShooting::SetSegments(Eigen::Index samples,
                                   const std::vector<Matrix>& trajectories) {
  CHECK_EQ(trajectories.size(), records_.size())
      << "one trajectory per training record";
  for (size_t r = 0; r < records_.size(); ++r) {
    CHECK_EQ(trajectories[r].cols(), records_[r]->grid().num_samples());
    CHECK_EQ(trajectories[r].rows(), problem_.dynamics->num_states());
  }
  CutRecords(samples, [&trajectories](size_t r, Eigen::Index sample) {
    return Vector(trajectories[r].col(sample));
  });
}

bool MultipleShooting::SetSegmentsAlong(Eigen::Index samples,
                                        const TrajectoryOutlines& outlines) {
  CHECK_EQ(outlines.records.size(), records_.size())
      << "one outline per training record";
  const auto find = [&](size_t r, Eigen::Index sample) {
    const std::vector<Eigen::Index>& known = outlines.records[r].samples;
    const auto found = std::lower_bound(known.begin(), known.end() - 1, sample);
    return found != known.end() - 1 && *found == sample
               ? static_cast<int>(found - known.begin())
               : -1;
  };
  bool all_known = true;
  CutRecords(samples, [&](size_t r, Eigen::Index sample) {
    const int k = find(r, sample);
    all_known = all_known && k >= 0;
    return Vector(outlines.records[r].starts.col(std::max(0, k)));
  });
  std::vector<Matrix> trajectories;
  if (all_known) return true;
  if (!Trajectories(outlines, &trajectories)) return false;
  SetSegments(samples, trajectories);
  return true;
}

void MultipleShooting::SetSegmentsAtRest(Eigen::Index samples) {
  CutRecords(samples, [this](size_t, Eigen::Index) {
    return Vector(Vector::Zero(problem_.dynamics->num_states()));
  });
}

void MultipleShooting::SetWholeRecords(const std::vector<Vector>& starts) {
  CHECK_EQ(starts.size(), records_.size()) << "one start per training record";
  CutRecords(0, [&starts](size_t r, Eigen::Index) { return starts[r]; });
}

void MultipleShooting::CutRecords(
    Eigen::Index samples,
    const std::function<Vector(size_t, Eigen::Index)>& state_at) {
  for (size_t r = 0; r < records_.size(); ++r) {
    starts_[r] = records_[r]->Cut(
        samples, [&](Eigen::Index sample) { return state_at(r, sample); });
  }
  linearized_starts_ = starts_;
  linearized_free_.resize(0);
  squares_free_.resize(0);
  CostHasChanged();
}

int MultipleShooting::num_segments(int train_record) const {
  return records_[static_cast<size_t>(train_record)]->num_segments();
}

bool MultipleShooting::IsSingleShooting() const {
  return std::all_of(records_.begin(), records_.end(), [](const auto& record) {
    return record->num_segments() == 1;
  });
}

void MultipleShooting::SetStateScales(const std::vector<Vector>& scales) {
  CHECK_EQ(scales.size(), records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    CHECK_EQ(scales[r].size(), problem_.dynamics->num_states());
    CHECK_GT(scales[r].minCoeff(), 0.0) << "state scales must be positive";
    records_[r]->gaps().set_scales(scales[r]);
  }
  CostHasChanged();
}

void MultipleShooting::SetSigmas(const std::vector<Vector>& sigmas) {
  CHECK_EQ(sigmas.size(), records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    CHECK_EQ(sigmas[r].size(), records_[r]->observation().num_channels());
    CHECK_GT(sigmas[r].minCoeff(), 0.0) << "sigmas must be positive";
    records_[r]->set_sigmas(sigmas[r]);
  }
  CostHasChanged();
}

bool MultipleShooting::PrepareDynamics(const Vector& free) {
  parameters_ = layout_.InitialValues();
  layout_.SetFree(free, &parameters_);
  divergence_ = Divergence();
  std::string error;
  return parameters_.allFinite() &&
         problem_.dynamics->Prepare(parameters_.head(layout_.num_dynamics()),
                                    &prepared_, &error);
}

bool MultipleShooting::AllFinite(const ShootingRecord& record) {
  for (int k = 0; k < record.num_segments(); ++k) {
    const SegmentResult& result = record.result(k);
    if (result.ok) continue;
    divergence_ = {record.index(), k, result.failed_sample,
                   result.failed_state};
    return false;
  }
  return true;
}

Matrix MultipleShooting::PredictStarts(size_t r, const Vector& free) const {
  Matrix starts = linearized_starts_[r];
  const auto sensitivity = records_[r]->start_sensitivity();
  if (linearized_free_.size() == free.size() &&
      sensitivity.cols() == free.size()) {
    const Vector move = sensitivity * (free - linearized_free_);
    starts +=
        Eigen::Map<const Matrix>(move.data(), starts.rows(), starts.cols());
  }
  return starts;
}

bool MultipleShooting::SolveStarts(const std::vector<Matrix>& from,
                                   double* cost) {
  std::vector<StartSearch> searches;
  for (size_t r = 0; r < records_.size(); ++r) {
    searches.emplace_back(
        options_.starts, records_[r].get(), gap_penalty_, from[r],
        linearized_free_.size() == 0 ? nullptr : &linearized_starts_[r]);
  }
  divergence_ = Divergence();
  has_columns_ = false;
  for (int i = 0; i < options_.starts.max_iterations; ++i) {
    std::vector<bool> searching;
    std::vector<const Matrix*> trials;
    for (const StartSearch& search : searches) {
      searching.push_back(!search.done());
      trials.push_back(&search.trial());
    }
    const std::vector<Task> tasks = sweep_.SegmentsOf(searching);
    if (tasks.empty()) break;
    // Rows are to be kept of points that were linearised, not of every trial.
    has_columns_ =
        options_.looks_ahead && !keeps_rows_ &&
        look_ahead_.GoesAlong(i, ProgressOf(searches), linearized_cost_);
    if (!sweep_.Evaluate(tasks, trials, has_columns_)) return false;
    for (size_t r = 0; r < records_.size(); ++r) {
      if (searching[r] &&
          !searches[r].Advance(AllFinite(*records_[r]), linearized_cost_)) {
        return false;
      }
    }
    look_ahead_.Learn(i + 1, ProgressOf(searches));
  }
  *cost = 0.0;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!searches[r].found()) return false;
    has_columns_ = has_columns_ && searches[r].progress().is_at_trial;
    starts_[r] = searches[r].best();
    records_[r]->cost = searches[r].best_cost();
    *cost += searches[r].best_cost();
  }
  divergence_ = Divergence();
  return std::isfinite(*cost);
}

bool MultipleShooting::SolveStartsFor(const Vector& free, double* cost) {
  std::vector<Matrix> predicted;
  for (size_t r = 0; r < records_.size(); ++r) {
    predicted.push_back(PredictStarts(r, free));
  }
  const bool found = SolveStarts(predicted, cost);
  if (!IsSingleShooting() ||
      (found && !(*cost > options_.starts.stray_cost * linearized_cost_)) ||
      std::isinf(options_.starts.stray_cost)) {
    return found;
  }
  const std::vector<Matrix> starts = starts_;
  double other_cost = 0.0;
  if (!SolveStarts(linearized_starts_, &other_cost) ||
      (found && other_cost >= *cost)) {
    starts_ = starts;
    has_columns_ = false;
    return found;
  }
  *cost = other_cost;
  return true;
}

bool MultipleShooting::Evaluate(const Vector& free, double* cost) {
  if (last_free_.size() == free.size() && free == last_free_) {
    *cost = last_cost_;
    return true;
  }
  last_free_.resize(0);
  is_linearized_ = false;
  failed_ = !PrepareDynamics(free) || !SolveStartsFor(free, cost);
  if (failed_) return false;
  last_free_ = free;
  last_cost_ = *cost;
  return true;
}

bool MultipleShooting::Linearize(const Vector& free, CondensedSystem* system) {
  if (is_linearized_ && free.size() == linearized_free_.size() &&
      free == linearized_free_) {
    *system = linearized_;
    return true;
  }
  if (!Evaluate(free, &system->cost)) return false;
  failed_ = true;
  if (!PrepareDynamics(free)) return false;
  if (!has_columns_) {
    std::vector<const Matrix*> starts;
    for (const Matrix& record : starts_) starts.push_back(&record);
    if (!sweep_.Evaluate(
            sweep_.SegmentsOf(std::vector<bool>(records_.size(), true)), starts,
            true)) {
      return false;
    }
  }
  has_columns_ = false;
  int num_segments = 0;
  for (const auto& record : records_) {
    if (!AllFinite(*record)) return false;
    if (record->HasFreeStarts()) num_segments += record->num_segments();
  }

  FreeEquations sum = sweep_.sum();
  data_curvature_ = 0.0;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (records_[r]->HasFreeStarts()) {
      data_curvature_ += records_[r]->DataCurvature() / num_segments;
    }
    if (!records_[r]->Eliminate(gap_penalty_, starts_[r], &sum)) return false;
  }
  system->gradient = sum.gradient;
  system->hessian = sum.hessian.selfadjointView<Eigen::Lower>();
  linearized_free_ = free;
  linearized_starts_ = starts_;
  linearized_cost_ = system->cost;
  for (auto& record : records_) record->linearized_cost = record->cost;
  failed_ = !system->hessian.allFinite() || !system->gradient.allFinite();
  is_linearized_ = !failed_;
  if (!is_linearized_) return false;
  linearized_ = *system;
  squares_free_ = free;
  squares_.clear();
  for (const auto& record : records_) {
    squares_.push_back(Vector::Zero(record->observation().num_channels()));
    for (int k = 0; k < record->num_segments(); ++k) {
      squares_.back() += record->result(k).squares;
    }
  }
  return true;
}

bool MultipleShooting::KeepRows(bool keep) {
  constexpr double kMostBytes = 1073741824.0;
  double bytes = 0.0;
  for (const auto& record : records_) {
    bytes += static_cast<double>(sizeof(double)) *
             record->observation().num_channels() *
             static_cast<double>(record->grid().num_samples()) *
             layout_.num_free();
  }
  keep = keep && IsSingleShooting() && bytes < kMostBytes;
  if (keep && !keeps_rows_) is_linearized_ = false;
  keeps_rows_ = keep;
  sweep_.set_keeps_rows(keep);
  if (!keep) {
    for (auto& record : records_) record->kept_rows() = SegmentRows();
  }
  return keep;
}

bool MultipleShooting::BendAlong(const Vector& step, Vector* projected) {
  // As published: small enough for a derivative, large enough for rounding.
  constexpr double kShare = 0.1;
  if (!keeps_rows_ || linearized_free_.size() != step.size()) return false;
  last_free_.resize(0);
  is_linearized_ = false;
  has_columns_ = false;
  const Vector there = linearized_free_ + kShare * step;
  if (!PrepareDynamics(there)) return false;
  std::vector<Matrix> starts;
  for (size_t r = 0; r < records_.size(); ++r) {
    starts.push_back(PredictStarts(r, there));
  }
  return sweep_.Bend(starts, step, kShare, projected);
}

std::string MultipleShooting::Failure() const {
  if (!failed_) return "";
  if (!divergence_.Happened()) return "the trajectory is not finite";
  const IdentificationRecord& record =
      problem_.records[static_cast<size_t>(divergence_.record)];
  std::ostringstream text;
  text << "the trajectory of record '" << record.name
       << "' is not finite in segment " << divergence_.segment + 1
       << " at t = " << record.excitation->time(divergence_.sample)
       << " s, state "
       << problem_.dynamics->StateNames()[static_cast<size_t>(
              std::max(0, divergence_.state))];
  return text.str();
}

double MultipleShooting::LargestGap() const {
  double largest = 0.0;
  for (size_t r = 0; r < records_.size(); ++r) {
    largest = std::max(largest, records_[r]->gaps().LargestGap(
                                    records_[r]->ends(), starts_[r]));
  }
  return largest;
}

void MultipleShooting::UpdateMultipliers() {
  for (size_t r = 0; r < records_.size(); ++r) {
    records_[r]->gaps().UpdateMultipliers(records_[r]->ends(), starts_[r]);
  }
  CostHasChanged();
}

void MultipleShooting::RescaleMultipliers(double factor) {
  for (auto& record : records_) record->gaps().RescaleMultipliers(factor);
  CostHasChanged();
}

bool MultipleShooting::RunPieces(size_t r,
                                 const std::vector<Eigen::Index>& samples,
                                 const Matrix& starts, Keep keep,
                                 const Take& take) {
  const ObservationMap nothing(*problem_.dynamics, {});
  for (size_t k = 0; k + 1 < samples.size(); ++k) {
    Trajectory piece;
    if (!FreeRun(*problem_.dynamics, prepared_, nothing, records_[r]->grid(),
                 starts.col(static_cast<Eigen::Index>(k)), samples[k],
                 samples[k + 1], &piece, keep, options_.num_threads)) {
      return false;
    }
    const bool last = k + 2 == samples.size();
    take(samples[k], samples[k + 1] - samples[k] + (last ? 1 : 0), &piece);
  }
  return true;
}

bool MultipleShooting::RunRecord(size_t r,
                                 const std::vector<Eigen::Index>& samples,
                                 const Matrix& starts, Matrix* states) {
  const bool whole = samples.size() == 2;
  if (!whole) {
    states->resize(problem_.dynamics->num_states(),
                   records_[r]->grid().num_samples());
  }
  return RunPieces(
      r, samples, starts, Keep::kAll,
      [&](Eigen::Index first, Eigen::Index count, Trajectory* piece) {
        if (whole) {
          *states = std::move(piece->states);
          return;
        }
        states->middleCols(first, count) = piece->states.leftCols(count);
      });
}

bool MultipleShooting::HasFreeStarts() const {
  return std::any_of(records_.begin(), records_.end(),
                     [](const auto& r) { return r->HasFreeStarts(); });
}

bool MultipleShooting::Trajectories(const Vector& free,
                                    std::vector<Matrix>* states) {
  if (!PrepareDynamics(free)) return false;
  states->assign(records_.size(), Matrix());
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!RunRecord(r, records_[r]->boundaries(), starts_[r], &(*states)[r])) {
      return false;
    }
  }
  return true;
}

bool MultipleShooting::Trajectories(const TrajectoryOutlines& outlines,
                                    std::vector<Matrix>* states) {
  if (!PrepareDynamics(outlines.free)) return false;
  states->assign(records_.size(), Matrix());
  for (size_t r = 0; r < records_.size(); ++r) {
    const TrajectoryOutline& outline = outlines.records[r];
    if (!RunRecord(r, outline.samples, outline.starts, &(*states)[r])) {
      return false;
    }
  }
  return true;
}

bool MultipleShooting::Outline(const Vector& free,
                               TrajectoryOutlines* outlines) {
  if (!PrepareDynamics(free)) return false;
  outlines->free = free;
  outlines->records.resize(records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    TrajectoryOutline& outline = outlines->records[r];
    outline.samples = records_[r]->boundaries();
    outline.starts = starts_[r];
    Vector squares = Vector::Zero(problem_.dynamics->num_states());
    if (!RunPieces(r, outline.samples, outline.starts, Keep::kMeanSquares,
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
        static_cast<double>(records_[r]->grid().num_samples());
  }
  return true;
}

const std::vector<Vector>* MultipleShooting::SquaresAt(
    const Vector& free) const {
  return squares_.size() == records_.size() &&
                 squares_free_.size() == free.size() && squares_free_ == free
             ? &squares_
             : nullptr;
}

bool MultipleShooting::VisitWeightedResiduals(const Vector& free,
                                              bool with_jacobian,
                                              const Visitor& visitor,
                                              int num_threads) {
  is_linearized_ = false;
  has_columns_ = false;
  if (!PrepareDynamics(free)) return false;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!sweep_.Visit(r, starts_[r], with_jacobian, num_threads, visitor)) {
      return false;
    }
  }
  return true;
}

bool MultipleShooting::IsByModes() const { return sweep_.IsByModes(); }

bool MultipleShooting::MovedResiduals(const Vector& free, const Vector& step,
                                      std::vector<Matrix>* residuals) {
  if (!PrepareDynamics(free)) return false;
  residuals->resize(records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!sweep_.MovedResiduals(r, starts_[r], step, &(*residuals)[r])) {
      return false;
    }
  }
  return true;
}

Matrix MultipleShooting::Information() const {
  Matrix information = sweep_.sum().hessian.selfadjointView<Eigen::Lower>();
  const int ns = problem_.dynamics->num_states();
  for (const auto& record : records_) {
    if (!record->HasFreeStarts()) continue;
    for (int k = 0; k < record->num_segments(); ++k) {
      // Starts go along with the parameters.
      const auto follow = record->start_sensitivity().middleRows(
          static_cast<Eigen::Index>(k) * ns, ns);
      const SegmentResult& result = record->result(k);
      const Matrix mixed = result.cross * follow;
      information += mixed + mixed.transpose() +
                     follow.transpose() * result.start_hessian * follow;
    }
  }
  return information;
}

bool MultipleShooting::AddScores(const Vector& free,
                                 const std::vector<Eigen::Index>& lengths,
                                 Matrix* products, double* count) {
  if (!PrepareDynamics(free)) return false;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!sweep_.AddScores(r, starts_[r], lengths[r], products, count)) {
      return false;
    }
  }
  return true;
}

bool MultipleShooting::WeightedResiduals(const Vector& free, bool with_jacobian,
                                         std::vector<Matrix>* residuals,
                                         std::vector<Matrix>* jacobians) {
  residuals->clear();
  if (with_jacobian) jacobians->clear();
  for (const auto& record : records_) {
    const int nc = record->observation().num_channels();
    const Eigen::Index samples = record->grid().num_samples();
    residuals->push_back(Matrix::Zero(nc, samples));
    if (!with_jacobian) continue;
    jacobians->push_back(Matrix::Zero(nc * samples, layout_.num_free()));
  }
  return VisitWeightedResiduals(
      free, with_jacobian,
      [&](size_t r, Eigen::Index first, const Matrix& part,
          const Matrix& rows) {
        (*residuals)[r].middleCols(first, part.cols()) = part;
        if (!with_jacobian) return;
        (*jacobians)[r].middleRows(first * part.rows(), part.size()) = rows;
      },
      options_.num_threads);
}

}  // namespace pinode
