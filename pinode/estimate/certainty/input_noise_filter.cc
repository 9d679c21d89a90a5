#include "pinode/estimate/certainty/input_noise_filter.h"

#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {

InputNoiseFilter::InputNoiseFilter(const LinearizedRecord& record,
                                   const Vector& input_sigmas,
                                   const Vector& start_sigmas,
                                   const Matrix& noise)
    : record_(record),
      num_channels_(static_cast<int>(noise.rows())),
      num_states_(static_cast<int>(start_sigmas.size())),
      num_inputs_(static_cast<int>(input_sigmas.size())) {
  const auto samples = static_cast<Eigen::Index>(record.samples.size());
  const int size = num_states_ + num_inputs_;
  CHECK_EQ(noise.cols(), samples);
  const Matrix input_variance = input_sigmas.cwiseAbs2().asDiagonal();
  Matrix variance = Matrix::Zero(size, size);
  variance.topLeftCorner(num_states_, num_states_) =
      start_sigmas.cwiseAbs2().asDiagonal();
  variance.bottomRightCorner(num_inputs_, num_inputs_) = input_variance;
  updates_.resize(static_cast<size_t>(samples));
  for (Eigen::Index i = 0; i < samples; ++i) {
    const LinearizedRecord::Sample& sample =
        record.samples[static_cast<size_t>(i)];
    Update& update = updates_[static_cast<size_t>(i)];
    for (int c = 0; c < num_channels_; ++c) {
      if (!std::isnan(noise(c, i))) update.rows.push_back(c);
    }
    const int rows = static_cast<int>(update.rows.size());
    update.by_all.resize(rows, size);
    Vector noise_variance(rows);
    for (int k = 0; k < rows; ++k) {
      const int c = update.rows[static_cast<size_t>(k)];
      update.by_all.row(k).head(num_states_) = sample.by_state.row(c);
      update.by_all.row(k).tail(num_inputs_) = sample.by_input.row(c);
      noise_variance[k] = noise(c, i) * noise(c, i);
    }
    update.variance = variance;
    if (rows > 0) {
      const Matrix cross = variance * update.by_all.transpose();
      Matrix innovation = update.by_all * cross;
      innovation.diagonal() += noise_variance;
      update.innovation.compute(innovation);
      update.gain = update.innovation.solve(cross.transpose()).transpose();
      // Joseph's form keeps the variance positive.
      const Matrix rest =
          Matrix::Identity(size, size) - update.gain * update.by_all;
      variance =
          rest * variance * rest.transpose() +
          update.gain * noise_variance.asDiagonal() * update.gain.transpose();
    }
    if (i + 1 == samples) break;
    const Matrix transition = Transition(i);
    Matrix fresh(size, num_inputs_);
    fresh.topRows(num_states_) = sample.right;
    fresh.bottomRows(num_inputs_).setIdentity();
    variance = transition * variance * transition.transpose() +
               fresh * input_variance * fresh.transpose();
  }
}

Matrix InputNoiseFilter::Transition(Eigen::Index sample) const {
  const LinearizedRecord::Sample& at =
      record_.samples[static_cast<size_t>(sample)];
  const int size = num_states_ + num_inputs_;
  Matrix transition = Matrix::Zero(size, size);
  transition.topLeftCorner(num_states_, num_states_) = at.transition;
  transition.topRightCorner(num_states_, num_inputs_) = at.left;
  return transition;
}

Matrix InputNoiseFilter::Rows(const Update& update, Eigen::Index first,
                              const Matrix& columns) {
  Matrix rows(update.rows.size(), columns.cols());
  for (size_t k = 0; k < update.rows.size(); ++k) {
    rows.row(static_cast<int>(k)) = columns.row(first + update.rows[k]);
  }
  return rows;
}

Matrix InputNoiseFilter::Information(const Matrix& columns) const {
  CHECK_EQ(columns.rows(),
           num_channels_ * static_cast<Eigen::Index>(updates_.size()));
  Matrix information = Matrix::Zero(columns.cols(), columns.cols());
  Matrix state = Matrix::Zero(num_states_ + num_inputs_, columns.cols());
  for (size_t i = 0; i < updates_.size(); ++i) {
    const Update& update = updates_[i];
    const auto sample = static_cast<Eigen::Index>(i);
    if (!update.rows.empty()) {
      Matrix innovation =
          Rows(update, sample * num_channels_, columns) - update.by_all * state;
      state.noalias() += update.gain * innovation;
      update.innovation.matrixL().solveInPlace(innovation);
      information.selfadjointView<Eigen::Lower>().rankUpdate(
          innovation.transpose());
    }
    if (i + 1 < updates_.size()) state = Transition(sample) * state;
  }
  return information.selfadjointView<Eigen::Lower>();
}

void InputNoiseFilter::Smooth(const Vector& residuals, Matrix* errors,
                              Vector* noise_mean_square) const {
  const auto samples = static_cast<Eigen::Index>(updates_.size());
  const int size = num_states_ + num_inputs_;
  CHECK_EQ(residuals.size(), num_channels_ * samples);
  // Forward: the innovations, and the state before each update.
  std::vector<Vector> predicted(updates_.size());
  std::vector<Vector> innovations(updates_.size());
  Vector state = Vector::Zero(size);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const Update& update = updates_[static_cast<size_t>(i)];
    predicted[static_cast<size_t>(i)] = state;
    if (!update.rows.empty()) {
      Vector& innovation = innovations[static_cast<size_t>(i)];
      innovation =
          Rows(update, i * num_channels_, residuals) - update.by_all * state;
      state += update.gain * innovation;
    }
    if (i + 1 < samples) state = Transition(i) * state;
  }
  // Backward, in the form that inverts no variance of the state (G. J. Bierman,
  // Int. J. Control 18 (1973) 65-75): at rest it is singular.
  errors->resize(num_inputs_, samples);
  *noise_mean_square = Vector::Zero(num_channels_);
  Vector count = Vector::Zero(num_channels_);
  Vector adjoint = Vector::Zero(size);
  Matrix adjoint_variance = Matrix::Zero(size, size);
  for (Eigen::Index i = samples - 1; i >= 0; --i) {
    const Update& update = updates_[static_cast<size_t>(i)];
    if (i + 1 < samples) {
      const Matrix transition = Transition(i);
      adjoint = transition.transpose() * adjoint;
      adjoint_variance = transition.transpose() * adjoint_variance * transition;
    }
    if (!update.rows.empty()) {
      const Matrix rest =
          Matrix::Identity(size, size) - update.gain * update.by_all;
      adjoint =
          update.by_all.transpose() *
              update.innovation.solve(innovations[static_cast<size_t>(i)]) +
          rest.transpose() * adjoint;
      adjoint_variance =
          update.by_all.transpose() * update.innovation.solve(update.by_all) +
          rest.transpose() * adjoint_variance * rest;
    }
    const Vector smoothed =
        predicted[static_cast<size_t>(i)] + update.variance * adjoint;
    errors->col(i) = smoothed.tail(num_inputs_);
    if (update.rows.empty()) continue;
    const Matrix variance =
        update.variance - update.variance * adjoint_variance * update.variance;
    const Vector left =
        Rows(update, i * num_channels_, residuals) - update.by_all * smoothed;
    const Vector spread =
        (update.by_all * variance * update.by_all.transpose()).diagonal();
    for (size_t k = 0; k < update.rows.size(); ++k) {
      const int row = static_cast<int>(k);
      (*noise_mean_square)[update.rows[k]] +=
          left[row] * left[row] + spread[row];
      count[update.rows[k]] += 1.0;
    }
  }
  *noise_mean_square = noise_mean_square->cwiseQuotient(count.cwiseMax(1.0));
}

}  // namespace pinode
