#include "pinode/estimate/multiple_shooting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"
#include "pinode/estimate/sensor.h"
#include "pinode/integrate/free_run.h"

namespace pinode {
namespace {

// rho(s) and its derivative for s = (r / sigma)^2; see ceres/loss_function.h.
void EvaluateLoss(RobustLoss loss, double scale, double s, double* rho,
                  double* slope) {
  const double b = scale * scale;
  *rho = s;
  *slope = 1.0;
  switch (loss) {
    case RobustLoss::kNone:
      return;
    case RobustLoss::kHuber:
      if (s > b) {
        *rho = 2.0 * scale * std::sqrt(s) - b;
        *slope = scale / std::sqrt(s);
      }
      return;
    case RobustLoss::kCauchy:
      *rho = b * std::log1p(s / b);
      *slope = 1.0 / (1.0 + s / b);
      return;
  }
}

}  // namespace

// What one segment contributes.
struct SegmentResult {
  bool ok = false;
  double cost = 0.0;
  Matrix start_hessian;  // A_k: J_s' J_s
  Vector start_gradient;
  Matrix cross;  // J_s' J_theta, num_states x num_free
  Vector end_state;
  Matrix end_sensitivity;  // num_states x (num_states [+ num_free])
  int failed_sample = -1;
  int failed_state = -1;
};

struct MultipleShooting::Record {
  int index = -1;  // in the problem
  const IdentificationRecord* data = nullptr;
  IntegrationGrid grid;
  ObservationMap observation;
  bool start_is_free = false;
  Vector fixed_start;
  std::vector<int> boundaries;  // first samples of the segments, then the last
  Vector scales;                // D
  Vector sigmas;
  Matrix multipliers;  // num_states x gaps
  std::vector<SegmentResult> results;
  std::unique_ptr<BlockTridiagonal> system;
  // d starts / d free, (num_states * segments) x num_free, at the last
  // linearisation.
  Matrix start_sensitivity;
  // Its share of the cost, at the last evaluation and the last linearisation.
  double cost = 0.0;
  double linearized_cost = 0.0;

  int num_segments() const { return static_cast<int>(boundaries.size()) - 1; }
  bool HasFreeStarts() const { return start_is_free || num_segments() > 1; }
};

struct MultipleShooting::Thread {
  explicit Thread(const StructuralDynamics& dynamics, DerivativeMethod method,
                  int num_free)
      : propagator(dynamics, method),
        hessian(Matrix::Zero(num_free, num_free)),
        gradient(Vector::Zero(num_free)) {}
  SegmentPropagator propagator;
  SegmentTangents tangents;
  Matrix rows;      // weighted jacobian
  Vector residual;  // weighted
  Matrix hessian;   // lower triangle, summed over the thread's segments
  Vector gradient;
};

MultipleShooting::MultipleShooting(const IdentificationProblem& problem,
                                   const ParameterLayout& layout,
                                   const Options& options)
    : problem_(problem), layout_(layout), options_(options) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& data = problem.records[r];
    if (data.role != IdentificationRecord::Role::kTrain) continue;
    train_records_.push_back(static_cast<int>(r));
    auto record = std::make_unique<Record>();
    record->index = static_cast<int>(r);
    record->data = &data;
    record->grid = IntegrationGrid(*data.excitation, data.substeps);
    std::vector<Observation> observations;
    for (const MeasuredChannel& channel : data.channels) {
      observations.push_back(channel.observation);
    }
    record->observation = ObservationMap(dynamics, observations);
    record->start_is_free = data.start == IdentificationRecord::Start::kFree;
    record->fixed_start = data.start == IdentificationRecord::Start::kKnown
                              ? data.known_start
                              : Vector::Zero(dynamics.num_states());
    record->scales = Vector::Ones(dynamics.num_states());
    record->sigmas = Vector::Ones(static_cast<int>(data.channels.size()));
    records_.push_back(std::move(record));
  }
  starts_.resize(records_.size());
  if (!problem.modal.empty()) {
    modal_ = std::make_unique<ModalResidual>(problem.modal, dynamics, layout);
  }
  decays_ = Vector::Zero(layout.num_decay_groups());
  for (int t = 0; t < std::max(1, options.num_threads); ++t) {
    threads_.push_back(std::make_unique<Thread>(dynamics, options.derivatives,
                                                layout.num_free()));
  }
}

MultipleShooting::~MultipleShooting() = default;

void MultipleShooting::SetSegments(int samples,
                                   const std::vector<Matrix>& trajectories) {
  CHECK_EQ(trajectories.size(), records_.size())
      << "one trajectory per training record";
  const int ns = problem_.dynamics->num_states();
  for (size_t r = 0; r < records_.size(); ++r) {
    Record& record = *records_[r];
    const int last = record.data->num_samples() - 1;
    CHECK_EQ(trajectories[r].cols(), last + 1);
    CHECK_EQ(trajectories[r].rows(), ns);
    // Segments of nearly equal length.
    const int count =
        samples <= 0 ? 1 : std::max(1, (last + samples / 2) / samples);
    record.boundaries.clear();
    for (int k = 0; k <= count; ++k) {
      record.boundaries.push_back(
          static_cast<int>(static_cast<int64_t>(last) * k / count));
    }
    Matrix& starts = starts_[r];
    starts.resize(ns, count);
    for (int k = 0; k < count; ++k) {
      starts.col(k) =
          trajectories[r].col(record.boundaries[static_cast<size_t>(k)]);
    }
    if (!record.start_is_free) starts.col(0) = record.fixed_start;
    record.multipliers = Matrix::Zero(ns, count - 1);
    record.results.assign(static_cast<size_t>(count), SegmentResult());
    record.system = std::make_unique<BlockTridiagonal>(count, ns);
    record.start_sensitivity.resize(0, 0);
  }
  linearized_starts_ = starts_;
  linearized_free_.resize(0);
  CostHasChanged();
}

int MultipleShooting::num_segments(int train_record) const {
  return records_[static_cast<size_t>(train_record)]->num_segments();
}

bool MultipleShooting::IsSingleShooting() const {
  for (const auto& record : records_) {
    if (record->num_segments() > 1) return false;
  }
  return true;
}

void MultipleShooting::SetStateScales(const std::vector<Vector>& scales) {
  CHECK_EQ(scales.size(), records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    CHECK_EQ(scales[r].size(), problem_.dynamics->num_states());
    CHECK_GT(scales[r].minCoeff(), 0.0) << "state scales must be positive";
    records_[r]->scales = scales[r];
  }
  CostHasChanged();
}

void MultipleShooting::SetSigmas(const std::vector<Vector>& sigmas) {
  CHECK_EQ(sigmas.size(), records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    CHECK_EQ(sigmas[r].size(), records_[r]->observation.num_channels());
    CHECK_GT(sigmas[r].minCoeff(), 0.0) << "sigmas must be positive";
    records_[r]->sigmas = sigmas[r];
  }
  CostHasChanged();
}

bool MultipleShooting::PrepareDynamics(const Vector& free) {
  full_parameters_ = layout_.InitialValues();
  layout_.SetFree(free, &full_parameters_);
  std::string error;
  return full_parameters_.allFinite() &&
         problem_.dynamics->Prepare(
             full_parameters_.head(layout_.num_dynamics()), &prepared_, &error);
}

void MultipleShooting::WeightRows(const Record& record, int segment,
                                  bool with_parameters,
                                  const SegmentTangents& tangents,
                                  Thread* thread, double* cost) const {
  const int ns = problem_.dynamics->num_states();
  const int nc = record.observation.num_channels();
  const int samples = static_cast<int>(tangents.channels.cols());
  const int first = record.boundaries[static_cast<size_t>(segment)];
  const int free = with_parameters ? layout_.num_free() : 0;

  // Columns of the free parameters only.
  Matrix& rows = thread->rows;
  rows.resize(nc * samples, ns + free);
  rows.leftCols(ns) = tangents.jacobian.leftCols(ns);
  if (with_parameters) {
    const std::vector<int>& columns = layout_.tangent_columns();
    for (size_t j = 0; j < columns.size(); ++j) {
      rows.col(ns + static_cast<int>(j)) =
          tangents.jacobian.col(ns + columns[j]);
    }
    rows.rightCols(free - layout_.num_free_dynamics()).setZero();
  }

  // Predictions of real sensors, sample-major as the rows are.
  Vector prediction = Eigen::Map<const Vector>(tangents.channels.data(),
                                               tangents.channels.size());
  std::vector<bool> valid(static_cast<size_t>(nc * samples), true);
  ApplySensors(problem_, layout_, full_parameters_, *record.data,
               with_parameters, &prediction, &rows, &valid);

  // A filter needs the whole history; before the last stage the segments are
  // compared as they are.
  if (record.data->filter != nullptr && record.num_segments() == 1) {
    Matrix history(samples, 1 + rows.cols());
    for (int c = 0; c < nc; ++c) {
      for (int i = 0; i < samples; ++i) {
        history(i, 0) = prediction[i * nc + c];
        history.row(i).tail(rows.cols()) = rows.row(i * nc + c);
      }
      record.data->filter->Apply(&history);
      for (int i = 0; i < samples; ++i) {
        prediction[i * nc + c] = history(i, 0);
        rows.row(i * nc + c) = history.row(i).tail(rows.cols());
      }
    }
  }

  thread->residual.resize(nc * samples);
  Vector weights(nc * samples);
  for (int i = 0; i < samples; ++i) {
    for (int c = 0; c < nc; ++c) {
      const int row = i * nc + c;
      const MeasuredChannel& channel =
          record.data->channels[static_cast<size_t>(c)];
      const double value = channel.values[first + i];
      if (!channel.fit || !valid[static_cast<size_t>(row)] ||
          std::isnan(value)) {
        thread->residual[row] = 0.0;
        weights[row] = 0.0;
        continue;
      }
      const double residual = (prediction[row] - value) / record.sigmas[c];
      double rho, slope;
      EvaluateLoss(options_.loss, options_.loss_scale, residual * residual,
                   &rho, &slope);
      *cost += 0.5 * rho;
      const double root = std::sqrt(slope);
      thread->residual[row] = residual * root;
      weights[row] = root / record.sigmas[c];
    }
  }
  rows.array().colwise() *= weights.array();
}

bool MultipleShooting::EvaluateSegment(Record* record, int segment,
                                       const Matrix& starts,
                                       bool with_parameters,
                                       Thread* thread) const {
  const int ns = problem_.dynamics->num_states();
  const int segments = record->num_segments();
  const bool last = segment + 1 == segments;
  SegmentResult& result = record->results[static_cast<size_t>(segment)];
  result.ok = thread->propagator.Propagate(
      prepared_, record->observation, record->grid, starts.col(segment),
      record->boundaries[static_cast<size_t>(segment)],
      record->boundaries[static_cast<size_t>(segment) + 1], last,
      with_parameters, &thread->tangents);
  if (!result.ok) {
    result.failed_sample = thread->tangents.failed_sample;
    result.failed_state = thread->tangents.failed_state;
    return false;
  }
  result.cost = 0.0;
  WeightRows(*record, segment, with_parameters, thread->tangents, thread,
             &result.cost);
  const auto by_start = thread->rows.leftCols(ns);
  result.start_hessian.noalias() = by_start.transpose() * by_start;
  result.start_gradient.noalias() = by_start.transpose() * thread->residual;
  result.end_state = thread->tangents.end_state;
  result.end_sensitivity = thread->tangents.end_sensitivity.leftCols(ns);
  if (!with_parameters) return true;

  const int free = layout_.num_free();
  const auto by_parameters = thread->rows.rightCols(free);
  result.cross.noalias() = by_start.transpose() * by_parameters;
  thread->hessian.selfadjointView<Eigen::Lower>().rankUpdate(
      by_parameters.transpose());
  thread->gradient.noalias() += by_parameters.transpose() * thread->residual;
  // Psi, the end by the free parameters; sensors have no part in it.
  result.end_sensitivity.resize(ns, ns + free);
  result.end_sensitivity.leftCols(ns) =
      thread->tangents.end_sensitivity.leftCols(ns);
  result.end_sensitivity.rightCols(free).setZero();
  const std::vector<int>& columns = layout_.tangent_columns();
  for (size_t j = 0; j < columns.size(); ++j) {
    result.end_sensitivity.col(ns + static_cast<int>(j)) =
        thread->tangents.end_sensitivity.col(ns + columns[j]);
  }
  return true;
}

bool MultipleShooting::EvaluateModes(Matrix* jacobian) {
  modal_error_.clear();
  return modal_ == nullptr || modal_->Evaluate(prepared_, &modal_residuals_,
                                               jacobian, &modal_error_);
}

double MultipleShooting::PriorCost(const Vector& free) const {
  double cost = 0.0;
  for (int j = 0; j < layout_.num_free(); ++j) {
    const int index = layout_.free()[static_cast<size_t>(j)];
    const Parameter& parameter = layout_.parameter(index);
    if (parameter.HasPrior()) {
      const double r = (free[j] - parameter.prior_mean) / parameter.prior_sigma;
      cost += 0.5 * r * r;
    }
  }
  for (const ParameterLayout::DecayRow& row : layout_.decay_rows()) {
    const double value = row.Value(free);
    cost += 0.5 * decays_[row.group] * value * value;
  }
  return cost;
}

void MultipleShooting::AddPriors(const Vector& free,
                                 CondensedSystem* system) const {
  for (int j = 0; j < layout_.num_free(); ++j) {
    const int index = layout_.free()[static_cast<size_t>(j)];
    const Parameter& parameter = layout_.parameter(index);
    if (parameter.HasPrior()) {
      const double precision =
          1.0 / (parameter.prior_sigma * parameter.prior_sigma);
      system->gradient[j] += precision * (free[j] - parameter.prior_mean);
      system->hessian(j, j) += precision;
    }
  }
  for (const ParameterLayout::DecayRow& row : layout_.decay_rows()) {
    const Eigen::Index count = row.weights.size();
    const Vector weighted = decays_[row.group] * row.weights;
    system->gradient.segment(row.first, count) += row.Value(free) * weighted;
    system->hessian.block(row.first, row.first, count, count).noalias() +=
        weighted * row.weights.transpose();
  }
}

Vector MultipleShooting::GapForce(const Record& record, const Matrix& starts,
                                  int gap) const {
  const SegmentResult& result = record.results[static_cast<size_t>(gap)];
  return gap_penalty_ * ((result.end_state - starts.col(gap + 1))
                             .cwiseQuotient(record.scales) +
                         record.multipliers.col(gap))
                            .cwiseQuotient(record.scales);
}

void MultipleShooting::AssembleStarts(Record* record, const Matrix& starts,
                                      int num_free, Matrix* right) const {
  const int ns = problem_.dynamics->num_states();
  const int segments = record->num_segments();
  BlockTridiagonal& system = *record->system;
  system.SetZero();
  *right = Matrix::Zero(ns * segments, num_free + 1);
  const auto cross = [&](int k) {
    return right->middleRows(k * ns, ns).leftCols(num_free);
  };
  const auto gradient = [&](int k) {
    return right->middleRows(k * ns, ns).col(num_free);
  };
  const Vector precision = record->scales.cwiseAbs2().cwiseInverse();
  const Vector weight = gap_penalty_ * precision;
  for (int k = 0; k < segments; ++k) {
    const SegmentResult& result = record->results[static_cast<size_t>(k)];
    system.diagonal(k) += result.start_hessian;
    if (num_free > 0) cross(k) += result.cross;
    gradient(k) += result.start_gradient;
    if (k + 1 == segments) break;
    const auto transition = result.end_sensitivity.leftCols(ns);
    const Matrix weighted = weight.asDiagonal() * transition;
    const Vector force = GapForce(*record, starts, k);
    system.diagonal(k).noalias() += transition.transpose() * weighted;
    system.coupling(k) = -weighted.transpose();
    system.diagonal(k + 1).diagonal() += weight;
    gradient(k).noalias() += transition.transpose() * force;
    gradient(k + 1) -= force;
    if (num_free > 0) {
      const auto by_parameters = result.end_sensitivity.rightCols(num_free);
      cross(k).noalias() += weighted.transpose() * by_parameters;
      cross(k + 1) -= weight.asDiagonal() * by_parameters;
    }
  }
  if (record->start_is_free) {
    system.diagonal(0).diagonal() +=
        options_.starts.prior_precision * precision;
    gradient(0) +=
        options_.starts.prior_precision * precision.cwiseProduct(starts.col(0));
  } else {
    // A start that is known takes no part.
    system.diagonal(0).setIdentity();
    if (segments > 1) system.coupling(0).setZero();
    right->topRows(ns).setZero();
  }
}

bool MultipleShooting::SolveStarts(const Vector& free, double* cost) {
  const int ns = problem_.dynamics->num_states();
  // Trial starts: where the last linearisation's tangent leads.
  struct Search {
    Matrix trial, best;
    double best_cost = std::numeric_limits<double>::infinity();
    double damping = 0.0;
    double promised = 0.0;  // decrease of the cost by the trial step
    bool done = false;
    bool failed_once = false;
    Matrix gradient;
  };
  std::vector<Search> searches(records_.size());
  for (size_t r = 0; r < records_.size(); ++r) {
    Search& search = searches[r];
    search.trial = linearized_starts_[r];
    const Record& record = *records_[r];
    if (linearized_free_.size() == free.size() &&
        record.start_sensitivity.cols() == free.size()) {
      const Vector move = record.start_sensitivity * (free - linearized_free_);
      search.trial +=
          Eigen::Map<const Matrix>(move.data(), ns, search.trial.cols());
    }
  }
  divergence_ = Divergence();
  for (int iteration = 0; iteration < options_.starts.max_iterations;
       ++iteration) {
    std::vector<std::pair<int, int>> tasks;
    for (size_t r = 0; r < records_.size(); ++r) {
      if (searches[r].done) continue;
      for (int k = 0; k < records_[r]->num_segments(); ++k) {
        tasks.emplace_back(static_cast<int>(r), k);
      }
    }
    if (tasks.empty()) break;
    ParallelFor(static_cast<int>(tasks.size()),
                static_cast<int>(threads_.size()), [&](int t, int thread) {
                  const auto& [r, k] = tasks[static_cast<size_t>(t)];
                  EvaluateSegment(records_[static_cast<size_t>(r)].get(), k,
                                  searches[static_cast<size_t>(r)].trial, false,
                                  threads_[static_cast<size_t>(thread)].get());
                });
    for (size_t r = 0; r < records_.size(); ++r) {
      Search& search = searches[r];
      if (search.done) continue;
      Record& record = *records_[r];
      const int segments = record.num_segments();
      double trial_cost = 0.0;
      bool finite = true;
      for (int k = 0; k < segments; ++k) {
        const SegmentResult& result = record.results[static_cast<size_t>(k)];
        if (!result.ok) {
          finite = false;
          divergence_.record = record.index;
          divergence_.segment = k;
          divergence_.sample = result.failed_sample;
          divergence_.state = result.failed_state;
          break;
        }
        trial_cost += result.cost;
      }
      const Vector inverse_scales = record.scales.cwiseInverse();
      if (finite) {
        for (int k = 0; k + 1 < segments; ++k) {
          const Vector gap =
              inverse_scales.cwiseProduct(
                  record.results[static_cast<size_t>(k)].end_state -
                  search.trial.col(k + 1)) +
              record.multipliers.col(k);
          trial_cost += 0.5 * gap_penalty_ * gap.squaredNorm();
        }
        if (record.start_is_free) {
          trial_cost +=
              0.5 * options_.starts.prior_precision *
              inverse_scales.cwiseProduct(search.trial.col(0)).squaredNorm();
        }
        finite = std::isfinite(trial_cost);
      }
      if (!record.HasFreeStarts()) {
        if (!finite) return false;
        search.best = search.trial;
        search.best_cost = trial_cost;
        search.done = true;
        continue;
      }
      const bool improved = finite && trial_cost < search.best_cost;
      if (improved) {
        const double gain = search.best_cost - trial_cost;
        search.best = search.trial;
        search.best_cost = trial_cost;
        if (gain < 0.25 * search.promised) {
          search.damping = std::max(1e-3, 3.0 * search.damping);
        } else if (gain > 0.75 * search.promised) {
          search.damping *= search.damping > 1e-6 ? 0.1 : 0.0;
        }
        AssembleStarts(&record, search.best, 0, &search.gradient);
      } else {
        if (search.best_cost == std::numeric_limits<double>::infinity()) {
          // The tangent led astray: fall back on the starts themselves, once.
          if (search.failed_once || linearized_free_.size() == 0) return false;
          search.failed_once = true;
          search.trial = linearized_starts_[r];
          continue;
        }
        search.damping = std::max(1e-3, 10.0 * search.damping);
        if (search.damping > 1e8) {
          search.done = true;
          continue;
        }
      }
      while (!record.system->Factor(search.damping)) {
        search.damping = std::max(1e-12, 10.0 * search.damping);
        if (search.damping > 1e8) return false;
      }
      Matrix step = search.gradient;
      record.system->SolveLower(&step);
      const double decrease = 0.5 * step.squaredNorm();
      const bool hopeless =
          iteration >= options_.starts.hopeless_iterations &&
          search.best_cost - options_.starts.hopeless_promises * decrease >
              options_.starts.hopeless_cost * linearized_cost_;
      double enough = options_.starts.tolerance * search.best_cost;
      if (std::isfinite(linearized_cost_)) {
        enough = std::max(
            enough, options_.starts.change_tolerance *
                        std::abs(search.best_cost - record.linearized_cost));
      }
      if ((improved && decrease <= enough) || hopeless) {
        search.done = true;
        continue;
      }
      search.promised = decrease;
      record.system->SolveUpper(&step);
      search.trial =
          search.best - Eigen::Map<const Matrix>(step.data(), ns, segments);
    }
  }
  *cost = PriorCost(free);
  for (size_t r = 0; r < records_.size(); ++r) {
    if (searches[r].best_cost == std::numeric_limits<double>::infinity()) {
      return false;
    }
    starts_[r] = searches[r].best;
    records_[r]->cost = searches[r].best_cost;
    *cost += searches[r].best_cost;
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
  if (!PrepareDynamics(free) || !EvaluateModes(nullptr)) return false;
  if (!SolveStarts(free, cost)) return false;
  *cost += ModalCost();
  last_free_ = free;
  last_cost_ = *cost;
  return true;
}

bool MultipleShooting::Linearize(const Vector& free, CondensedSystem* system) {
  if (!Evaluate(free, &system->cost)) return false;
  Matrix modal_jacobian;
  if (!PrepareDynamics(free) || !EvaluateModes(&modal_jacobian)) return false;
  const int ns = problem_.dynamics->num_states();
  const int nf = layout_.num_free();
  for (auto& thread : threads_) {
    thread->hessian.setZero();
    thread->gradient.setZero();
  }
  std::vector<std::pair<int, int>> tasks;
  for (size_t r = 0; r < records_.size(); ++r) {
    for (int k = 0; k < records_[r]->num_segments(); ++k) {
      tasks.emplace_back(static_cast<int>(r), k);
    }
  }
  std::vector<char> ok(tasks.size(), 0);
  ParallelFor(static_cast<int>(tasks.size()), static_cast<int>(threads_.size()),
              [&](int t, int thread) {
                const auto& [r, k] = tasks[static_cast<size_t>(t)];
                ok[static_cast<size_t>(t)] = EvaluateSegment(
                    records_[static_cast<size_t>(r)].get(), k,
                    starts_[static_cast<size_t>(r)], true,
                    threads_[static_cast<size_t>(thread)].get());
              });
  if (std::find(ok.begin(), ok.end(), 0) != ok.end()) return false;

  Matrix hessian = threads_[0]->hessian;
  Vector gradient = threads_[0]->gradient;
  for (size_t t = 1; t < threads_.size(); ++t) {
    hessian += threads_[t]->hessian;
    gradient += threads_[t]->gradient;
  }

  double curvature_sum = 0.0;
  int curvature_count = 0;
  for (size_t r = 0; r < records_.size(); ++r) {
    Record& record = *records_[r];
    const int segments = record.num_segments();
    for (int k = 0; k < segments; ++k) {
      curvature_sum +=
          (record.results[static_cast<size_t>(k)].start_hessian.diagonal())
              .dot(record.scales.cwiseAbs2()) /
          ns;
      ++curvature_count;
    }
    if (!record.HasFreeStarts()) {
      record.start_sensitivity = Matrix::Zero(ns, nf);
      continue;
    }
    BlockTridiagonal& start_system = *record.system;
    // Right-hand sides: the cross terms with theta, then the gradient.
    Matrix right;
    AssembleStarts(&record, starts_[r], nf, &right);
    for (int k = 0; k + 1 < segments; ++k) {
      const SegmentResult& result = record.results[static_cast<size_t>(k)];
      const auto by_parameters = result.end_sensitivity.rightCols(nf);
      const Matrix scaled =
          (std::sqrt(gap_penalty_) * record.scales.cwiseInverse())
              .asDiagonal() *
          by_parameters;
      hessian.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
      gradient.noalias() +=
          by_parameters.transpose() * GapForce(record, starts_[r], k);
    }
    double damping = 0.0;
    while (!start_system.Factor(damping)) {
      damping = std::max(1e-12, 10.0 * damping);
      if (damping > 1.0) return false;
    }
    start_system.SolveLower(&right);
    const auto projected = right.leftCols(nf);
    hessian.selfadjointView<Eigen::Lower>().rankUpdate(projected.transpose(),
                                                       -1.0);
    gradient.noalias() -= projected.transpose() * right.col(nf);
    start_system.SolveUpper(&right);
    record.start_sensitivity = -right.leftCols(nf);
  }
  data_curvature_ = curvature_count > 0 ? curvature_sum / curvature_count : 0.0;
  system->gradient = gradient;
  system->hessian = hessian.selfadjointView<Eigen::Lower>();
  AddPriors(free, system);
  if (modal_ != nullptr) {
    modal_information_ = modal_jacobian.transpose() * modal_jacobian;
    system->hessian += modal_information_;
    system->gradient.noalias() += modal_jacobian.transpose() * modal_residuals_;
  }
  linearized_free_ = free;
  linearized_starts_ = starts_;
  linearized_cost_ = system->cost;
  for (auto& record : records_) record->linearized_cost = record->cost;
  return system->hessian.allFinite() && system->gradient.allFinite();
}

double MultipleShooting::LargestGap() const {
  double largest = 0.0;
  for (size_t r = 0; r < records_.size(); ++r) {
    const Record& record = *records_[r];
    for (int k = 0; k + 1 < record.num_segments(); ++k) {
      const Vector gap = (record.results[static_cast<size_t>(k)].end_state -
                          starts_[r].col(k + 1))
                             .cwiseQuotient(record.scales);
      largest = std::max(largest, gap.cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

void MultipleShooting::UpdateMultipliers() {
  for (size_t r = 0; r < records_.size(); ++r) {
    Record& record = *records_[r];
    for (int k = 0; k + 1 < record.num_segments(); ++k) {
      record.multipliers.col(k) +=
          (record.results[static_cast<size_t>(k)].end_state -
           starts_[r].col(k + 1))
              .cwiseQuotient(record.scales);
    }
  }
  CostHasChanged();
}

void MultipleShooting::RescaleMultipliers(double factor) {
  for (auto& record : records_) record->multipliers *= factor;
  CostHasChanged();
}

bool MultipleShooting::Trajectories(const Vector& free,
                                    std::vector<Matrix>* states) {
  if (!PrepareDynamics(free)) return false;
  const int ns = problem_.dynamics->num_states();
  states->clear();
  for (size_t r = 0; r < records_.size(); ++r) {
    const Record& record = *records_[r];
    Matrix whole(ns, record.grid.num_samples());
    for (int k = 0; k < record.num_segments(); ++k) {
      Trajectory trajectory;
      const int first = record.boundaries[static_cast<size_t>(k)];
      const int last = record.boundaries[static_cast<size_t>(k) + 1];
      if (!FreeRun(*problem_.dynamics, prepared_, record.observation,
                   record.grid, starts_[r].col(k), first, last, &trajectory)) {
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
  if (!PrepareDynamics(free)) return false;
  const int ns = problem_.dynamics->num_states();
  const int nf = layout_.num_free();
  residuals->clear();
  if (with_jacobian) jacobians->clear();
  Thread& thread = *threads_[0];
  for (size_t r = 0; r < records_.size(); ++r) {
    Record& record = *records_[r];
    const int nc = record.observation.num_channels();
    const int samples = record.grid.num_samples();
    Matrix residual(nc, samples);
    Matrix jacobian(with_jacobian ? nc * samples : 0, nf);
    for (int k = 0; k < record.num_segments(); ++k) {
      if (!EvaluateSegment(&record, k, starts_[r], with_jacobian, &thread)) {
        return false;
      }
      const int first = record.boundaries[static_cast<size_t>(k)];
      const int count = static_cast<int>(thread.residual.size()) / nc;
      residual.middleCols(first, count) =
          Eigen::Map<const Matrix>(thread.residual.data(), nc, count);
      if (with_jacobian) {
        jacobian.middleRows(first * nc, count * nc) = thread.rows.rightCols(nf);
        if (record.HasFreeStarts()) {
          jacobian.middleRows(first * nc, count * nc).noalias() +=
              thread.rows.leftCols(ns) *
              record.start_sensitivity.middleRows(k * ns, ns);
        }
      }
    }
    residuals->push_back(std::move(residual));
    if (with_jacobian) jacobians->push_back(std::move(jacobian));
  }
  return true;
}

}  // namespace pinode
