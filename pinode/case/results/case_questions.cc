#include "pinode/case/results/case_questions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/base/units.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/spectra.h"

namespace pinode {
namespace {

constexpr size_t kMostPeaks = 6;
// Height of a peak above the lower of the valleys beside it, as a factor, and
// over the largest peak.
constexpr double kProminence = 4.0;
constexpr double kLowestPeak = 1e-3;
// Part of the ground's largest density that is added to it before dividing.
constexpr double kFloorOfGround = 1e-2;
// Factor between modes and peaks from which on they are asked about, and where
// the model has modes of which the peaks may be higher ones.
constexpr double kFar = 2.0;
constexpr double kFarForOne = 4.0;
// Largest deviation of a factor from that of a known slip.
constexpr double kNearSlip = 0.15;

// Returns the positions of the peaks of a spectrum, ascending. The first line
// is drift.
std::vector<Eigen::Index> PeaksOf(const Vector& density) {
  const Eigen::Index n = density.size();
  std::vector<std::pair<double, Eigen::Index>> found;
  double largest = 0.0;
  for (Eigen::Index i = 2; i + 1 < n; ++i) {
    if (density[i] < density[i - 1] || density[i] <= density[i + 1]) continue;
    // Valleys up to the next higher line on each side.
    double left = density[i];
    for (Eigen::Index j = i; j-- > 1 && density[j] <= density[i];) {
      left = std::min(left, density[j]);
    }
    double right = density[i];
    for (Eigen::Index j = i + 1; j < n && density[j] <= density[i]; ++j) {
      right = std::min(right, density[j]);
    }
    if (density[i] < kProminence * std::max(left, right)) continue;
    found.emplace_back(density[i], i);
    largest = std::max(largest, density[i]);
  }
  std::sort(found.rbegin(), found.rend());
  std::vector<Eigen::Index> peaks;
  for (const auto& [height, place] : found) {
    if (peaks.size() < kMostPeaks && height >= kLowestPeak * largest) {
      peaks.push_back(place);
    }
  }
  std::sort(peaks.begin(), peaks.end());
  return peaks;
}

// Mean of the channels' densities, each of variance 1; empty without channels.
Vector MeanDensity(const Matrix& samples, double step, Vector* hz) {
  ResponseRecord record;
  record.sampling_step = step;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    if (samples.row(i).array().isNaN().all()) continue;
    double lowest = 0.0;
    double highest = 0.0;
    for (const double value : samples.row(i)) {
      if (std::isnan(value)) continue;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    if (highest > lowest) rows.push_back(i);
  }
  if (rows.empty()) return Vector();
  record.samples.resize(static_cast<Eigen::Index>(rows.size()), samples.cols());
  for (size_t i = 0; i < rows.size(); ++i) {
    record.channels.push_back({std::to_string(i), 2});
    record.samples.row(static_cast<Eigen::Index>(i)) = samples.row(rows[i]);
  }
  // Eight segments or so, with half a segment of overlap.
  Eigen::Index segment = 64;
  while (8 * segment <= samples.cols() && segment < 4096) segment *= 2;
  if (segment > samples.cols()) return Vector();
  const Spectra spectra = EstimateSpectra(record, segment, 1);
  Vector density = Vector::Zero(spectra.frequency_hz.size());
  for (Eigen::Index i = 0; i < spectra.densities.rows(); ++i) {
    const double power = spectra.densities.row(i).sum();
    if (power > 0.0) density += spectra.densities.row(i).transpose() / power;
  }
  *hz = spectra.frequency_hz;
  return density;
}

RecordPeaks PeaksOfSamples(const std::string& name, const Matrix& samples,
                           const Matrix& ground, double step_in_seconds) {
  RecordPeaks peaks;
  peaks.record = name;
  Vector hz;
  Vector density = MeanDensity(samples, step_in_seconds, &hz);
  if (density.size() == 0) return peaks;
  Vector ground_hz;
  const Vector load = MeanDensity(ground, step_in_seconds, &ground_hz);
  if (load.size() == density.size()) {
    density.array() /= load.array() + kFloorOfGround * load.maxCoeff();
  }
  for (const Eigen::Index place : PeaksOf(density)) {
    peaks.hz.push_back(hz[place]);
  }
  return peaks;
}

// Returns what is known to be wrong by this factor of the frequencies, or "".
std::string SlipOf(double factor, const UnitSystem& units) {
  double gravity = 0.0;
  std::string error;
  if (!UnitFactor("g", Dimension::kAcceleration, units, &gravity, &error)) {
    return "";
  }
  const auto near = [factor](double slip) {
    return std::abs(factor / std::sqrt(slip) - 1.0) < kNearSlip;
  };
  const std::string unit = UnitName(Dimension::kAcceleration, units);
  if (near(gravity)) {
    return " The factor suggests weights instead of masses: divide them by g "
           "= " +
           FormatNumber(gravity, 5) + " " + unit + ".";
  }
  if (near(1.0 / gravity)) {
    return " The factor suggests masses that were divided by g = " +
           FormatNumber(gravity, 5) + " " + unit +
           " once too often: multiply them.";
  }
  if (near(1000.0) || near(1e-3)) {
    return " The factor suggests an error of 1000 in stiffness or mass, such "
           "as kN with kg or N with t. The unit of mass is " +
           MassUnitName(units) + ".";
  }
  return "";
}

}  // namespace

std::vector<RecordPeaks> FindRecordPeaks(const Case& c) {
  std::vector<RecordPeaks> all;
  const double to_hz = c.problem.description.HzPerModelFrequency();
  // Model time in seconds.
  const double second = 1.0 / to_hz;
  for (const IdentificationRecord& record : c.problem.records) {
    Matrix samples(static_cast<Eigen::Index>(record.channels.size()),
                   record.num_samples());
    for (size_t i = 0; i < record.channels.size(); ++i) {
      samples.row(static_cast<Eigen::Index>(i)) =
          record.channels[i].values.transpose();
    }
    std::vector<Eigen::Index> grounds;
    const std::vector<InputSpec>& inputs = c.problem.dynamics->inputs();
    for (size_t i = 0; i < inputs.size(); ++i) {
      if (inputs[i].kind == InputSpec::Kind::kGroundAcceleration) {
        grounds.push_back(static_cast<Eigen::Index>(i));
      }
    }
    Matrix ground(static_cast<Eigen::Index>(grounds.size()),
                  record.num_samples());
    for (size_t i = 0; i < grounds.size(); ++i) {
      ground.row(static_cast<Eigen::Index>(i)) =
          record.excitation->samples().row(grounds[i]);
    }
    all.push_back(PeaksOfSamples(record.name, samples, ground,
                                 record.sampling_step() * second));
  }
  for (const AmbientRecord& record : c.problem.ambient) {
    all.push_back(PeaksOfSamples(record.name, record.samples, Matrix(),
                                 record.sampling_step * second));
  }
  return all;
}

std::vector<std::string> FindQuestions(const Case& c,
                                       const ModalProperties& modes,
                                       const std::vector<RecordPeaks>& peaks) {
  std::vector<std::string> questions;
  const UnitSystem& units = c.problem.description.units;
  const double to_hz = c.problem.description.HzPerModelFrequency();
  std::vector<double> model;
  for (Eigen::Index i = 0; i < modes.frequency_hz.size(); ++i) {
    const double hz = to_hz * modes.frequency_hz[i];
    if (std::isfinite(hz) && hz > 0.0) model.push_back(hz);
    const double ratio = modes.damping_ratio[i];
    if (std::isfinite(ratio) && ratio > 0.5) {
      questions.push_back("Mode " + std::to_string(i + 1) +
                          " has a damping of " +
                          FormatNumber(100.0 * ratio, 3) +
                          " % of critical. Check the unit of the damping and "
                          "the coefficients of `rayleigh`.");
    }
  }
  for (const RecordPeaks& record : peaks) {
    const size_t compared =
        std::min({record.hz.size(), model.size(), size_t{3}});
    if (compared == 0) continue;
    const double limit = compared == 1 && model.size() > 1 ? kFarForOne : kFar;
    double sum = 0.0;
    bool all_above = true;
    bool all_below = true;
    for (size_t i = 0; i < compared; ++i) {
      const double factor = record.hz[i] / model[i];
      sum += std::log(factor);
      all_above = all_above && factor > limit;
      all_below = all_below && factor < 1.0 / limit;
    }
    if (!all_above && !all_below) continue;
    const double factor = std::exp(sum / static_cast<double>(compared));
    questions.push_back("Record '" + record.record +
                        "': the responses have peaks at " +
                        FormatNumber(record.hz[0], 3) +
                        " Hz and above, but the modes of the model begin at " +
                        FormatNumber(model[0], 3) + " Hz, " +
                        FormatNumber(all_above ? factor : 1.0 / factor, 3) +
                        (all_above ? " times lower." : " times higher.") +
                        " Check the units of mass, stiffness and time." +
                        SlipOf(factor, units));
  }
  return questions;
}

}  // namespace pinode
