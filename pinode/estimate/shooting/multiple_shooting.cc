#include "pinode/estimate/shooting/multiple_shooting.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>

#include "pinode/base/logging.h"

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

// Returns true if derivatives by parameters cost about as much as the starts.
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
  sweep_.SetPoint(&point_);
}

void MultipleShooting::Cut(Eigen::Index samples, const StateAt& state_at) {
  for (size_t r = 0; r < records_.size(); ++r) {
    starts_[r] = records_[r]->Cut(
        samples, [&](Eigen::Index sample) { return state_at(r, sample); });
  }
  state_.SetCut(starts_);
  look_ahead_.Forget();
}

void MultipleShooting::SetWholeRecords(const std::vector<Vector>& starts) {
  CHECK_EQ(starts.size(), records_.size()) << "one start per training record";
  Cut(0, [&starts](size_t r, Eigen::Index) { return starts[r]; });
}

void MultipleShooting::CostHasChanged() {
  state_.SetCostChanged();
  look_ahead_.Forget();
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

void MultipleShooting::SetGapPenalty(double mu) {
  CHECK_GT(mu, 0.0) << "the gaps' penalty must be positive";
  const double factor = gap_penalty_ / mu;
  gap_penalty_ = mu;
  for (auto& record : records_) record->gaps().RescaleMultipliers(factor);
  CostHasChanged();
}

void MultipleShooting::UpdateMultipliers() {
  for (size_t r = 0; r < records_.size(); ++r) {
    records_[r]->gaps().UpdateMultipliers(records_[r]->results().ends,
                                          starts_[r]);
  }
  CostHasChanged();
}

double MultipleShooting::LargestGap() const {
  double largest = 0.0;
  for (size_t r = 0; r < records_.size(); ++r) {
    largest = std::max(largest, record(r).gaps().LargestGap(
                                    record(r).results().ends, starts_[r]));
  }
  return largest;
}

bool MultipleShooting::PrepareAt(const Vector& free) {
  return sweep_.PreparePoint(free, &point_);
}

bool MultipleShooting::AllFinite(const ShootingRecord& record,
                                 Divergence* divergence) {
  for (int k = 0; k < record.num_segments(); ++k) {
    const SegmentResult& result = record.results().of(k);
    if (result.ok) continue;
    *divergence = {record.index(), k, result.failed_sample,
                   result.failed_state};
    return false;
  }
  return true;
}

bool MultipleShooting::Fail(const Divergence& divergence) {
  state_.SetFailed(divergence);
  return false;
}

Matrix MultipleShooting::PredictStarts(size_t r, const Vector& free) const {
  const ShootingLinearization& from = state_.linearization();
  Matrix starts = from.starts[r];
  const auto sensitivity = record(r).equations().start_sensitivity();
  if (state_.HasTangent(free.size()) && sensitivity.cols() == free.size()) {
    const Vector move = sensitivity * (free - from.free);
    starts +=
        Eigen::Map<const Matrix>(move.data(), starts.rows(), starts.cols());
  }
  return starts;
}

bool MultipleShooting::SolveStarts(const std::vector<Matrix>& from,
                                   StartsFound* found) {
  const ShootingLinearization& linearization = state_.linearization();
  std::vector<StartSearch> searches;
  for (size_t r = 0; r < records_.size(); ++r) {
    searches.emplace_back(
        options_.starts, &records_[r]->equations(), gap_penalty_, from[r],
        linearization.free.size() == 0 ? nullptr : &linearization.starts[r]);
  }
  *found = StartsFound();
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
    found->with_derivatives =
        options_.looks_ahead && !sweep_.keeps_rows() &&
        look_ahead_.GoesAlong(i, ProgressOf(searches), linearization.cost);
    if (!sweep_.Evaluate(tasks, trials, found->with_derivatives)) return false;
    for (size_t r = 0; r < records_.size(); ++r) {
      if (searching[r] &&
          !searches[r].Advance(AllFinite(*records_[r], &found->divergence),
                               linearization.cost)) {
        return false;
      }
    }
    look_ahead_.Learn(i + 1, ProgressOf(searches));
  }
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!searches[r].found()) return false;
    found->with_derivatives =
        found->with_derivatives && searches[r].progress().is_at_trial;
    starts_[r] = searches[r].best();
    records_[r]->equations().cost = searches[r].best_cost();
    found->cost += searches[r].best_cost();
  }
  found->divergence = Divergence();
  return std::isfinite(found->cost);
}

bool MultipleShooting::SolveStartsFor(const Vector& free, StartsFound* found) {
  std::vector<Matrix> predicted;
  for (size_t r = 0; r < records_.size(); ++r) {
    predicted.push_back(PredictStarts(r, free));
  }
  const bool ok = SolveStarts(predicted, found);
  const ShootingLinearization& linearization = state_.linearization();
  const double stray_cost = options_.starts.stray_cost;
  if (!IsSingleShooting(*this) ||
      (ok && !(found->cost > stray_cost * linearization.cost)) ||
      std::isinf(stray_cost)) {
    return ok;
  }
  const std::vector<Matrix> starts = starts_;
  StartsFound other;
  if (!SolveStarts(linearization.starts, &other) ||
      (ok && other.cost >= found->cost)) {
    starts_ = starts;
    found->with_derivatives = false;
    found->divergence = other.divergence;
    return ok;
  }
  *found = other;
  return true;
}

bool MultipleShooting::Evaluate(const Vector& free, double* cost) {
  if (state_.HasTrajectoryAt(free)) {
    *cost = state_.cost();
    return true;
  }
  state_.SetNothing();
  StartsFound found;
  if (!PrepareAt(free) || !SolveStartsFor(free, &found)) {
    return Fail(found.divergence);
  }
  *cost = found.cost;
  state_.SetTrajectory(free, found.cost, found.with_derivatives);
  return true;
}

bool MultipleShooting::FindDerivatives() {
  std::vector<const Matrix*> starts;
  for (const Matrix& record : starts_) starts.push_back(&record);
  return sweep_.Evaluate(
      sweep_.SegmentsOf(std::vector<bool>(records_.size(), true)), starts,
      true);
}

bool MultipleShooting::Linearize(const Vector& free, CondensedSystem* system) {
  if (state_.HasSensitivitiesAt(free)) {
    *system = state_.linearization().system;
    return true;
  }
  if (!Evaluate(free, &system->cost)) return false;
  if (!PrepareAt(free)) return Fail(Divergence());
  const bool found = state_.HasDerivatives() || FindDerivatives();
  // Eliminating the starts uses the segments' results up.
  state_.DropDerivatives();
  if (!found) return Fail(Divergence());
  for (const auto& record : records_) {
    Divergence divergence;
    if (!AllFinite(*record, &divergence)) return Fail(divergence);
  }
  return Condense(free, system->cost, system);
}

bool MultipleShooting::Condense(const Vector& free, double cost,
                                CondensedSystem* system) {
  int num_segments = 0;
  for (const auto& record : records_) {
    if (record->HasFreeStarts()) num_segments += record->num_segments();
  }
  ShootingLinearization result;
  FreeEquations sum = sweep_.sum();
  std::vector<Vector> squares;
  for (size_t r = 0; r < records_.size(); ++r) {
    StartEquations& equations = records_[r]->equations();
    if (records_[r]->HasFreeStarts()) {
      result.data_curvature += equations.DataCurvature() / num_segments;
    }
    if (!equations.Eliminate(gap_penalty_, starts_[r], &sum)) {
      return Fail(Divergence());
    }
    Vector& of_channels = squares.emplace_back(
        Vector::Zero(records_[r]->observation().num_channels()));
    for (int k = 0; k < records_[r]->num_segments(); ++k) {
      of_channels += records_[r]->results().of(k).squares;
    }
  }
  result.squares = std::move(squares);
  for (auto& record : records_) {
    record->equations().linearized_cost = record->equations().cost;
  }
  system->gradient = sum.gradient;
  system->hessian = sum.hessian.selfadjointView<Eigen::Lower>();
  result.free = free;
  result.starts = starts_;
  result.cost = cost;
  result.system = *system;
  state_.SetLinearization(std::move(result));
  return state_.HasSensitivitiesAt(free);
}

std::string MultipleShooting::Failure() const {
  if (!state_.HasFailed()) return "";
  const Divergence& divergence = state_.divergence();
  if (!divergence.Happened()) return "the trajectory is not finite";
  const IdentificationRecord& record =
      problem_.records[static_cast<size_t>(divergence.record)];
  std::ostringstream text;
  text << "the trajectory of record '" << record.name
       << "' is not finite in segment " << divergence.segment + 1
       << " at t = " << record.excitation->time(divergence.sample)
       << " s, state "
       << problem_.dynamics->StateNames()[static_cast<size_t>(
              std::max(0, divergence.state))];
  return text.str();
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
  keep = keep && IsSingleShooting(*this) && bytes < kMostBytes;
  if (keep && !sweep_.keeps_rows()) state_.DropDerivatives();
  sweep_.set_keeps_rows(keep);
  if (!keep) {
    for (auto& record : records_) record->results().kept_rows = SegmentRows();
  }
  return keep;
}

bool MultipleShooting::BendAlong(const Vector& step, Vector* projected) {
  // As published: small enough for a derivative, large enough for rounding.
  constexpr double kShare = 0.1;
  if (!sweep_.keeps_rows() || !state_.HasTangent(step.size())) return false;
  state_.SetNothing();
  const Vector there = state_.linearization().free + kShare * step;
  if (!PrepareAt(there)) return false;
  std::vector<Matrix> starts;
  for (size_t r = 0; r < records_.size(); ++r) {
    starts.push_back(PredictStarts(r, there));
  }
  return sweep_.Bend(starts, step, kShare, projected);
}

bool MultipleShooting::VisitWeightedResiduals(const Vector& free,
                                              bool with_jacobian,
                                              const Visitor& visitor,
                                              int num_threads) {
  // Segments' results are overwritten.
  state_.DropDerivatives();
  if (!PrepareAt(free)) return false;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!sweep_.Visit(r, starts_[r], with_jacobian, num_threads, visitor)) {
      return false;
    }
  }
  return true;
}

void SetSegments(Eigen::Index samples, const std::vector<Matrix>& trajectories,
                 MultipleShooting* shooting) {
  CHECK_EQ(trajectories.size(), shooting->train_records().size())
      << "one trajectory per training record";
  for (size_t r = 0; r < trajectories.size(); ++r) {
    CHECK_EQ(trajectories[r].cols(), shooting->record(r).grid().num_samples());
    CHECK_EQ(trajectories[r].rows(),
             shooting->sweep().problem().dynamics->num_states());
  }
  shooting->Cut(samples, [&trajectories](size_t r, Eigen::Index sample) {
    return Vector(trajectories[r].col(sample));
  });
}

void SetSegmentsAtRest(Eigen::Index samples, MultipleShooting* shooting) {
  const int num_states = shooting->sweep().problem().dynamics->num_states();
  shooting->Cut(samples, [num_states](size_t, Eigen::Index) {
    return Vector(Vector::Zero(num_states));
  });
}

bool IsSingleShooting(const MultipleShooting& shooting) {
  for (size_t r = 0; r < shooting.train_records().size(); ++r) {
    if (shooting.record(r).num_segments() != 1) return false;
  }
  return true;
}

bool HasFreeStarts(const MultipleShooting& shooting) {
  for (size_t r = 0; r < shooting.train_records().size(); ++r) {
    if (shooting.record(r).HasFreeStarts()) return true;
  }
  return false;
}

}  // namespace pinode
