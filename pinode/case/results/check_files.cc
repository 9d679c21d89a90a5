#include "pinode/case/results/check_files.h"

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/case/sections/finite_element_section.h"
#include "pinode/case/text/json_table.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/model/modal_mass.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// JSON has null for a number that is not known.
constexpr double kUnknown = kNaN;

double ToHz(const Case& c) {
  return c.problem.description.HzPerModelFrequency();
}

double ExpectedHz(const std::vector<double>& expected, Eigen::Index mode) {
  const auto i = static_cast<size_t>(mode);
  return mode >= 0 && i < expected.size() ? expected[i] : kUnknown;
}

Json Modes(const Case& c, const CaseCheck& check) {
  Json modes = Json::array();
  if (check.modes.frequency_hz.size() == 0) return modes;
  const std::vector<std::string>& directions = check.model.directions;
  const ModalMasses masses =
      EffectiveModalMasses(check.model, check.modes.mode_shapes);
  const Matrix shares = masses.Shares();
  for (Eigen::Index i = 0; i < check.modes.frequency_hz.size(); ++i) {
    Json mode = {{"mode", i + 1},
                 {"frequency_hz", ToHz(c) * check.modes.frequency_hz[i]},
                 {"damping_ratio", check.modes.damping_ratio[i]},
                 {"expected_hz", ExpectedHz(c.expected_hz, i)}};
    for (size_t d = 0; d < directions.size(); ++d) {
      const auto column = static_cast<Eigen::Index>(d);
      mode["participation_" + directions[d]] = masses.participation(i, column);
      mode["effective_mass_" + directions[d]] = masses.effective(i, column);
      mode["mass_share_" + directions[d]] = shares(i, column);
    }
    modes.push_back(std::move(mode));
  }
  return modes;
}

// Returns the modes of the whole model, each compared with its reduction.
Json WholeModesAsJson(const Case& c) {
  const ReducedStructure& source = *c.finite_element;
  const ReducedModel& reduced = source.reduced;
  const SparseModes& whole = reduced.whole_modes;
  Json modes = Json::array();
  for (Eigen::Index i = 0; i < whole.frequency_hz.size(); ++i) {
    const bool compared = i < reduced.mac.size();
    modes.push_back(
        {{"mode", i + 1},
         {"whole_hz", ToHz(c) * whole.frequency_hz[i]},
         {"expected_hz",
          ExpectedHz(source.expected_hz, i - whole.num_rigid_body_modes)},
         {"frequency_error", compared ? reduced.frequency_error[i] : kUnknown},
         {"mac", compared ? reduced.mac[i] : kUnknown}});
  }
  return modes;
}

Json FiniteElement(const Case& c) {
  if (c.finite_element == nullptr) return nullptr;
  const ReducedStructure& source = *c.finite_element;
  Json json;
  json["dofs"] = source.exported.num_dofs();
  json["removed"] = source.removed_dofs.size();
  json["rigid_body_modes"] = source.reduced.whole_modes.num_rigid_body_modes;
  json["reduction"] = source.is_reduced
                          ? Json(ReductionMethodName(source.options.method))
                          : Json(nullptr);
  json["notes"] = source.notes;
  json["modes"] = WholeModesAsJson(c);
  return json;
}

Json Records(const Case& c) {
  Json records = Json::array();
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    const IdentificationRecord& record = c.problem.records[r];
    const SubstepChoice& choice = c.substeps[r];
    Json entry;
    entry["name"] = record.name;
    entry["role"] =
        record.role == IdentificationRecord::Role::kTrain ? "train" : "holdout";
    entry["samples"] = record.num_samples();
    entry["step"] = record.sampling_step();
    entry["channels"] = Json::array();
    for (const MeasuredChannel& channel : record.channels) {
      entry["channels"].push_back(channel.observation.name);
    }
    entry["integrator"] = IntegratorName(choice.integrator);
    entry["substeps"] = choice.integrator == Integrator::kExact ? Json(nullptr)
                        : choice.integrator == Integrator::kExponential
                            ? Json(record.exponential_steps)
                            : Json(record.substeps);
    entry["fastest_mode"] = choice.stability.largest_eigenvalue;
    entry["remarks"] = record.description.remarks;
    records.push_back(std::move(entry));
  }
  return records;
}

Json Peaks(const CaseCheck& check) {
  Json peaks = Json::array();
  for (const RecordPeaks& record : check.record_peaks) {
    peaks.push_back({{"record", record.record}, {"hz", record.hz}});
  }
  return peaks;
}

Json AmbientRecords(const Case& c) {
  Json records = Json::array();
  for (const AmbientRecord& record : c.problem.ambient) {
    Json entry;
    entry["name"] = record.name;
    entry["samples"] = record.samples.cols();
    entry["step"] = record.sampling_step;
    entry["channels"] = Json::array();
    for (const Observation& channel : record.channels) {
      entry["channels"].push_back(channel.name);
    }
    records.push_back(std::move(entry));
  }
  return records;
}

Json FrequencyResponseSets(const Case& c) {
  Json all = Json::array();
  for (const FrfRecord& record : c.problem.frfs) {
    Json pairs = Json::array();
    for (Eigen::Index p = 0; p < record.num_pairs(); ++p) {
      pairs.push_back(record.PairName(p));
    }
    all.push_back(
        {{"name", record.name},
         {"lines", record.num_lines()},
         {"lowest_hz", ToHz(c) * record.frequencies[0]},
         {"highest_hz", ToHz(c) * record.frequencies[record.num_lines() - 1]},
         {"pairs", pairs}});
  }
  return all;
}

Json MeasuredModes(const Case& c, const CaseCheck& check) {
  Json modes = Json::array();
  for (size_t i = 0; i < check.mode_in_use.size(); ++i) {
    const MeasuredMode& mode = c.problem.modal.modes[i];
    const ModeMatch& match = check.mode_match[i];
    const bool used = check.mode_in_use[i];
    modes.push_back({{"name", mode.name},
                     {"frequency_hz", ToHz(c) * mode.frequency},
                     {"in_use", used},
                     {"mode", used ? Json(match.mode + 1) : Json(nullptr)},
                     {"model_hz", ToHz(c) * match.frequency},
                     {"mac", match.mac}});
  }
  return modes;
}

Json Expected(const ProblemAssessment& assessment) {
  Json expected = Json::array();
  for (const ExpectedDeviation& parameter : assessment.expected) {
    expected.push_back({{"name", parameter.name},
                        {"unit", parameter.unit},
                        {"initial", parameter.initial},
                        {"sigma", parameter.sigma}});
  }
  return expected;
}

Json Check(const Case& c, const CaseCheck& check) {
  const ProblemDescription& description = c.problem.description;
  const ProblemAssessment& assessment = check.assessment;
  const bool assessed = check.has_measurements && check.ok();
  Json json;
  json["schema"] = "pinode-check-1";
  json["case"] = c.path;
  json["title"] = description.title;
  json["assessed"] = assessed;
  json["message"] = !check.has_measurements ? "nothing was measured"
                    : !check.ok()           ? check.not_assessed
                    : !check.confusions.empty()
                        ? "every named parameter is determined by the data, if "
                          "the case is right about the confusions"
                    : assessment.undetermined.empty()
                        ? "every named parameter is determined by the data"
                        : "the data do not determine every named parameter";
  json["dofs"] = check.model.dof_names;
  json["num_states"] = c.problem.dynamics->num_states();
  json["units"] = {{"force", description.units.force},
                   {"length", description.units.length},
                   {"time", description.units.time}};
  json["no_modes"] =
      check.no_modes.empty() ? Json(nullptr) : Json(check.no_modes);
  json["modes"] = Modes(c, check);
  json["finite_element"] = FiniteElement(c);
  json["records"] = Records(c);
  json["ambient"] = AmbientRecords(c);
  json["frfs"] = FrequencyResponseSets(c);
  json["peaks"] = Peaks(check);
  json["questions"] = check.questions;
  json["measured_modes"] = MeasuredModes(c, check);
  json["candidates"] = Json::array();
  for (const ModelCandidate& candidate : c.candidates) {
    json["candidates"].push_back(candidate.name);
  }
  json["free_parameters"] =
      assessed ? Json(assessment.num_free) : Json(nullptr);
  json["residuals"] = assessed ? Json(assessment.num_residuals) : Json(nullptr);
  json["start_states"] = assessed ? Json(assessment.num_starts) : Json(nullptr);
  json["expected"] = Expected(assessment);
  json["undetermined"] = assessment.undetermined;
  json["confusions"] = check.confusions;
  json["remarks"] = description.remarks;
  for (const std::string& remark : assessment.remarks) {
    json["remarks"].push_back(remark);
  }
  return json;
}

std::string Text(const Json& json) {
  // Names that are not UTF-8 must not end the program.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string CheckAsJson(const Case& c, const CaseCheck& check) {
  return Text(Check(c, check));
}

bool WriteCheckFiles(const Case& c, const CaseCheck& check,
                     const std::string& folder, std::string* error) {
  const Json json = Check(c, check);
  if (!WriteFileAtomically(folder + "/check.json", Text(json), error)) {
    return false;
  }
  const auto write_table = [&](const char* name, const Json& entries) {
    return entries.empty() ||
           WriteFileAtomically(folder + "/" + name, TableOfEntries(entries),
                               error);
  };
  if (!write_table("modes.csv", json["modes"]) ||
      !write_table("measured_modes.csv", json["measured_modes"]) ||
      !write_table("expected.csv", json["expected"]) ||
      (c.finite_element != nullptr &&
       !write_table("reduction.csv", json["finite_element"]["modes"]))) {
    return false;
  }
  const auto write_matrix = [&](const char* name, const Matrix& matrix) {
    return matrix.size() == 0 ||
           WriteMatrixMarket(folder + "/" + name, matrix, error);
  };
  return write_matrix("M.mtx", check.model.mass) &&
         write_matrix("C.mtx", check.model.damping) &&
         write_matrix("K.mtx", check.model.stiffness) &&
         write_matrix("mode_shapes.mtx", check.modes.mode_shapes);
}

bool MayGiveWayToCheck(const std::string& folder, std::string* error) {
  for (const char* name : {"result.json", "discover.json", "modes.json",
                           "damage.json", "simulate.json", "checkpoint.json"}) {
    std::error_code status;
    if (!std::filesystem::exists(std::filesystem::path(folder) / name,
                                 status)) {
      continue;
    }
    *error = folder + ": has " + name +
             ", which a check does not replace; give another folder";
    return false;
  }
  return true;
}

}  // namespace pinode
