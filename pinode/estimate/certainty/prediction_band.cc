#include "pinode/estimate/certainty/prediction_band.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/start/initial_states.h"

namespace pinode {
namespace {

// Largest number of derivatives that are computed.
constexpr double kMostNumbers = 3e7;
// Change of a start as a share of its state's RMS.
constexpr double kStartStep = 1e-4;

// Returns row * covariance * row' of each row.
Vector RowVariances(const Matrix& rows, const Matrix& covariance) {
  return (rows * covariance).cwiseProduct(rows).rowwise().sum();
}

// Returns the parameters' part of the prediction's variances over those of the
// noise, channels x samples; empty if the run is not finite.
Matrix ParameterVariances(const IdentificationProblem& problem, int record,
                          const Vector& parameters, const Matrix& covariance,
                          const Vector& sigmas, const RecordScore& score,
                          int num_threads) {
  IdentificationProblem alone = problem;
  alone.records = {problem.records[static_cast<size_t>(record)]};
  IdentificationRecord& data = alone.records[0];
  data.role = IdentificationRecord::Role::kTrain;
  if (data.start == IdentificationRecord::Start::kFree) {
    data.start = IdentificationRecord::Start::kKnown;
    data.known_start = score.start;
  }
  // Every sample has a prediction, measured or not.
  for (MeasuredChannel& channel : data.channels) {
    channel.values.setZero();
    channel.fit = true;
  }
  alone.modal = ModalData();
  const ParameterLayout layout(alone);
  // A known start depends on no parameter, so nothing is linearised before it.
  MultipleShooting::Options options;
  options.num_threads = num_threads;
  MultipleShooting shooting(alone, layout, options);
  shooting.SetSigmas({sigmas});
  shooting.SetStateScales({StateScalesOf(alone, score.state_mean_squares)});
  shooting.SetWholeRecords({score.start});
  if (layout.num_free() != covariance.rows()) return Matrix();
  Matrix variances(score.prediction.rows(), score.prediction.cols());
  if (!shooting.VisitWeightedResiduals(
          layout.Free(parameters), true,
          [&](size_t, Eigen::Index first, const Matrix& part,
              const Matrix& rows) {
            const Vector values = RowVariances(rows, covariance);
            variances.middleCols(first, part.cols()) = Eigen::Map<const Matrix>(
                values.data(), part.rows(), part.cols());
          },
          num_threads)) {
    return Matrix();
  }
  return variances;
}

// Returns the derivatives by the start, in units of `scales`. They are
// one-sided differences, whose error is a share kStartStep of the run's
// nonlinearity in its start.
Matrix StartRows(const IdentificationProblem& problem, int record,
                 const Vector& parameters, const Vector& sigmas,
                 const Vector& scales, const RecordScore& score) {
  Matrix rows(score.prediction.size(), scales.size());
  for (Eigen::Index k = 0; k < scales.size(); ++k) {
    Vector start = score.start;
    start[k] += kStartStep * scales[k];
    RecordScore moved;
    ScoreRecord(problem, record, parameters, start, score.first_scored_sample,
                &moved, Keep::kChannels);
    if (!moved.finite) return Matrix();
    const Matrix slope = sigmas.cwiseInverse().asDiagonal() *
                         (moved.prediction - score.prediction) / kStartStep;
    rows.col(k) = Eigen::Map<const Vector>(slope.data(), slope.size());
  }
  return rows;
}

// Returns the covariance of the start in units of its scales, which are its
// prior's deviations, from the samples that determine the start.
Matrix StartCovariance(const IdentificationRecord& data, const Matrix& rows,
                       const RecordScore& score) {
  const int nc = static_cast<int>(data.channels.size());
  const Eigen::Index samples = data.role == IdentificationRecord::Role::kTrain
                                   ? data.num_samples()
                                   : score.first_scored_sample;
  Matrix information = Matrix::Identity(rows.cols(), rows.cols());
  for (Eigen::Index i = 0; i < samples; ++i) {
    for (int c = 0; c < nc; ++c) {
      const MeasuredChannel& channel = data.channels[static_cast<size_t>(c)];
      if (!channel.fit || std::isnan(channel.values[i])) continue;
      const RowVector row = rows.row(i * nc + c);
      information.noalias() += row.transpose() * row;
    }
  }
  Matrix root, null_space;
  if (!InvertInformation(information, &root, &null_space)) return Matrix();
  return root * root.transpose();
}

}  // namespace

Matrix PredictionDeviations(const IdentificationProblem& problem, int record,
                            const Vector& parameters, const Matrix& covariance,
                            const Vector& sigmas, const RecordScore& score,
                            int num_threads) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  const double numbers = static_cast<double>(score.prediction.size()) *
                         static_cast<double>(covariance.cols());
  if (!score.finite || numbers > kMostNumbers || !(sigmas.minCoeff() > 0.0)) {
    return Matrix();
  }
  Matrix variances = ParameterVariances(problem, record, parameters, covariance,
                                        sigmas, score, num_threads);
  if (variances.size() == 0) return Matrix();
  if (data.start == IdentificationRecord::Start::kFree &&
      !(data.excitation->periodic() && score.first_scored_sample == 0 &&
        data.role == IdentificationRecord::Role::kHoldout)) {
    const Matrix starts =
        StartRows(problem, record, parameters, sigmas,
                  StateScalesOf(problem, score.state_mean_squares), score);
    if (starts.size() == 0) return Matrix();
    const Matrix start_covariance = StartCovariance(data, starts, score);
    if (start_covariance.size() == 0) return Matrix();
    variances.reshaped() += RowVariances(starts, start_covariance);
  }
  variances = (variances.array().max(0.0) + 1.0).sqrt();
  variances.array().colwise() *= sigmas.array();
  return variances;
}

double BandCoverage(const IdentificationRecord& record,
                    const RecordScore& score, int channel, double quantile) {
  if (score.deviations.size() == 0) return kNaN;
  const Vector& values = record.channels[static_cast<size_t>(channel)].values;
  Eigen::Index count = 0;
  Eigen::Index inside = 0;
  for (Eigen::Index i = score.first_scored_sample; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    ++count;
    inside += std::abs(values[i] - score.prediction(channel, i)) <=
              quantile * score.deviations(channel, i);
  }
  return count > 0 ? static_cast<double>(inside) / static_cast<double>(count)
                   : kNaN;
}

}  // namespace pinode
