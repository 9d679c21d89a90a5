#include "pinode/modal/mode_estimate.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "pinode/base/statistics.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Converts the shape and its influences to displacements, with largest entry 1.
void InDisplacements(const ResponseRecord& record, const Vector& scales,
                     SubspacePole* pole) {
  for (Eigen::Index c = 0; c < pole->shape.size(); ++c) {
    const int d = record.channels[static_cast<size_t>(c)].derivative;
    const Complex factor = scales[c] / std::pow(pole->s, d);
    pole->shape[c] *= factor;
    pole->shape_influence.row(c) *= factor;
    pole->shape_influence.row(c) -= static_cast<double>(d) * pole->shape[c] /
                                    pole->s * pole->s_influence.transpose();
  }
}

// |phi^T phi|^2 / |phi|^4.
double PhaseCollinearity(const Eigen::VectorXcd& shape) {
  const double size = shape.squaredNorm();
  const Complex product = shape.transpose() * shape;
  return size > 0.0 ? std::norm(product) / (size * size) : 0.0;
}

}  // namespace

IdentifiedMode MakeMode(const ResponseRecord& record, const Vector& scales,
                        double sampling_step, const PoleCluster& cluster,
                        int max_order, double window_seconds) {
  SubspacePole pole = cluster.mean;
  InDisplacements(record, scales, &pole);
  int largest = 0;
  pole.shape.cwiseAbs().maxCoeff(&largest);
  const PoleMoments moments =
      FindPoleMoments(NormalisedPole(pole, largest), window_seconds);
  IdentifiedMode mode;
  mode.frequency_hz = pole.frequency();
  mode.damping_ratio = pole.damping_ratio();
  mode.shape = pole.shape / pole.shape[largest];
  mode.shape[largest] = 1.0;
  mode.covariance = moments.covariance;
  mode.degrees_of_freedom = moments.degrees_of_freedom;
  const Vector sigmas = moments.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Index channels = mode.shape.size();
  mode.frequency_sigma = sigmas[0];
  mode.damping_sigma = sigmas[1];
  mode.shape_sigma_real = sigmas.segment(2, channels);
  mode.shape_sigma_imaginary = sigmas.tail(channels);
  const double t = StudentQuantile(mode.degrees_of_freedom);
  mode.frequency_lower95 = mode.frequency_hz - t * mode.frequency_sigma;
  mode.frequency_upper95 = mode.frequency_hz + t * mode.frequency_sigma;
  mode.damping_lower95 =
      std::max(0.0, mode.damping_ratio - t * mode.damping_sigma);
  mode.damping_upper95 = mode.damping_ratio + t * mode.damping_sigma;
  mode.orders_seen = static_cast<int>(cluster.members.size());
  mode.orders_possible = (max_order - cluster.first_order) / 2 + 1;
  mode.frequency_spread = cluster.frequency_spread;
  mode.damping_spread = cluster.damping_spread;
  mode.phase_collinearity = PhaseCollinearity(mode.shape);
  mode.sampling_step = sampling_step;
  return mode;
}

bool IsSameMode(const IdentifiedMode& a, const IdentifiedMode& b) {
  const double apart = std::abs(a.frequency_hz - b.frequency_hz);
  const double sigma = std::hypot(a.frequency_sigma, b.frequency_sigma);
  return apart < std::max(3.0 * sigma, 0.003 * a.frequency_hz) &&
         ComplexMac(a.shape, b.shape) > 0.8;
}

void CheckMode(const PoleCluster& cluster,
               const std::vector<SubspacePole>& poles, int max_order,
               const StabilisationOptions& options, IdentifiedMode* mode) {
  const SubspacePole& mean = cluster.mean;
  struct Nearest {
    double distance = 0.0;
    double frequency_hz = 0.0;
    double damping_ratio = 0.0;
  };
  std::map<int, Nearest> by_order;
  for (const SubspacePole& pole : poles) {
    const double apart = std::abs(pole.frequency() / mean.frequency() - 1.0);
    if (apart > options.frequency_tolerance) continue;
    const double mac = ComplexMac(pole.shape, mean.shape);
    if (mac < options.smallest_mac) continue;
    const double distance =
        apart / options.frequency_tolerance +
        (1.0 - mac) / (1.0 - options.smallest_mac) +
        std::abs(pole.damping_ratio() - mean.damping_ratio()) /
            options.frequency_tolerance;
    const Nearest next = {distance, pole.frequency(), pole.damping_ratio()};
    const auto [place, added] = by_order.insert({pole.order, next});
    if (!added && distance < place->second.distance) place->second = next;
  }
  const int orders = max_order / 2;
  if (static_cast<double>(by_order.size()) <
      options.smallest_share_of_all * orders) {
    return;
  }
  std::vector<double> frequencies;
  std::vector<double> ratios;
  for (const auto& [order, nearest] : by_order) {
    frequencies.push_back(nearest.frequency_hz);
    ratios.push_back(nearest.damping_ratio);
  }
  mode->check_frequency_hz = Median(frequencies);
  mode->check_damping_ratio = Median(ratios);
}

}  // namespace pinode
