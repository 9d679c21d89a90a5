#include "pinode/modal/identify_modes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/data_driven.h"
#include "pinode/modal/input_projection.h"
#include "pinode/modal/mode_estimate.h"
#include "pinode/modal/ring_down.h"
#include "pinode/modal/windowed_correlations.h"
#include "pinode/record/resample.h"

namespace pinode {
namespace {

// Limits of a band, relative to half the sampling rate: resampling leaves
// signals unchanged up to the first, and the next lower rate starts at the
// second (with as much overlap again).
constexpr double kBandTop = 0.8;
constexpr double kBandBottom = 0.2;
constexpr double kRecordTop = 0.95;
// Fewest cycles in the record for a reliable mode, under noise and in a decay.
constexpr double kFewestCycles = 50.0;
constexpr double kFewestDecayCycles = 5.0;
// Samples below which a rate is not halved.
constexpr Eigen::Index kFewestSamples = 3000;
constexpr Eigen::Index kFewestDecaySamples = 600;
// Samples at the beginning of a decay for which the filter of a lower rate
// still uses earlier samples.
constexpr Eigen::Index kFilterReach = 24;
// Most lags per window, and fewest windows.
constexpr int kMostWindows = 120;
constexpr int kFewestWindows = 20;
// Limits for a ring-down: most block rows, and the largest remainder of a
// channel.
constexpr int kMostDecayRows = 300;
constexpr double kLargestRest = 0.3;
// Largest uncertainty of the shape of a mode under a measured load. A measured
// load separates close modes, so a pole whose shape is less certain is not a
// mode.
constexpr double kLargestShapeSigma = 0.4;
// Standard deviations by which two methods may differ on one record.
constexpr double kDisagreement = 3.0;

// One record at one rate.
struct Level {
  double step = 0.0;
  Matrix samples;  // channels x samples, mean zero, standard deviation 1
  Vector scales;   // by which they were divided
  Matrix inputs;   // likewise
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

class ModeFinder {
 public:
  ModeFinder(const ResponseRecord& record,
             const ModeIdentificationOptions& options, ModesOfRecord* result,
             std::string* error)
      : record_(record), options_(options), result_(result), error_(error) {}

  // Option that is at fault, valid after Find.
  const std::string& option() const { return option_; }

  bool Find() {
    if (!record_.IsValid(error_) || !FindMethod() || !FindReferences() ||
        !FindLimits()) {
      return false;
    }
    *result_ = ModesOfRecord();
    result_->method = method_;
    result_->remarks = FindChannelFaults(record_);
    Level level;
    level.step = record_.sampling_step;
    level.samples = record_.samples;
    if (method_ == ModalMethod::kInputOutput) level.inputs = record_.inputs;
    double top = kRecordTop;
    while (true) {
      const double nyquist = 0.5 / level.step;
      const bool is_last = IsLast(level);
      // Frequencies that a lower rate also covers are left to that rate.
      if (is_last || highest_hz_ > kBandTop * 0.5 * nyquist) {
        level.lowest_hz =
            is_last ? lowest_hz_ : std::max(lowest_hz_, kBandBottom * nyquist);
        level.highest_hz = std::min(highest_hz_, top * nyquist);
        if (!Analyse(level)) return false;
      }
      if (is_last) break;
      level.samples = Halved(level.samples, level.step);
      if (method_ == ModalMethod::kRingDown) {
        level.samples =
            level.samples.rightCols(level.samples.cols() - kFilterReach).eval();
      }
      if (level.inputs.rows() > 0) {
        level.inputs = Halved(level.inputs, level.step);
      }
      level.step *= 2.0;
      top = kBandTop;
    }
    Merge();
    RemarkOnPicks();
    RemarkOnChecks();
    return true;
  }

 private:
  // Sets the error. `what` follows the record's name.
  bool Fail(const std::string& option, const std::string& what) {
    option_ = option;
    *error_ = "record '" + record_.name + "' " + what;
    return false;
  }

  std::string GivenBlockRows() const {
    return options_.block_rows > 0 ? "block_rows" : "";
  }

  bool FindMethod() {
    method_ = options_.method;
    if (method_ == ModalMethod::kAutomatic) {
      method_ = record_.free_decay          ? ModalMethod::kRingDown
                : record_.inputs.rows() > 0 ? ModalMethod::kInputOutput
                                            : ModalMethod::kCovarianceDriven;
    }
    if (method_ == ModalMethod::kInputOutput && record_.inputs.rows() == 0) {
      return Fail("method",
                  "has no measured load, expected one for method input_output");
    }
    if (method_ == ModalMethod::kRingDown && record_.samples.hasNaN()) {
      return Fail(options_.method == method_ ? "method" : "",
                  "has missing samples, expected a complete decay for method "
                  "ring_down");
    }
    return true;
  }

  bool is_decay() const { return method_ == ModalMethod::kRingDown; }

  void RemarkOnChecks() {
    for (const IdentifiedMode& mode : result_->modes) {
      if (method_ != ModalMethod::kCovarianceDriven) return;
      const std::string name =
          "the mode at " + FormatNumber(mode.frequency_hz, 5) + " Hz";
      if (std::isnan(mode.check_frequency_hz)) {
        result_->remarks.push_back("Data-driven identification does not see " +
                                   name + ".");
      } else if (std::abs(mode.check_frequency_hz - mode.frequency_hz) >
                     kDisagreement * mode.frequency_sigma ||
                 std::abs(mode.check_damping_ratio - mode.damping_ratio) >
                     kDisagreement * mode.damping_sigma) {
        result_->remarks.push_back(
            "Data-driven identification sees " + name + " at " +
            FormatNumber(mode.check_frequency_hz, 6) +
            " Hz with a damping of " +
            FormatNumber(100.0 * mode.check_damping_ratio, 3) +
            " %, further away than its deviations.");
      }
    }
  }

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
        option_ = "references";
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
    const double cycles = is_decay() ? kFewestDecayCycles : kFewestCycles;
    const double lowest = cycles / record_.duration();
    lowest_hz_ = options_.lowest_hz > 0.0 ? options_.lowest_hz : lowest;
    highest_hz_ =
        options_.highest_hz > 0.0 ? options_.highest_hz : kRecordTop * nyquist;
    if (highest_hz_ >= nyquist || lowest_hz_ >= highest_hz_) {
      const std::string limits =
          FormatNumber(cycles) + " cycles in the record (" +
          FormatNumber(lowest, 3) + " Hz) and half its sampling rate (" +
          FormatNumber(nyquist, 4) + " Hz)";
      if (options_.lowest_hz <= 0.0 && options_.highest_hz <= 0.0) {
        return Fail("", "is too short: there is no band between " + limits);
      }
      return Fail(options_.highest_hz > 0.0 ? "highest_hz" : "lowest_hz",
                  "has modes looked for from " + FormatNumber(lowest_hz_, 4) +
                      " to " + FormatNumber(highest_hz_, 4) +
                      " Hz, expected a band between " + limits);
    }
    return true;
  }

  bool IsLast(const Level& level) const {
    return level.samples.cols() <
               2 * (is_decay() ? kFewestDecaySamples : kFewestSamples) ||
           kBandBottom * 0.5 / level.step <= lowest_hz_;
  }

  bool Analyse(Level level) {
    AnalysedBand band;
    band.sampling_step = level.step;
    band.lowest_hz = level.lowest_hz;
    band.highest_hz = level.highest_hz;
    Standardise(&level.samples, &level.scales);
    Vector input_scales;
    if (level.inputs.rows() > 0) Standardise(&level.inputs, &input_scales);
    SizeMatrix(level, &band);
    correlations_ = WindowedCorrelations();
    HankelWindows hankel;
    double window_seconds = 0.0;
    if (!(is_decay()
              ? FormDecay(level, &band, &hankel)
              : FormCorrelations(level, &band, &hankel, &window_seconds))) {
      return false;
    }
    SubspaceOptions subspace;
    subspace.block_rows = band.block_rows;
    subspace.max_order = band.max_order;
    // For a decay all modes must be known, because they are fitted together.
    if (!is_decay()) {
      subspace.lowest_hz = band.lowest_hz;
      subspace.highest_hz = band.highest_hz;
    }
    std::vector<SubspacePole> poles;
    std::vector<SubspacePole> checks;
    const auto identify = [&](const HankelWindows& matrix,
                              std::vector<SubspacePole>* found) {
      if (IdentifySubspace(matrix, level.step, subspace, options_.num_threads,
                           found, error_)) {
        return true;
      }
      option_ = options_.max_order > 0 ? "max_order" : GivenBlockRows();
      *error_ = "record '" + record_.name + "': " + *error_;
      return false;
    };
    if (!identify(hankel, &poles)) return false;
    if (method_ == ModalMethod::kCovarianceDriven) {
      HankelWindows other =
          DataDrivenHankel(correlations_, references_, band.block_rows);
      other.num_windows = 0;
      if (!identify(other, &checks)) return false;
    }
    Keep(level, poles, checks, window_seconds, std::move(band));
    return true;
  }

  void SizeMatrix(const Level& level, AnalysedBand* band) const {
    const int channels = record_.num_channels();
    const int third = static_cast<int>(
        std::min<Eigen::Index>(level.samples.cols() / 3, kMostDecayRows));
    band->block_rows = options_.block_rows > 0 ? options_.block_rows
                       : is_decay()
                           ? std::clamp(300 / channels, 2, std::max(2, third))
                           : std::clamp(600 / channels, 12, 40);
    const int columns =
        is_decay()
            ? static_cast<int>(level.samples.cols()) + 1 - band->block_rows
            : band->block_rows * static_cast<int>(references_.size());
    const int largest = std::min((band->block_rows - 1) * channels, columns);
    band->max_order = options_.max_order > 0 ? options_.max_order
                                             : std::min(60, largest / 2 * 2);
  }

  bool FormDecay(const Level& level, AnalysedBand* band,
                 HankelWindows* hankel) {
    if (level.samples.cols() < 3 * band->block_rows || band->max_order < 2) {
      return Fail(GivenBlockRows(),
                  "has " + std::to_string(level.samples.cols()) +
                      " samples, too few for " +
                      std::to_string(band->block_rows) +
                      " block rows, expected " +
                      std::to_string(3 * band->block_rows) + " and more");
    }
    decay_ = RingDownHankel(level.samples, band->block_rows, band->max_order);
    *hankel = decay_.hankel;
    band->num_windows = hankel->num_windows;
    for (Eigen::Index c = 0; c < decay_.noise.size(); ++c) {
      const double rest = decay_.noise[c] /
                          std::sqrt(decay_.samples.row(c).squaredNorm() /
                                    static_cast<double>(decay_.samples.cols()));
      if (rest < kLargestRest || !result_->bands.empty()) continue;
      result_->remarks.push_back(
          "Channel '" + record_.channels[static_cast<size_t>(c)].name +
          "': decaying vibrations leave " + FormatNumber(100.0 * rest, 2) +
          " % of it. Does a load still act, or does the damping depend on the "
          "amplitude?");
    }
    return true;
  }

  // Computes correlations under unmeasured loads, or under unmeasured loads in
  // addition to measured ones.
  bool FormCorrelations(const Level& level, AnalysedBand* band,
                        HankelWindows* hankel, double* window_seconds) {
    const int lags = 2 * band->block_rows - 1;
    const Eigen::Index hops = level.samples.cols() / std::max(1, lags);
    if (hops < kFewestWindows) {
      return Fail(GivenBlockRows(),
                  "has " + std::to_string(level.samples.cols()) +
                      " samples at " + FormatNumber(1.0 / level.step, 6) +
                      " Hz, too few for " + std::to_string(band->block_rows) +
                      " block rows, expected " +
                      std::to_string(kFewestWindows * lags) + " and more");
    }
    band->num_windows =
        static_cast<int>(std::min<Eigen::Index>(hops, kMostWindows));
    Eigen::Index window_samples = 0;
    if (method_ == ModalMethod::kInputOutput) {
      *hankel = ProjectInput(std::make_shared<Matrix>(level.samples),
                             std::make_shared<Matrix>(level.inputs),
                             references_, band->block_rows, band->num_windows,
                             options_.num_threads, &window_samples);
    } else {
      correlations_ = CorrelateWindows(level.samples, references_, lags,
                                       band->num_windows, options_.num_threads);
      window_samples = correlations_.window_samples;
      *hankel =
          method_ == ModalMethod::kDataDriven
              ? DataDrivenHankel(correlations_, references_, band->block_rows)
              : HankelOfCorrelations(correlations_, band->block_rows);
    }
    *window_seconds = static_cast<double>(window_samples) * level.step;
    return true;
  }

  void Keep(const Level& level, const std::vector<SubspacePole>& poles,
            const std::vector<SubspacePole>& checks, double window_seconds,
            AnalysedBand band) {
    const auto is_inside = [&band](const SubspacePole& pole) {
      return pole.frequency() >= band.lowest_hz &&
             pole.frequency() <= band.highest_hz;
    };
    std::vector<int> places;  // in band.poles; what is not inside has none
    for (const SubspacePole& pole : poles) {
      places.push_back(static_cast<int>(band.poles.size()));
      if (!is_inside(pole)) continue;
      band.poles.push_back({pole.order, pole.frequency(),
                            FindPoleSigmas(pole, window_seconds).frequency,
                            pole.damping_ratio(), -1});
    }
    const int number = static_cast<int>(result_->bands.size());
    StabilisationOptions stabilisation = options_.stabilisation;
    if (method_ == ModalMethod::kInputOutput) {
      stabilisation.largest_shape_sigma =
          std::min(stabilisation.largest_shape_sigma, kLargestShapeSigma);
    }
    std::vector<PoleCluster> clusters =
        FindClusters(poles, band.max_order, window_seconds, stabilisation);
    if (is_decay()) {
      if (options_.stabilisation.pick.empty()) LeaveOutNoise(level, &clusters);
      FitShapes(level, poles, band.max_order, &clusters);
    }
    for (const PoleCluster& cluster : clusters) {
      if (!is_inside(cluster.mean)) continue;
      std::vector<int> members;
      for (const int member : cluster.members) {
        if (is_inside(poles[static_cast<size_t>(member)])) {
          members.push_back(places[static_cast<size_t>(member)]);
        }
      }
      IdentifiedMode mode = MakeMode(record_, level.scales, level.step, cluster,
                                     band.max_order, window_seconds);
      if (!checks.empty()) {
        CheckMode(cluster, checks, band.max_order, options_.stabilisation,
                  &mode);
      }
      found_.push_back({std::move(mode), number, std::move(members)});
    }
    result_->bands.push_back(std::move(band));
  }

  // Fits the shapes of the modes. Modes that were not picked decay too, so the
  // fit includes them.
  void FitShapes(const Level& level, const std::vector<SubspacePole>& poles,
                 int max_order, std::vector<PoleCluster>* clusters) const {
    const size_t count = clusters->size();
    StabilisationOptions automatic = options_.stabilisation;
    if (!automatic.pick.empty()) {
      automatic.pick.clear();
      std::vector<PoleCluster> others =
          FindClusters(poles, max_order, 0.0, automatic);
      LeaveOutNoise(level, &others);
      for (PoleCluster& other : others) {
        const bool picked = std::any_of(
            clusters->begin(), clusters->begin() + static_cast<long>(count),
            [&other](const PoleCluster& cluster) {
              return std::find_first_of(
                         cluster.members.begin(), cluster.members.end(),
                         other.members.begin(),
                         other.members.end()) != cluster.members.end();
            });
        if (!picked) clusters->push_back(std::move(other));
      }
    }
    FitDecayShapes(decay_, level.step, clusters);
    clusters->resize(count);
  }

  void LeaveOutNoise(const Level& level,
                     std::vector<PoleCluster>* clusters) const {
    std::vector<std::complex<double>> s;
    for (const PoleCluster& cluster : *clusters) s.push_back(cluster.mean.s);
    const std::vector<bool> significant =
        FindSignificantDecays(decay_, s, level.step);
    std::vector<PoleCluster> kept;
    for (size_t i = 0; i < s.size(); ++i) {
      if (significant[i]) kept.push_back(std::move((*clusters)[i]));
    }
    *clusters = std::move(kept);
  }

  // Keeps the more certain of two estimates if two rates found the same mode.
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
  std::string option_;
  ModalMethod method_ = ModalMethod::kCovarianceDriven;
  WindowedCorrelations correlations_;  // of the rate that is looked at
  RingDown decay_;                     // likewise
  std::vector<int> references_;
  double lowest_hz_ = 0.0;
  double highest_hz_ = 0.0;
  std::vector<Found> found_;
};

}  // namespace

const char* ModalMethodName(ModalMethod method) {
  switch (method) {
    case ModalMethod::kAutomatic:
      return "automatic";
    case ModalMethod::kCovarianceDriven:
      return "covariance_driven";
    case ModalMethod::kDataDriven:
      return "data_driven";
    case ModalMethod::kInputOutput:
      return "input_output";
    case ModalMethod::kRingDown:
      return "ring_down";
  }
  return "";
}

bool IdentifyModes(const ResponseRecord& record,
                   const ModeIdentificationOptions& options,
                   ModesOfRecord* result, std::string* error,
                   std::string* option) {
  ModeFinder finder(record, options, result, error);
  const bool found = finder.Find();
  if (option != nullptr) *option = finder.option();
  return found;
}

}  // namespace pinode
