#include "pinode/estimate/residual_rows.h"

#include <cmath>

#include "pinode/estimate/sensor.h"

namespace pinode {
namespace {

// Channel by channel over all samples, derivatives like predictions.
void FilterHistories(const ZeroPhaseFilter& filter, int num_channels,
                     Vector* prediction, Matrix* rows) {
  const int samples = static_cast<int>(prediction->size()) / num_channels;
  Matrix history(samples, 1 + rows->cols());
  for (int c = 0; c < num_channels; ++c) {
    for (int i = 0; i < samples; ++i) {
      history(i, 0) = (*prediction)[i * num_channels + c];
      history.row(i).tail(rows->cols()) = rows->row(i * num_channels + c);
    }
    filter.Apply(&history);
    for (int i = 0; i < samples; ++i) {
      (*prediction)[i * num_channels + c] = history(i, 0);
      rows->row(i * num_channels + c) = history.row(i).tail(rows->cols());
    }
  }
}

}  // namespace

void AddSensorColumns(const ParameterLayout& layout, int num_states,
                      bool with_parameters, const Matrix& tangents,
                      Matrix* result) {
  const int free = with_parameters ? layout.num_free() : 0;
  result->resize(tangents.rows(), num_states + free);
  if (!with_parameters) {
    *result = tangents.leftCols(num_states);
    return;
  }
  // The dynamics' tangent columns are its free parameters, which come first.
  const int known = num_states + layout.num_free_dynamics();
  result->leftCols(known) = tangents.leftCols(known);
  result->rightCols(num_states + free - known).setZero();
}

ResidualRows::ResidualRows(const IdentificationProblem& problem,
                           const ParameterLayout& layout, RobustLoss loss,
                           double loss_scale)
    : problem_(problem),
      layout_(layout),
      loss_(loss),
      loss_scale_(loss_scale) {}

void ResidualRows::Compute(const IdentificationRecord& record,
                           const Vector& sigmas, const Vector& parameters,
                           int first, bool whole, bool with_parameters,
                           const SegmentTangents& tangents) {
  const int nc = static_cast<int>(tangents.channels.rows());
  const int samples = static_cast<int>(tangents.channels.cols());
  AddSensorColumns(layout_, problem_.dynamics->num_states(), with_parameters,
                   tangents.jacobian, &jacobian_);
  // Predictions of real sensors, sample-major as the rows are.
  Vector prediction = Eigen::Map<const Vector>(tangents.channels.data(),
                                               tangents.channels.size());
  std::vector<bool> valid(static_cast<size_t>(nc * samples), true);
  ApplySensors(problem_, layout_, parameters, record, with_parameters,
               &prediction, &jacobian_, &valid);
  if (record.filter != nullptr && whole) {
    FilterHistories(*record.filter, nc, &prediction, &jacobian_);
  }

  cost_ = 0.0;
  residuals_.resize(nc * samples);
  Vector weights(nc * samples);
  for (int i = 0; i < samples; ++i) {
    for (int c = 0; c < nc; ++c) {
      const int row = i * nc + c;
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      const double value = channel.values[first + i];
      if (!channel.fit || !valid[static_cast<size_t>(row)] ||
          std::isnan(value)) {
        residuals_[row] = 0.0;
        weights[row] = 0.0;
        continue;
      }
      const double residual = (prediction[row] - value) / sigmas[c];
      double rho, slope;
      EvaluateRobustLoss(loss_, loss_scale_, residual * residual, &rho, &slope);
      cost_ += 0.5 * rho;
      const double root = std::sqrt(slope);
      residuals_[row] = residual * root;
      weights[row] = root / sigmas[c];
    }
  }
  jacobian_.array().colwise() *= weights.array();
}

}  // namespace pinode
