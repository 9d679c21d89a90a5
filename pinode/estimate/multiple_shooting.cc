#include "pinode/estimate/multiple_shooting.h"

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
             records_) {
  for (const auto& record : records_) train_records_.push_back(record->index());
  starts_.resize(records_.size());
  sweep_.SetPoint(&prepared_, &parameters_);
}

MultipleShooting::~MultipleShooting() = default;

void MultipleShooting::SetSegments(int samples,
                                   const std::vector<Matrix>& trajectories) {
  CHECK_EQ(trajectories.size(), records_.size())
      << "one trajectory per training record";
  for (size_t r = 0; r < records_.size(); ++r) {
    starts_[r] = records_[r]->Cut(samples, trajectories[r]);
  }
  linearized_starts_ = starts_;
  linearized_free_.resize(0);
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
  const Matrix& sensitivity = records_[r]->start_sensitivity();
  if (linearized_free_.size() == free.size() &&
      sensitivity.cols() == free.size()) {
    const Vector move = sensitivity * (free - linearized_free_);
    starts +=
        Eigen::Map<const Matrix>(move.data(), starts.rows(), starts.cols());
  }
  return starts;
}

bool MultipleShooting::LooksAhead() const {
  // A linearisation of the laws takes about as long as so many columns.
  constexpr int kLinearization = 10;
  return options_.looks_ahead &&
         std::any_of(records_.begin(), records_.end(),
                     [](const auto& r) { return r->HasFreeStarts(); }) &&
         layout_.num_free() <=
             2 * (kLinearization + problem_.dynamics->num_states());
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
    has_columns_ = i == 0 && LooksAhead();
    if (!sweep_.Evaluate(tasks, trials, has_columns_)) return false;
    for (size_t r = 0; r < records_.size(); ++r) {
      if (searching[r] &&
          !searches[r].Advance(AllFinite(*records_[r]), linearized_cost_)) {
        return false;
      }
    }
  }
  *cost = 0.0;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!searches[r].found()) return false;
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
  if (is_linearized_) linearized_ = *system;
  return !failed_;
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

bool MultipleShooting::Trajectories(const Vector& free,
                                    std::vector<Matrix>* states) {
  if (!PrepareDynamics(free)) return false;
  states->clear();
  const ObservationMap nothing(*problem_.dynamics, {});
  for (size_t r = 0; r < records_.size(); ++r) {
    const ShootingRecord& record = *records_[r];
    Matrix whole;
    for (int k = 0; k < record.num_segments(); ++k) {
      Trajectory trajectory;
      const int first = record.first_sample(k);
      const int last = record.last_sample(k);
      if (!FreeRun(*problem_.dynamics, prepared_, nothing, record.grid(),
                   starts_[r].col(k), first, last, &trajectory)) {
        return false;
      }
      if (record.num_segments() == 1) {
        whole = std::move(trajectory.states);
        break;
      }
      whole.resize(problem_.dynamics->num_states(),
                   record.grid().num_samples());
      const bool final = k + 1 == record.num_segments();
      const int count = last - first + (final ? 1 : 0);
      whole.middleCols(first, count) = trajectory.states.leftCols(count);
    }
    states->push_back(std::move(whole));
  }
  return true;
}

bool MultipleShooting::VisitWeightedResiduals(const Vector& free,
                                              bool with_jacobian,
                                              const Visitor& visitor) {
  is_linearized_ = false;
  has_columns_ = false;
  if (!PrepareDynamics(free)) return false;
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!sweep_.Visit(r, starts_[r], with_jacobian, visitor)) return false;
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
    const int samples = record->grid().num_samples();
    residuals->push_back(Matrix::Zero(nc, samples));
    if (!with_jacobian) continue;
    jacobians->push_back(Matrix::Zero(static_cast<Eigen::Index>(nc) * samples,
                                      layout_.num_free()));
  }
  return VisitWeightedResiduals(
      free, with_jacobian,
      [&](size_t r, int first, const Matrix& part, const Matrix& rows) {
        (*residuals)[r].middleCols(first, part.cols()) = part;
        if (!with_jacobian) return;
        (*jacobians)[r].middleRows(first * part.rows(), part.size()) = rows;
      });
}

}  // namespace pinode
