#include "pinode/study/laws/score_without_fit.h"

#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/start/free_run_start.h"

namespace pinode {
namespace {

Vector NoiseOf(const IdentificationRecord& record, const RecordScore& score) {
  Vector sigmas(static_cast<int>(record.channels.size()));
  for (Eigen::Index k = 0; k < sigmas.size(); ++k) {
    const MeasuredChannel& channel = record.channels[static_cast<size_t>(k)];
    Vector residual = score.prediction.row(k).transpose() - channel.values;
    for (double& value : residual) value = std::isfinite(value) ? value : 0.0;
    sigmas[k] = channel.sigma;
    if (!(sigmas[k] > 0.0)) {
      sigmas[k] = std::sqrt(MemorylessMeanSquare(residual));
    }
    if (!(sigmas[k] > 0.0)) sigmas[k] = 1.0;
  }
  return sigmas;
}

}  // namespace

bool ScoreWithoutFit(const IdentificationProblem& problem,
                     IdentifiedModel* model, std::vector<RecordScore>* scores) {
  const size_t num_records = problem.records.size();
  scores->resize(num_records);
  model->sigmas.resize(num_records);
  model->starts.resize(num_records);
  for (size_t r = 0; r < num_records; ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const int index = static_cast<int>(r);
    Vector& start = model->starts[r];
    if (start.size() != problem.dynamics->num_states()) {
      FreeRunStart(problem, index, model->parameters,
                   Vector::Ones(static_cast<int>(record.channels.size())),
                   &start);
    }
    RecordScore& score = (*scores)[r];
    ScoreRecord(problem, index, model->parameters, start, 0, &score);
    if (!score.finite) return false;
    model->sigmas[r] = NoiseOf(record, score);
  }
  return true;
}

}  // namespace pinode
