#include "pinode/case/draft/record_draft.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

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
  int floor = 0;
  bool is_upside_down = false;
};

// Reads "acc_1=1,acc_2=-2".
bool ParsePlaces(const std::string& text, int storeys,
                 std::vector<Place>* places, std::string* error) {
  places->clear();
  std::set<std::string> seen;
  for (const std::string_view part : Split(text, ',')) {
    const size_t equals = part.rfind('=');
    Place place;
    int floor = 0;
    if (equals == std::string_view::npos || equals == 0 ||
        !ParseInt(StripBlanks(part.substr(equals + 1)), &floor) || floor == 0 ||
        std::abs(floor) > storeys) {
      *error = "--sensors: " + Quote(part) +
               ", expected COLUMN=FLOOR with a floor from 1 to " +
               std::to_string(storeys) + ", negative if upside down";
      return false;
    }
    place.column = std::string(StripBlanks(part.substr(0, equals)));
    place.floor = std::abs(floor);
    place.is_upside_down = floor < 0;
    if (!seen.insert(place.column).second) {
      *error = "--sensors names " + Quote(place.column) + " twice";
      return false;
    }
    places->push_back(place);
  }
  return true;
}

bool IsInAny(const std::vector<LogFile>& logs, const std::string& column,
             std::vector<std::string>* known) {
  for (const LogFile& log : logs) {
    if (log.Find(column) != nullptr) return true;
    for (const std::string& name : log.ColumnNames()) known->push_back(name);
  }
  return false;
}

// Sets the unit of a signal of accelerations; false with a question or error.
bool SetUnit(const LogFile& log, const DraftRequest& request,
             DraftSignal* signal, DraftQuestion* question, std::string* error) {
  const LogColumn* column = log.Find(signal->column);
  const std::string where = log.path + ": column " + Quote(signal->column);
  signal->unit = column->unit;
  signal->unit_is_stated = !signal->unit.empty();
  if (!signal->unit_is_stated) {
    if (request.unit.empty()) {
      question->flag = "unit";
      question->text = where + " states no unit of acceleration";
      question->example = "mg (or m/s^2, g, gal; for all columns without)";
      return false;
    }
    signal->unit = CanonicalUnit(request.unit);
  }
  Dimension dimension;
  if (FindDimension(signal->unit, &dimension) &&
      dimension == Dimension::kAcceleration) {
    return true;
  }
  *error = signal->unit_is_stated
               ? where + " is in " + signal->unit +
                     ", which is no acceleration; leave it out with "
                     "--ignore=" +
                     signal->column +
                     ", and add it to the case by hand (pinode/case/README.md)"
               : "--unit: " + Quote(request.unit) +
                     " is no unit of acceleration; use one of " +
                     Join(KnownUnits(Dimension::kAcceleration), " ");
  return false;
}

// Asks for the places of columns, with an answer to fill in.
void AskForSensors(const LogFile& log, const PlacesByName& by_name,
                   const std::vector<std::string>& columns, int storeys,
                   DraftQuestion* question) {
  std::vector<std::string> answer;
  for (size_t i = 0; i < columns.size(); ++i) {
    const int place = by_name.places[i];
    if (place == 0) continue;
    answer.push_back(columns[i] + "=" +
                     (place > 0 ? std::to_string(place) : "FLOOR"));
  }
  question->flag = "sensors";
  question->text =
      log.path + ": it is not clear on which floor, 1 to " +
      std::to_string(storeys) +
      " from the lowest above the base, each sensor is: " + by_name.doubt +
      "; columns that are not listed are left out";
  question->example = "\"" + Join(answer, ",") + "\"";
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
                        const std::vector<LogFile>& logs, int storeys,
                        std::string* error) {
  std::vector<std::string> known;
  if (!request.base.empty() && request.base != "none" &&
      !IsInAny(logs, request.base, &known)) {
    *error = "--base: no column " + Quote(request.base) +
             NameHint(request.base, known);
    return false;
  }
  std::vector<Place> places;
  if (request.sensors.empty()) return true;
  if (!ParsePlaces(request.sensors, storeys, &places, error)) return false;
  for (const Place& place : places) {
    if (!IsInAny(logs, place.column, &known)) {
      *error = "--sensors: no column " + Quote(place.column) +
               NameHint(place.column, known);
      return false;
    }
    if (place.column == request.base) {
      *error = "--sensors names " + Quote(place.column) +
               ", which is the base by --base; name it once";
      return false;
    }
  }
  return true;
}

bool DraftRecordOf(const LogFile& log, const DraftRequest& request, int storeys,
                   DraftRecord* record, DraftQuestion* question,
                   std::string* error) {
  record->file = log.path;
  record->time_column = log.time_column;
  record->time_unit = log.time_unit;
  record->sampling_rate_hz = log.sampling_rate_hz;
  record->step = log.step;
  record->duration = log.duration();

  // Columns by name, without the base if that was given.
  std::vector<std::string> columns;
  for (const std::string& name : log.ColumnNames()) {
    if (name != request.base) columns.push_back(name);
  }
  const PlacesByName by_name = FindPlacesByName(columns, storeys);
  std::string base = request.base == "none" ? "" : request.base;
  if (request.base.empty()) {
    const auto found =
        std::find(by_name.places.begin(), by_name.places.end(), 0);
    if (found == by_name.places.end()) {
      question->flag = "base";
      question->text = log.path +
                       ": which column is the base (ground) is not clear; "
                       "columns: " +
                       Join(log.ColumnNames(), ", ") +
                       "; 'none' if its motion was not measured";
      question->example = "COLUMN";
      return false;
    }
    base = columns[static_cast<size_t>(found - by_name.places.begin())];
  } else if (!base.empty() && log.Find(base) == nullptr) {
    *error = log.path + ": no column " + Quote(base) + " (--base)";
    return false;
  }
  if (!base.empty()) {
    record->base.push_back({base, "", false, 0, request.base.empty()});
  }

  std::vector<Place> places;
  if (!request.sensors.empty()) {
    if (!ParsePlaces(request.sensors, storeys, &places, error)) return false;
    for (const Place& place : places) {
      if (log.Find(place.column) == nullptr) continue;
      record->floors.push_back(
          {place.column, "", false, place.floor, false, place.is_upside_down});
    }
  } else {
    if (!by_name.doubt.empty()) {
      AskForSensors(log, by_name, columns, storeys, question);
      return false;
    }
    for (size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] == base) continue;
      record->floors.push_back(
          {columns[i], "", false, by_name.places[i], true});
    }
  }
  if (record->floors.empty()) {
    *error = log.path +
             ": no column is a sensor on a floor; name them with "
             "--sensors=COLUMN=FLOOR,...";
    return false;
  }
  std::stable_sort(record->floors.begin(), record->floors.end(),
                   [](const DraftSignal& a, const DraftSignal& b) {
                     return a.floor < b.floor;
                   });
  for (std::vector<DraftSignal>* signals : {&record->base, &record->floors}) {
    for (DraftSignal& signal : *signals) {
      if (!SetUnit(log, request, &signal, question, error)) return false;
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
  record->starts_at_rest = !record->base.empty();
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
