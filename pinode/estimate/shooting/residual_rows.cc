#include "pinode/estimate/shooting/residual_rows.h"

#include <algorithm>
#include <cmath>

#include "pinode/problem/sensor.h"

namespace pinode {
namespace {

// Channel by channel over all samples, derivatives like predictions.
void FilterHistories(const ZeroPhaseFilter& filter, int num_channels,
                     Vector* prediction, Eigen::Ref<Matrix> rows) {
  const Eigen::Index samples = prediction->size() / num_channels;
  Matrix history(samples, 1 + rows.cols());
  for (int c = 0; c < num_channels; ++c) {
    for (Eigen::Index i = 0; i < samples; ++i) {
      history(i, 0) = (*prediction)[i * num_channels + c];
      history.row(i).tail(rows.cols()) = rows.row(i * num_channels + c);
    }
    filter.Apply(&history);
    for (Eigen::Index i = 0; i < samples; ++i) {
      (*prediction)[i * num_channels + c] = history(i, 0);
      rows.row(i * num_channels + c) = history.row(i).tail(rows.cols());
    }
  }
}

// Whether derivatives are something else behind the sensors than before them.
bool ChangesRows(const IdentificationRecord& record, bool whole) {
  return (record.filter != nullptr && whole) ||
         std::any_of(record.channels.begin(), record.channels.end(),
                     [](const MeasuredChannel& channel) {
                       return channel.delay >= 0 || channel.gain >= 0 ||
                              channel.offset >= 0;
                     });
}

}  // namespace

void AddSensorColumns(const ParameterLayout& layout, int num_states,
                      SegmentColumns columns, const Matrix& tangents,
                      Matrix* result) {
  if (!HasParameters(columns)) {
    *result = tangents;
    return;
  }
  // The dynamics' tangent columns are its free parameters, which come first.
  const int by_start = HasStart(columns) ? num_states : 0;
  result->resize(tangents.rows(), by_start + layout.num_free());
  result->leftCols(tangents.cols()) = tangents;
  result->rightCols(result->cols() - tangents.cols()).setZero();
}

ResidualRows::ResidualRows(const ParameterLayout& layout, RobustLoss loss,
                           double loss_scale)
    : layout_(layout), loss_(loss), loss_scale_(loss_scale) {}

void ResidualRows::Prepare(const IdentificationRecord& record,
                           const Vector& sigmas, bool whole, int num_states,
                           SegmentColumns columns,
                           SegmentTangents* tangents) const {
  const bool by_parameters = HasParameters(columns);
  const Eigen::Index derivatives = (HasStart(columns) ? num_states : 0) +
                                   (by_parameters ? layout_.num_free() : 0);
  const Eigen::Index sensors =
      by_parameters ? layout_.num_free() - layout_.num_free_dynamics() : 0;
  tangents->columns_before = WholeFours(derivatives + 1) - 1 - derivatives;
  tangents->columns_behind = sensors + 1;
  tangents->factors = sigmas.cwiseInverse();
  if (ChangesRows(record, whole)) tangents->factors.resize(0);
}

void ResidualRows::Compute(const IdentificationRecord& record,
                           const Vector& sigmas, const Vector& parameters,
                           Eigen::Index first, bool whole,
                           SegmentColumns columns, SegmentTangents* tangents) {
  const int nc = static_cast<int>(tangents->channels.rows());
  const Eigen::Index samples = tangents->channels.cols();
  const bool weighted = tangents->factors.size() > 0;
  const Eigen::Index sensors = tangents->columns_behind - 1;
  rows_.first = tangents->columns_before;
  rows_.values.swap(tangents->rows);
  const Eigen::Index all = rows_.values.cols();
  rows_.values.leftCols(rows_.first).setZero();
  auto jacobian = rows_.values.middleCols(rows_.first, all - 1 - rows_.first);
  auto residuals = rows_.values.col(all - 1);
  jacobian.rightCols(sensors).setZero();
  // Predictions of real sensors, sample-major as the rows are.
  Vector prediction = Eigen::Map<const Vector>(tangents->channels.data(),
                                               tangents->channels.size());
  std::vector<bool> valid(
      static_cast<size_t>(nc) * static_cast<size_t>(samples), true);
  if (ChangesRows(record, whole)) {
    ApplySensors(layout_, parameters, record, HasParameters(columns),
                 prediction, jacobian, &valid);
  }
  if (record.filter != nullptr && whole) {
    FilterHistories(*record.filter, nc, &prediction, jacobian);
  }

  cost_ = 0.0;
  Vector weights(nc * samples);  // of the derivatives
  bool all_one = weighted;
  for (Eigen::Index i = 0; i < samples; ++i) {
    for (int c = 0; c < nc; ++c) {
      const Eigen::Index row = i * nc + c;
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      const double value = channel.values[first + i];
      if (!channel.fit || !valid[static_cast<size_t>(row)] ||
          std::isnan(value)) {
        residuals[row] = 0.0;
        weights[row] = 0.0;
        all_one = false;
        continue;
      }
      const double residual = (prediction[row] - value) / sigmas[c];
      double rho, slope;
      EvaluateRobustLoss(loss_, loss_scale_, residual * residual, &rho, &slope);
      cost_ += 0.5 * rho;
      const double root = std::sqrt(slope);
      residuals[row] = residual * root;
      weights[row] = weighted ? root : root / sigmas[c];
      all_one = all_one && root == 1.0;
    }
  }
  if (!all_one) jacobian.array().colwise() *= weights.array();
}

}  // namespace pinode
