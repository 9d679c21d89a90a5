#include "pinode/study/problem/simulation.h"

#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/start/free_run_start.h"

namespace pinode {
namespace {

// Returns the start of the response: rest, unless the record determines
// another.
Vector ResponseStart(const IdentificationProblem& problem, int r,
                     const Vector& parameters, std::string* remark) {
  const IdentificationRecord& record = problem.records[static_cast<size_t>(r)];
  if (record.start == IdentificationRecord::Start::kKnown) {
    return record.known_start;
  }
  if (record.excitation->periodic()) {
    Vector start;
    if (FindSteadyState(problem, r, parameters, &start)) return start;
    *remark = "no steady state was found, so it is simulated from rest";
  } else if (record.start == IdentificationRecord::Start::kFree) {
    *remark = "its start is unknown, so it is simulated from rest";
  }
  return Vector::Zero(problem.dynamics->num_states());
}

}  // namespace

void SensorNoise::AddTo(double percent, Vector* values) {
  const double spread = StandardDeviationOfPresent(*values);
  for (double& value : *values) value += 0.01 * percent * spread * Gaussian();
}

double SensorNoise::Gaussian() {
  // Box-Muller; the second number is not kept.
  // Two statements: compilers may evaluate factors in either order.
  const double radius = std::sqrt(-2.0 * std::log(Uniform()));
  return radius * std::cos(kTwoPi * Uniform());
}

double SensorNoise::Uniform() {
  return (static_cast<double>(random_() >> 11) + 0.5) * 0x1.0p-53;
}

double OwnNoisePercent(const MeasuredChannel& channel, const Vector& values) {
  const double spread = StandardDeviationOfPresent(values);
  if (!(spread > 0.0)) return 0.0;
  return 100.0 * channel.sigma /
         (std::abs(channel.description.factor) * spread);
}

SimulatedResponse SimulateRecord(const IdentificationProblem& problem,
                                 int record, const Vector& parameters) {
  SimulatedResponse response;
  RecordScore score;
  ScoreRecord(problem, record, parameters,
              ResponseStart(problem, record, parameters, &response.remark), 0,
              &score);
  response.finite = score.finite;
  while (response.first_not_finite + 1 < score.prediction.cols() &&
         score.prediction.col(response.first_not_finite).allFinite()) {
    ++response.first_not_finite;
  }
  response.sensors = std::move(score.prediction);
  response.states = std::move(score.states);
  const std::vector<MeasuredChannel>& channels =
      problem.records[static_cast<size_t>(record)].channels;
  for (size_t i = 0; i < channels.size(); ++i) {
    response.sensors.row(static_cast<Eigen::Index>(i)) /=
        channels[i].description.factor;
  }
  return response;
}

}  // namespace pinode
