#include "pinode/case/sections/frf_section.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/signal_section.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/record/frf/frf_files.h"

namespace pinode {
namespace {

// Lines with a deviation below this share of their pair's root mean square
// count as lines with so much: zeros of an FRF have no certain value, and a
// coherence of exactly 1 is rounding.
constexpr double kLeastRelative = 1e-3;

bool SetFrfDerivative(const std::string& quantity, FrfFileOptions* options,
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
std::vector<std::string> FrfNamesOf(const std::vector<std::string>& names,
                                    size_t i, size_t files) {
  if (names.size() <= 1 || files == 1) return names;
  return {names[i]};
}

bool AreAlike(const Parameter& a, const Parameter& b) {
  return a.unit == b.unit && a.value == b.value && a.lower == b.lower &&
         a.upper == b.upper && a.prior_mean == b.prior_mean &&
         a.prior_sigma == b.prior_sigma && a.free == b.free && a.tie == b.tie &&
         a.tie_factor == b.tie_factor;
}

class FrfReader {
 public:
  FrfReader(const TomlTable& table, const UnitSystem& units,
            const StructuralModel& model, IdentificationProblem* problem)
      : table_(table), units_(units), model_(model), problem_(*problem) {}

  bool Read(size_t number) {
    if (!table_.AllowKeys() ||
        !table_.RequireKey("files", "the files of the functions")) {
      return false;
    }
    record_.name = table_.String("name", "frf " + std::to_string(number));
    for (const FrfRecord& other : problem_.frfs) {
      if (other.name == record_.name) {
        return table_.Fail("name",
                           "this name is used twice, expected different names");
      }
    }
    if (!ReadMeasured() || !ReadPlaces() || !ReadLines() || !ReadNoise() ||
        !ReadUnknowns()) {
      return false;
    }
    std::string message;
    if (!record_.IsValid(*problem_.dynamics, problem_.sensors.size(),
                         &message)) {
      return table_.Fail("files", message);
    }
    problem_.frfs.push_back(std::move(record_));
    return true;
  }

 private:
  bool ReadMeasured() {
    FrfFiles files;
    for (const std::string& file : table_.Strings("files")) {
      files.files.push_back(ResolvePath(table_, file));
    }
    files.responses = table_.Strings("responses");
    files.references = table_.Strings("references");
    files.quantity = table_.Choice(
        "quantity", {"acceleration", "velocity", "displacement"}, "");
    if (!table_.errors()->ok()) return false;
    if (files.files.empty()) {
      return table_.Fail("files", "'files' is empty, expected at least one");
    }
    for (const std::string& file : files.files) {
      if (!FileExists(table_, file)) return false;
    }
    std::string message;
    if (!ReadFrfFiles(files, &measured_, &message)) {
      return table_.errors()->FailAsIs(message);
    }
    if (measured_.decay_rate > 0.0) {
      return table_.Fail(
          "files",
          "the functions were measured with an exponential window, which a fit "
          "would take for damping; fit functions without a window, or the "
          "modes of pinode_modes, which are corrected for it");
    }
    for (const std::string& remark : measured_.remarks) {
      problem_.description.remarks.push_back("Frequency responses '" +
                                             record_.name + "': " + remark);
    }
    return true;
  }

  // Finds the DOF of a place, and the sign of its direction.
  bool FindPlace(const std::string& place, const std::string& key, int* dof,
                 double* sign) {
    const TomlTable dofs = table_.Has("dofs")
                               ? table_.Table("dofs", table_.name() + ", dofs")
                               : table_;
    std::string name = place;
    *sign = 1.0;
    std::string named_by = key;
    if (table_.Has("dofs") && dofs.Has(place)) {
      name = dofs.String(place);
      if (!table_.errors()->ok()) return false;
      named_by = "dofs";
      if (!name.empty() && name[0] == '-') {
        name.erase(0, 1);
        *sign = -1.0;
      }
    }
    return FindDof(model_, table_, table_.Has(named_by) ? named_by : "files",
                   name, /*ground_allowed=*/false, dof);
  }

  bool ReadPlaces() {
    const Quantity quantities[] = {Quantity::kDisplacement, Quantity::kVelocity,
                                   Quantity::kRelativeAcceleration};
    for (const std::string& place : measured_.responses) {
      int dof = -1;
      double sign = 1.0;
      if (!FindPlace(place, "responses", &dof, &sign)) return false;
      Observation response;
      response.name = place;
      response.quantity = quantities[measured_.derivative];
      response.weights = sign * Vector::Unit(model_.num_dofs(), dof);
      record_.responses.push_back(std::move(response));
    }
    record_.references =
        Matrix::Zero(model_.num_dofs(), measured_.num_references());
    for (Eigen::Index j = 0; j < measured_.num_references(); ++j) {
      const std::string& place = measured_.references[static_cast<size_t>(j)];
      int dof = -1;
      double sign = 1.0;
      if (!FindPlace(place, "references", &dof, &sign)) return false;
      record_.references(dof, j) = sign;
      record_.reference_names.push_back(place);
    }
    return true;
  }

  // Keeps the lines of the band, and converts to the model's units.
  bool ReadLines() {
    std::vector<double> band = {0.0, measured_.frequencies_hz.maxCoeff()};
    if (table_.Has("band_hz")) {
      band = table_.Numbers("band_hz", 2, "end: from and to");
      if (!table_.errors()->ok()) return false;
      if (!(band[0] >= 0.0) || !(band[1] > band[0])) {
        return table_.Fail("band_hz",
                           "expected two frequencies, the second larger");
      }
    }
    const int stride = table_.Integer("stride", 1, 1, 1000000);
    if (!table_.errors()->ok()) return false;
    for (Eigen::Index k = 0; k < measured_.num_lines(); ++k) {
      const double hz = measured_.frequencies_hz[k];
      if (hz > 0.0 && hz >= band[0] && hz <= band[1]) lines_.push_back(k);
    }
    for (size_t i = 0; i * static_cast<size_t>(stride) < lines_.size(); ++i) {
      lines_[i] = lines_[i * static_cast<size_t>(stride)];
    }
    lines_.resize((lines_.size() + static_cast<size_t>(stride) - 1) /
                  static_cast<size_t>(stride));
    std::string message;
    double second = 1.0;
    double per_response = 1.0;
    double per_force = 1.0;
    const Dimension dimension = DimensionOf(record_.responses.front().quantity);
    if (!UnitFactor("s", Dimension::kTime, units_, &second, &message)) {
      return table_.Fail("files", message);
    }
    if (table_.Has("unit") && !UnitFactor(table_.String("unit"), dimension,
                                          units_, &per_response, &message)) {
      return table_.Fail("unit", message);
    }
    if (table_.Has("force_unit") &&
        !UnitFactor(table_.String("force_unit"), Dimension::kForce, units_,
                    &per_force, &message)) {
      return table_.Fail("force_unit", message);
    }
    factor_ = per_response / per_force;
    record_.frequencies = measured_.frequencies_hz(lines_) / second;
    record_.values = factor_ * measured_.values(lines_, Eigen::all);
    return table_.errors()->ok();
  }

  bool ReadNoise() {
    const bool has_coherence = measured_.variances.size() > 0;
    const std::string noise =
        table_.Choice("noise", {"constant", "relative", "coherence"},
                      has_coherence ? "coherence" : "constant");
    if (!table_.errors()->ok()) return false;
    if (noise == "coherence") {
      if (!has_coherence) {
        return table_.Fail("noise",
                           "the files have no coherence, expected "
                           "\"constant\" or \"relative\"");
      }
      record_.variances = measured_.variances(lines_, Eigen::all);
    } else if (noise == "relative") {
      record_.variances = record_.values.cwiseAbs2();
    }
    // Relative to their mean: `sigma` is the noise of a mean line.
    for (auto column : record_.variances.colwise()) {
      const double mean = column.mean();
      if (!(mean > 0.0)) continue;
      column = (column / mean).cwiseMax(kLeastRelative * kLeastRelative);
    }
    if (table_.Has("sigma")) {
      const double sigma =
          std::abs(factor_) * table_.PositiveNumber("sigma", 1.0);
      record_.sigma = Vector::Constant(record_.num_pairs(), sigma);
    }
    return table_.errors()->ok();
  }

  // Reads one unknown, which other sections may have as well. *index: that of
  // the sensors, -1 without the key.
  bool ReadUnknown(const std::string& key, double factor, Parameter parameter,
                   int* index) {
    *index = -1;
    if (!table_.Has(key)) return true;
    const TomlTable keys = table_.Table(key, table_.name() + ", " + key);
    if (!table_.errors()->ok() || !keys.AllowKeys()) return false;
    parameter.free = false;
    parameter.prior_mean = parameter.value;
    if (!ReadParameterKeys(keys, factor, &parameter)) return false;
    std::vector<Parameter>& all = problem_.sensors.parameters;
    const auto known = std::find_if(
        all.begin(), all.end(),
        [&](const Parameter& other) { return other.name == parameter.name; });
    *index = static_cast<int>(known - all.begin());
    if (known == all.end()) {
      all.push_back(std::move(parameter));
    } else if (!AreAlike(*known, parameter)) {
      return table_.Fail(key, "'" + parameter.name +
                                  "' is given twice with different values, "
                                  "expected the same, or another name of the "
                                  "sensor");
    }
    return true;
  }

  bool ReadUnknowns() {
    double second = 1.0;
    std::string message;
    if (!UnitFactor("s", Dimension::kTime, units_, &second, &message)) {
      return table_.Fail("delay", message);
    }
    for (const Observation& response : record_.responses) {
      Parameter gain;
      gain.name = "gain." + response.name;
      gain.value = 1.0;
      Parameter delay;
      delay.name = "delay." + response.name;
      delay.unit = UnitName(Dimension::kTime, units_);
      record_.gains.push_back(-1);
      record_.delays.push_back(-1);
      if (!ReadUnknown("gain", 1.0, gain, &record_.gains.back()) ||
          !ReadUnknown("delay", second, delay, &record_.delays.back())) {
        return false;
      }
    }
    Parameter loss;
    loss.name = "loss_factor";
    loss.lower = 0.0;
    return ReadUnknown("loss_factor", 1.0, loss, &record_.loss_factor);
  }

  const TomlTable& table_;
  const UnitSystem& units_;
  const StructuralModel& model_;
  IdentificationProblem& problem_;
  FrequencyResponses measured_;
  std::vector<Eigen::Index> lines_;
  double factor_ = 1.0;
  FrfRecord record_;
};

}  // namespace

bool ReadFrfFiles(const FrfFiles& files, FrequencyResponses* all,
                  std::string* error) {
  const size_t count = files.files.size();
  for (const auto& [key, names] :
       {std::make_pair("responses", &files.responses),
        std::make_pair("references", &files.references)}) {
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
    if (!SetFrfDerivative(files.quantity, &options, error)) return false;
    options.responses = FrfNamesOf(files.responses, i, count);
    options.references = FrfNamesOf(files.references, i, count);
    // A file of text has one function, whose places it seldom names.
    if (!IsUniversalFile(WithoutGz(files.files[i]))) {
      if (options.responses.empty()) options.responses = {"response"};
      if (options.references.empty()) {
        options.references = {"reference" +
                              (count > 1 ? std::to_string(i + 1) : "")};
      }
    }
    if (!ReadFrfFile(files.files[i], options, &single, &remarks, error)) {
      return false;
    }
  }
  if (!AssembleFrequencyResponses(single, all, error)) return false;
  all->name = files.files[0].substr(files.files[0].find_last_of('/') + 1);
  all->remarks = std::move(remarks);
  return true;
}

bool ReadFrfSections(const TomlTable& root, const UnitSystem& units,
                     const StructuralModel& model,
                     IdentificationProblem* problem) {
  size_t number = 0;
  for (const TomlTable& table : root.Tables("frf")) {
    if (!FrfReader(table, units, model, problem).Read(++number)) return false;
  }
  return root.errors()->ok();
}

}  // namespace pinode
