#include "pinode/modal/stabilisation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/modal/windowed_correlations.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Length of windows in 1 / (2 zeta omega), the memory of a mode's energy. At
// this length they miss at most a tenth of its variance.
constexpr double kMemories = 12.0;
// Standard deviations of a pole from the median over orders, beyond which it is
// not averaged.
constexpr double kFarthestPole = 3.0;

// Rows: frequency (Hz), damping ratio, real and imaginary parts of the shape.
Matrix Influences(const SubspacePole& pole) {
  const Eigen::Index channels = pole.shape.size();
  const Eigen::Index windows = pole.s_influence.size();
  Matrix rows(2 + 2 * channels, windows);
  const double size = std::abs(pole.s);
  const Vector growth =
      (std::conj(pole.s) * pole.s_influence.array()).real() / size;
  rows.row(0) = growth.transpose() / kTwoPi;
  rows.row(1) =
      (-pole.s_influence.real() / size + pole.s.real() / (size * size) * growth)
          .transpose();
  rows.middleRows(2, channels) = pole.shape_influence.real();
  rows.bottomRows(channels) = pole.shape_influence.imag();
  return rows;
}

double SmoothingLength(const SubspacePole& pole, double window_seconds) {
  return kMemories / (2.0 * std::max(-pole.s.real(), 1e-12)) / window_seconds;
}

// Returns columns whose products with themselves sum to the covariance.
Matrix Scatter(const SubspacePole& pole, const Matrix& influences,
               double window_seconds, double* degrees_of_freedom) {
  const Eigen::Index count = influences.cols();
  if (window_seconds <= 0.0) {
    if (degrees_of_freedom != nullptr) {
      *degrees_of_freedom = static_cast<double>(count);
    }
    return influences / std::sqrt(static_cast<double>(count));
  }
  const WindowSmoother smoother(static_cast<int>(count),
                                SmoothingLength(pole, window_seconds));
  if (degrees_of_freedom != nullptr) {
    *degrees_of_freedom = smoother.degrees_of_freedom();
  }
  return smoother.Smooth(influences);
}

class ClusterFinder {
 public:
  ClusterFinder(const std::vector<SubspacePole>& poles, int max_order,
                double window_seconds, const StabilisationOptions& options)
      : poles_(poles),
        max_order_(max_order),
        window_seconds_(window_seconds),
        options_(options),
        used_(poles.size(), false) {
    for (const SubspacePole& pole : poles) {
      sigmas_.push_back(FindPoleSigmas(pole, window_seconds));
    }
  }

  std::vector<PoleCluster> Find() {
    std::vector<int> seeds(poles_.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    std::stable_sort(seeds.begin(), seeds.end(), [this](int a, int b) {
      return Relative(a) < Relative(b);
    });
    std::vector<PoleCluster> clusters;
    if (!options_.pick.empty()) {
      for (const double wanted : options_.pick) Pick(wanted, seeds, &clusters);
      return Sorted(std::move(clusters));
    }
    for (const int seed : seeds) {
      if (used_[static_cast<size_t>(seed)]) continue;
      if (Relative(seed) > options_.largest_frequency_sigma) break;
      PoleCluster cluster;
      cluster.members = Gather(seed);
      for (const int member : cluster.members) {
        used_[static_cast<size_t>(member)] = true;
      }
      if (!IsStable(cluster.members)) continue;
      Choose(&cluster);
      if (IsCertain(cluster)) clusters.push_back(std::move(cluster));
    }
    return Sorted(std::move(clusters));
  }

 private:
  static std::vector<PoleCluster> Sorted(std::vector<PoleCluster> clusters) {
    std::sort(clusters.begin(), clusters.end(),
              [](const PoleCluster& a, const PoleCluster& b) {
                return a.mean.frequency() < b.mean.frequency();
              });
    return clusters;
  }

  // seeds: ordered from the most certain.
  void Pick(double wanted, const std::vector<int>& seeds,
            std::vector<PoleCluster>* clusters) {
    for (const int seed : seeds) {
      if (used_[static_cast<size_t>(seed)] ||
          std::abs(pole(seed).frequency() / wanted - 1.0) >
              options_.frequency_tolerance) {
        continue;
      }
      PoleCluster cluster;
      cluster.members = Gather(seed);
      for (const int member : cluster.members) {
        used_[static_cast<size_t>(member)] = true;
      }
      Choose(&cluster);
      clusters->push_back(std::move(cluster));
      return;
    }
  }

  const SubspacePole& pole(int i) const {
    return poles_[static_cast<size_t>(i)];
  }
  double Relative(int i) const {
    return sigmas_[static_cast<size_t>(i)].frequency / pole(i).frequency();
  }

  // Returns for each order the pole nearest to the seed, if one is near enough.
  std::vector<int> Gather(int seed) const {
    struct Nearest {
      int pole;
      double distance;
    };
    std::map<int, Nearest> nearest;  // by order
    const SubspacePole& centre = pole(seed);
    for (int i = 0; i < static_cast<int>(poles_.size()); ++i) {
      if (used_[static_cast<size_t>(i)]) continue;
      const double apart =
          std::abs(pole(i).frequency() / centre.frequency() - 1.0);
      if (apart > options_.frequency_tolerance) continue;
      const double mac = ComplexMac(pole(i).shape, centre.shape);
      if (mac < options_.smallest_mac) continue;
      const double distance =
          apart / options_.frequency_tolerance +
          (1.0 - mac) / (1.0 - options_.smallest_mac) +
          std::abs(pole(i).damping_ratio() - centre.damping_ratio()) /
              options_.frequency_tolerance;
      const auto [place, added] =
          nearest.insert({pole(i).order, {i, distance}});
      if (!added && distance < place->second.distance) {
        place->second = {i, distance};
      }
    }
    std::vector<int> members;
    for (const auto& [order, found] : nearest) members.push_back(found.pole);
    return members;
  }

  bool IsStable(const std::vector<int>& members) const {
    const int seen = static_cast<int>(members.size());
    const int possible = (max_order_ - pole(members.front()).order) / 2 + 1;
    const int orders = max_order_ / 2;
    return seen >= options_.smallest_share_of_all * orders &&
           seen >= options_.smallest_share * possible;
  }

  // Computes the mean of the members, weighted by the inverse variance of their
  // frequency. Model orders above the true one add poles of noise. Other poles
  // interfere with these, and first-order standard deviations become too large.
  void Choose(PoleCluster* cluster) const {
    std::vector<double> frequencies;
    for (const int member : cluster->members) {
      frequencies.push_back(pole(member).frequency());
    }
    const double middle = Median(frequencies);
    for (const int member : cluster->members) {
      if (std::abs(pole(member).frequency() - middle) <=
          kFarthestPole * sigmas_[static_cast<size_t>(member)].frequency) {
        cluster->chosen.push_back(member);
      }
    }
    if (cluster->chosen.empty()) cluster->chosen = cluster->members;
    Average(cluster);
  }

  // Returns the weights of the chosen poles; their sum is one.
  Vector Weights(const std::vector<int>& chosen) const {
    Vector sigmas(static_cast<Eigen::Index>(chosen.size()));
    for (size_t i = 0; i < chosen.size(); ++i) {
      sigmas[static_cast<Eigen::Index>(i)] = Relative(chosen[i]);
    }
    // Relative to the smallest one, which may be almost zero.
    const double least = std::max(sigmas.minCoeff(), 1e-300);
    const Vector weights =
        (sigmas.cwiseMax(least) / least).cwiseAbs2().cwiseInverse();
    return weights / weights.sum();
  }

  void Average(PoleCluster* cluster) const {
    const SubspacePole& first = pole(cluster->chosen.front());
    cluster->first_order = pole(cluster->members.front()).order;
    first.shape.cwiseAbs().maxCoeff(&cluster->reference);
    const Vector weights = Weights(cluster->chosen);
    SubspacePole& mean = cluster->mean;
    mean = NormalisedPole(first, cluster->reference);
    mean.s *= weights[0];
    mean.shape *= weights[0];
    mean.s_influence *= weights[0];
    mean.shape_influence *= weights[0];
    for (size_t i = 1; i < cluster->chosen.size(); ++i) {
      const double weight = weights[static_cast<Eigen::Index>(i)];
      const SubspacePole next =
          NormalisedPole(pole(cluster->chosen[i]), cluster->reference);
      mean.s += weight * next.s;
      mean.shape += weight * next.shape;
      mean.s_influence += weight * next.s_influence;
      mean.shape_influence += weight * next.shape_influence;
    }
    double frequencies = 0.0;
    double ratios = 0.0;
    for (size_t i = 0; i < cluster->chosen.size(); ++i) {
      const double weight = weights[static_cast<Eigen::Index>(i)];
      const SubspacePole& member = pole(cluster->chosen[i]);
      frequencies +=
          weight * std::pow(member.frequency() - mean.frequency(), 2);
      ratios +=
          weight * std::pow(member.damping_ratio() - mean.damping_ratio(), 2);
    }
    cluster->frequency_spread = std::sqrt(frequencies);
    cluster->damping_spread = std::sqrt(ratios);
    const PoleSigmas sigmas = FindPoleSigmas(mean, window_seconds_);
    cluster->frequency_sigma = sigmas.frequency;
    cluster->damping_sigma = sigmas.damping;
    if (window_seconds_ <= 0.0) return;
    // Windows overlap by half.
    const double duration = 0.5 * window_seconds_ *
                            static_cast<double>(mean.s_influence.size() + 1);
    const double f = mean.frequency();
    cluster->excess = cluster->frequency_sigma / f /
                      std::sqrt(mean.damping_ratio() / (kTwoPi * f * duration));
  }

  double ShapeSigma(const SubspacePole& mean) const {
    const Matrix smooth =
        Scatter(mean, Influences(mean), window_seconds_, nullptr);
    return smooth.bottomRows(smooth.rows() - 2).norm() /
           std::sqrt(static_cast<double>(mean.shape.size()));
  }

  bool IsCertain(const PoleCluster& cluster) const {
    return cluster.frequency_sigma <=
               options_.largest_frequency_sigma * cluster.mean.frequency() &&
           cluster.excess <= options_.largest_excess &&
           cluster.mean.damping_ratio() <= options_.largest_damping_ratio &&
           ShapeSigma(cluster.mean) <= options_.largest_shape_sigma;
  }

  const std::vector<SubspacePole>& poles_;
  const int max_order_;
  const double window_seconds_;
  const StabilisationOptions& options_;
  std::vector<PoleSigmas> sigmas_;
  std::vector<bool> used_;
};

}  // namespace

std::complex<double> TurnToReal(const Eigen::VectorXcd& shape) {
  std::complex<double> square = 0.0;
  for (const std::complex<double>& entry : shape) {
    if (std::isfinite(entry.real())) square += entry * entry;
  }
  return std::polar(1.0, -0.5 * std::arg(square));
}

double ComplexMac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  const double norms = a.squaredNorm() * b.squaredNorm();
  return norms > 0.0 ? std::norm(a.dot(b)) / norms : 0.0;
}

PoleSigmas FindPoleSigmas(const SubspacePole& pole, double window_seconds) {
  const Matrix smooth =
      Scatter(pole, Influences(pole).topRows(2), window_seconds, nullptr);
  return {smooth.row(0).norm(), smooth.row(1).norm()};
}

PoleMoments FindPoleMoments(const SubspacePole& pole, double window_seconds) {
  PoleMoments moments;
  const Matrix smooth = Scatter(pole, Influences(pole), window_seconds,
                                &moments.degrees_of_freedom);
  moments.covariance = smooth * smooth.transpose();
  return moments;
}

void RespectAmbientBound(double window_seconds, double duration,
                         PoleCluster* cluster) {
  SubspacePole& mean = cluster->mean;
  const double ratio = std::max(0.0, mean.damping_ratio());
  const double bound =
      std::sqrt(ratio / (kTwoPi * mean.frequency() * duration));
  const PoleSigmas sigmas = FindPoleSigmas(mean, window_seconds);
  const double relative = sigmas.frequency / mean.frequency();
  if (!(relative > 0.0) || !(sigmas.damping > 0.0)) return;
  const double by_frequency = std::max(1.0, bound / relative);
  const double by_damping = std::max(1.0, bound / sigmas.damping);
  // s = |s| (-zeta + i sqrt(1 - zeta^2)): scaled along |s| and along zeta.
  const double size = std::abs(mean.s);
  const Complex direction = mean.s / size;
  const Complex across(-1.0,
                       -ratio / std::sqrt(std::max(1e-6, 1.0 - ratio * ratio)));
  for (Eigen::Index b = 0; b < mean.s_influence.size(); ++b) {
    const Complex change = mean.s_influence[b];
    const double growth = (std::conj(direction) * change).real();
    const double damping =
        -change.real() / size + mean.s.real() / (size * size) * growth;
    mean.s_influence[b] = by_frequency * growth * direction +
                          by_damping * damping * size * across;
  }
  cluster->frequency_sigma *= by_frequency;
  cluster->damping_sigma *= by_damping;
}

SubspacePole NormalisedPole(const SubspacePole& pole, int reference) {
  SubspacePole result = pole;
  const Complex scale = pole.shape[reference];
  result.shape /= scale;
  const Eigen::RowVectorXcd moved = pole.shape_influence.row(reference);
  result.shape_influence =
      (pole.shape_influence - result.shape * moved) / scale;
  return result;
}

std::vector<PoleCluster> FindClusters(const std::vector<SubspacePole>& poles,
                                      int max_order, double window_seconds,
                                      const StabilisationOptions& options) {
  return ClusterFinder(poles, max_order, window_seconds, options).Find();
}

bool IsOneMode(std::complex<double> a, const Eigen::VectorXcd& shape_a,
               std::complex<double> b, const Eigen::VectorXcd& shape_b) {
  constexpr double kNearInDecays = 0.5;
  constexpr double kLikeShape = 0.9;
  return std::abs(a.imag() - b.imag()) <
             kNearInDecays * std::max(-a.real(), -b.real()) &&
         ComplexMac(shape_a, shape_b) > kLikeShape;
}

}  // namespace pinode
