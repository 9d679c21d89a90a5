#include "pinode/case/draft/record_draft.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/file_text.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/case/draft/sensor_places.h"

namespace pinode {
namespace {

// Rests, if the motion in the first half period of the first mode has less than
// this part of the record's RMS. Noise is part of both.
constexpr double kMotionAtRest = 0.05;
// An offset is removed from this part of the RMS on: a record of an
// acceleration that ends at rest has a smaller mean.
constexpr double kLeastOffset = 0.02;

struct Place {
  std::string column;
  int floor = 0;  // 0: a DOF of a deck
  std::string dof;
  bool is_upside_down = false;
};

// Reads "1051.1" or "-1051.1" as a DOF of the deck.
bool ParseDeckPlace(std::string_view text, const DeckModel& deck,
                    Place* place) {
  text = StripBlanks(text);
  place->is_upside_down = !text.empty() && text[0] == '-';
  if (place->is_upside_down) text.remove_prefix(1);
  place->dof = std::string(text);
  return deck.HasTranslation(place->dof);
}

bool ParseFloor(std::string_view text, int storeys, Place* place) {
  int floor = 0;
  if (!ParseInt(StripBlanks(text), &floor) || floor == 0 ||
      std::abs(floor) > storeys) {
    return false;
  }
  place->floor = std::abs(floor);
  place->dof = "u" + std::to_string(place->floor);
  place->is_upside_down = floor < 0;
  return true;
}

// Reads "acc_1=1,acc_2=-2" of a flag; of a deck "a=12.1,b=-12.2".
bool ParsePlaces(const std::string& text, const std::string& flag,
                 const CaseDraft& draft, std::vector<Place>* places,
                 std::string* error) {
  places->clear();
  std::set<std::string> seen;
  for (const std::string_view part : Split(text, ',')) {
    const size_t equals = part.rfind('=');
    Place place;
    const bool is_pair = equals != std::string_view::npos && equals > 0;
    const std::string_view value = is_pair ? part.substr(equals + 1) : part;
    if (!is_pair || !(draft.deck != nullptr
                          ? ParseDeckPlace(value, *draft.deck, &place)
                          : ParseFloor(value, draft.num_storeys(), &place))) {
      *error = flag + ": " + Quote(part) + ", expected COLUMN=" +
               (draft.deck != nullptr
                    ? "NODE.DIRECTION with a node of the deck and direction 1, "
                      "2 or 3"
                    : "FLOOR with a floor from 1 to " +
                          std::to_string(draft.num_storeys())) +
               ", negative if upside down";
      return false;
    }
    place.column = std::string(StripBlanks(part.substr(0, equals)));
    if (!seen.insert(place.column).second) {
      *error = flag + " names " + Quote(place.column) + " twice";
      return false;
    }
    places->push_back(place);
  }
  return true;
}

// Returns the DOF that a column's name has in it, such as "12.1" or "12:x";
// empty: none, or several.
std::string DofInName(const std::string& name, const DeckModel& deck) {
  std::string found;
  for (size_t i = 1; i + 1 < name.size(); ++i) {
    if (name[i] != '.' && name[i] != ':') continue;
    size_t first = i;
    while (first > 0 &&
           std::isdigit(static_cast<unsigned char>(name[first - 1])) != 0) {
      --first;
    }
    const size_t axis = std::string_view("xyz").find(name[i + 1]);
    const std::string direction = axis != std::string_view::npos
                                      ? std::to_string(axis + 1)
                                      : std::string(1, name[i + 1]);
    const bool ends =
        i + 2 == name.size() ||
        std::isalnum(static_cast<unsigned char>(name[i + 2])) == 0;
    const std::string dof = name.substr(first, i - first) + "." + direction;
    if (first == i || !ends || !deck.HasTranslation(dof)) continue;
    if (!found.empty()) return "";
    found = dof;
  }
  return found;
}

bool IsInAny(const std::vector<LogFile>& logs, const std::string& column,
             std::vector<std::string>* known) {
  for (const LogFile& log : logs) {
    if (log.Find(column) != nullptr) return true;
    for (const std::string& name : log.ColumnNames()) known->push_back(name);
  }
  return false;
}

// Sets the unit of a signal, an acceleration or a force; false with a question
// or error.
bool SetUnit(const LogFile& log, const DraftRequest& request, bool is_force,
             DraftSignal* signal, DraftQuestion* question, std::string* error) {
  const std::string flag = is_force ? "force_unit" : "unit";
  const std::string& given = is_force ? request.force_unit : request.unit;
  const Dimension wanted =
      is_force ? Dimension::kForce : Dimension::kAcceleration;
  const std::string what = is_force ? "force" : "acceleration";
  const LogColumn* column = log.Find(signal->column);
  const std::string where = log.path + ": column " + Quote(signal->column);
  signal->unit = column->unit;
  signal->scale = column->scale;
  const bool is_changed = column->scale != 1.0 && !given.empty();
  signal->unit_is_stated = !signal->unit.empty() && !is_changed;
  if (!signal->unit_is_stated) {
    if (given.empty()) {
      question->flag = flag;
      question->text = where + " has no stated unit of " + what;
      question->example =
          is_force ? "kN (or N, kip, lbf; for all forces without a unit)"
                   : "mg (or m/s^2, g, gal; for all columns without a unit)";
      return false;
    }
    signal->unit = CanonicalUnit(given);
  }
  Dimension dimension;
  if (FindDimension(signal->unit, &dimension) && dimension == wanted) {
    return true;
  }
  const bool is_voltage = FindDimension(signal->unit, &dimension) &&
                          dimension == Dimension::kVoltage;
  *error = signal->unit_is_stated
               ? where + " is in " + signal->unit +
                     ", which is not a unit of " + what + "; " +
                     (is_voltage ? "give its sensitivity by --scale and --" +
                                       flag + ", or leave it out with "
                                 : std::string("leave it out with ")) +
                     "--ignore=" + signal->column +
                     ", and add it to the case by hand (pinode/case/README.md)"
               : "--" + flag + ": " + Quote(given) + " is not a unit of " +
                     what + "; use one of " + Join(KnownUnits(wanted), " ");
  return false;
}

// Refuses a column that does not move.
bool CheckMoves(const LogFile& log, const DraftSignal& signal,
                std::string* error) {
  const Vector& samples = log.Find(signal.column)->samples;
  double lowest = kInfinity;
  double highest = -kInfinity;
  for (const double value : samples) {
    if (std::isnan(value)) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (highest > lowest) return true;
  *error = log.path + ": column " + Quote(signal.column) +
           " has the same value in every sample, like a dead sensor; leave it "
           "out with --ignore=\"" +
           signal.column + "\"";
  return false;
}

// Asks for the places of columns, with an answer to fill in.
void AskForSensors(const LogFile& log, const PlacesByName& by_name,
                   const std::vector<std::string>& columns,
                   const CaseDraft& draft, DraftQuestion* question) {
  std::vector<std::string> answer;
  const bool is_deck = draft.deck != nullptr;
  for (size_t i = 0; i < columns.size(); ++i) {
    const int place = by_name.places[i];
    if (place == 0) continue;
    const std::string dof =
        is_deck ? DofInName(columns[i], *draft.deck) : std::string();
    answer.push_back(columns[i] + "=" +
                     (is_deck     ? (dof.empty() ? "NODE.DIRECTION" : dof)
                      : place > 0 ? std::to_string(place)
                                  : "FLOOR"));
  }
  question->flag = "sensors";
  question->text =
      log.path + ": it is not clear " +
      (is_deck ? "at which node and in which direction (1, 2, 3) of the deck "
                 "each sensor is: "
               : "on which floor, 1 to " + std::to_string(draft.num_storeys()) +
                     " from the lowest above the base, each sensor is: ") +
      by_name.doubt + ". Columns that are not listed are left out";
  question->example = "\"" + Join(answer, ",") + "\"";
}

// Returns the places of columns by their names: floors, or the deck's DOFs.
PlacesByName PlacesIn(const std::vector<std::string>& columns,
                      const CaseDraft& draft) {
  if (draft.deck == nullptr) {
    return FindPlacesByName(columns, draft.num_storeys());
  }
  // One storey: the base alone is looked for.
  PlacesByName found = FindPlacesByName(columns, 1);
  found.doubt.clear();
  for (size_t i = 0; i < columns.size(); ++i) {
    if (found.places[i] == 0) continue;
    const bool clear = !DofInName(columns[i], *draft.deck).empty();
    found.places[i] = clear ? 1 : kPlaceUnclear;
    if (!clear && found.doubt.empty()) {
      found.doubt = Quote(columns[i]) + " names no node";
    }
  }
  return found;
}

bool IsForce(const DraftRecord& record, const std::string& column) {
  return std::any_of(
      record.forces.begin(), record.forces.end(),
      [&](const DraftSignal& force) { return force.column == column; });
}

DraftSignal SignalAt(const Place& place) {
  DraftSignal signal;
  signal.column = place.column;
  signal.floor = place.floor;
  signal.dof = place.dof;
  signal.is_upside_down = place.is_upside_down;
  return signal;
}

bool AddForces(const LogFile& log, const DraftRequest& request,
               const CaseDraft& draft, DraftRecord* record,
               std::string* error) {
  if (request.force.empty()) return true;
  std::vector<Place> places;
  if (!ParsePlaces(request.force, "--force", draft, &places, error)) {
    return false;
  }
  for (const Place& place : places) {
    if (log.Find(place.column) == nullptr) {
      *error = log.path + ": no column " + Quote(place.column) + " (--force)";
      return false;
    }
    record->forces.push_back(SignalAt(place));
  }
  return true;
}

// Adds the base: as given, or by its name. With a force there may be none.
bool AddBase(const LogFile& log, const DraftRequest& request,
             const CaseDraft& draft, const std::vector<std::string>& columns,
             const PlacesByName& by_name, DraftRecord* record,
             DraftQuestion* question, std::string* error) {
  if (request.base == "none") return true;
  DraftSignal base;
  base.column = request.base;
  base.is_by_name = request.base.empty();
  if (base.is_by_name) {
    const auto found =
        std::find(by_name.places.begin(), by_name.places.end(), 0);
    if (found == by_name.places.end()) {
      if (!record->forces.empty()) return true;
      question->flag = "base";
      question->text =
          log.path +
          ": it is not clear which column is the base (ground). Columns: " +
          Join(log.ColumnNames(), ", ") +
          ". Give 'none' if its motion was not measured";
      question->example = "COLUMN";
      return false;
    }
    base.column = columns[static_cast<size_t>(found - by_name.places.begin())];
  } else if (log.Find(base.column) == nullptr) {
    *error = log.path + ": no column " + Quote(base.column) + " (--base)";
    return false;
  }
  base.dof = draft.deck == nullptr ? "x" : request.base_direction;
  if (base.dof.empty()) {
    *question = {"base_direction",
                 log.path +
                     ": the direction in the deck is not known for the sensor "
                     "of the base, " +
                     Quote(base.column),
                 "x (or y, z)"};
    return false;
  }
  if (base.dof != "x" && base.dof != "y" && base.dof != "z") {
    *error = "--base_direction is " + Quote(base.dof) + ", expected x, y or z";
    return false;
  }
  record->base.push_back(base);
  return true;
}

// Adds the sensors: as given, or by their names.
bool AddSensors(const LogFile& log, const DraftRequest& request,
                const CaseDraft& draft, const std::vector<std::string>& columns,
                const PlacesByName& by_name, DraftRecord* record,
                DraftQuestion* question, std::string* error) {
  if (!request.sensors.empty()) {
    std::vector<Place> places;
    if (!ParsePlaces(request.sensors, "--sensors", draft, &places, error)) {
      return false;
    }
    for (const Place& place : places) {
      if (log.Find(place.column) != nullptr) {
        record->floors.push_back(SignalAt(place));
      }
    }
  } else {
    if (!by_name.doubt.empty()) {
      AskForSensors(log, by_name, columns, draft, question);
      return false;
    }
    for (size_t i = 0; i < columns.size(); ++i) {
      if (by_name.places[i] == 0) continue;
      DraftSignal signal;
      signal.column = columns[i];
      signal.is_by_name = true;
      signal.floor = draft.deck == nullptr ? by_name.places[i] : 0;
      signal.dof = draft.deck == nullptr ? "u" + std::to_string(signal.floor)
                                         : DofInName(columns[i], *draft.deck);
      record->floors.push_back(signal);
    }
  }
  if (record->floors.empty()) {
    *error = log.path +
             ": no column is a sensor; name them and their places with "
             "--sensors";
    return false;
  }
  std::stable_sort(record->floors.begin(), record->floors.end(),
                   [](const DraftSignal& a, const DraftSignal& b) {
                     return a.floor < b.floor;
                   });
  return true;
}

Vector Signed(const LogFile& log, const DraftSignal& signal) {
  double factor = 1.0;
  std::string error;
  const bool known = UnitFactor(signal.unit, Dimension::kAcceleration,
                                UnitSystem(), &factor, &error);
  const double sign = signal.is_upside_down ? -1.0 : 1.0;
  return (known ? factor : 1.0) * sign * log.Find(signal.column)->samples;
}

double Rms(const Vector& values) {
  double sum = 0.0;
  Eigen::Index count = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value * value;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

}  // namespace

bool CheckColumnAnswers(const DraftRequest& request,
                        const std::vector<LogFile>& logs,
                        const CaseDraft& draft, std::string* error) {
  std::vector<std::string> known;
  if (!request.base.empty() && request.base != "none" &&
      !IsInAny(logs, request.base, &known)) {
    *error = "--base: no column " + Quote(request.base) +
             NameHint(request.base, known);
    return false;
  }
  std::vector<std::string> scaled;
  for (const LogFile& log : logs) {
    for (const LogColumn& column : log.columns) {
      scaled.push_back(column.name);
      scaled.push_back(column.file_name);
    }
  }
  if (!request.time.scales.AreOf(scaled, error)) {
    *error = "--scale: " + *error;
    return false;
  }
  std::string used = request.base == "none" ? "" : request.base;
  for (const auto& [flag, text] :
       {std::pair<std::string, std::string>{"--force", request.force},
        {"--sensors", request.sensors}}) {
    std::vector<Place> places;
    if (text.empty()) continue;
    if (!ParsePlaces(text, flag, draft, &places, error)) return false;
    for (const Place& place : places) {
      if (!IsInAny(logs, place.column, &known)) {
        *error = flag + ": no column " + Quote(place.column) +
                 NameHint(place.column, known);
        return false;
      }
      if (place.column == used) {
        *error = flag + " names " + Quote(place.column) +
                 ", but --base names it too; name it once";
        return false;
      }
    }
  }
  return true;
}

bool DraftRecordOf(const LogFile& log, const DraftRequest& request,
                   const CaseDraft& draft, DraftRecord* record,
                   DraftQuestion* question, std::string* error) {
  record->file = log.path;
  record->time_column = log.time_column;
  record->time_unit = log.time_unit;
  record->sampling_rate_hz = log.sampling_rate_hz;
  record->format = request.time.format;
  record->step = log.step;
  record->duration = log.duration();
  if (!AddForces(log, request, draft, record, error)) return false;

  // Columns by name, without the forces, and the base if that was given.
  std::vector<std::string> columns;
  for (const std::string& name : log.ColumnNames()) {
    if (name != request.base && !IsForce(*record, name)) {
      columns.push_back(name);
    }
  }
  const PlacesByName by_name = PlacesIn(columns, draft);
  if (!AddBase(log, request, draft, columns, by_name, record, question,
               error) ||
      !AddSensors(log, request, draft, columns, by_name, record, question,
                  error)) {
    return false;
  }
  for (std::vector<DraftSignal>* signals :
       {&record->base, &record->forces, &record->floors}) {
    for (DraftSignal& signal : *signals) {
      // A force may be zero in one record.
      const bool is_force = signals == &record->forces;
      if ((!is_force && !CheckMoves(log, signal, error)) ||
          !SetUnit(log, request, is_force, &signal, question, error)) {
        return false;
      }
    }
  }
  return true;
}

FirstMode FirstModeOf(const LogFile& log, const DraftRecord& record) {
  Matrix floors(static_cast<Eigen::Index>(record.floors.size()),
                log.num_samples());
  for (size_t c = 0; c < record.floors.size(); ++c) {
    floors.row(static_cast<Eigen::Index>(c)) =
        Signed(log, record.floors[c]).transpose();
  }
  const Vector base =
      record.base.empty() ? Vector() : Signed(log, record.base[0]);
  return FindFirstMode(floors, base, log.step);
}

void DraftStartAndOffsets(const LogFile& log, double first_mode_hz,
                          DraftRecord* record) {
  record->starts_at_rest = !record->base.empty() || !record->forces.empty();
  const Eigen::Index first = std::clamp<Eigen::Index>(
      static_cast<Eigen::Index>(
          std::ceil(0.5 / (std::max(first_mode_hz, 1e-3) * log.step))),
      10, log.num_samples());
  for (std::vector<DraftSignal>* signals : {&record->base, &record->floors}) {
    for (DraftSignal& signal : *signals) {
      const Vector& samples = log.Find(signal.column)->samples;
      const double mean = MeanOfPresent(samples);
      const Vector motion = samples.array() - mean;
      const double rms = Rms(motion);
      signal.remove_offset = std::abs(mean) > kLeastOffset * rms;
      if (Rms(motion.head(first)) > kMotionAtRest * rms) {
        record->starts_at_rest = false;
      }
    }
  }
}

}  // namespace pinode
