#include "pinode/case/run/find_frf_modes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/case/text/csv_file.h"

namespace pinode {
namespace {

// Half-power width of a resonance, in lines, from which Hann's window leaves
// the damping as it is.
constexpr double kFewestLinesOfResonance = 4.0;
// Vibration that is left of a blow, from which modes are in error. With 13 %
// left before each blow, an exponential window made the damping 18 % too small.
constexpr double kMuchVibration = 0.05;

// Origin of the functions, which decides what a user can change.
enum class FrfSource { kRecords, kOneFile, kSeveralFiles };

// Remark on FRFs that the modes do not describe; empty if they do.
std::string LeftByModes(const ModesOfFrfs& frfs, FrfSource source) {
  // A tenth is left by a drift of two files of a free beam, whose intervals
  // then excluded the frequencies of the others.
  constexpr double kMuch = 0.1;
  if (frfs.errors.size() == 0 || !(frfs.errors.maxCoeff() > kMuch)) {
    return "";
  }
  const std::string begin =
      "The modes leave up to " +
      FormatNumber(100.0 * frfs.errors.maxCoeff(), 3) +
      " % of a frequency response function, and the intervals may be too "
      "narrow. A mode may be missing, or the structure has changed ";
  switch (source) {
    case FrfSource::kRecords:
      return begin +
             "during the test: set lowest_hz and highest_hz in [modes].";
    case FrfSource::kOneFile:
      return begin + "during the test: try another --frf_band.";
    case FrfSource::kSeveralFiles:
      break;
  }
  return begin +
         "between the files: try --frf_poles=per_file or another --frf_band.";
}

// Puts the modes of `all` together with its remarks.
bool CollectFrfModes(const FrequencyResponses& all, FrfSource source,
                     const ModesOfFrfs& frfs, FoundModes* found,
                     std::string* error) {
  *found = FoundModes();
  ModesResult& result = found->result;
  result.remarks = all.remarks;
  result.setups = {all.name};
  result.remarks.insert(result.remarks.end(), frfs.record.remarks.begin(),
                        frfs.record.remarks.end());
  const std::string left = LeftByModes(frfs, source);
  if (!left.empty()) result.remarks.push_back(left);
  SetupModes modes;
  modes.name = all.name;
  modes.places = frfs.places;
  modes.modes = frfs.record.modes;
  if (!MergeSetups({modes}, {}, &result.merged, error)) return false;
  found->by_record = {frfs.record};
  return true;
}

// Remark on a mode that has not decayed when the next blow comes, or at the end
// of a block; empty: none.
std::string SayDecay(const EstimatedFrfs& estimated, const ModesOfFrfs& frfs) {
  if (!(estimated.block_seconds > 0.0)) return "";
  for (const IdentifiedMode& mode : frfs.record.modes) {
    const double decay = kTwoPi * mode.frequency_hz * mode.damping_ratio;
    const double before = estimated.shortest_rest > 0.0
                              ? std::exp(-decay * estimated.shortest_rest)
                              : 0.0;
    const double after =
        std::exp(-(decay + estimated.all.decay_rate) * estimated.block_seconds);
    const std::string begin =
        "The vibration at " + FormatNumber(mode.frequency_hz, 4) +
        " Hz is at " + FormatNumber(100.0 * std::max(before, after), 2) + " % ";
    if (before > kMuchVibration) {
      return begin +
             "of its size when the next blow comes, so that its frequency and "
             "damping are in error: wait longer between the blows. No window "
             "helps against it.";
    }
    if (after > kMuchVibration) {
      return begin +
             "of its size at the end of a block, which changes its damping: "
             "set "
             "a longer block, or exponential_window in [modes.frf].";
    }
  }
  return "";
}

// Remark on resonances that are narrower than the lines can show; empty: none.
std::string SayLeakage(const EstimatedFrfs& estimated,
                       const ModesOfFrfs& frfs) {
  if (!estimated.has_leakage) return "";
  for (const IdentifiedMode& mode : frfs.record.modes) {
    const double width = 2.0 * mode.damping_ratio * mode.frequency_hz;
    if (width >= kFewestLinesOfResonance * estimated.line_distance_hz) {
      continue;
    }
    return "The resonance at " + FormatNumber(mode.frequency_hz, 4) +
           " Hz is only " +
           FormatNumber(width / estimated.line_distance_hz, 2) +
           " lines wide, so that the blocks widen it and its damping is too "
           "large: set a longer block in [modes.frf].";
  }
  return "";
}

}  // namespace

bool FindModesOfEstimatedFrfs(const ModesCase& c, EstimatedFrfs* estimated,
                              ModesOfFrfs* frfs, FoundModes* found,
                              std::string* error) {
  FrfModesOptions options;
  options.identification = c.options;
  if (!EstimateFrfsOfCase(c, estimated, error)) return false;
  ModeIdentificationOptions& band = options.identification;
  if (!(band.lowest_hz > 0.0)) band.lowest_hz = estimated->lowest_hz;
  if (!(band.highest_hz > 0.0)) band.highest_hz = estimated->highest_hz;
  std::string message;
  if (!FindFrfModes(estimated->all, options, frfs, &message) ||
      !CollectFrfModes(estimated->all, FrfSource::kRecords, *frfs, found,
                       &message)) {
    *error = c.path + ": " + message;
    return false;
  }
  std::vector<std::string>& remarks = found->result.remarks;
  remarks.insert(remarks.begin(), c.remarks.begin(), c.remarks.end());
  for (const std::string& remark :
       {SayLeakage(*estimated, *frfs), SayDecay(*estimated, *frfs)}) {
    if (!remark.empty()) remarks.push_back(remark);
  }
  PlaceModes(c, found);
  return true;
}

bool FindModesOfFrfFiles(const FrfSetup& setup, ModesOfFrfs* frfs,
                         FoundModes* found, std::string* error) {
  FrequencyResponses all;
  if (!ReadFrfFiles(setup, &all, error) ||
      !FindFrfModes(all, setup.options, frfs, error)) {
    return false;
  }
  const FrfSource source =
      setup.files.size() > 1 ? FrfSource::kSeveralFiles : FrfSource::kOneFile;
  return CollectFrfModes(all, source, *frfs, found, error);
}

bool WriteFrfFiles(const ModesOfFrfs& frfs, const std::string& folder,
                   std::string* error) {
  const Eigen::Index count = static_cast<Eigen::Index>(frfs.scales.size());
  std::vector<CsvColumn> columns;
  const auto add = [&](const std::string& name,
                       const std::function<double(const FrfModeScale&)>& of) {
    Vector values(count);
    for (Eigen::Index m = 0; m < count; ++m) {
      values[m] = of(frfs.scales[static_cast<size_t>(m)]);
    }
    columns.emplace_back(name, values);
  };
  columns.emplace_back(
      "mode", Vector::LinSpaced(count, 1.0, static_cast<double>(count)));
  add("modal_mass", [](const FrfModeScale& s) { return s.modal_mass; });
  add("modal_mass_sigma",
      [](const FrfModeScale& s) { return s.modal_mass_sigma; });
  add("modal_a_real", [](const FrfModeScale& s) { return s.modal_a.real(); });
  add("modal_a_imaginary",
      [](const FrfModeScale& s) { return s.modal_a.imag(); });
  for (size_t p = 0; p < frfs.pair_names.size(); ++p) {
    const Eigen::Index pair = static_cast<Eigen::Index>(p);
    const std::string& name = frfs.pair_names[p];
    add(name + "_real", [pair](const FrfModeScale& s) {
      return s.residues.reshaped()[pair].real();
    });
    add(name + "_imaginary", [pair](const FrfModeScale& s) {
      return s.residues.reshaped()[pair].imag();
    });
    add(name + "_sigma_real", [pair](const FrfModeScale& s) {
      return s.sigma_real.reshaped()[pair];
    });
    add(name + "_sigma_imaginary", [pair](const FrfModeScale& s) {
      return s.sigma_imaginary.reshaped()[pair];
    });
  }
  return WriteCsv(folder + "/residues.csv", columns, error);
}

}  // namespace pinode
