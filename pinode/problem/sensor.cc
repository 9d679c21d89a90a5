#include "pinode/problem/sensor.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Lagrange weights, and their derivatives, of the nodes 0, 1, 2, 3 at u.
void CubicWeights(double u, double* weight, double* slope) {
  for (int a = 0; a < 4; ++a) {
    double value = 1.0;
    double derivative = 0.0;
    for (int b = 0; b < 4; ++b) {
      if (b == a) continue;
      const double factor = (u - b) / (a - b);
      derivative = derivative * factor + value / (a - b);
      value *= factor;
    }
    weight[a] = value;
    slope[a] = derivative;
  }
}

// Delays one channel; rows and derivative as in ApplySensors.
void DelayChannel(int channel, int channels, double delay, double dt,
                  ParameterLayout::Dependence by_delay,
                  Eigen::Ref<Vector> prediction, Eigen::Ref<Matrix> rows,
                  std::vector<bool>* valid) {
  const Eigen::Index samples = prediction.size() / channels;
  Vector before(samples);
  Matrix rows_before(samples, rows.cols());
  for (Eigen::Index i = 0; i < samples; ++i) {
    before[i] = prediction[i * channels + channel];
    rows_before.row(i) = rows.row(i * channels + channel);
  }
  for (Eigen::Index i = 0; i < samples; ++i) {
    const Eigen::Index row = i * channels + channel;
    const double position = static_cast<double>(i) - delay / dt;
    if (samples < 4 || position < -0.5 ||
        position > static_cast<double>(samples) - 0.5) {
      (*valid)[static_cast<size_t>(row)] = false;
      continue;
    }
    const auto first = std::clamp<Eigen::Index>(
        static_cast<Eigen::Index>(std::floor(position)) - 1, 0, samples - 4);
    double weight[4], slope[4];
    CubicWeights(position - static_cast<double>(first), weight, slope);
    double value = 0.0;
    double rate = 0.0;
    rows.row(row).setZero();
    for (int a = 0; a < 4; ++a) {
      value += weight[a] * before[first + a];
      rate += slope[a] * before[first + a];
      rows.row(row) += weight[a] * rows_before.row(first + a);
    }
    prediction[row] = value;
    if (by_delay.free >= 0) {
      rows(row, by_delay.free) -= by_delay.factor * rate / dt;
    }
  }
}

}  // namespace

void ApplySensors(const ParameterLayout& layout, const Vector& parameters,
                  const IdentificationRecord& record, bool with_parameters,
                  Eigen::Ref<Vector> prediction, Eigen::Ref<Matrix> rows,
                  std::vector<bool>* valid) {
  const int channels = static_cast<int>(record.channels.size());
  const Eigen::Index samples = prediction.size() / channels;
  const int first_free = static_cast<int>(rows.cols()) - layout.num_free();
  // Column of a sensor parameter, or of the parameter that it is tied to; -1
  // where fixed or not asked for.
  const auto column = [&](int sensor) {
    if (sensor < 0 || !with_parameters) return ParameterLayout::Dependence();
    ParameterLayout::Dependence result =
        layout.DependenceOf(layout.num_dynamics() + sensor);
    if (result.free >= 0) result.free += first_free;
    return result;
  };
  const auto value = [&](int sensor) {
    return parameters[layout.num_dynamics() + sensor];
  };
  for (int c = 0; c < channels; ++c) {
    const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
    if (channel.delay >= 0) {
      DelayChannel(c, channels, value(channel.delay), record.sampling_step(),
                   column(channel.delay), prediction, rows, valid);
    }
    if (channel.gain >= 0) {
      const double gain = value(channel.gain);
      const ParameterLayout::Dependence by_gain = column(channel.gain);
      for (Eigen::Index i = 0; i < samples; ++i) {
        const Eigen::Index row = i * channels + c;
        rows.row(row) *= gain;
        if (by_gain.free >= 0) {
          rows(row, by_gain.free) += by_gain.factor * prediction[row];
        }
        prediction[row] *= gain;
      }
    }
    if (channel.offset >= 0) {
      const ParameterLayout::Dependence by_offset = column(channel.offset);
      for (Eigen::Index i = 0; i < samples; ++i) {
        const Eigen::Index row = i * channels + c;
        prediction[row] += value(channel.offset);
        if (by_offset.free >= 0) {
          rows(row, by_offset.free) += by_offset.factor;
        }
      }
    }
  }
}

}  // namespace pinode
