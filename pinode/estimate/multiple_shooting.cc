#include "pinode/estimate/multiple_shooting.h"

#include <algorithm>
#include <array>
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
        works{Work(problem, layout, options), Work(problem, layout, options)},
        sum{Matrix::Zero(layout.num_free(), layout.num_free()),
            Vector::Zero(layout.num_free())} {}

  struct Work {
    Work(const IdentificationProblem& problem, const ParameterLayout& layout,
         const Options& options)
        : rows(problem, layout, options.loss, options.loss_scale) {}
    SegmentTangents tangents;
    ResidualRows rows;
  };
  // Those with derivatives are large, and would be given back and asked for
  // again where costs alone lie between them.
  Work& work(bool with_parameters) { return works[with_parameters ? 1 : 0]; }

  SegmentPropagator propagator;
  std::array<Work, 2> works;
  FreeEquations sum;  // over the thread's segments
};

MultipleShooting::MultipleShooting(const IdentificationProblem& problem,
                                   const ParameterLayout& layout,
                                   const Options& options)
    : problem_(problem),
      layout_(layout),
      options_(options),
      parallel_(*problem.dynamics, options.derivatives,
                std::max(1, options.num_threads)) {
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].role != IdentificationRecord::Role::kTrain) continue;
    train_records_.push_back(static_cast<int>(r));
    records_.push_back(std::make_unique<ShootingRecord>(
        problem, static_cast<int>(r), options.starts.prior_precision));
    const ShootingRecord& record = *records_.back();
    linear_.push_back(options.derivatives == DerivativeMethod::kTangents
                          ? LinearRecord::Create(
                                problem, layout, record.data(), record.grid(),
                                record.observation(), options.loss)
                          : nullptr);
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

SegmentColumns MultipleShooting::ColumnsOf(const ShootingRecord& record,
                                           bool with_parameters) const {
  // A start that is known needs no derivatives.
  if (record.HasFreeStarts()) {
    return with_parameters ? SegmentColumns::kAll : SegmentColumns::kStart;
  }
  return with_parameters ? SegmentColumns::kParameters : SegmentColumns::kNone;
}

bool MultipleShooting::EvaluateSegment(ShootingRecord* record, int segment,
                                       const Matrix& starts,
                                       bool with_parameters, bool alone,
                                       Thread* thread) {
  const int ns = problem_.dynamics->num_states();
  const int first = record->first_sample(segment);
  const int last = record->last_sample(segment);
  const bool with_start = record->HasFreeStarts();
  const SegmentColumns columns = ColumnsOf(*record, with_parameters);
  Thread::Work& work = thread->work(with_parameters);
  const SegmentTangents& tangents = work.tangents;
  SegmentResult& result = record->result(segment);
  const bool is_last = segment + 1 == record->num_segments();
  const auto propagate = [&](auto* propagator) {
    return propagator->Propagate(prepared_, record->observation(),
                                 record->grid(), starts.col(segment), first,
                                 last, is_last, columns, &work.tangents);
  };
  result.ok =
      alone && parallel_.IsWorthwhile(record->grid(), first, last, columns)
          ? propagate(&parallel_)
          : propagate(&thread->propagator);
  if (!result.ok) {
    result.failed_sample = tangents.failed_sample;
    result.failed_state = tangents.failed_state;
    return false;
  }
  work.rows.Compute(record->data(), record->sigmas(), parameters_, first,
                    record->num_segments() == 1, columns, tangents);
  const Vector& residuals = work.rows.residuals();
  result.cost = work.rows.cost();
  record->ends().col(segment) = tangents.end_state;
  const auto by_parameters =
      work.rows.jacobian().rightCols(with_parameters ? layout_.num_free() : 0);
  if (with_start) {
    const auto by_start = work.rows.jacobian().leftCols(ns);
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
  // Records that are linear share the threads where there are enough of them,
  // and each has them all to itself where there are not.
  const int num_threads = static_cast<int>(threads_.size());
  const auto whole =
      std::count_if(tasks.begin(), tasks.end(), [this](const Task& task) {
        return IsWholeAndLinear(static_cast<size_t>(task.first));
      });
  const bool side_by_side = whole >= num_threads;
  std::vector<char> done(tasks.size(), 0);
  ParallelFor(static_cast<int>(tasks.size()), side_by_side ? num_threads : 1,
              [&](int t, int thread) {
                const size_t r =
                    static_cast<size_t>(tasks[static_cast<size_t>(t)].first);
                done[static_cast<size_t>(t)] =
                    IsWholeAndLinear(r) &&
                    EvaluateWhole(r, *starts[r], with_parameters,
                                  side_by_side ? 1 : num_threads,
                                  &threads_[static_cast<size_t>(thread)]->sum);
              });
  // Fewer than there are threads go one after the other, where each is long
  // enough for all threads.
  std::vector<size_t> left;
  for (size_t t = 0; t < tasks.size(); ++t) {
    if (done[t] == 0) left.push_back(t);
  }
  const bool alone =
      left.size() < threads_.size() &&
      std::all_of(left.begin(), left.end(), [&](size_t t) {
        const ShootingRecord& of =
            *records_[static_cast<size_t>(tasks[t].first)];
        return parallel_.IsWorthwhile(
            of.grid(), of.first_sample(tasks[t].second),
            of.last_sample(tasks[t].second), ColumnsOf(of, with_parameters));
      });
  ParallelFor(static_cast<int>(tasks.size()), alone ? 1 : num_threads,
              [&](int t, int thread) {
                if (done[static_cast<size_t>(t)] != 0) return;
                const auto& [record, segment] = tasks[static_cast<size_t>(t)];
                const size_t r = static_cast<size_t>(record);
                EvaluateSegment(records_[r].get(), segment, *starts[r],
                                with_parameters, alone,
                                threads_[static_cast<size_t>(thread)].get());
              });
}

bool MultipleShooting::IsWholeAndLinear(size_t record) const {
  return linear_[record] != nullptr && records_[record]->num_segments() == 1;
}

LinearRecord::Point MultipleShooting::PointOf(size_t record,
                                              const Matrix& starts,
                                              SegmentColumns columns) const {
  return {&prepared_, &parameters_, &records_[record]->sigmas(), starts.col(0),
          columns};
}

bool MultipleShooting::EvaluateWhole(size_t r, const Matrix& starts,
                                     bool with_parameters, int num_threads,
                                     FreeEquations* sum) {
  ShootingRecord& record = *records_[r];
  const SegmentColumns columns = ColumnsOf(record, with_parameters);
  LinearRecord::Equations equations;
  if (!linear_[r]->Evaluate(PointOf(r, starts, columns), num_threads,
                            &equations)) {
    return false;
  }
  const int ns = problem_.dynamics->num_states();
  const int by_start = HasStart(columns) ? ns : 0;
  const int nf = with_parameters ? layout_.num_free() : 0;
  SegmentResult& result = record.result(0);
  result.ok = true;
  result.cost = equations.cost;
  record.ends().col(0) = equations.end_state;
  result.start_hessian = Matrix::Zero(ns, ns);
  result.start_gradient = Vector::Zero(ns);
  if (by_start > 0) {
    result.start_hessian = equations.hessian.topLeftCorner(ns, ns);
    result.start_gradient = equations.gradient.head(ns);
    result.cross = equations.hessian.topRightCorner(ns, nf);
  }
  if (!with_parameters) return true;
  sum->hessian += equations.hessian.bottomRightCorner(nf, nf);
  sum->gradient += equations.gradient.tail(nf);
  return true;
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

void MultipleShooting::ClearSums() {
  for (auto& thread : threads_) {
    thread->sum.hessian.setZero();
    thread->sum.gradient.setZero();
  }
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
    const std::vector<Task> tasks = SegmentsOf(searching);
    if (tasks.empty()) break;
    has_columns_ = i == 0 && LooksAhead();
    if (has_columns_) ClearSums();
    EvaluateSegments(tasks, trials, has_columns_);
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
    ClearSums();
    std::vector<const Matrix*> starts;
    for (const Matrix& record : starts_) starts.push_back(&record);
    EvaluateSegments(SegmentsOf(std::vector<bool>(records_.size(), true)),
                     starts, true);
  }
  has_columns_ = false;
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
    if (IsWholeAndLinear(r) && VisitWhole(r, with_jacobian, visitor)) continue;
    for (int k = 0; k < records_[r]->num_segments(); ++k) {
      if (!VisitSegment(r, k, with_jacobian, visitor)) return false;
    }
  }
  return true;
}

bool MultipleShooting::VisitWhole(size_t r, bool with_jacobian,
                                  const Visitor& visitor) {
  const ShootingRecord& record = *records_[r];
  const SegmentColumns columns =
      with_jacobian ? ColumnsOf(record, true) : SegmentColumns::kNone;
  const int nf = layout_.num_free();
  return linear_[r]->Visit(
      PointOf(r, starts_[r], columns),
      [&](int first, const Matrix& residuals, const Matrix& rows) {
        if (!HasStart(columns)) {
          visitor(r, first, residuals,
                  with_jacobian ? rows : Matrix(rows.rows(), 0));
          return;
        }
        Matrix jacobian = rows.rightCols(nf);
        jacobian.noalias() +=
            rows.leftCols(rows.cols() - nf) * record.start_sensitivity();
        visitor(r, first, residuals, jacobian);
      });
}

bool MultipleShooting::VisitSegment(size_t r, int segment, bool with_jacobian,
                                    const Visitor& visitor) {
  ShootingRecord& record = *records_[r];
  Thread& thread = *threads_[0];
  if (!EvaluateSegment(&record, segment, starts_[r], with_jacobian,
                       /*alone=*/true, &thread)) {
    return false;
  }
  const int ns = problem_.dynamics->num_states();
  const int nc = record.observation().num_channels();
  const int nf = layout_.num_free();
  const ResidualRows& own = thread.work(with_jacobian).rows;
  const Vector& values = own.residuals();
  const Matrix& rows = own.jacobian();
  Matrix jacobian(rows.rows(), 0);
  if (with_jacobian) {
    jacobian = rows.rightCols(nf);
    if (record.HasFreeStarts()) {
      jacobian.noalias() +=
          rows.leftCols(ns) *
          record.start_sensitivity().middleRows(segment * ns, ns);
    }
  }
  visitor(r, record.first_sample(segment),
          Eigen::Map<const Matrix>(values.data(), nc, values.size() / nc),
          jacobian);
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
