#include "pinode/estimate/multiple_shooting.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"
#include "pinode/estimate/residual_rows.h"
#include "pinode/integrate/free_run.h"

namespace pinode {

struct MultipleShooting::Thread {
  Thread(const IdentificationProblem& problem, const ParameterLayout& layout,
         const Options& options)
      : propagator(*problem.dynamics, options.derivatives),
        rows(problem, layout, options.loss, options.loss_scale),
        sum{Matrix::Zero(layout.num_free(), layout.num_free()),
            Vector::Zero(layout.num_free())} {}
  SegmentPropagator propagator;
  SegmentTangents tangents;
  ResidualRows rows;
  FreeEquations sum;  // over the thread's segments
};

MultipleShooting::MultipleShooting(const IdentificationProblem& problem,
                                   const ParameterLayout& layout,
                                   const Options& options)
    : problem_(problem), layout_(layout), options_(options) {
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].role != IdentificationRecord::Role::kTrain) continue;
    train_records_.push_back(static_cast<int>(r));
    records_.push_back(std::make_unique<ShootingRecord>(
        problem, static_cast<int>(r), options.starts.prior_precision));
  }
  starts_.resize(records_.size());
  for (int t = 0; t < std::max(1, options.num_threads); ++t) {
    threads_.push_back(std::make_unique<Thread>(problem, layout, options));
  }
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

bool MultipleShooting::EvaluateSegment(ShootingRecord* record, int segment,
                                       const Matrix& starts,
                                       bool with_parameters,
                                       Thread* thread) const {
  const int ns = problem_.dynamics->num_states();
  const int first = record->first_sample(segment);
  // A start that is known needs no derivatives.
  const bool with_start = record->HasFreeStarts();
  const SegmentColumns columns =
      with_start
          ? (with_parameters ? SegmentColumns::kAll : SegmentColumns::kStart)
          : (with_parameters ? SegmentColumns::kParameters
                             : SegmentColumns::kNone);
  const SegmentTangents& tangents = thread->tangents;
  SegmentResult& result = record->result(segment);
  result.ok = thread->propagator.Propagate(
      prepared_, record->observation(), record->grid(), starts.col(segment),
      first, record->last_sample(segment),
      segment + 1 == record->num_segments(), columns, &thread->tangents);
  if (!result.ok) {
    result.failed_sample = tangents.failed_sample;
    result.failed_state = tangents.failed_state;
    return false;
  }
  thread->rows.Compute(record->data(), record->sigmas(), parameters_, first,
                       record->num_segments() == 1, columns, tangents);
  const Vector& residuals = thread->rows.residuals();
  result.cost = thread->rows.cost();
  record->ends().col(segment) = tangents.end_state;
  const auto by_parameters = thread->rows.jacobian().rightCols(
      with_parameters ? layout_.num_free() : 0);
  if (with_start) {
    const auto by_start = thread->rows.jacobian().leftCols(ns);
    result.start_hessian.noalias() = by_start.transpose() * by_start;
    result.start_gradient.noalias() = by_start.transpose() * residuals;
    if (with_parameters) {
      result.cross.noalias() = by_start.transpose() * by_parameters;
    }
    AddSensorColumns(layout_, ns, columns, tangents.end_sensitivity,
                     &result.end_sensitivity);
  } else {
    result.start_hessian = Matrix::Zero(ns, ns);
    result.start_gradient = Vector::Zero(ns);
  }
  if (!with_parameters) return true;

  thread->sum.hessian.selfadjointView<Eigen::Lower>().rankUpdate(
      by_parameters.transpose());
  thread->sum.gradient.noalias() += by_parameters.transpose() * residuals;
  return true;
}

std::vector<MultipleShooting::Task> MultipleShooting::SegmentsOf(
    const std::vector<bool>& wanted) const {
  std::vector<Task> tasks;
  for (size_t r = 0; r < records_.size(); ++r) {
    for (int k = 0; wanted[r] && k < records_[r]->num_segments(); ++k) {
      tasks.emplace_back(static_cast<int>(r), k);
    }
  }
  return tasks;
}

void MultipleShooting::EvaluateSegments(
    const std::vector<Task>& tasks, const std::vector<const Matrix*>& starts,
    bool with_parameters) {
  const int columns = problem_.dynamics->num_states() +
                      (with_parameters ? layout_.num_free() : 0);
  for (const auto& [record, segment] : tasks) {
    const ShootingRecord& of = *records_[static_cast<size_t>(record)];
    work_ += static_cast<int64_t>(columns) *
             (of.last_sample(segment) - of.first_sample(segment));
  }
  ParallelFor(static_cast<int>(tasks.size()), static_cast<int>(threads_.size()),
              [&](int t, int thread) {
                const auto& [record, segment] = tasks[static_cast<size_t>(t)];
                const size_t r = static_cast<size_t>(record);
                EvaluateSegment(records_[r].get(), segment, *starts[r],
                                with_parameters,
                                threads_[static_cast<size_t>(thread)].get());
              });
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

bool MultipleShooting::SolveStarts(const Vector& free, double* cost) {
  std::vector<StartSearch> searches;
  for (size_t r = 0; r < records_.size(); ++r) {
    searches.emplace_back(
        options_.starts, records_[r].get(), gap_penalty_,
        PredictStarts(r, free),
        linearized_free_.size() == 0 ? nullptr : &linearized_starts_[r]);
  }
  divergence_ = Divergence();
  for (int i = 0; i < options_.starts.max_iterations; ++i) {
    std::vector<bool> searching;
    std::vector<const Matrix*> trials;
    for (const StartSearch& search : searches) {
      searching.push_back(!search.done());
      trials.push_back(&search.trial());
    }
    const std::vector<Task> tasks = SegmentsOf(searching);
    if (tasks.empty()) break;
    EvaluateSegments(tasks, trials, false);
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

bool MultipleShooting::Evaluate(const Vector& free, double* cost) {
  if (last_free_.size() == free.size() && free == last_free_) {
    *cost = last_cost_;
    return true;
  }
  last_free_.resize(0);
  is_linearized_ = false;
  failed_ = !PrepareDynamics(free) || !SolveStarts(free, cost);
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
  for (auto& thread : threads_) {
    thread->sum.hessian.setZero();
    thread->sum.gradient.setZero();
  }
  std::vector<const Matrix*> starts;
  for (const Matrix& record : starts_) starts.push_back(&record);
  EvaluateSegments(SegmentsOf(std::vector<bool>(records_.size(), true)), starts,
                   true);
  int num_segments = 0;
  for (const auto& record : records_) {
    if (!AllFinite(*record)) return false;
    if (record->HasFreeStarts()) num_segments += record->num_segments();
  }

  FreeEquations sum = threads_[0]->sum;
  for (size_t t = 1; t < threads_.size(); ++t) {
    sum.hessian += threads_[t]->sum.hessian;
    sum.gradient += threads_[t]->sum.gradient;
  }
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
  for (size_t r = 0; r < records_.size(); ++r) {
    const ShootingRecord& record = *records_[r];
    Matrix whole(problem_.dynamics->num_states(), record.grid().num_samples());
    for (int k = 0; k < record.num_segments(); ++k) {
      Trajectory trajectory;
      const int first = record.first_sample(k);
      const int last = record.last_sample(k);
      if (!FreeRun(*problem_.dynamics, prepared_, record.observation(),
                   record.grid(), starts_[r].col(k), first, last,
                   &trajectory)) {
        return false;
      }
      const bool final = k + 1 == record.num_segments();
      const int count = last - first + (final ? 1 : 0);
      whole.middleCols(first, count) = trajectory.states.leftCols(count);
    }
    states->push_back(std::move(whole));
  }
  return true;
}

bool MultipleShooting::WeightedResiduals(const Vector& free, bool with_jacobian,
                                         std::vector<Matrix>* residuals,
                                         std::vector<Matrix>* jacobians) {
  is_linearized_ = false;
  if (!PrepareDynamics(free)) return false;
  const int ns = problem_.dynamics->num_states();
  const int nf = layout_.num_free();
  residuals->clear();
  if (with_jacobian) jacobians->clear();
  Thread& thread = *threads_[0];
  for (size_t r = 0; r < records_.size(); ++r) {
    ShootingRecord& record = *records_[r];
    const int nc = record.observation().num_channels();
    const int samples = record.grid().num_samples();
    Matrix residual(nc, samples);
    Matrix jacobian(with_jacobian ? nc * samples : 0, nf);
    for (int k = 0; k < record.num_segments(); ++k) {
      if (!EvaluateSegment(&record, k, starts_[r], with_jacobian, &thread)) {
        return false;
      }
      const Vector& values = thread.rows.residuals();
      const int first = record.first_sample(k);
      const int count = static_cast<int>(values.size()) / nc;
      residual.middleCols(first, count) =
          Eigen::Map<const Matrix>(values.data(), nc, count);
      if (!with_jacobian) continue;
      const Matrix& rows = thread.rows.jacobian();
      jacobian.middleRows(first * nc, count * nc) = rows.rightCols(nf);
      if (record.HasFreeStarts()) {
        jacobian.middleRows(first * nc, count * nc).noalias() +=
            rows.leftCols(ns) *
            record.start_sensitivity().middleRows(k * ns, ns);
      }
    }
    residuals->push_back(std::move(residual));
    if (with_jacobian) jacobians->push_back(std::move(jacobian));
  }
  return true;
}

}  // namespace pinode
