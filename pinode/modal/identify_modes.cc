#include "pinode/modal/identify_modes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/modal/data_driven.h"
#include "pinode/modal/decay_search.h"
#include "pinode/modal/forced_search.h"
#include "pinode/modal/input_projection.h"
#include "pinode/modal/mode_estimate.h"
#include "pinode/modal/mode_list.h"
#include "pinode/modal/ring_down.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/modal/windowed_correlations.h"

namespace pinode {
namespace {

// Limits of a band, relative to half the sampling rate: resampling leaves
// signals unchanged up to the first, and the next lower rate starts at the
// second (with as much overlap again).
constexpr double kBandTop = 0.8;
constexpr double kBandBottom = 0.2;
constexpr double kRecordTop = 0.95;
// The same under measured loads. Loads between samples are not known above it:
// a sum over 49 samples holds them to 1e-5 there, and to 1/44 at 0.95.
constexpr double kLoadedTop = 0.85;
// Fewest cycles in the record for a reliable mode, under noise and in a decay.
constexpr double kFewestCycles = 50.0;
constexpr double kFewestDecayCycles = 5.0;
// Samples below which a rate is not halved.
constexpr Eigen::Index kFewestSamples = 3000;
constexpr Eigen::Index kFewestDecaySamples = 600;
// Samples at either end of a decay for which the filter of a lower rate uses
// samples outside of the record (resample.h).
constexpr Eigen::Index kFilterReach = 35;
// Most lags per window, and fewest windows.
constexpr int kMostWindows = 120;
constexpr int kFewestWindows = 20;
// Most block rows for a ring-down.
constexpr int kMostDecayRows = 300;
// Largest damping ratio of a vibration that is looked for in a decay.
constexpr double kLargestDecayRatio = 0.95;
// Largest uncertainty of the shape of a mode under a measured load. A measured
// load separates close modes, so a pole whose shape is less certain is not a
// mode.
constexpr double kLargestShapeSigma = 0.4;
// Standard deviations by which two methods may differ on one record.
constexpr double kDisagreement = 3.0;

class ModeFinder {
 public:
  ModeFinder(const ResponseRecord& record,
             const ModeIdentificationOptions& options, ModesOfRecord* result,
             std::string* error)
      : record_(record),
        options_(options),
        result_(result),
        error_(error),
        modes_(result),
        decays_(record, options.stabilisation, result, &modes_),
        forced_(record, options.stabilisation, result, &modes_) {}

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
    RecordAtRate level;
    level.step = record_.sampling_step;
    level.samples = record_.samples;
    if (method_ == ModalMethod::kInputOutput) level.inputs = record_.inputs;
    double top = record_top();
    while (true) {
      const double nyquist = 0.5 / level.step;
      const bool is_last = IsLast(level);
      // Frequencies that a lower rate also covers are left to that rate.
      // A decay's vibrations above them have images at the lower rate.
      if (is_last || is_decay() || highest_hz_ > kBandTop * 0.5 * nyquist) {
        level.lowest_hz =
            is_last ? lowest_hz_ : std::max(lowest_hz_, kBandBottom * nyquist);
        level.highest_hz = std::min(highest_hz_, top * nyquist);
        if (!Analyse(level)) return false;
      }
      if (is_last) break;
      level.samples = Halved(level.samples, level.step);
      if (method_ == ModalMethod::kRingDown) {
        level.samples = level.samples
                            .middleCols(kFilterReach,
                                        level.samples.cols() - 2 * kFilterReach)
                            .eval();
      }
      if (level.inputs.rows() > 0) {
        level.inputs = Halved(level.inputs, level.step);
      }
      level.step *= 2.0;
      top = kBandTop;
    }
    decays_.Fit(lowest_hz_);
    forced_.Fit(lowest_hz_);
    modes_.Finish();
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
                  "has no measured load; method input_output needs one");
    }
    if (method_ == ModalMethod::kRingDown && record_.samples.hasNaN()) {
      return Fail(
          options_.method == method_ ? "method" : "",
          "has missing samples; method ring_down needs a complete decay");
    }
    return true;
  }

  bool is_decay() const { return method_ == ModalMethod::kRingDown; }
  double record_top() const {
    return method_ == ModalMethod::kInputOutput && options_.highest_hz <= 0.0
               ? kLoadedTop
               : kRecordTop;
  }

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
            " %, further away than its standard deviation allows.");
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
        result_->remarks.push_back(
            "No pole lies at the " + FormatNumber(wanted, 6) +
            " Hz that you picked. Pick a peak of the diagram.");
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
        *error_ = "reference '" + name + "' is not a channel of record '" +
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
    highest_hz_ = options_.highest_hz > 0.0 ? options_.highest_hz
                                            : record_top() * nyquist;
    if (highest_hz_ >= nyquist || lowest_hz_ >= highest_hz_) {
      const std::string limits =
          FormatNumber(cycles) + " cycles in the record (" +
          FormatNumber(lowest, 3) + " Hz) and half its sampling rate (" +
          FormatNumber(nyquist, 4) + " Hz)";
      if (options_.lowest_hz <= 0.0 && options_.highest_hz <= 0.0) {
        return Fail("", "is too short: there is no band between " + limits);
      }
      return Fail(options_.highest_hz > 0.0 ? "highest_hz" : "lowest_hz",
                  "is searched for modes from " + FormatNumber(lowest_hz_, 4) +
                      " to " + FormatNumber(highest_hz_, 4) +
                      " Hz, expected a band between " + limits);
    }
    return true;
  }

  bool IsLast(const RecordAtRate& level) const {
    return level.samples.cols() <
               2 * (is_decay() ? kFewestDecaySamples : kFewestSamples) ||
           kBandBottom * 0.5 / level.step <= lowest_hz_;
  }

  bool Analyse(RecordAtRate level) {
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
    if (is_decay()) {
      subspace.max_damping_ratio = kLargestDecayRatio;
    } else {
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
    if (is_decay()) {
      decays_.Take(level, std::move(poles), std::move(band));
    } else {
      Keep(level, poles, checks, window_seconds, std::move(band));
    }
    return true;
  }

  void SizeMatrix(const RecordAtRate& level, AnalysedBand* band) const {
    const int channels = record_.num_channels();
    const int third = static_cast<int>(
        std::min<Eigen::Index>(level.samples.cols() / 3, kMostDecayRows));
    band->block_rows = options_.block_rows > 0 ? options_.block_rows
                       : is_decay()
                           ? std::clamp(300 / channels, 2, std::max(2, third))
                           : std::clamp(600 / channels, 12, 40);
    // Any number of rows may be asked for; products are wider.
    const Eigen::Index block_rows = band->block_rows;
    const Eigen::Index columns =
        is_decay() ? level.samples.cols() + 1 - block_rows
                   : block_rows * static_cast<Eigen::Index>(references_.size());
    const Eigen::Index largest = std::min((block_rows - 1) * channels, columns);
    band->max_order =
        options_.max_order > 0
            ? options_.max_order
            : static_cast<int>(std::min<Eigen::Index>(60, largest / 2 * 2));
  }

  bool FormDecay(const RecordAtRate& level, AnalysedBand* band,
                 HankelWindows* hankel) {
    const Eigen::Index fewest = Eigen::Index{3} * band->block_rows;
    if (level.samples.cols() < fewest || band->max_order < 2) {
      return Fail(GivenBlockRows(),
                  "has " + std::to_string(level.samples.cols()) +
                      " samples, too few for " +
                      std::to_string(band->block_rows) +
                      " block rows, expected " + std::to_string(fewest) +
                      " and more. Use a longer record, or fewer 'block_rows'");
    }
    *hankel =
        RingDownHankel(level.samples, band->block_rows, band->max_order).hankel;
    band->num_windows = hankel->num_windows;
    return true;
  }

  // Computes correlations under unmeasured loads, or under unmeasured loads in
  // addition to measured ones.
  bool FormCorrelations(const RecordAtRate& level, AnalysedBand* band,
                        HankelWindows* hankel, double* window_seconds) {
    const Eigen::Index lags = Eigen::Index{2} * band->block_rows - 1;
    const Eigen::Index hops =
        level.samples.cols() / std::max<Eigen::Index>(1, lags);
    if (hops < kFewestWindows) {
      return Fail(GivenBlockRows(),
                  "has " + std::to_string(level.samples.cols()) +
                      " samples at " + FormatNumber(1.0 / level.step, 6) +
                      " Hz, too few for " + std::to_string(band->block_rows) +
                      " block rows, expected " +
                      std::to_string(kFewestWindows * lags) +
                      " and more. Use a longer record, or fewer 'block_rows'");
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
      correlations_ =
          CorrelateWindows(level.samples, references_, static_cast<int>(lags),
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

  void Keep(const RecordAtRate& level, const std::vector<SubspacePole>& poles,
            const std::vector<SubspacePole>& checks, double window_seconds,
            AnalysedBand band) {
    const std::vector<int> places = AddPoles(poles, window_seconds, &band);
    const int number = static_cast<int>(result_->bands.size());
    StabilisationOptions stabilisation = options_.stabilisation;
    if (method_ == ModalMethod::kInputOutput) {
      stabilisation.largest_shape_sigma =
          std::min(stabilisation.largest_shape_sigma, kLargestShapeSigma);
    }
    std::vector<PoleCluster> clusters =
        FindClusters(poles, band.max_order, window_seconds, stabilisation);
    if (method_ == ModalMethod::kInputOutput) {
      forced_.Take(level, band, clusters, places, window_seconds);
      clusters.clear();
    }
    for (PoleCluster& cluster : clusters) {
      if (!IsInside(cluster.mean, band)) continue;
      std::vector<std::pair<int, int>> members;
      for (const int member : cluster.members) {
        const int place = places[static_cast<size_t>(member)];
        if (place >= 0) members.emplace_back(number, place);
      }
      const double sigma = cluster.frequency_sigma;
      RespectAmbientBound(window_seconds, record_.duration(), &cluster);
      IdentifiedMode mode = MakeMode(record_, level.scales, level.step, cluster,
                                     band.max_order, window_seconds);
      if (!checks.empty()) {
        CheckMode(cluster, checks, band.max_order, options_.stabilisation,
                  &mode);
      }
      modes_.MarkHarmonic(level, cluster.mean, &mode);
      modes_.Add({std::move(mode), number, std::move(members), sigma});
    }
    result_->bands.push_back(std::move(band));
  }

  const ResponseRecord& record_;
  const ModeIdentificationOptions& options_;
  ModesOfRecord* result_;
  std::string* error_;
  std::string option_;
  ModalMethod method_ = ModalMethod::kCovarianceDriven;
  WindowedCorrelations correlations_;  // of the rate that is looked at
  std::vector<int> references_;
  double lowest_hz_ = 0.0;
  double highest_hz_ = 0.0;
  ModeList modes_;
  DecaySearch decays_;
  ForcedSearch forced_;
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
