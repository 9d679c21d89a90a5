#include "pinode/estimate/shooting/linear_record.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "pinode/base/parallel_for.h"
#include "pinode/estimate/shooting/record_sums.h"
#include "pinode/integrate/history_pass.h"

namespace pinode {
namespace {

// Each has a Gram matrix of its own.
constexpr size_t kMostPatterns = 4;

// Of the equations of all channels together, more than this are not kept by
// channel.
constexpr double kMostNumbers = 4e6;

}  // namespace

struct LinearRecord::Tables {
  ModalResponse::Contents contents;
  Eigen::Index columns = 0;
  // R x channels: the sensors' predictions over sigma, what was measured not
  // subtracted.
  Matrix predictions;
  // R x columns of each channel, over sigma; empty where it is not fitted.
  std::vector<Matrix> derivatives;
  Vector start;
  Vector sigmas;
  // Whether the channels' equations are kept apart.
  bool apart = false;
  size_t EquationsOf(int channel) const {
    return apart ? static_cast<size_t>(channel) : 0;
  }
  // Whether rows of the Jacobian are cheaper than the histories' Gram matrix.
  bool by_rows = false;
  // That a sample's sums take.
  double operations = 0.0;
  // For so many combinations of a sample's histories for each channel.
  double OperationsOf(Eigen::Index combinations) const {
    return 2.0 * static_cast<double>(combinations) *
           static_cast<double>(predictions.size());
  }
};

LinearRecord::LinearRecord(const IdentificationProblem& problem,
                           const ParameterLayout& layout,
                           const IdentificationRecord& record,
                           const IntegrationGrid& grid,
                           const ObservationMap& observation)
    : problem_(problem),
      layout_(layout),
      record_(record),
      grid_(grid),
      observation_(observation) {}

std::unique_ptr<LinearRecord> LinearRecord::Create(
    const IdentificationProblem& problem, const ParameterLayout& layout,
    const IdentificationRecord& record, const IntegrationGrid& grid,
    const ObservationMap& observation, RobustLoss loss) {
  const bool delayed =
      std::any_of(record.channels.begin(), record.channels.end(),
                  [](const auto& channel) { return channel.delay >= 0; });
  if (!problem.dynamics->IsLinear() || record.filter != nullptr || delayed ||
      loss != RobustLoss::kNone) {
    return nullptr;
  }
  std::unique_ptr<LinearRecord> result(
      new LinearRecord(problem, layout, record, grid, observation));
  return result->FindPatterns() ? std::move(result) : nullptr;
}

bool LinearRecord::FindPatterns() {
  for (size_t c = 0; c < record_.channels.size(); ++c) {
    const MeasuredChannel& channel = record_.channels[c];
    if (!channel.fit) continue;
    std::vector<bool> present;
    if (channel.values.array().isNaN().any()) {
      for (const double value : channel.values) {
        present.push_back(!std::isnan(value));
      }
    }
    const auto same =
        std::find_if(patterns_.begin(), patterns_.end(),
                     [&](const Pattern& p) { return p.present == present; });
    if (same != patterns_.end()) {
      same->channels.push_back(static_cast<int>(c));
      continue;
    }
    patterns_.push_back({{static_cast<int>(c)}, std::move(present)});
  }
  return patterns_.size() <= kMostPatterns;
}

bool LinearRecord::Tabulate(const Point& point, const Vector& sigmas,
                            int num_threads, Tables* tables) {
  const bool by_parameters = HasParameters(point.columns);
  const bool by_start = HasStart(point.columns);
  if (!response_.Prepare(*problem_.dynamics, *point.prepared, grid_,
                         by_parameters)) {
    return false;
  }
  tables->contents.with_slopes = by_parameters;
  tables->contents.with_start = by_start || !point.start.isZero(0.0);
  tables->start = point.start;
  tables->sigmas = sigmas;
  const Eigen::Index ns = by_start ? point.start.size() : 0;
  tables->columns = ns + (by_parameters ? layout_.num_free() : 0);
  const int constant = response_.ConstantRow(tables->contents);
  tables->predictions =
      response_.Values(tables->contents, observation_, point.start);
  std::vector<Matrix> ideal =
      response_.Derivatives(tables->contents, observation_, point.start,
                            by_start, by_parameters, num_threads);
  tables->derivatives.assign(record_.channels.size(), Matrix());
  size_t fitted = 0;
  const auto value = [&](int sensor) {
    return (*point.parameters)[layout_.num_dynamics() + sensor];
  };
  // Column of a sensor's parameter, or of the parameter that it is tied to; -1
  // where it is fixed or not asked for.
  const auto column = [&](int sensor) {
    ParameterLayout::Dependence result =
        layout_.DependenceOf(layout_.num_dynamics() + sensor);
    result.free = by_parameters && result.free >= 0
                      ? static_cast<int>(ns) + result.free
                      : -1;
    return result;
  };
  for (size_t c = 0; c < record_.channels.size(); ++c) {
    const MeasuredChannel& channel = record_.channels[c];
    auto prediction = tables->predictions.col(static_cast<Eigen::Index>(c));
    Matrix& derivatives = tables->derivatives[c];
    if (channel.fit) {
      ++fitted;
      derivatives = Matrix::Zero(prediction.size(), tables->columns);
      derivatives.leftCols(ideal[c].cols()) = ideal[c];
      ideal[c].resize(0, 0);
    }
    if (channel.gain >= 0) {
      derivatives *= value(channel.gain);
      const ParameterLayout::Dependence by_gain = column(channel.gain);
      if (channel.fit && by_gain.free >= 0) {
        derivatives.col(by_gain.free) += by_gain.factor * prediction;
      }
      prediction *= value(channel.gain);
    }
    if (channel.offset >= 0) {
      prediction[constant] += value(channel.offset);
      const ParameterLayout::Dependence by_offset = column(channel.offset);
      if (channel.fit && by_offset.free >= 0) {
        derivatives(constant, by_offset.free) += by_offset.factor;
      }
    }
    const double sigma = sigmas[static_cast<Eigen::Index>(c)];
    prediction /= sigma;
    derivatives /= sigma;
  }
  const auto rows = static_cast<double>(tables->predictions.rows());
  const auto columns = static_cast<double>(tables->columns);
  const double by_rows =
      static_cast<double>(fitted) * columns * (2.0 * rows + columns);
  const double by_histories =
      static_cast<double>(patterns_.size()) * rows * rows;
  tables->by_rows = by_rows < by_histories;
  tables->operations =
      tables->columns == 0
          ? tables->OperationsOf(1)
          : tables->OperationsOf(2) + std::min(by_rows, by_histories);
  return true;
}

Matrix LinearRecord::Residuals(const Tables& tables, Eigen::Index first,
                               const Matrix& histories) const {
  const auto count = histories.cols();
  Matrix residuals = tables.predictions.transpose() * histories;
  for (size_t c = 0; c < record_.channels.size(); ++c) {
    const MeasuredChannel& channel = record_.channels[c];
    auto row = residuals.row(static_cast<Eigen::Index>(c));
    if (!channel.fit) {
      row.setZero();
      continue;
    }
    row -= channel.values.segment(first, count).transpose() /
           tables.sigmas[static_cast<Eigen::Index>(c)];
  }
  for (const Pattern& pattern : patterns_) {
    if (pattern.present.empty()) continue;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (pattern.present[static_cast<size_t>(first + i)]) continue;
      for (const int c : pattern.channels) residuals(c, i) = 0.0;
    }
  }
  return residuals;
}

void LinearRecord::AddBlock(const Tables& tables, Eigen::Index first,
                            const Matrix& histories, RecordSums* sums) const {
  const Matrix residuals = Residuals(tables, first, histories);
  sums->costs += 0.5 * residuals.rowwise().squaredNorm();
  if (tables.columns == 0) return;
  sums->products.noalias() += histories * residuals.transpose();
  Matrix present = histories;
  for (size_t p = 0; p < patterns_.size(); ++p) {
    const Pattern& pattern = patterns_[p];
    if (!pattern.present.empty()) {
      for (Eigen::Index i = 0; i < histories.cols(); ++i) {
        if (pattern.present[static_cast<size_t>(first + i)]) {
          present.col(i) = histories.col(i);
        } else {
          present.col(i).setZero();
        }
      }
    }
    const Matrix& used = pattern.present.empty() ? histories : present;
    if (!tables.by_rows) {
      sums->grams[p].selfadjointView<Eigen::Lower>().rankUpdate(used);
      continue;
    }
    for (const int c : pattern.channels) {
      const Matrix rows =
          tables.derivatives[static_cast<size_t>(c)].transpose() * used;
      sums->hessians[tables.EquationsOf(c)]
          .selfadjointView<Eigen::Lower>()
          .rankUpdate(rows);
    }
  }
}

void LinearRecord::Condense(const Tables& tables, const RecordSums& sums,
                            int num_threads, ByChannel* equations) const {
  const size_t count = tables.apart ? record_.channels.size() : 1;
  equations->costs = sums.costs;
  equations->end_state =
      response_.States(tables.contents, tables.start).transpose() * sums.end;
  equations->gradients =
      Matrix::Zero(tables.columns, static_cast<Eigen::Index>(count));
  equations->hessians = sums.hessians;
  if (!tables.by_rows || tables.columns == 0) {
    equations->hessians.assign(count,
                               Matrix::Zero(tables.columns, tables.columns));
  }
  if (tables.columns == 0) return;
  for (size_t p = 0; p < patterns_.size(); ++p) {
    const std::vector<int>& channels = patterns_[p].channels;
    std::vector<Matrix> hessians(channels.size());
    if (!tables.by_rows) {
      ParallelFor(static_cast<int>(channels.size()), num_threads,
                  [&](int i, int) {
                    const auto k = static_cast<size_t>(i);
                    const Matrix& table =
                        tables.derivatives[static_cast<size_t>(channels[k])];
                    const Matrix product =
                        sums.grams[p].selfadjointView<Eigen::Lower>() * table;
                    hessians[k].noalias() = table.transpose() * product;
                  });
    }
    // In an order that does not depend on who found them.
    for (size_t k = 0; k < channels.size(); ++k) {
      const int c = channels[k];
      const size_t own = tables.EquationsOf(c);
      equations->gradients.col(static_cast<Eigen::Index>(own)).noalias() +=
          tables.derivatives[static_cast<size_t>(c)].transpose() *
          sums.products.col(c);
      if (!tables.by_rows) equations->hessians[own] += hessians[k];
    }
  }
  if (!tables.by_rows) return;
  for (Matrix& hessian : equations->hessians) {
    hessian = Matrix(hessian.selfadjointView<Eigen::Lower>());
  }
}

RecordSums LinearRecord::SumPieces(const Tables& tables, int num_threads,
                                   const Communicator& communicator) const {
  const Eigen::Index rows = tables.predictions.rows();
  RecordSums zero;
  zero.end = Vector::Zero(rows);
  zero.costs = Vector::Zero(tables.predictions.cols());
  if (tables.columns > 0) {
    zero.products = Matrix::Zero(rows, tables.predictions.cols());
    if (!tables.by_rows) {
      zero.grams.assign(patterns_.size(), Matrix::Zero(rows, rows));
    }
  }
  if (tables.by_rows) {
    zero.hessians.assign(tables.apart ? record_.channels.size() : 1,
                         Matrix::Zero(tables.columns, tables.columns));
  }

  const Eigen::Index samples = record_.num_samples();
  const int ranks = communicator.size();
  const HistoryPass pass(response_, tables.contents, grid_, 0, samples,
                         tables.operations);
  const int pieces = pass.num_pieces();
  const int begin = pass.Bound(0, pieces, communicator.rank(), ranks);
  const int end = pass.Bound(0, pieces, communicator.rank() + 1, ranks);
  const int shares = HistoryPass::NumShares(begin, end, num_threads);
  std::vector<PieceSums> sums(static_cast<size_t>(shares), PieceSums(zero));
  pass.Visit(begin, end, shares,
             [&](int share, Eigen::Index first, const Matrix& histories) {
               PieceSums& into = sums[static_cast<size_t>(share)];
               AddBlock(tables, first, histories, into.piece());
               const Eigen::Index next = first + histories.cols();
               if (next == samples) {
                 into.piece()->end = histories.rightCols(1);
               }
               if (next == samples ||
                   HistoryPass::PieceOf(next) != HistoryPass::PieceOf(first)) {
                 into.Close();
               }
             });
  for (int s = 1; s < shares; ++s) sums[0].Add(&sums[static_cast<size_t>(s)]);
  return sums[0].Take();
}

bool LinearRecord::HasBeenAt(const Point& point, const ByChannel& known) const {
  return known.apart && known.parameters.size() == point.parameters->size() &&
         known.parameters == *point.parameters && known.start == point.start &&
         (known.columns == point.columns ||
          point.columns == SegmentColumns::kNone);
}

bool LinearRecord::Evaluate(const Point& point, int num_threads,
                            Communicator* communicator, Equations* equations) {
  const ByChannel* found = nullptr;
  for (const ByChannel& known : known_) {
    if (HasBeenAt(point, known)) found = &known;
  }
  Point at = point;
  if (point.columns != SegmentColumns::kNone) {
    last_columns_ = point.columns;
    trial_is_open_ = false;
  } else if (found == nullptr) {
    if (!trial_is_open_ && KeepsApart()) at.columns = last_columns_;
    trial_is_open_ = true;
  }
  if (found == nullptr) {
    ByChannel& known = known_[at.columns == SegmentColumns::kNone ? 0 : 1];
    if (!Sum(at, num_threads, communicator, &known)) {
      known = ByChannel();
      return false;
    }
    found = &known;
  }
  const Vector weights = found->apart
                             ? Vector(point.sigmas->cwiseAbs2().cwiseInverse())
                             : Vector::Ones(1);
  const Eigen::Index columns =
      point.columns == SegmentColumns::kNone ? 0 : found->gradients.rows();
  equations->squares = 2.0 * found->costs;
  equations->cost = found->costs.sum();
  if (found->apart) {
    equations->cost = weights.dot(found->costs);
  } else {
    equations->squares.array() *= point.sigmas->array().square();
  }
  equations->end_state = found->end_state;
  equations->gradient = found->gradients.topRows(columns) * weights;
  equations->hessian = Matrix::Zero(columns, columns);
  for (Eigen::Index c = 0; columns > 0 && c < weights.size(); ++c) {
    equations->hessian += weights[c] * found->hessians[static_cast<size_t>(c)];
  }
  return std::isfinite(equations->cost) && equations->end_state.allFinite();
}

bool LinearRecord::KeepsApart() const {
  const double most = problem_.dynamics->num_states() + layout_.num_free();
  return static_cast<double>(record_.channels.size()) * most * most <
         kMostNumbers;
}

bool LinearRecord::Sum(const Point& point, int num_threads,
                       Communicator* communicator, ByChannel* equations) {
  const auto channels = static_cast<Eigen::Index>(record_.channels.size());
  const bool apart = KeepsApart();
  Tables tables;
  tables.apart = apart;
  if (!Tabulate(point, apart ? Vector(Vector::Ones(channels)) : *point.sigmas,
                num_threads, &tables)) {
    return false;
  }
  Communicator& ranks = CommunicatorOrSingle(communicator);
  Condense(tables, SumPieces(tables, num_threads, ranks), num_threads,
           equations);
  equations->parameters = *point.parameters;
  equations->start = point.start;
  equations->columns = point.columns;
  equations->apart = apart;
  return AddRanks(&ranks, equations);
}

bool LinearRecord::AddRanks(Communicator* ranks, ByChannel* equations) {
  if (ranks->size() == 1) return true;
  Eigen::Index size = equations->costs.size() + equations->end_state.size() +
                      equations->gradients.size();
  for (const Matrix& hessian : equations->hessians) size += hessian.size();
  Vector numbers(size);
  const auto pass = [&](const auto& each) {
    Eigen::Index at = 0;
    const auto next = [&](auto* values) {
      each(numbers.segment(at, values->size()), values);
      at += values->size();
    };
    next(&equations->costs);
    next(&equations->end_state);
    next(&equations->gradients);
    for (Matrix& hessian : equations->hessians) next(&hessian);
  };
  pass([](auto there, const auto* here) { there = here->reshaped(); });
  if (!ranks->Sum(&numbers)) return false;
  pass([](const auto& there, auto* here) { here->reshaped() = there; });
  return true;
}

bool LinearRecord::Visit(const Point& point, int num_threads,
                         const Visitor& visitor) {
  Tables tables;
  if (!Tabulate(point, *point.sigmas, num_threads, &tables)) return false;
  const auto nc = static_cast<Eigen::Index>(record_.channels.size());
  std::atomic<bool> finite = true;
  const HistoryPass pass(response_, tables.contents, grid_, 0,
                         record_.num_samples(),
                         tables.OperationsOf(tables.columns + 1));
  pass.Visit(
      num_threads, [&](int, Eigen::Index first, const Matrix& histories) {
        const Matrix residuals = Residuals(tables, first, histories);
        if (!residuals.allFinite()) finite = false;
        if (!finite) return;
        const Eigen::Index count = histories.cols();
        Matrix jacobian = Matrix::Zero(nc * count, tables.columns);
        for (const Pattern& pattern : patterns_) {
          for (const int c : pattern.channels) {
            if (tables.columns == 0) continue;
            const Matrix rows = histories.transpose() *
                                tables.derivatives[static_cast<size_t>(c)];
            for (Eigen::Index i = 0; i < count; ++i) {
              if (!pattern.present.empty() &&
                  !pattern.present[static_cast<size_t>(first + i)]) {
                continue;
              }
              jacobian.row(i * nc + c) = rows.row(i);
            }
          }
        }
        visitor(first, residuals, jacobian);
      });
  return finite;
}

bool LinearRecord::Residuals(const Point& point, const Vector& step,
                             int num_threads, Matrix* residuals) {
  Tables tables;
  if (!Tabulate(point, *point.sigmas, num_threads, &tables)) return false;
  for (Eigen::Index c = 0; step.size() > 0 && c < tables.predictions.cols();
       ++c) {
    const Matrix& table = tables.derivatives[static_cast<size_t>(c)];
    if (table.size() > 0) tables.predictions.col(c) += table * step;
  }
  residuals->resize(tables.predictions.cols(), record_.num_samples());
  const HistoryPass pass(response_, tables.contents, grid_, 0,
                         record_.num_samples(), tables.OperationsOf(1));
  pass.Visit(num_threads,
             [&](int, Eigen::Index first, const Matrix& histories) {
               residuals->middleCols(first, histories.cols()) =
                   Residuals(tables, first, histories);
             });
  return residuals->allFinite();
}

// Sums Z r' (R x channels) of blocks: of the first one that ends in the share,
// which others have begun, and of the one that goes on behind it.
struct LinearRecord::ScoreShare {
  Matrix head, tail;
  bool has_head = false;
  Matrix products;
  double count = 0.0;
};

bool LinearRecord::AddScores(const Point& point, const Matrix& projection,
                             Eigen::Index length, int num_threads,
                             Matrix* products, double* count) {
  Tables tables;
  if (!Tabulate(point, *point.sigmas, num_threads, &tables)) return false;
  const Eigen::Index samples = record_.num_samples();
  ScoreShare zero;
  zero.tail =
      Matrix::Zero(tables.predictions.rows(), tables.predictions.cols());
  zero.products = Matrix::Zero(products->rows(), products->cols());
  const auto end_block = [&](const Matrix& sums, ScoreShare* share) {
    Vector score = Vector::Zero(tables.columns);
    for (Eigen::Index c = 0; c < sums.cols(); ++c) {
      const Matrix& table = tables.derivatives[static_cast<size_t>(c)];
      if (table.size() > 0) score += table.transpose() * sums.col(c);
    }
    share->products.selfadjointView<Eigen::Lower>().rankUpdate(
        Vector(projection.transpose() * score));
    share->count += 1.0;
  };
  const HistoryPass pass(response_, tables.contents, grid_, 0, samples,
                         tables.OperationsOf(2));
  const int num_shares =
      HistoryPass::NumShares(0, pass.num_pieces(), num_threads);
  std::vector<ScoreShare> shares(static_cast<size_t>(num_shares), zero);
  pass.Visit(0, pass.num_pieces(), num_shares,
             [&](int s, Eigen::Index first, const Matrix& histories) {
               ScoreShare* share = &shares[static_cast<size_t>(s)];
               const Matrix residuals = Residuals(tables, first, histories);
               const Eigen::Index last = first + histories.cols();
               for (Eigen::Index from = first; from < last;) {
                 const Eigen::Index to =
                     std::min(last, from + length - from % length);
                 share->tail.noalias() +=
                     histories.middleCols(from - first, to - from) *
                     residuals.middleCols(from - first, to - from).transpose();
                 from = to;
                 if (to % length != 0 && to != samples) continue;
                 if (share->has_head) {
                   end_block(share->tail, share);
                 } else {
                   share->head = share->tail;
                   share->has_head = true;
                 }
                 share->tail.setZero();
               }
             });
  Matrix begun = zero.tail;
  for (ScoreShare& share : shares) {
    if (!share.has_head) {
      begun += share.tail;
      continue;
    }
    end_block(begun + share.head, &share);
    begun = share.tail;
    *products += share.products;
    *count += share.count;
  }
  return true;
}

}  // namespace pinode
