#include "pinode/watch/examine_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/modes_data_file.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/record/channel_faults.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/sample_faults.h"

namespace pinode {
namespace {

// Returns the sentence of FindChannelFaults behind the channel's name.
std::string WithoutName(const std::string& sentence, const std::string& name) {
  const std::string begin = "Channel '" + name + "' ";
  return sentence.compare(0, begin.size(), begin) == 0
             ? sentence.substr(begin.size())
             : sentence;
}

// Returns the file's name without its folder and extensions.
std::string Stem(const std::string& path) {
  const std::string name = path.substr(path.find_last_of('/') + 1);
  const std::string plain = WithoutGz(name);
  return plain.substr(0, plain.find_last_of('.'));
}

class Examination {
 public:
  Examination(const WatchedStructure& structure, const std::string& path)
      : structure_(structure), path_(path) {}

  StoredRecord Run(const std::string& content) {
    record_.content = ContentIdentity(content);
    record_.name = path_.substr(path_.find_last_of('/') + 1);
    std::string error;
    if (!ReadOutline(&error) || !ReadValues(&error) || !FindTime(&error) ||
        !CheckChannels(&error) || !FindModes(&error)) {
      // A store is moved; the record's name tells enough.
      const size_t slash = path_.find_last_of('/');
      if (slash != std::string::npos) {
        ReplaceAll(path_.substr(0, slash + 1), "", &error);
      }
      record_.refusal = error;
      // A file that cannot be read still tells that nothing was measured then.
      if (std::isnan(record_.time) &&
          !structure_.records.time_in_name.empty() &&
          !ParseDateBy(structure_.records.time_in_name, Stem(path_),
                       &record_.time)) {
        record_.time = kNaN;
      }
      record_.modes.clear();
    }
    return std::move(record_);
  }

 private:
  // Returns the form of the files, with the column of the time if it is known.
  TextFormat Format() const {
    TextFormat format;
    format.time_column = time_;
    format.time_format = structure_.records.time_format;
    return format;
  }

  // Finds the names of the channels and of the time.
  bool ReadOutline(std::string* error) {
    const WatchedRecords& records = structure_.records;
    time_ = records.time_column;
    columns_ = records.columns;
    if (!IsTextFile(path_)) return true;
    TextOutline outline;
    if (!ReadTextOutline(path_, Format(), &outline, error)) return false;
    if (time_.empty() && records.sampling_rate_hz == 0.0 &&
        outline.time_column >= 0) {
      time_ = outline.columns[static_cast<size_t>(outline.time_column)].name;
    }
    if (columns_ == std::vector<std::string>{"all"}) columns_.clear();
    const bool all = columns_.empty();
    for (size_t i = 0; i < outline.columns.size(); ++i) {
      present_.push_back(outline.columns[i].name);
      if (!outline.columns[i].short_name.empty()) {
        present_.push_back(outline.columns[i].short_name);
      }
      if (all && outline.is_channel[i] && outline.columns[i].name != time_ &&
          outline.columns[i].kind != CellKind::kText &&
          !IsCovariate(outline.columns[i])) {
        columns_.push_back(outline.columns[i].name);
      }
    }
    return true;
  }

  // A temperature among the columns of a file is no sensor of vibration.
  bool IsCovariate(const TextColumn& column) const {
    return std::any_of(structure_.covariates.begin(),
                       structure_.covariates.end(),
                       [&column](const WatchedCovariate& covariate) {
                         return covariate.file.empty() &&
                                (covariate.column == column.name ||
                                 (!column.short_name.empty() &&
                                  covariate.column == column.short_name));
                       });
  }

  bool IsPresent(const std::string& column) const {
    return present_.empty() || std::find(present_.begin(), present_.end(),
                                         column) != present_.end();
  }

  // Reads all columns once: those of the channels, the time and covariates.
  bool ReadValues(std::string* error) {
    if (columns_ == std::vector<std::string>{"all"}) return true;
    std::vector<std::string> wanted;
    for (const std::string& column : columns_) {
      if (IsPresent(column)) wanted.push_back(column);
    }
    if (wanted.empty()) {
      *error = path_ + ": none of the columns " + Join(columns_, ", ") +
               " is in the file; check `columns` in [records]";
      return false;
    }
    for (const WatchedCovariate& covariate : structure_.covariates) {
      if (covariate.file.empty() && IsPresent(covariate.column)) {
        wanted.push_back(covariate.column);
      }
    }
    const TextFormat format = Format();
    if (!time_.empty()) wanted.push_back(time_);
    if (!ReadTable(path_, wanted, format, &table_, error)) return false;
    for (const WatchedCovariate& covariate : structure_.covariates) {
      if (!covariate.file.empty() || !IsPresent(covariate.column)) continue;
      const int place = table_.FindColumn(covariate.column);
      if (place < 0) continue;
      const double mean = MeanOfPresent(table_.values.col(place));
      if (std::isfinite(mean)) {
        record_.covariates.emplace_back(covariate.name, mean);
      }
    }
    return true;
  }

  bool FindTime(std::string* error) {
    const std::string& format = structure_.records.time_in_name;
    if (!format.empty()) {
      if (ParseDateBy(format, Stem(path_), &record_.time)) return true;
      *error = path_ + ": the name '" + Stem(path_) + "' has not the form " +
               format + " of `time_in_name`; rename the file, or correct it";
      return false;
    }
    if (table_.time_origin.kind == TimeOrigin::Kind::kDate) {
      record_.time = table_.time_origin.seconds;
      const int place = table_.FindColumn(time_);
      if (place >= 0 && table_.num_rows() > 0 &&
          std::isfinite(table_.values(0, place))) {
        record_.time += table_.values(0, place);
      }
      return true;
    }
    *error = path_ +
             (table_.time_origin.kind == TimeOrigin::Kind::kDoubtfulDate
                  ? ": the order of day, month and year is open in its dates; "
                    "set `time_format` in [records], such as \"%d.%m.%y "
                    "%H:%M:%S\", or `time_in_name`"
                  : ": it has no clock times with dates; set `time_in_name` in "
                    "[records], so that its name says when it begins");
    return false;
  }

  bool CheckChannels(std::string* error) {
    if (table_.columns.empty()) {
      used_ = columns_;
      return true;
    }
    const std::vector<std::string>& quantities = structure_.records.quantities;
    std::vector<Vector> healthy;
    std::vector<std::string> reasons;
    for (size_t c = 0; c < columns_.size(); ++c) {
      const std::string& name = columns_[c];
      const int place = IsPresent(name) ? table_.FindColumn(name) : -1;
      std::string fault = "is not in the file.";
      if (place >= 0) {
        const Vector values = table_.values.col(place);
        fault = FaultOfSamples(values);
        if (fault.empty()) fault = FaultOfPair(name, values, healthy);
        if (fault.empty()) healthy.push_back(values);
      }
      if (fault.empty()) {
        used_.push_back(name);
        if (quantities.size() > 1 && c < quantities.size()) {
          quantities_.push_back(quantities[c]);
        }
      } else {
        reasons.push_back("'" + name + "' " + fault);
      }
      record_.channels.push_back({name, fault});
    }
    if (!used_.empty()) return true;
    *error = path_ + ": no channel can be used: " + Join(reasons, " ");
    return false;
  }

  // Returns the fault of a channel that repeats one of the `others`.
  std::string FaultOfPair(const std::string& name, const Vector& values,
                          const std::vector<Vector>& others) const {
    for (size_t i = 0; i < others.size(); ++i) {
      Matrix pair(2, values.size());
      pair.row(0) = others[i].transpose();
      pair.row(1) = values.transpose();
      const std::vector<std::string> faults =
          FindChannelFaults({used_[i], name}, pair);
      if (!faults.empty()) return WithoutName(faults.back(), name);
    }
    return "";
  }

  bool FindModes(std::string* error) {
    ModesDataFile file;
    file.path = path_;
    file.columns = used_;
    file.quantities =
        quantities_.empty() ? structure_.records.quantities : quantities_;
    file.time_column = structure_.records.time_column;
    file.format.time_format = structure_.records.time_format;
    file.sampling_rate_hz = structure_.records.sampling_rate_hz;
    ModesCase c;
    ModesOfRecord found;
    if (!ReadModesDataFile(file, &c, error)) return false;
    const ResponseRecord& response = c.records.front();
    record_.duration = response.duration();
    std::string message;
    if (!IdentifyModes(response, structure_.modes, &found, &message)) {
      *error = path_ + ": " + message;
      return false;
    }
    if (record_.channels.empty()) {
      for (const ResponseChannel& channel : response.channels) {
        record_.channels.push_back({channel.name, ""});
      }
    }
    for (const IdentifiedMode& mode : found.modes) {
      // The vibration of a machine says nothing about the structure.
      if (mode.is_harmonic) continue;
      record_.modes.push_back({mode.frequency_hz, mode.frequency_sigma,
                               mode.damping_ratio, mode.damping_sigma,
                               mode.shape});
    }
    return true;
  }

  const WatchedStructure& structure_;
  const std::string& path_;
  StoredRecord record_;
  std::string time_;
  std::vector<std::string> columns_;
  std::vector<std::string> present_;  // empty: not known before reading
  Table table_;
  std::vector<std::string> used_;
  std::vector<std::string> quantities_;
};

// Returns the value at `time` on the line between two rows; NaN if the rows are
// farther apart than `gap`, or if `time` is outside of them.
double Interpolated(const std::vector<std::pair<double, double>>& rows,
                    double time, double gap) {
  const auto after = std::lower_bound(rows.begin(), rows.end(),
                                      std::make_pair(time, -kInfinity));
  if (after == rows.end()) return kNaN;
  if (after->first == time) return after->second;
  if (after == rows.begin()) return kNaN;
  const auto& [t0, v0] = *std::prev(after);
  const auto& [t1, v1] = *after;
  if (t1 - t0 > gap) return kNaN;
  return v0 + (v1 - v0) * (time - t0) / (t1 - t0);
}

}  // namespace

std::string FaultOfSamples(const Vector& values) {
  if (CountPresent(values) < 2) return "has no samples.";
  double lowest = kInfinity;
  double highest = -kInfinity;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (std::isinf(lowest) || std::isinf(highest)) {
    return "has an infinite sample.";
  }
  if (lowest == highest) return "is dead: all its samples are equal.";
  const std::vector<std::string> faults =
      FindChannelFaults({"x"}, values.transpose());
  if (!faults.empty()) {
    const std::string fault = WithoutName(faults.front(), "x");
    return fault.substr(0, fault.find(". ") + 1);
  }
  const Outliers outliers = FindOutliers(values);
  if (outliers.samples.empty()) return "";
  return "has " + std::to_string(outliers.samples.size()) +
         (outliers.samples.size() == 1 ? " spike." : " spikes.");
}

StoredRecord ExamineRecord(const WatchedStructure& structure,
                           const std::string& path,
                           const std::string& content) {
  return Examination(structure, path).Run(content);
}

bool FillCovariates(const WatchedStructure& structure,
                    std::vector<StoredRecord>* records, std::string* error) {
  for (const WatchedCovariate& covariate : structure.covariates) {
    if (covariate.file.empty()) continue;
    TextFormat format;
    format.time_column = covariate.time_column;
    Table table;
    if (!ReadTable(covariate.file, {covariate.time_column, covariate.column},
                   format, &table, error)) {
      return false;
    }
    if (table.time_origin.kind != TimeOrigin::Kind::kDate) {
      *error = covariate.file + ": column '" + covariate.time_column +
               "' has no clock times with clear dates, expected times such as "
               "2024-03-01 12:00";
      return false;
    }
    std::vector<std::pair<double, double>> rows;
    for (Eigen::Index i = 0; i < table.num_rows(); ++i) {
      const double value = table.values(i, 1);
      if (std::isnan(value)) continue;
      rows.emplace_back(table.time_origin.seconds + table.values(i, 0), value);
    }
    std::sort(rows.begin(), rows.end());
    for (StoredRecord& record : *records) {
      if (std::isnan(record.time) ||
          !std::isnan(record.Covariate(covariate.name))) {
        continue;
      }
      const double value =
          Interpolated(rows, record.time + 0.5 * record.duration,
                       3600.0 * covariate.largest_gap_hours);
      if (std::isnan(value)) continue;
      record.covariates.emplace_back(covariate.name, value);
    }
  }
  return true;
}

}  // namespace pinode
