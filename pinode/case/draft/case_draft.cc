#include "pinode/case/draft/case_draft.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/case/draft/damping_draft.h"
#include "pinode/case/draft/deck_draft.h"
#include "pinode/case/draft/first_mode.h"
#include "pinode/case/draft/floor_weights.h"
#include "pinode/case/draft/record_draft.h"
#include "pinode/structure/model/damping.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/shear_building.h"

namespace pinode {
namespace {

constexpr int kMostStoreys = 100;
// Without a model at hand, Rayleigh's damping has the given ratio at the first
// mode and at this many times its frequency.
constexpr double kBandOfDamping = 5.0;

bool ParsePositive(const std::string& text, const std::string& flag,
                   const std::string& what, double* value, std::string* error) {
  if (ParseDouble(text, value) && std::isfinite(*value) && *value > 0.0) {
    return true;
  }
  *error = "--" + flag + " is " + Quote(text) + ", expected " + what;
  return false;
}

// Refuses a file that is given twice, under two names too.
bool CheckFiles(const DraftRequest& request, std::string* error) {
  std::vector<std::string> files = request.logs;
  files.insert(files.end(), request.later_logs.begin(),
               request.later_logs.end());
  std::vector<std::string> contents(files.size());
  for (size_t i = 0; i < files.size(); ++i) {
    if (!ReadBinaryFile(files[i], &contents[i], error)) return false;
    for (size_t j = 0; j < i; ++j) {
      if (contents[j] != contents[i]) continue;
      *error = files[j] == files[i]
                   ? files[i] + " is given twice; give each record once"
                   : files[i] + " is a copy of " + files[j] +
                         "; give each record once";
      return false;
    }
  }
  for (const std::string& path : {request.case_path, request.later_case_path}) {
    for (const std::string& file : files) {
      std::error_code status;
      if (std::filesystem::equivalent(path, file, status)) {
        *error = "--case is also a record: " + file + "; give another name";
        return false;
      }
    }
  }
  if (request.holdout.empty() || request.holdout == "none" ||
      std::count(files.begin(), files.end(), request.holdout) > 0) {
    return true;
  }
  *error = "--holdout: " + Quote(request.holdout) +
           " is not one of the records; use one of " + Join(files, " ") +
           " or none";
  return false;
}

bool ReadStoreys(const DraftRequest& request, int* storeys,
                 DraftQuestion* question, std::string* error) {
  if (request.storeys.empty()) {
    *question = {"storeys",
                 "The number of storeys is not known (for a finite-element "
                 "model give --deck)",
                 "5"};
    return false;
  }
  if (ParseInt(request.storeys, storeys) && *storeys >= 1 &&
      *storeys <= kMostStoreys) {
    return true;
  }
  *error = "--storeys is " + Quote(request.storeys) + ", expected 1 to " +
           std::to_string(kMostStoreys);
  return false;
}

bool SetDampingRatio(const DraftRequest& request, CaseDraft* draft,
                     std::string* error) {
  if (!ParsePositive(request.damping_ratio, "damping_ratio",
                     "a fraction of critical such as 0.02",
                     &draft->damping_ratio, error)) {
    return false;
  }
  if (draft->damping_ratio < 1.0) return true;
  *error = "--damping_ratio is " + request.damping_ratio +
           ", expected a fraction of critical; 2 % is 0.02";
  return false;
}

// Sets masses and damping ratio, which no record tells.
bool SetMasses(const DraftRequest& request, int storeys, CaseDraft* draft,
               DraftQuestion* question, std::string* error) {
  if (request.weights.empty()) {
    *question = {"weights", "The weights of the floors are not known",
                 "\"900 kN\" (one for all floors, or one each from the lowest "
                 "up, with commas; units: N kN MN kgf lbf kip kg t)"};
    return false;
  }
  FloorMasses masses;
  if (!ParseFloorWeights(request.weights, storeys, &masses, error)) {
    return false;
  }
  draft->units = masses.units;
  draft->masses = masses.masses;
  draft->masses_origin = masses.origin;
  return SetDampingRatio(request, draft, error);
}

// Sets the model of a deck: its files, units, and the factor of its exports.
bool SetDeck(const DraftRequest& request, CaseDraft* draft,
             DraftQuestion* question, std::string* error) {
  for (const auto& [flag, text] : {std::pair<const char*, const std::string&>{
                                       "--storeys", request.storeys},
                                   {"--weights", request.weights},
                                   {"--stiffness", request.stiffness}}) {
    if (text.empty()) continue;
    *error = std::string(flag) + " and --deck, expected one of them";
    return false;
  }
  if (request.deck_units.empty()) {
    *question = {"deck_units",
                 "The units of force and length in the deck are not known",
                 "N,mm (or N,m, kip,in, ...)"};
    return false;
  }
  const std::vector<std::string_view> units = Split(request.deck_units, ',');
  if (units.size() == 2) {
    draft->units.force = CanonicalUnit(units[0]);
    draft->units.length = CanonicalUnit(units[1]);
  }
  if (units.size() != 2 || !draft->units.IsValid(error)) {
    *error = "--deck_units is " + Quote(request.deck_units) +
             ", expected a force and a length such as N,mm";
    return false;
  }
  if (request.factor.empty()) {
    *question = {"factor",
                 "The factor on the properties of the element sets in their "
                 "exports is not known (pinode.calculix.export uses 2)",
                 "2"};
    return false;
  }
  auto deck = std::make_shared<DeckModel>();
  if (!ParsePositive(request.factor, "factor", "a positive number, not 1",
                     &draft->deck_factor, error) ||
      !SetDampingRatio(request, draft, error) ||
      !FindDeckModel(request.deck, deck.get(), error)) {
    return false;
  }
  if (draft->deck_factor == 1.0) {
    *error =
        "--factor is 1, which changes nothing; give the factor of the exports";
    return false;
  }
  if (!deck->left_out.empty()) {
    draft->assumptions.push_back(
        request.deck + ": left out, because no element set has their name: " +
        Join(deck->left_out, ", ") +
        ". Name an export like its set, such as SET.sti or mass_SET.mas.");
  }
  draft->deck = deck;
  return true;
}

bool Modes(const CaseDraft& draft, UndampedModes* modes, std::string* error) {
  ShearBuilding building;
  building.masses = draft.masses;
  building.stiffnesses = draft.stiffnesses;
  StructuralModel model;
  return BuildShearBuilding(building, &model, error) &&
         ComputeUndampedModes(model.mass, model.stiffness, modes, error);
}

double Hz(const UndampedModes& modes, Eigen::Index mode) {
  return std::sqrt(modes.eigenvalues[mode]) / kTwoPi;
}

// Sets the first mode: as given, or that of the records.
bool SetFirstMode(const DraftRequest& request, CaseDraft* draft,
                  DraftQuestion* question, std::string* error) {
  draft->stiffness_origin = StiffnessOrigin::kFirstMode;
  if (!request.first_mode_hz.empty()) {
    draft->stiffness_origin = StiffnessOrigin::kGivenFirstMode;
    if (!ParsePositive(request.first_mode_hz, "first_mode_hz",
                       "a frequency in Hz", &draft->first_mode_hz, error)) {
      return false;
    }
  }
  if (draft->first_mode_hz <= 0.0) {
    *question = {"first_mode_hz",
                 "The spectra of the records have no clear peak. An estimate "
                 "of the first mode in Hz is needed, or --stiffness",
                 "1.2"};
    return false;
  }
  return true;
}

// Sets the stiffnesses: as given, or all alike so that the first mode is that
// of the records.
bool SetStiffnesses(const DraftRequest& request, CaseDraft* draft,
                    DraftQuestion* question, std::string* error) {
  const int storeys = draft->num_storeys();
  if (!request.stiffness.empty()) {
    draft->stiffness_origin = StiffnessOrigin::kGiven;
    return ParseStoreyStiffnesses(request.stiffness, storeys, draft->units,
                                  &draft->stiffnesses, error);
  }
  if (!SetFirstMode(request, draft, question, error)) return false;
  draft->stiffnesses.assign(draft->masses.size(), 1.0);
  UndampedModes modes;
  if (!Modes(*draft, &modes, error)) return false;
  const double factor = draft->first_mode_hz / Hz(modes, 0);
  for (double& stiffness : draft->stiffnesses) stiffness *= factor * factor;
  return true;
}

// Sets Rayleigh's coefficients by the ratio at the first and third mode, or the
// modes whose ratios are free.
bool SetDamping(const DraftRequest& request, CaseDraft* draft,
                DraftQuestion* question, std::string* error) {
  const bool is_deck = draft->deck != nullptr;
  if (!IsDampingKind(request.damping, is_deck, error)) return false;
  if (request.damping == "modes") {
    DraftDamping(draft);
    return true;
  }
  double first = 0.0;
  double last = 0.0;
  if (is_deck) {
    if (!SetFirstMode(request, draft, question, error)) return false;
    first = draft->first_mode_hz;
    last = kBandOfDamping * first;
  } else {
    UndampedModes modes;
    if (!Modes(*draft, &modes, error)) return false;
    first = Hz(modes, 0);
    last = Hz(modes, std::min(draft->num_storeys(), 3) - 1);
  }
  if (first == last) {
    draft->rayleigh_mass = 2.0 * draft->damping_ratio * kTwoPi * first;
    return true;
  }
  RayleighCoefficients coefficients;
  if (!RayleighFromRatios(first, draft->damping_ratio, last,
                          draft->damping_ratio, &coefficients, error)) {
    return false;
  }
  draft->rayleigh_mass = coefficients.mass;
  draft->rayleigh_stiffness = coefficients.stiffness;
  if (is_deck || request.damping == "rayleigh") return true;
  return DraftStoreyDamping(request.damping == "storeys", draft, error);
}

// Returns a name for a record that may be part of file names.
std::string RecordName(const std::string& path,
                       const std::vector<DraftRecord>& records) {
  std::string name = std::filesystem::path(WithoutGz(path)).stem().string();
  for (char& c : name) {
    const bool allowed = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                         (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!allowed) c = '_';
  }
  if (name.empty()) name = "record";
  const auto is_used = [&](const std::string& candidate) {
    return std::any_of(
        records.begin(), records.end(),
        [&](const DraftRecord& r) { return r.name == candidate; });
  };
  std::string unique = name;
  for (int i = 2; is_used(unique); ++i) unique = name + "_" + std::to_string(i);
  return unique;
}

// Says what the first mode tells of the signs of sensors. That of a deck may
// move them either way.
void AddSignRemarks(const FirstMode& mode, DraftRecord* drafted,
                    std::vector<std::string>* remarks) {
  DraftRecord& record = *drafted;
  if (record.floors.front().floor == 0) return;
  const std::string hz = FormatNumber(mode.hz, 3) + " Hz";
  for (size_t c = 0; c < record.floors.size(); ++c) {
    if (!mode.is_reversed[c]) continue;
    DraftSignal& signal = record.floors[c];
    signal.moves_against = true;
    remarks->push_back(
        record.file + ": sensor " + Quote(signal.column) +
        " moves opposite to the other floors in the first mode (" + hz +
        "). If it is upside down, set sign = -1 in the case, or give its floor "
        "as " +
        std::to_string(signal.is_upside_down ? signal.floor : -signal.floor) +
        " in --sensors.");
  }
  if (mode.is_base_reversed) {
    record.base[0].moves_against = true;
    remarks->push_back(
        record.file + ": the floors move opposite to the sensor of the base, " +
        Quote(record.base[0].column) + " in the first mode (" + hz +
        "). If it is upside down, set sign = -1 for it in the case.");
  }
}

void AddAssumptions(const LogFile& log, const DraftRecord& record,
                    std::vector<std::string>* assumptions) {
  std::string text = log.path + ": " + std::to_string(log.num_samples()) +
                     " samples at " + FormatNumber(1.0 / log.step, 5) + " Hz";
  text += record.is_holdout ? ", held out" : ", for the fit";
  std::vector<std::string> places;
  std::set<std::string> used;
  for (const DraftSignal& signal : record.base) {
    places.push_back(Quote(signal.column) + " is the base");
    used.insert(signal.column);
  }
  for (const DraftSignal& signal : record.forces) {
    places.push_back(Quote(signal.column) + " is the force at " + signal.dof);
    used.insert(signal.column);
  }
  for (const DraftSignal& signal : record.floors) {
    places.push_back(Quote(signal.column) +
                     (signal.floor > 0
                          ? " is on floor " + std::to_string(signal.floor)
                          : " is at " + signal.dof));
    used.insert(signal.column);
  }
  assumptions->push_back(text + "; " + Join(places, ", ") + ".");
  std::vector<std::string> left_out;
  for (const std::string& name : log.ColumnNames()) {
    if (used.count(name) == 0) left_out.push_back(name);
  }
  if (!left_out.empty()) {
    assumptions->push_back(log.path + ": left out: " + Join(left_out, ", ") +
                           ".");
  }
  if (!log.unused_times.empty()) {
    assumptions->push_back(
        log.path + ": left out, because their names are those of times: " +
        Join(log.unused_times, ", ") + ".");
  }
  if (log.is_time_unit_assumed && !log.time_column.empty()) {
    assumptions->push_back(log.path + ": the times in " +
                           Quote(log.time_column) +
                           " are read as seconds, because no unit is stated.");
  }
}

// Refuses a base with missing samples: an excitation has to be complete.
bool CheckComplete(const LogFile& log, const std::string& column,
                   std::string* error) {
  const Vector& samples = log.Find(column)->samples;
  const Eigen::Index missing = samples.array().isNaN().count();
  if (missing == 0) return true;
  Eigen::Index first = 0;
  while (!std::isnan(samples[first])) ++first;
  *error = log.path + ": column " + Quote(column) + " misses " +
           std::to_string(missing) + " samples, the first one " +
           FormatNumber(static_cast<double>(first) * log.step, 6) +
           " s after the start. An excitation must be complete. Fill the gap "
           "in the file, or cut the record there";
  return false;
}

// Reads the files of one state and makes the records of its draft.
bool DraftRecords(const DraftRequest& request, const std::vector<LogFile>& logs,
                  CaseDraft* draft, DraftQuestion* question,
                  std::string* error) {
  size_t holdout = logs.size() > 1 ? logs.size() - 1 : logs.size();
  if (request.holdout == "none") holdout = logs.size();
  for (size_t i = 0; i < logs.size(); ++i) {
    if (logs[i].path == request.holdout) holdout = i;
  }
  if (holdout == 0 && logs.size() == 1) {
    *error = "--holdout: " + logs[0].path +
             " is the only record of its state, so none would be left to fit; "
             "give another record or none";
    return false;
  }
  for (size_t i = 0; i < logs.size(); ++i) {
    DraftRecord record;
    if (!DraftRecordOf(logs[i], request, *draft, &record, question, error)) {
      return false;
    }
    std::vector<Vector> samples;
    for (const auto* loads : {&record.base, &record.forces}) {
      for (const DraftSignal& signal : *loads) {
        if (!CheckComplete(logs[i], signal.column, error)) return false;
        samples.push_back(logs[i].Find(signal.column)->samples);
      }
    }
    record.interpolation = FindLoadInterpolation(samples);
    record.name = RecordName(logs[i].path, draft->records);
    // Unmeasured loads cannot be predicted from.
    const bool is_ambient = record.base.empty() && record.forces.empty();
    if (is_ambient && logs[i].path == request.holdout) {
      *error = "--holdout: " + logs[i].path +
               " has neither base nor force, so it cannot be predicted; give "
               "--holdout=none";
      return false;
    }
    record.is_holdout = i == holdout && !is_ambient;
    const FirstMode mode = FirstModeOf(logs[i], record);
    DraftStartAndOffsets(logs[i], mode.hz, &record);
    if (!record.is_holdout && draft->first_mode_hz <= 0.0) {
      draft->first_mode_hz = mode.hz;
    }
    AddAssumptions(logs[i], record, &draft->assumptions);
    AddSignRemarks(mode, &record, &draft->remarks);
    draft->records.push_back(record);
  }
  return true;
}

bool ReadLogs(const std::vector<std::string>& paths, const LogOptions& options,
              std::vector<LogFile>* logs, DraftQuestion* question,
              std::string* error) {
  for (const std::string& path : paths) {
    logs->emplace_back();
    if (!ReadLogFile(path, options, &logs->back(), question, error)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool DraftCases(const DraftRequest& request, std::vector<CaseDraft>* drafts,
                DraftQuestion* question, std::string* error) {
  *question = DraftQuestion();
  if (request.logs.empty()) {
    *error = "no record is given; give the file of the logger, see --help";
    return false;
  }
  LogOptions options = request.time;
  for (const std::string_view name : Split(request.ignore, ',')) {
    if (!name.empty()) options.ignored.emplace_back(name);
  }
  int storeys = 0;
  CaseDraft draft;
  std::vector<LogFile> logs;
  std::vector<LogFile> later_logs;
  if (!CheckFiles(request, error) ||
      !ReadLogs(request.logs, options, &logs, question, error) ||
      !ReadLogs(request.later_logs, options, &later_logs, question, error) ||
      !(request.deck.empty()
            ? ReadStoreys(request, &storeys, question, error) &&
                  SetMasses(request, storeys, &draft, question, error)
            : SetDeck(request, &draft, question, error))) {
    return false;
  }
  std::vector<LogFile> all = logs;
  all.insert(all.end(), later_logs.begin(), later_logs.end());
  draft.path = request.case_path;
  draft.title = request.title;
  CaseDraft later = draft;
  later.assumptions.clear();
  if (!CheckColumnAnswers(request, all, draft, error) ||
      !DraftRecords(request, logs, &draft, question, error) ||
      !DraftRecords(request, later_logs, &later, question, error) ||
      (draft.deck == nullptr &&
       !SetStiffnesses(request, &draft, question, error)) ||
      !SetDamping(request, &draft, question, error)) {
    return false;
  }
  drafts->assign(1, draft);
  if (later_logs.empty()) return true;
  later.path = request.later_case_path;
  later.stiffnesses = draft.stiffnesses;
  later.stiffness_origin = draft.stiffness_origin;
  later.first_mode_hz = draft.first_mode_hz;
  later.rayleigh_mass = draft.rayleigh_mass;
  later.rayleigh_stiffness = draft.rayleigh_stiffness;
  later.storeys_are_damped = draft.storeys_are_damped;
  later.damped_modes = draft.damped_modes;
  later.damped_from = draft.damped_from;
  later.some_damping_is_hidden = draft.some_damping_is_hidden;
  drafts->push_back(later);
  return true;
}

}  // namespace pinode
