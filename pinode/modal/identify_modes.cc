#include "pinode/modal/identify_modes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/data_driven.h"
#include "pinode/modal/decay_modes.h"
#include "pinode/modal/harmonics.h"
#include "pinode/modal/input_projection.h"
#include "pinode/modal/mode_estimate.h"
#include "pinode/modal/ring_down.h"
#include "pinode/modal/stabilisation.h"
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
// Samples at either end of a decay for which the filter of a lower rate uses
// samples outside of the record (resample.h).
constexpr Eigen::Index kFilterReach = 35;
// Most lags per window, and fewest windows.
constexpr int kMostWindows = 120;
constexpr int kFewestWindows = 20;
// Limits for a ring-down: most block rows, and the largest remainder of a
// channel.
constexpr int kMostDecayRows = 300;
constexpr double kLargestRest = 0.3;
// Largest damping ratio of a vibration that is looked for in a decay, and the
// largest uncertainty of the frequency of one that is listed.
constexpr double kLargestDecayRatio = 0.95;
constexpr double kLargestDecaySigma = 0.1;
// Most samples of a rate at which all vibrations of a decay are fitted.
constexpr Eigen::Index kMostJointSamples = 30000;
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
    FitDecays(lowest_hz_);
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
      KeepDecay(level, std::move(poles), std::move(band));
    } else {
      Keep(level, poles, checks, window_seconds, std::move(band));
    }
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
    *hankel =
        RingDownHankel(level.samples, band->block_rows, band->max_order).hankel;
    band->num_windows = hankel->num_windows;
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

  static bool IsInside(const SubspacePole& pole, const AnalysedBand& band) {
    return pole.frequency() >= band.lowest_hz &&
           pole.frequency() <= band.highest_hz;
  }

  // Adds the poles inside of the band to it. Returns their places there, -1 for
  // those outside.
  static std::vector<int> AddPoles(const std::vector<SubspacePole>& poles,
                                   double window_seconds, AnalysedBand* band) {
    std::vector<int> places;
    for (const SubspacePole& pole : poles) {
      if (!IsInside(pole, *band)) {
        places.push_back(-1);
        continue;
      }
      places.push_back(static_cast<int>(band->poles.size()));
      band->poles.push_back({pole.order, pole.frequency(),
                             FindPoleSigmas(pole, window_seconds).frequency,
                             pole.damping_ratio(), -1});
    }
    return places;
  }

  void Keep(const Level& level, const std::vector<SubspacePole>& poles,
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
    for (PoleCluster& cluster : clusters) {
      if (!IsInside(cluster.mean, band)) continue;
      std::vector<std::pair<int, int>> members;
      for (const int member : cluster.members) {
        const int place = places[static_cast<size_t>(member)];
        if (place >= 0) members.emplace_back(number, place);
      }
      const double sigma = cluster.frequency_sigma;
      if (method_ != ModalMethod::kInputOutput) {
        RespectAmbientBound(window_seconds, record_.duration(), &cluster);
      }
      IdentifiedMode mode = MakeMode(record_, level.scales, level.step, cluster,
                                     band.max_order, window_seconds);
      MarkHarmonic(level, cluster.mean, &mode);
      if (!checks.empty()) {
        CheckMode(cluster, checks, band.max_order, options_.stabilisation,
                  &mode);
      }
      found_.push_back({std::move(mode), number, std::move(members), sigma});
    }
    result_->bands.push_back(std::move(band));
  }

  // Marks a mode whose damping may be zero and whose amplitude is constant.
  void MarkHarmonic(const Level& level, const SubspacePole& pole,
                    IdentifiedMode* mode) {
    if (mode->damping_lower95 > 0.0) return;
    const NarrowBand narrow =
        FindNarrowBand(level.samples, level.step, pole.shape, pole.frequency());
    mode->is_harmonic = IsSine(narrow);
    if (!mode->is_harmonic) return;
    result_->remarks.push_back(
        "The vibration at " + FormatNumber(mode->frequency_hz, 5) +
        " Hz is a harmonic, not a mode: its amplitude is constant, its "
        "kurtosis "
        "is " +
        FormatNumber(narrow.kurtosis, 3) +
        " (a sine has 1.5, random vibration 3), and its damping may be zero. "
        "Set harmonics = true in [modes] to have it in modes.toml.");
  }

  // A rate at which the vibrations of a decay are fitted.
  struct DecayFitLevel {
    Level level;
    int band = 0;
    std::vector<SubspacePole> poles;
    std::vector<int> places;  // of the poles in the band
    std::vector<DecayTerm> terms;
    std::vector<std::complex<double>> candidates;  // from lower rates
    std::vector<std::complex<double>> picked;
  };

  // Looks for the vibrations of a decay at one rate. They are fitted at the
  // highest rate that has not too many samples. Higher rates have a fit of
  // their own; lower ones provide candidates.
  void KeepDecay(const Level& level, std::vector<SubspacePole> poles,
                 AnalysedBand band) {
    std::vector<int> places = AddPoles(poles, 0.0, &band);
    const std::vector<DecayTerm> terms =
        FindDecayTerms(level.samples, level.step, poles, terms_);
    terms_ = TermsAtHalfRate(terms, level.step);
    std::vector<std::complex<double>> picked;
    if (!options_.stabilisation.pick.empty()) {
      for (const PoleCluster& cluster :
           FindClusters(poles, band.max_order, 0.0, options_.stabilisation)) {
        if (IsInside(cluster.mean, band)) picked.push_back(cluster.mean.s);
      }
    }
    const int number = static_cast<int>(result_->bands.size());
    if (joint_ == nullptr) {
      joint_ =
          std::make_unique<DecayFitLevel>(DecayFitLevel{level,
                                                        number,
                                                        std::move(poles),
                                                        std::move(places),
                                                        terms,
                                                        {},
                                                        std::move(picked)});
    } else {
      for (const DecayTerm& term : terms) {
        SubspacePole pole;
        pole.s = term.s;
        if (term.vibrates() && !term.is_alias && IsInside(pole, band)) {
          joint_->candidates.push_back(term.s);
        }
      }
      joint_->picked.insert(joint_->picked.end(), picked.begin(), picked.end());
    }
    result_->bands.push_back(std::move(band));
    if (level.samples.cols() > kMostJointSamples) FitDecays(level.lowest_hz);
  }

  // Fits the vibrations, if there is a rate to be fitted.
  void FitDecays(double lowest_hz) {
    if (joint_ == nullptr) return;
    const DecayFitLevel job = std::move(*joint_);
    joint_.reset();
    AnalysedBand band = result_->bands[static_cast<size_t>(job.band)];
    band.lowest_hz = lowest_hz;
    if (!options_.stabilisation.pick.empty() && job.picked.empty()) return;
    DecayModes modes = EstimateDecays(job.level.samples, job.level.step,
                                      job.terms, job.candidates, job.picked);
    if (found_.empty()) RemarkOnRest(modes.rest);
    for (PoleCluster& cluster : modes.clusters) {
      if (!IsInside(cluster.mean, band)) continue;
      if (options_.stabilisation.pick.empty() && !IsListed(cluster)) continue;
      cluster.first_order = band.max_order;
      FindDecayMembers(job.poles, options_.stabilisation, &cluster);
      std::vector<std::pair<int, int>> members;
      for (const int member : cluster.members) {
        const int place = job.places[static_cast<size_t>(member)];
        if (place >= 0) members.emplace_back(job.band, place);
      }
      IdentifiedMode mode =
          MakeMode(record_, job.level.scales, job.level.step, cluster,
                   band.max_order, /*window_seconds=*/0.0);
      MarkHarmonic(job.level, cluster.mean, &mode);
      if (mode.damping_ratio <= 0.0 && !mode.is_harmonic) continue;
      AddMembersOfLowerRates(job.band, &mode, &members);
      found_.push_back({std::move(mode), job.band, std::move(members),
                        cluster.frequency_sigma});
    }
  }

  // Adds the poles of lower rates near the mode. Counts orders at the rate that
  // sees it most often.
  void AddMembersOfLowerRates(int band, IdentifiedMode* mode,
                              std::vector<std::pair<int, int>>* members) const {
    const double tolerance = options_.stabilisation.frequency_tolerance;
    for (int b = band + 1; b < static_cast<int>(result_->bands.size()); ++b) {
      const AnalysedBand& other = result_->bands[static_cast<size_t>(b)];
      std::map<int, int> by_order;
      for (size_t i = 0; i < other.poles.size(); ++i) {
        const DiagramPole& pole = other.poles[i];
        if (std::abs(pole.frequency_hz / mode->frequency_hz - 1.0) <=
                tolerance &&
            std::abs(pole.damping_ratio - mode->damping_ratio) <=
                tolerance + mode->damping_ratio) {
          by_order.insert({pole.order, static_cast<int>(i)});
        }
      }
      for (const auto& [order, place] : by_order) {
        members->emplace_back(b, place);
      }
      const int seen = static_cast<int>(by_order.size());
      if (seen <= mode->orders_seen) continue;
      mode->orders_seen = seen;
      mode->orders_possible =
          (other.max_order - by_order.begin()->first) / 2 + 1;
    }
  }

  // Returns true for modes within the limits. Names the others.
  bool IsListed(const PoleCluster& cluster) {
    const double hz = cluster.mean.frequency();
    const double ratio = cluster.mean.damping_ratio();
    if (ratio > options_.stabilisation.largest_damping_ratio) {
      result_->remarks.push_back(
          "A vibration at " + FormatNumber(hz, 4) + " Hz has a damping of " +
          FormatNumber(100.0 * ratio, 3) + " +- " +
          FormatNumber(100.0 * cluster.damping_sigma, 2) +
          " %, more than max_damping_ratio = " +
          FormatNumber(options_.stabilisation.largest_damping_ratio, 3) +
          ", and is not listed. Increase max_damping_ratio in [modes] to list "
          "it.");
      return false;
    }
    return ratio + 2.0 * cluster.damping_sigma > 0.0 &&
           cluster.frequency_sigma <= kLargestDecaySigma * hz;
  }

  void RemarkOnRest(const Vector& rest) {
    for (Eigen::Index c = 0; c < rest.size(); ++c) {
      if (rest[c] < kLargestRest) continue;
      result_->remarks.push_back(
          "Channel '" + record_.channels[static_cast<size_t>(c)].name +
          "': decaying vibrations leave " + FormatNumber(100.0 * rest[c], 2) +
          " % of it. Does a load still act, or does the damping depend on the "
          "amplitude?");
    }
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
        if (next.sigma < other.sigma) {
          other = next;
        }
        break;
      }
      if (is_new) kept.push_back(std::move(next));
    }
    for (size_t i = 0; i < kept.size(); ++i) {
      for (const auto& [band, member] : kept[i].members) {
        result_->bands[static_cast<size_t>(band)]
            .poles[static_cast<size_t>(member)]
            .mode = static_cast<int>(i);
      }
      result_->modes.push_back(std::move(kept[i].mode));
    }
  }

  struct Found {
    IdentifiedMode mode;
    int band = 0;
    std::vector<std::pair<int, int>> members;  // bands, and poles there
    double sigma = 0.0;  // of the frequency, before it respects a bound
  };

  const ResponseRecord& record_;
  const ModeIdentificationOptions& options_;
  ModesOfRecord* result_;
  std::string* error_;
  std::string option_;
  ModalMethod method_ = ModalMethod::kCovarianceDriven;
  WindowedCorrelations correlations_;  // of the rate that is looked at
  // Decays: terms of higher rates as they are at the next rate, and the rate at
  // which vibrations are fitted.
  std::vector<DecayTerm> terms_;
  std::unique_ptr<DecayFitLevel> joint_;
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
