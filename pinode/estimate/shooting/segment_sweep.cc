#include "pinode/estimate/shooting/segment_sweep.h"

#include <algorithm>
#include <array>
#include <string>

#include "pinode/base/parallel_for.h"
#include "pinode/estimate/shooting/residual_rows.h"
#include "pinode/estimate/shooting/segment_exchange.h"

namespace pinode {

struct SegmentSweep::Thread {
  Thread(const IdentificationProblem& problem, const ParameterLayout& layout,
         const Options& options)
      : propagator(*problem.dynamics, options.derivatives),
        works{Work(layout, options), Work(layout, options)} {}

  struct Work {
    Work(const ParameterLayout& layout, const Options& options)
        : rows(layout, options.loss, options.loss_scale) {}
    SegmentTangents tangents;
    ResidualRows rows;
  };
  // Those with derivatives are large, and would be given back and asked for
  // again where costs alone lie between them.
  Work& work(bool with_parameters) { return works[with_parameters ? 1 : 0]; }

  SegmentPropagator propagator;
  std::array<Work, 2> works;
};

SegmentSweep::SegmentSweep(const IdentificationProblem& problem,
                           const ParameterLayout& layout,
                           const Options& options, const Records& records)
    : problem_(problem),
      layout_(layout),
      options_(options),
      records_(records),
      communicator_(CommunicatorOrSingle(options.communicator)),
      parallel_(*problem.dynamics, options.derivatives,
                std::max(1, options.num_threads)),
      sums_(layout.num_free(), problem.dynamics->num_states(),
            options.num_threads, &communicator_) {
  for (const auto& record : records_) {
    linear_.push_back(options.derivatives == DerivativeMethod::kTangents
                          ? LinearRecord::Create(
                                problem, layout, record->data(), record->grid(),
                                record->observation(), options.loss)
                          : nullptr);
  }
  for (int t = 0; t < std::max(1, options.num_threads); ++t) {
    threads_.push_back(std::make_unique<Thread>(problem, layout, options));
  }
}

SegmentSweep::~SegmentSweep() = default;

SegmentColumns SegmentSweep::ColumnsOf(const ShootingRecord& record,
                                       bool with_parameters) const {
  // A start that is known needs no derivatives.
  if (record.HasFreeStarts()) {
    return with_parameters ? SegmentColumns::kAll : SegmentColumns::kStart;
  }
  return with_parameters ? SegmentColumns::kParameters : SegmentColumns::kNone;
}

bool SegmentSweep::PreparePoint(const Vector& free,
                                ShootingPoint* point) const {
  point->parameters = layout_.InitialValues();
  layout_.SetFree(free, &point->parameters);
  std::string error;
  return point->parameters.allFinite() &&
         problem_.dynamics->Prepare(
             point->parameters.head(layout_.num_dynamics()), &point->prepared,
             &error);
}

std::vector<SegmentSweep::Task> SegmentSweep::SegmentsOf(
    const std::vector<bool>& wanted) const {
  std::vector<Task> tasks;
  for (size_t r = 0; r < records_.size(); ++r) {
    for (int k = 0; wanted[r] && k < records_[r]->num_segments(); ++k) {
      tasks.emplace_back(static_cast<int>(r), k);
    }
  }
  return tasks;
}

bool SegmentSweep::IsWholeAndLinear(size_t record) const {
  return linear_[record] != nullptr && records_[record]->num_segments() == 1;
}

LinearRecord::Point SegmentSweep::PointOf(const ShootingPoint& point,
                                          size_t record, const Matrix& starts,
                                          SegmentColumns columns) const {
  return {&point.prepared, &point.parameters, &records_[record]->sigmas(),
          starts.col(0), columns};
}

bool SegmentSweep::EvaluateWhole(size_t r, const Matrix& starts,
                                 bool with_parameters, int num_threads,
                                 bool together, Matrix* sum) {
  ShootingRecord& record = *records_[r];
  const SegmentColumns columns = ColumnsOf(record, with_parameters);
  LinearRecord::Equations equations;
  if (!linear_[r]->Evaluate(PointOf(*point_, r, starts, columns), num_threads,
                            together ? options_.communicator : nullptr,
                            &equations)) {
    return false;
  }
  const int ns = problem_.dynamics->num_states();
  const int by_start = HasStart(columns) ? ns : 0;
  const int nf = with_parameters ? layout_.num_free() : 0;
  SegmentResult& result = record.results().of(0);
  result.ok = true;
  result.cost = equations.cost;
  result.squares = equations.squares;
  record.results().ends.col(0) = equations.end_state;
  result.start_hessian = Matrix::Zero(ns, ns);
  result.start_gradient = Vector::Zero(ns);
  if (by_start > 0) {
    result.start_hessian = equations.hessian.topLeftCorner(ns, ns);
    result.start_gradient = equations.gradient.head(ns);
    result.cross = equations.hessian.bottomLeftCorner(nf, ns);
  }
  // What all have found together is added up once.
  if (!with_parameters || (together && communicator_.rank() > 0)) return true;
  const Eigen::Index last = sum->rows() - 1;
  sum->block(last - nf, last - nf, nf, nf) +=
      equations.hessian.bottomRightCorner(nf, nf);
  sum->row(last).segment(last - nf, nf) +=
      equations.gradient.tail(nf).transpose();
  return true;
}

bool SegmentSweep::EvaluateSegment(size_t r, int segment, const Matrix& starts,
                                   bool with_parameters, bool alone,
                                   Thread* thread, Matrix* sum) {
  ShootingRecord* record = records_[r].get();
  const int ns = problem_.dynamics->num_states();
  const Eigen::Index first = record->first_sample(segment);
  const Eigen::Index last = record->last_sample(segment);
  const bool with_start = record->HasFreeStarts();
  const SegmentColumns columns = ColumnsOf(*record, with_parameters);
  Thread::Work& work = thread->work(with_parameters);
  SegmentTangents& tangents = work.tangents;
  SegmentResult& result = record->results().of(segment);
  const bool is_last = segment + 1 == record->num_segments();
  const bool is_whole = record->num_segments() == 1;
  work.rows.Prepare(record->data(), record->sigmas(), is_whole, ns, columns,
                    &tangents);
  const auto propagate = [&](auto* propagator) {
    return propagator->Propagate(point_->prepared, record->observation(),
                                 record->grid(), starts.col(segment), first,
                                 last, is_last, columns, &tangents);
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
  work.rows.Compute(record->data(), record->sigmas(), point_->parameters, first,
                    is_whole, columns, &tangents);
  const SegmentRows& rows = work.rows.rows();
  const auto residuals = rows.residuals();
  result.cost = work.rows.cost();
  const Eigen::Index channels = record->sigmas().size();
  result.squares = Eigen::Map<const Matrix>(residuals.data(), channels,
                                            residuals.size() / channels)
                       .rowwise()
                       .squaredNorm()
                       .cwiseProduct(record->sigmas().cwiseAbs2());
  record->results().ends.col(segment) = tangents.end_state;
  const int nf = with_parameters ? layout_.num_free() : 0;
  if (with_start) {
    if (sum == nullptr) {
      const auto by_start = rows.jacobian().leftCols(ns);
      result.start_hessian.noalias() = by_start.transpose() * by_start;
      result.start_gradient.noalias() = by_start.transpose() * residuals;
      result.cross.noalias() =
          rows.jacobian().rightCols(nf).transpose() * by_start;
    }
    AddSensorColumns(layout_, ns, columns, tangents.end_sensitivity,
                     &result.end_sensitivity);
  } else {
    result.start_hessian = Matrix::Zero(ns, ns);
    result.start_gradient = Vector::Zero(ns);
  }
  if (sum == nullptr) return true;

  // One update for all columns. Those of the start are this segment's alone.
  const Eigen::Index columns_in_use = rows.values.cols();
  const Eigen::Index last_row = sum->rows() - 1;
  const Eigen::Index start = last_row - nf - ns;
  sum->middleCols(start, ns).setZero();
  sum->bottomRightCorner(columns_in_use, columns_in_use)
      .selfadjointView<Eigen::Lower>()
      .rankUpdate(rows.values.transpose());
  if (with_start) {
    result.start_hessian =
        sum->block(start, start, ns, ns).selfadjointView<Eigen::Lower>();
    result.cross = sum->block(start + ns, start, nf, ns);
    result.start_gradient = sum->row(last_row).segment(start, ns).transpose();
  }
  if (keeps_rows_ && is_whole) {
    SegmentRows& kept = record->results().kept_rows;
    work.rows.Swap(&kept);
  }
  return true;
}

bool SegmentSweep::BendRecord(size_t r, const Vector& start, const Vector& step,
                              double share, Thread* thread,
                              Eigen::Ref<Vector> projected) {
  ShootingRecord& record = *records_[r];
  const SegmentRows& kept = record.results().kept_rows;
  const Eigen::Index last = record.last_sample(0);
  Thread::Work& work = thread->work(false);
  work.rows.Prepare(record.data(), record.sigmas(), true,
                    problem_.dynamics->num_states(), SegmentColumns::kNone,
                    &work.tangents);
  if (!thread->propagator.Propagate(point_->prepared, record.observation(),
                                    record.grid(), start, 0, last, true,
                                    SegmentColumns::kNone, &work.tangents)) {
    return false;
  }
  work.rows.Compute(record.data(), record.sigmas(), point_->parameters, 0, true,
                    SegmentColumns::kNone, &work.tangents);
  const auto moved = work.rows.rows().residuals();
  if (kept.IsEmpty() || kept.values.rows() != moved.size()) return false;
  const auto jacobian = kept.jacobian();
  const Eigen::Index by_start = jacobian.cols() - step.size();
  const auto by_parameters = jacobian.rightCols(step.size());
  Vector second = (moved - kept.residuals()) / share;
  second.noalias() -= by_parameters * step;
  if (by_start > 0) {
    second.noalias() -= jacobian.leftCols(by_start) *
                        Vector(record.equations().start_sensitivity() * step);
  }
  second *= 2.0 / share;
  projected.noalias() = by_parameters.transpose() * second;
  if (by_start > 0) {
    projected.noalias() +=
        record.equations().start_sensitivity().transpose() *
        Vector(jacobian.leftCols(by_start).transpose() * second);
  }
  return true;
}

bool SegmentSweep::Bend(const std::vector<Matrix>& starts, const Vector& step,
                        double share, Vector* projected) {
  const auto count = static_cast<int>(records_.size());
  bool possible = keeps_rows_;
  for (const auto& record : records_) {
    possible = possible && record->num_segments() == 1;
  }
  for (const auto& linear : linear_) possible = possible && linear == nullptr;
  if (!possible) return false;
  // Each record's in a column of its own, zero on other ranks: the sum is the
  // same for any number of them. The last one counts what has failed.
  Matrix bends = Matrix::Zero(step.size(), count + 1);
  std::vector<char> failed(records_.size(), 0);
  ParallelFor(count, static_cast<int>(threads_.size()), [&](int i, int thread) {
    const auto r = static_cast<size_t>(i);
    if (sums_.RankOf(i) != communicator_.rank()) return;
    failed[r] =
        !BendRecord(r, starts[r].col(0), step, share,
                    threads_[static_cast<size_t>(thread)].get(), bends.col(i));
  });
  for (const char fails : failed) bends(0, count) += fails;
  if (!communicator_.Sum(bends.data(), bends.size())) return false;
  *projected = bends.leftCols(count).rowwise().sum();
  return bends(0, count) == 0.0;
}

std::vector<char> SegmentSweep::EvaluateLinear(
    const std::vector<Task>& tasks, const std::vector<const Matrix*>& starts,
    bool with_parameters) {
  std::vector<size_t> whole;
  for (size_t t = 0; t < tasks.size(); ++t) {
    if (IsWholeAndLinear(static_cast<size_t>(tasks[t].first))) {
      whole.push_back(t);
    }
  }
  // Ranks and threads share records where there are enough of them; each record
  // has all of them to itself where there are not.
  const int count = static_cast<int>(whole.size());
  const bool together =
      communicator_.size() > 1 && count < communicator_.size();
  std::vector<char> done(tasks.size(), 0);
  const auto evaluate = [&](size_t t, int num_threads, Matrix* sum) {
    const auto r = static_cast<size_t>(tasks[t].first);
    done[t] = EvaluateWhole(r, *starts[r], with_parameters, num_threads,
                            together, sum);
  };
  const int num_threads = static_cast<int>(threads_.size());
  std::vector<int> owners(tasks.size(), -1);
  std::vector<std::vector<size_t>> by_slot(
      static_cast<size_t>(sums_.num_slots()));
  int own = 0;
  for (int i = 0; i < count; ++i) {
    const size_t t = whole[static_cast<size_t>(i)];
    if (together) {
      evaluate(t, num_threads, &sums_.slot(0));
      continue;
    }
    owners[t] = sums_.RankOf(i);
    if (owners[t] == communicator_.rank()) {
      by_slot[static_cast<size_t>(sums_.SlotOf(i))].push_back(t);
      ++own;
    }
  }
  if (together || count == 0) return done;
  const bool side_by_side = own >= num_threads;
  ParallelFor(sums_.num_slots(), side_by_side ? num_threads : 1,
              [&](int i, int) {
                const int s = sums_.order()[static_cast<size_t>(i)];
                for (const size_t t : by_slot[static_cast<size_t>(s)]) {
                  evaluate(t, side_by_side ? 1 : num_threads, &sums_.slot(s));
                }
              });
  if (!ExchangeSegments(records_, tasks, owners,
                        with_parameters ? layout_.num_free() : 0,
                        &communicator_, &done)) {
    answered_ = false;
  }
  return done;
}

void SegmentSweep::EvaluateSteps(const std::vector<Task>& tasks,
                                 const std::vector<const Matrix*>& starts,
                                 bool with_parameters) {
  std::vector<int> owners(tasks.size(), -1);
  std::vector<char> done(tasks.size(), 1);
  std::vector<std::vector<size_t>> by_slot(
      static_cast<size_t>(sums_.num_slots()));
  size_t own = 0;
  bool all_long = true;
  for (size_t t = 0; t < tasks.size(); ++t) {
    owners[t] = sums_.RankOf(static_cast<int>(t));
    if (owners[t] != communicator_.rank()) continue;
    by_slot[static_cast<size_t>(sums_.SlotOf(static_cast<int>(t)))].push_back(
        t);
    ++own;
    const ShootingRecord& of = *records_[static_cast<size_t>(tasks[t].first)];
    all_long = all_long && parallel_.IsWorthwhile(
                               of.grid(), of.first_sample(tasks[t].second),
                               of.last_sample(tasks[t].second),
                               ColumnsOf(of, with_parameters));
  }
  // Fewer than there are threads go one after the other, where each is long
  // enough for all threads.
  const bool alone = own < threads_.size() && all_long;
  ParallelFor(sums_.num_slots(), alone ? 1 : static_cast<int>(threads_.size()),
              [&](int i, int thread) {
                const int s = sums_.order()[static_cast<size_t>(i)];
                for (const size_t t : by_slot[static_cast<size_t>(s)]) {
                  const auto r = static_cast<size_t>(tasks[t].first);
                  EvaluateSegment(r, tasks[t].second, *starts[r],
                                  with_parameters, alone,
                                  threads_[static_cast<size_t>(thread)].get(),
                                  with_parameters ? &sums_.slot(s) : nullptr);
                }
              });
  if (!ExchangeSegments(records_, tasks, owners,
                        with_parameters ? layout_.num_free() : 0,
                        &communicator_, &done)) {
    answered_ = false;
  }
}

bool SegmentSweep::Evaluate(const std::vector<Task>& tasks,
                            const std::vector<const Matrix*>& starts,
                            bool with_parameters) {
  const int columns = problem_.dynamics->num_states() +
                      (with_parameters ? layout_.num_free() : 0);
  for (const auto& [record, segment] : tasks) {
    const ShootingRecord& of = *records_[static_cast<size_t>(record)];
    work_ += static_cast<int64_t>(columns) *
             (of.last_sample(segment) - of.first_sample(segment));
  }
  if (with_parameters) sums_.Clear();
  answered_ = true;
  const std::vector<char> done = EvaluateLinear(tasks, starts, with_parameters);
  std::vector<Task> left;
  for (size_t t = 0; t < tasks.size(); ++t) {
    if (done[t] == 0) left.push_back(tasks[t]);
  }
  if (!left.empty()) EvaluateSteps(left, starts, with_parameters);
  if (with_parameters && !sums_.Total(&sum_)) answered_ = false;
  return answered_;
}

bool SegmentSweep::Visit(size_t r, const Matrix& starts, bool with_jacobian,
                         int num_threads, const Visitor& visitor) {
  if (IsWholeAndLinear(r) &&
      VisitWhole(r, starts, with_jacobian, num_threads, visitor)) {
    return true;
  }
  for (int k = 0; k < records_[r]->num_segments(); ++k) {
    if (!VisitSegment(r, k, starts, with_jacobian, visitor)) return false;
  }
  return true;
}

bool SegmentSweep::VisitWhole(size_t r, const Matrix& starts,
                              bool with_jacobian, int num_threads,
                              const Visitor& visitor) {
  const ShootingRecord& record = *records_[r];
  const SegmentColumns columns =
      with_jacobian ? ColumnsOf(record, true) : SegmentColumns::kNone;
  const int nf = layout_.num_free();
  return linear_[r]->Visit(
      PointOf(*point_, r, starts, columns), num_threads,
      [&](Eigen::Index first, const Matrix& residuals, const Matrix& rows) {
        if (!HasStart(columns)) {
          visitor(r, first, residuals,
                  with_jacobian ? rows : Matrix(rows.rows(), 0));
          return;
        }
        Matrix jacobian = rows.rightCols(nf);
        jacobian.noalias() += rows.leftCols(rows.cols() - nf) *
                              record.equations().start_sensitivity();
        visitor(r, first, residuals, jacobian);
      });
}

bool SegmentSweep::IsByModes() const {
  for (size_t r = 0; r < records_.size(); ++r) {
    if (!IsWholeAndLinear(r)) return false;
  }
  return true;
}

Matrix SegmentSweep::ColumnsByFree(size_t r) const {
  const ShootingRecord& record = *records_[r];
  const int nf = layout_.num_free();
  if (!record.HasFreeStarts()) return Matrix::Identity(nf, nf);
  const auto starts = record.equations().start_sensitivity();
  Matrix columns(starts.rows() + nf, nf);
  columns << starts, Matrix::Identity(nf, nf);
  return columns;
}

bool SegmentSweep::MovedResiduals(const ShootingPoint& point, size_t r,
                                  const Matrix& starts, const Vector& step,
                                  Matrix* residuals) const {
  return linear_[r]->Residuals(
      PointOf(point, r, starts, ColumnsOf(*records_[r], true)),
      ColumnsByFree(r) * step, static_cast<int>(threads_.size()), residuals);
}

bool SegmentSweep::AddScores(const ShootingPoint& point, size_t r,
                             const Matrix& starts, Eigen::Index length,
                             Matrix* products, double* count) const {
  return linear_[r]->AddScores(
      PointOf(point, r, starts, ColumnsOf(*records_[r], true)),
      ColumnsByFree(r), length, static_cast<int>(threads_.size()), products,
      count);
}

bool SegmentSweep::VisitSegment(size_t r, int segment, const Matrix& starts,
                                bool with_jacobian, const Visitor& visitor) {
  const ShootingRecord& record = *records_[r];
  Thread& thread = *threads_[0];
  if (!EvaluateSegment(r, segment, starts, with_jacobian,
                       /*alone=*/true, &thread, nullptr)) {
    return false;
  }
  const Eigen::Index ns = problem_.dynamics->num_states();
  const int nc = record.observation().num_channels();
  const int nf = layout_.num_free();
  const SegmentRows& own = thread.work(with_jacobian).rows.rows();
  const auto values = own.residuals();
  const auto rows = own.jacobian();
  Matrix jacobian(rows.rows(), 0);
  if (with_jacobian) {
    jacobian = rows.rightCols(nf);
    if (record.HasFreeStarts()) {
      jacobian.noalias() +=
          rows.leftCols(ns) *
          record.equations().start_sensitivity().middleRows(segment * ns, ns);
    }
  }
  visitor(r, record.first_sample(segment),
          Eigen::Map<const Matrix>(values.data(), nc, values.size() / nc),
          jacobian);
  return true;
}

}  // namespace pinode
