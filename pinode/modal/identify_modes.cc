#include "pinode/modal/identify_modes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/windowed_correlations.h"
#include "pinode/record/resample.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Of half the sampling rate: where resampling leaves signals as they are, and
// where the next lower rate takes over (with as much again in common).
constexpr double kBandTop = 0.8;
constexpr double kBandBottom = 0.2;
constexpr double kRecordTop = 0.95;
// Cycles in the record below which nothing certain can be said of a mode.
constexpr double kFewestCycles = 50.0;
// Samples below which a rate is not halved.
constexpr Eigen::Index kFewestSamples = 3000;
// Lags that a window holds, and windows.
constexpr int kMostWindows = 120;
constexpr int kFewestWindows = 20;

// One record at one rate.
struct Level {
  double step = 0.0;
  Matrix samples;  // channels x samples, mean zero, standard deviation 1
  Vector scales;   // by which they were divided
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
};

void Standardise(Matrix* samples, Vector* scales) {
  scales->resize(samples->rows());
  for (Eigen::Index c = 0; c < samples->rows(); ++c) {
    const Vector values = samples->row(c);
    const double sigma = StandardDeviationOfPresent(values);
    (*scales)[c] = sigma > 0.0 ? sigma : 1.0;
    samples->row(c) = (values.array() - MeanOfPresent(values)) / (*scales)[c];
  }
}

Matrix Halved(const Matrix& samples, double step) {
  Matrix result;
  for (Eigen::Index c = 0; c < samples.rows(); ++c) {
    const Vector values = Resample(samples.row(c), step, 2.0 * step);
    if (c == 0) result.resize(samples.rows(), values.size());
    result.row(c) = values.transpose();
  }
  return result;
}

// Of the shape, in displacements, largest entry 1, and of its influences.
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

IdentifiedMode MakeMode(const ResponseRecord& record, const Level& level,
                        const PoleCluster& cluster, int max_order,
                        double window_seconds) {
  SubspacePole pole = cluster.mean;
  InDisplacements(record, level.scales, &pole);
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
  mode.sampling_step = level.step;
  return mode;
}

bool IsSameMode(const IdentifiedMode& a, const IdentifiedMode& b) {
  const double apart = std::abs(a.frequency_hz - b.frequency_hz);
  const double sigma = std::hypot(a.frequency_sigma, b.frequency_sigma);
  return apart < std::max(3.0 * sigma, 0.003 * a.frequency_hz) &&
         ComplexMac(a.shape, b.shape) > 0.8;
}

class ModeFinder {
 public:
  ModeFinder(const ResponseRecord& record,
             const ModeIdentificationOptions& options, ModesOfRecord* result,
             std::string* error)
      : record_(record), options_(options), result_(result), error_(error) {}

  bool Find() {
    if (!record_.IsValid(error_) || !FindReferences() || !FindLimits()) {
      return false;
    }
    *result_ = ModesOfRecord();
    result_->remarks = FindChannelFaults(record_);
    Level level;
    level.step = record_.sampling_step;
    level.samples = record_.samples;
    double top = kRecordTop;
    while (true) {
      const double nyquist = 0.5 / level.step;
      const bool is_last = IsLast(level);
      // What a lower rate shows as well is left to it.
      if (is_last || highest_hz_ > kBandTop * 0.5 * nyquist) {
        level.lowest_hz =
            is_last ? lowest_hz_ : std::max(lowest_hz_, kBandBottom * nyquist);
        level.highest_hz = std::min(highest_hz_, top * nyquist);
        if (!Analyse(level)) return false;
      }
      if (is_last) break;
      level.samples = Halved(level.samples, level.step);
      level.step *= 2.0;
      top = kBandTop;
    }
    Merge();
    RemarkOnPicks();
    return true;
  }

 private:
  void RemarkOnPicks() {
    for (const double wanted : options_.stabilisation.pick) {
      const bool found =
          std::any_of(result_->modes.begin(), result_->modes.end(),
                      [&](const IdentifiedMode& mode) {
                        return std::abs(mode.frequency_hz / wanted - 1.0) <=
                               2.0 * options_.stabilisation.frequency_tolerance;
                      });
      if (!found) {
        result_->remarks.push_back("No pole lies at the " +
                                   FormatNumber(wanted, 6) +
                                   " Hz that was picked.");
      }
    }
  }

  bool FindReferences() {
    for (const std::string& name : options_.references) {
      const auto place = std::find_if(
          record_.channels.begin(), record_.channels.end(),
          [&name](const ResponseChannel& c) { return c.name == name; });
      if (place == record_.channels.end()) {
        *error_ = "reference '" + name + "' is no channel of record '" +
                  record_.name + "'";
        return false;
      }
      references_.push_back(static_cast<int>(place - record_.channels.begin()));
    }
    if (references_.empty()) {
      for (int c = 0; c < record_.num_channels(); ++c) references_.push_back(c);
    }
    return true;
  }

  bool FindLimits() {
    const double nyquist = 0.5 / record_.sampling_step;
    lowest_hz_ = options_.lowest_hz > 0.0 ? options_.lowest_hz
                                          : kFewestCycles / record_.duration();
    highest_hz_ =
        options_.highest_hz > 0.0 ? options_.highest_hz : kRecordTop * nyquist;
    if (highest_hz_ >= nyquist || lowest_hz_ >= highest_hz_) {
      *error_ = "record '" + record_.name + "' has modes looked for from " +
                FormatNumber(lowest_hz_, 4) + " to " +
                FormatNumber(highest_hz_, 4) +
                " Hz, expected a band between 50 cycles in the record (" +
                FormatNumber(kFewestCycles / record_.duration(), 3) +
                " Hz) and half its sampling rate (" + FormatNumber(nyquist, 4) +
                " Hz)";
      return false;
    }
    return true;
  }

  bool IsLast(const Level& level) const {
    return level.samples.cols() < 2 * kFewestSamples ||
           kBandBottom * 0.5 / level.step <= lowest_hz_;
  }

  bool Analyse(Level level) {
    const int channels = record_.num_channels();
    AnalysedBand band;
    band.sampling_step = level.step;
    band.lowest_hz = level.lowest_hz;
    band.highest_hz = level.highest_hz;
    band.block_rows = options_.block_rows > 0
                          ? options_.block_rows
                          : std::clamp(600 / channels, 12, 40);
    const int largest =
        std::min((band.block_rows - 1) * channels,
                 band.block_rows * static_cast<int>(references_.size()));
    band.max_order = options_.max_order > 0 ? options_.max_order
                                            : std::min(60, largest / 2 * 2);
    const int lags = 2 * band.block_rows - 1;
    const Eigen::Index hops = level.samples.cols() / std::max(1, lags);
    if (hops < kFewestWindows) {
      *error_ = "record '" + record_.name + "' has " +
                std::to_string(level.samples.cols()) + " samples at " +
                FormatNumber(1.0 / level.step, 6) + " Hz, too few for " +
                std::to_string(band.block_rows) + " block rows, expected " +
                std::to_string(kFewestWindows * lags) + " and more";
      return false;
    }
    band.num_windows =
        static_cast<int>(std::min<Eigen::Index>(hops, kMostWindows));
    Standardise(&level.samples, &level.scales);
    const WindowedCorrelations correlations =
        CorrelateWindows(level.samples, references_, lags, band.num_windows,
                         options_.num_threads);
    SubspaceOptions subspace;
    subspace.block_rows = band.block_rows;
    subspace.max_order = band.max_order;
    subspace.lowest_hz = band.lowest_hz;
    subspace.highest_hz = band.highest_hz;
    std::vector<SubspacePole> poles;
    if (!IdentifySubspace(correlations, level.step, subspace,
                          options_.num_threads, &poles, error_)) {
      *error_ = "record '" + record_.name + "': " + *error_;
      return false;
    }
    Keep(level, poles,
         static_cast<double>(correlations.window_samples) * level.step,
         std::move(band));
    return true;
  }

  void Keep(const Level& level, const std::vector<SubspacePole>& poles,
            double window_seconds, AnalysedBand band) {
    for (const SubspacePole& pole : poles) {
      band.poles.push_back({pole.order, pole.frequency(),
                            FindPoleSigmas(pole, window_seconds).frequency,
                            pole.damping_ratio(), -1});
    }
    const int number = static_cast<int>(result_->bands.size());
    for (const PoleCluster& cluster : FindClusters(
             poles, band.max_order, window_seconds, options_.stabilisation)) {
      found_.push_back(
          {MakeMode(record_, level, cluster, band.max_order, window_seconds),
           number, cluster.members});
    }
    result_->bands.push_back(std::move(band));
  }

  // Of modes that two rates have seen the more certain one.
  void Merge() {
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
      return a.mode.frequency_hz < b.mode.frequency_hz;
    });
    std::vector<Found> kept;
    for (Found& next : found_) {
      bool is_new = true;
      for (Found& other : kept) {
        if (other.band == next.band || !IsSameMode(other.mode, next.mode)) {
          continue;
        }
        is_new = false;
        if (next.mode.frequency_sigma < other.mode.frequency_sigma) {
          other = next;
        }
        break;
      }
      if (is_new) kept.push_back(std::move(next));
    }
    for (size_t i = 0; i < kept.size(); ++i) {
      for (const int member : kept[i].members) {
        result_->bands[static_cast<size_t>(kept[i].band)]
            .poles[static_cast<size_t>(member)]
            .mode = static_cast<int>(i);
      }
      result_->modes.push_back(std::move(kept[i].mode));
    }
  }

  struct Found {
    IdentifiedMode mode;
    int band = 0;
    std::vector<int> members;
  };

  const ResponseRecord& record_;
  const ModeIdentificationOptions& options_;
  ModesOfRecord* result_;
  std::string* error_;
  std::vector<int> references_;
  double lowest_hz_ = 0.0;
  double highest_hz_ = 0.0;
  std::vector<Found> found_;
};

}  // namespace

bool IdentifyModes(const ResponseRecord& record,
                   const ModeIdentificationOptions& options,
                   ModesOfRecord* result, std::string* error) {
  return ModeFinder(record, options, result, error).Find();
}

}  // namespace pinode
