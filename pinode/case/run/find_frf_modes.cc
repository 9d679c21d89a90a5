#include "pinode/case/run/find_frf_modes.h"

#include <complex>
#include <functional>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/record/frf/frf_files.h"

namespace pinode {
namespace {

bool SetDerivative(const std::string& quantity, FrfFileOptions* options,
                   std::string* error) {
  if (quantity.empty()) return true;
  const char* const names[] = {"displacement", "velocity", "acceleration"};
  for (int d = 0; d < 3; ++d) {
    if (quantity == names[d]) options->derivative = d;
  }
  if (options->derivative >= 0) return true;
  *error = "quantity '" + quantity +
           "', expected acceleration, velocity or displacement per force";
  return false;
}

// The names of file i, if there is one for each file.
std::vector<std::string> NamesOf(const std::vector<std::string>& names,
                                 size_t i, size_t files) {
  if (names.size() <= 1 || files == 1) return names;
  return {names[i]};
}

bool Read(const FrfSetup& setup, FrequencyResponses* all, std::string* error) {
  const size_t count = setup.files.size();
  for (const auto& [key, names] :
       {std::make_pair("responses", &setup.responses),
        std::make_pair("references", &setup.references)}) {
    if (count > 1 && names->size() > 1 && names->size() != count) {
      *error = std::to_string(names->size()) + " " + key + " for " +
               std::to_string(count) +
               " files, expected one for all or one for each";
      return false;
    }
  }
  std::vector<FrequencyResponse> single;
  std::vector<std::string> remarks;
  for (size_t i = 0; i < count; ++i) {
    FrfFileOptions options;
    if (!SetDerivative(setup.quantity, &options, error)) return false;
    options.responses = NamesOf(setup.responses, i, count);
    options.references = NamesOf(setup.references, i, count);
    // A file of text has one function, whose places it seldom names.
    if (!IsUniversalFile(WithoutGz(setup.files[i]))) {
      if (options.responses.empty()) options.responses = {"response"};
      if (options.references.empty()) {
        options.references = {"reference" +
                              (count > 1 ? std::to_string(i + 1) : "")};
      }
    }
    if (!ReadFrfFile(setup.files[i], options, &single, &remarks, error)) {
      return false;
    }
  }
  if (!AssembleFrequencyResponses(single, all, error)) return false;
  all->name = setup.files[0].substr(setup.files[0].find_last_of('/') + 1);
  all->remarks = std::move(remarks);
  return true;
}

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
  if (!Read(setup, &all, error) ||
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
