#include "pinode/estimate/shooting/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/problem/record_grid.h"
#include "pinode/problem/sensor.h"

namespace pinode {
namespace {

// Infinite errors, and what there is of the trajectory.
void ScoreDivergence(const IdentificationRecord& data,
                     const Trajectory& trajectory, RecordScore* score) {
  const Eigen::Index samples = data.num_samples();
  score->prediction =
      Matrix::Constant(static_cast<int>(data.channels.size()), samples,
                       std::numeric_limits<double>::quiet_NaN());
  if (trajectory.channels.cols() == samples) {
    score->prediction = trajectory.channels;
    score->states = trajectory.states;
    score->start = score->states.col(0);  // with what is prescribed of it
  }
  score->nrmse = kInfinity;
  for (size_t c = 0; c < data.channels.size(); ++c) {
    score->channels[c].name = data.channels[c].observation.name;
    score->channels[c].fitted = data.channels[c].fit;
    score->channels[c].rmse = kInfinity;
    score->channels[c].nrmse = kInfinity;
  }
}

// Errors alone, from sums of squares of the fitted channels' residuals. False
// where delays leave out samples.
bool ScoreSquares(const IdentificationRecord& data,
                  const std::vector<SeriesStatistics>& measured,
                  const Vector& squares, RecordScore* score) {
  score->channels.resize(data.channels.size());
  score->finite = squares.allFinite();
  for (size_t c = 0; c < data.channels.size(); ++c) {
    const MeasuredChannel& channel = data.channels[c];
    if (channel.delay >= 0) return false;
    if (!channel.fit) continue;
    const double spread = measured[c].variation;
    score->channels[c].nrmse =
        spread > 0.0 ? std::sqrt(squares[static_cast<Eigen::Index>(c)] / spread)
                     : kInfinity;
  }
  score->nrmse = CombinedError(data, *score);
  return score->finite;
}

// Returns true if residuals are those of free runs: records in one piece,
// no robust loss.
bool HasFreeRuns(const MultipleShooting& shooting) {
  return IsSingleShooting(shooting) &&
         shooting.sweep().options().loss == RobustLoss::kNone;
}

// The record from `start`, seen by ideal sensors. False where the run is not
// finite, and where parameters or start are of another problem.
bool RunFreely(const StructuralDynamics& dynamics,
               const ParameterLayout& layout,
               const IdentificationRecord& record,
               const std::vector<Observation>& sensors,
               const Vector& parameters, const Vector& start, Keep keep,
               int num_threads, Trajectory* trajectory) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  return parameters.size() == layout.num_parameters() &&
         start.size() == dynamics.num_states() &&
         dynamics.Prepare(parameters.head(layout.num_dynamics()), &prepared,
                          &error) &&
         FreeRun(dynamics, prepared, ObservationMap(dynamics, sensors),
                 GridOf(dynamics, record), start, 0, record.num_samples() - 1,
                 trajectory, keep, num_threads);
}

// Turns what ideal sensors would show, channels x samples, into what those of
// the record do. False of an entry where a delayed sensor has none.
std::vector<bool> ShowBySensors(const ParameterLayout& layout,
                                const Vector& parameters,
                                const IdentificationRecord& record,
                                Matrix* shown) {
  Matrix no_rows(shown->size(), 0);
  std::vector<bool> valid(static_cast<size_t>(shown->size()), true);
  ApplySensors(layout, parameters, record, false,
               Eigen::Map<Vector>(shown->data(), shown->size()), no_rows,
               &valid);
  if (record.filter != nullptr) {
    Matrix history = shown->transpose();
    record.filter->Apply(&history);
    *shown = history.transpose();
  }
  return valid;
}

// Returns the part of the record that some of its sensors need to show a run.
// It has nothing that they measured, and not how the record is integrated.
IdentificationRecord WithSensors(const IdentificationRecord& record,
                                 const std::vector<int>& channels) {
  IdentificationRecord result;
  result.excitation = record.excitation;
  result.filter = record.filter;
  for (const int c : channels) {
    const MeasuredChannel& channel = record.channels.at(static_cast<size_t>(c));
    MeasuredChannel sensor;
    sensor.observation = channel.observation;
    sensor.gain = channel.gain;
    sensor.offset = channel.offset;
    sensor.delay = channel.delay;
    result.channels.push_back(std::move(sensor));
  }
  return result;
}

}  // namespace

void ScoreRecord(const IdentificationProblem& problem, int record,
                 const Vector& parameters, const Vector& start,
                 Eigen::Index first_scored_sample, RecordScore* score,
                 Keep keep, int num_threads) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  const ParameterLayout layout(problem);
  score->name = data.name;
  score->role = data.role;
  score->first_scored_sample = first_scored_sample;
  score->start = start;
  score->channels.resize(data.channels.size());

  Trajectory trajectory;
  const int nc = static_cast<int>(data.channels.size());
  const Eigen::Index samples = data.num_samples();
  score->finite =
      RunFreely(*problem.dynamics, layout, data, data.Observations(),
                parameters, start, keep, num_threads, &trajectory);
  if (!score->finite) {
    ScoreDivergence(data, trajectory, score);
    return;
  }
  if (keep == Keep::kAll) {
    score->state_mean_squares =
        trajectory.states.rowwise().squaredNorm() / samples;
    score->states = std::move(trajectory.states);
  } else {
    score->state_mean_squares = std::move(trajectory.mean_squares);
  }
  score->prediction = std::move(trajectory.channels);
  const std::vector<bool> valid =
      ShowBySensors(layout, parameters, data, &score->prediction);
  ParallelFor(nc, num_threads, [&](int c, int) {
    const MeasuredChannel& channel = data.channels[static_cast<size_t>(c)];
    ChannelScore& result = score->channels[static_cast<size_t>(c)];
    result.name = channel.observation.name;
    result.fitted = channel.fit;
    double sum = 0.0;
    double spread = 0.0;
    Eigen::Index count = 0;
    MemorylessPart memoryless;
    const double mean =
        MeanOfPresent(channel.values.tail(samples - first_scored_sample));
    for (Eigen::Index i = first_scored_sample; i < samples; ++i) {
      const double y = channel.values[i];
      if (std::isnan(y) || !valid[static_cast<size_t>(i * nc + c)]) continue;
      const double residual = y - score->prediction(c, i);
      memoryless.Add(residual);
      sum += residual * residual;
      spread += (y - mean) * (y - mean);
      ++count;
    }
    result.rmse = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
    result.nrmse = spread > 0.0 ? std::sqrt(sum / spread) : kInfinity;
    const double noise = memoryless.MeanSquare();
    result.noise_share =
        noise > 0.0 && count > 0
            ? std::min(1.0, noise * static_cast<double>(count) / sum)
            : kNaN;
  });
  score->nrmse = CombinedError(data, *score);
}

Matrix PredictChannels(const IdentificationProblem& problem, int record,
                       const std::vector<int>& channels,
                       const Vector& parameters, const Vector& start,
                       int num_threads) {
  if (channels.empty()) return Matrix();
  const IdentificationRecord& whole =
      problem.records.at(static_cast<size_t>(record));
  const IdentificationRecord some = WithSensors(whole, channels);
  const ParameterLayout layout(problem);
  Trajectory trajectory;
  if (!RunFreely(*problem.dynamics, layout, whole, some.Observations(),
                 parameters, start, Keep::kChannels, num_threads,
                 &trajectory)) {
    return Matrix();
  }
  ShowBySensors(layout, parameters, some, &trajectory.channels);
  return std::move(trajectory.channels);
}

double FreeRunError(const IdentificationProblem& problem,
                    const ParameterLayout& layout,
                    const MultipleShooting& shooting, const Vector& free) {
  Vector parameters = layout.InitialValues();
  layout.SetFree(free, &parameters);
  const std::vector<int>& train = shooting.train_records();
  if (train.empty()) return 0.0;
  const std::vector<Vector>* squares =
      HasFreeRuns(shooting) ? shooting.state().SquaresAt(free) : nullptr;
  double sum = 0.0;
  for (size_t t = 0; t < train.size(); ++t) {
    RecordScore score;
    if (squares != nullptr &&
        ScoreSquares(problem.records[static_cast<size_t>(train[t])],
                     shooting.record(t).measured(), (*squares)[t], &score)) {
      sum += score.nrmse * score.nrmse;
      continue;
    }
    ScoreRecord(problem, train[t], parameters, shooting.starts()[t].col(0), 0,
                &score, Keep::kChannels,
                shooting.sweep().options().num_threads);
    if (!score.finite) return kInfinity;
    sum += score.nrmse * score.nrmse;
  }
  return std::sqrt(sum / static_cast<double>(train.size()));
}

double CombinedError(const IdentificationRecord& record,
                     const RecordScore& score) {
  if (!score.finite) return kInfinity;
  double sum = 0.0;
  int count = 0;
  for (size_t c = 0; c < record.channels.size(); ++c) {
    // A channel at rest has no spread to compare with.
    if (!record.channels[c].fit || !std::isfinite(score.channels[c].nrmse)) {
      continue;
    }
    sum += score.channels[c].nrmse * score.channels[c].nrmse;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

double NoiseShareOf(const RecordScore& score) {
  double noise = 0.0, all = 0.0;
  for (const ChannelScore& channel : score.channels) {
    const double energy = channel.nrmse * channel.nrmse;
    // Channels that are only predicted are no part of the error either.
    if (!channel.fitted || !std::isfinite(energy * channel.noise_share)) {
      continue;
    }
    all += energy;
    noise += energy * channel.noise_share;
  }
  return all > 0.0 ? noise / all : kNaN;
}

double StructuredError(const RecordScore& score) {
  const double noise = NoiseShareOf(score);
  return std::sqrt(std::isnan(noise) ? 1.0 : 1.0 - noise) * score.nrmse;
}

}  // namespace pinode
