#include "pinode/case/run/find_frf_modes.h"

#include <complex>
#include <functional>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/text/csv_file.h"

namespace pinode {
namespace {

// Remark on FRFs that the modes do not describe; empty if they do.
std::string LeftByModes(const ModesOfFrfs& frfs, const FrfSetup& setup) {
  // A tenth is left by a drift of two files of a free beam, whose intervals
  // then excluded the frequencies of the others.
  constexpr double kMuch = 0.1;
  if (frfs.errors.size() == 0 || !(frfs.errors.maxCoeff() > kMuch)) {
    return "";
  }
  return "The modes leave up to " +
         FormatNumber(100.0 * frfs.errors.maxCoeff(), 3) +
         " % of a frequency response function, and the intervals may be too "
         "narrow. A mode may be missing, or the structure has changed between "
         "the files" +
         (setup.files.size() > 1
              ? ": try --frf_poles=per_file or another --frf_band."
              : ": try another --frf_band.");
}

}  // namespace

bool FindModesOfFrfFiles(const FrfSetup& setup, ModesOfFrfs* frfs,
                         FoundModes* found, std::string* error) {
  FrequencyResponses all;
  if (!ReadFrfFiles(setup, &all, error) ||
      !FindFrfModes(all, setup.options, frfs, error)) {
    return false;
  }
  *found = FoundModes();
  ModesResult& result = found->result;
  result.remarks = all.remarks;
  result.setups = {all.name};
  result.remarks.insert(result.remarks.end(), frfs->record.remarks.begin(),
                        frfs->record.remarks.end());
  const std::string left = LeftByModes(*frfs, setup);
  if (!left.empty()) result.remarks.push_back(left);
  SetupModes modes;
  modes.name = all.name;
  modes.places = frfs->places;
  modes.modes = frfs->record.modes;
  if (!MergeSetups({modes}, {}, &result.merged, error)) return false;
  found->by_record = {frfs->record};
  return true;
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
