#include "pinode/case/sections/record_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/at2.h"
#include "pinode/record/prepare.h"
#include "pinode/record/resample.h"

namespace pinode {
namespace {

// Largest number of samples. A larger one is probably a typing error, and would
// take days.
constexpr double kMostSamples = 1e8;
// Relative difference of factors that a user may have rounded.
constexpr double kEqualUnits = 1e-6;

// Returns the files that a record names, with the requested columns of tables.
std::map<std::string, std::vector<std::string>> FilesOf(
    const RecordSection& section, bool simulation) {
  std::map<std::string, std::vector<std::string>> wanted;
  if (!section.file.empty()) wanted[section.file];
  for (const InputSection& input : section.inputs) {
    if (input.value.has_value()) continue;
    wanted[input.signal.file].push_back(input.signal.column);
  }
  for (const ChannelSection& channel : section.channels) {
    if (simulation) continue;
    wanted[channel.signal.file].push_back(channel.signal.column);
  }
  if (section.time_column.empty()) return wanted;
  for (auto& [path, columns] : wanted) {
    columns.insert(columns.begin(), section.time_column);
  }
  return wanted;
}

// Returns true without other columns. Columns that are not requested are not
// checked, as in files.
bool HasNoOther(const Table& table, const std::vector<std::string>& wanted) {
  return std::all_of(table.columns.begin(), table.columns.end(),
                     [&wanted](const std::string& name) {
                       return std::find(wanted.begin(), wanted.end(), name) !=
                              wanted.end();
                     });
}

}  // namespace

std::vector<SharedTables::Wanted> RecordFiles::TablesOf(
    const RecordSection& section, bool simulation) {
  const CaseData& data = section.table.errors()->data();
  std::vector<SharedTables::Wanted> tables;
  for (const auto& [path, columns] : FilesOf(section, simulation)) {
    if (IsAt2File(path) || data.tables.count(path) > 0) continue;
    tables.push_back({path, columns, section.text_format});
  }
  return tables;
}

Vector RecordFiles::Source::Column(const std::string& name) const {
  return columns().columns.empty()
             ? motion
             : OnTimeGrid(columns(), columns().FindColumn(name), grid);
}

bool RecordFiles::Read(bool simulation) {
  for (const auto& [path, columns] : FilesOf(section_, simulation)) {
    if (!ReadFile(path, columns)) return false;
  }
  return SetGrid();
}

bool RecordFiles::SetGrid() {
  time_unit_ = section_.time_unit;
  time_factor_ = section_.time_factor;
  if (!section_.file.empty()) {
    const Source& base = files_.at(section_.file);
    start_time_ = base.start_time;
    time_unit_ = base.time_unit;
    time_factor_ = base.time_factor;
    step_ = base.step;
    num_samples_ = base.num_samples;
    return true;
  }
  step_ = section_.sampling_step;
  const double steps = std::floor(section_.duration / step_ + 1e-6);
  if (!(steps < kMostSamples)) {
    return table_.Fail("duration",
                       "'duration' holds 1e8 samples or more, expected fewer");
  }
  num_samples_ = 1 + static_cast<Eigen::Index>(steps);
  return num_samples_ >= 2 ||
         table_.Fail("duration",
                     "'duration' holds fewer than two samples, expected more");
}

bool RecordFiles::ReadFile(const std::string& path,
                           const std::vector<std::string>& columns) {
  Source file;
  if (!(IsAt2File(path) ? ReadMotion(path, &file)
                        : ReadColumns(path, columns, &file))) {
    return false;
  }
  files_.emplace(path, std::move(file));
  return true;
}

bool RecordFiles::ReadMotion(const std::string& path, Source* file) {
  At2Motion motion;
  std::string error;
  if (!ReadAt2(path, &motion, &error)) return table_.errors()->FailAsIs(error);
  double second = 1.0;
  if (!UnitFactor("s", Dimension::kTime, units_, &second, &error)) {
    return table_.Fail("file", error);
  }
  file->step = motion.sampling_step * second;
  file->time_unit = "s";
  file->time_factor = second;
  file->num_samples = motion.acceleration.size();
  file->motion = std::move(motion.acceleration);
  return file->num_samples >= 2 ||
         table_.errors()->FailAsIs(
             path + ": has fewer than two samples, expected a time history");
}

bool RecordFiles::ReadColumns(const std::string& path,
                              const std::vector<std::string>& columns,
                              Source* file) {
  std::string error;
  const std::map<std::string, Table>& arrays = table_.errors()->data().tables;
  const auto array = arrays.find(path);
  SharedTables* shared = table_.errors()->shared_tables();
  if (array != arrays.end() && HasNoOther(array->second, columns)) {
    file->array = &array->second;
  }
  if (!(file->array != nullptr ? CheckColumns(*file->array, columns, &error)
        : array != arrays.end()
            ? SelectColumns(array->second, columns, &file->table, &error)
        : shared != nullptr
            ? shared->Read({path, columns, section_.text_format}, &file->table,
                           &error)
            : ReadTable(path, columns, section_.text_format, &file->table,
                        &error))) {
    return table_.errors()->FailAsIs(error);
  }
  const Table& table = file->columns();
  TimeGrid& grid = file->grid;
  const std::string name = std::filesystem::path(path).filename().string();
  if (!table.reading.empty()) {
    remarks_.push_back("File " + name + ": " + table.reading);
  }
  file->time_unit =
      table.time_unit.empty() ? section_.time_unit : table.time_unit;
  if (!UnitFactor(file->time_unit, Dimension::kTime, units_, &file->time_factor,
                  &error)) {
    return table_.Fail("time_unit", error);
  }
  TimeColumnOptions options;
  options.factor = file->time_factor;
  options.unit = units_.time;
  options.interpolate_irregular = section_.resampling_step > 0.0;
  const bool found =
      section_.time_column.empty()
          ? TimeGridFromStep(table, section_.sampling_step, &grid, &error)
          : FindTimeGrid(table, section_.time_column, options, &grid, &error);
  if (!found) return table_.errors()->FailAsIs(error);
  for (const std::string& remark : grid.remarks) {
    remarks_.push_back((path == section_.file ? std::string() : name + ": ") +
                       remark);
  }
  file->start_time = grid.start_time;
  file->step = grid.step;
  file->num_samples = grid.num_samples();
  return true;
}

bool RecordFiles::Signal(const SignalSection& signal, bool is_input,
                         bool is_covariate, Channel* channel) {
  const Source& file = files_.at(signal.file);
  channel->name = signal.label;
  channel->unit = signal.unit;
  channel->values = file.Column(signal.column);
  if (!is_covariate) CompareUnits(signal, file.columns());
  std::string error;
  if (!ConvertChannel(signal.dimension, units_, signal.sign, channel, &error)) {
    return signal.table.Fail("unit", error);
  }
  channel->values *= signal.scale;
  if (CountPresent(channel->values) == 0) {
    return table_.errors()->FailAsIs(signal.file + ": column '" +
                                     signal.column +
                                     "' holds no number, expected a time "
                                     "history");
  }
  if (signal.remove_offset) {
    const double mean = RemoveOffset(&channel->values);
    subtracted_means_[signal.label] = mean;
    remarks_.push_back(signal.label + ": mean " +
                       FormatNumber(mean / signal.factor, 4) + " " +
                       signal.unit + " subtracted.");
  }
  if (is_covariate) FillReadings(signal.label, &channel->values);
  return Align(signal, file, is_input, &channel->values);
}

double RecordFiles::SubtractedMean(const std::string& label) const {
  const auto found = subtracted_means_.find(label);
  return found == subtracted_means_.end() ? 0.0 : found->second;
}

// Interpolates readings. A slow quantity such as temperature is read now and
// then. Straight lines join the readings. Before the first and after the last
// one the value is held for as long as the distance between two.
void RecordFiles::FillReadings(const std::string& label, Vector* values) {
  const Eigen::Index present = CountPresent(*values);
  const std::vector<Gap> gaps = FindGaps(*values);
  if (present < 2 || gaps.empty()) return;
  Eigen::Index longest = 1;
  const Eigen::Index size = values->size();
  const auto at_an_end = [size](const Gap& gap) {
    return gap.first == 0 || gap.first + gap.size == size;
  };
  for (const Gap& gap : gaps) {
    if (!at_an_end(gap)) longest = std::max(longest, gap.size);
  }
  const Vector filled = FillMissing(*values);
  for (const Gap& gap : gaps) {
    if (at_an_end(gap) && gap.size > longest) continue;
    values->segment(gap.first, gap.size) = filled.segment(gap.first, gap.size);
  }
  remarks_.push_back(
      label + ": " + std::to_string(present) + " of " + std::to_string(size) +
      " samples are present. The others are interpolated linearly.");
}

void RecordFiles::CompareUnits(const SignalSection& signal,
                               const Table& table) {
  const int place = table.FindColumn(signal.column);
  if (place < 0 || static_cast<size_t>(place) >= table.units.size()) return;
  const std::string& stated = table.units[static_cast<size_t>(place)];
  Dimension dimension = Dimension::kNumber;
  // One letter behind a name is often a direction: (N) is north.
  if (stated.empty() || stated == "N" || !FindDimension(stated, &dimension)) {
    return;
  }
  double in_file = 0.0;
  double in_case = 0.0;
  std::string error;
  // A scale near 1 corrects a sensor; others convert units.
  const double size = std::abs(signal.scale);
  const bool is_correction = size > 0.5 && size < 2.0;
  const bool same =
      dimension == signal.dimension &&
      UnitFactor(stated, dimension, units_, &in_file, &error) &&
      UnitFactor(signal.unit, dimension, units_, &in_case, &error) &&
      ((is_correction && std::abs(in_file / in_case - 1.0) < 1e-9) ||
       std::abs(in_file / (in_case * size) - 1.0) < kEqualUnits);
  // The scale of a voltage is the sensitivity of its sensor.
  const bool is_sensitivity = dimension == Dimension::kVoltage &&
                              dimension != signal.dimension &&
                              signal.scale != 1.0;
  if (same || is_sensitivity) return;
  const bool is_scaled = signal.scale != 1.0;
  remarks_.push_back(
      signal.label + ": the file says " + stated + ", the case says " +
      signal.unit +
      (is_scaled ? " with scale = " + FormatNumber(signal.scale, 7) : "") +
      ". pinode uses the unit" + (is_scaled ? " and the scale" : "") +
      " of the case. Set `unit = \"" + stated + "\"`" +
      (is_correction ? "" : " without `scale`") + " if the file is right.");
}

// Finds how much later than that of the record's file the zero of another
// file's clock is. Times without a clock are taken as they are.
bool RecordFiles::AlignClocks(const SignalSection& signal, const Source& file,
                              double* later) {
  using Kind = TimeOrigin::Kind;
  const TimeOrigin& own = file.columns().time_origin;
  const TimeOrigin& base = files_.at(section_.file).columns().time_origin;
  *later = 0.0;
  if (own.kind == Kind::kNone && base.kind == Kind::kNone) return true;
  if (own.kind == Kind::kDoubtfulDate || base.kind == Kind::kDoubtfulDate) {
    return signal.table.Fail(
        "file",
        "the order of day, month and year is open in its dates or in those of "
        "the record's file; set `time_format` in the record");
  }
  if (own.kind != base.kind) {
    return signal.table.Fail("file",
                             "its times and those of '" + section_.file +
                                 "' are not clock times of the same kind, "
                                 "expected times that can be compared");
  }
  double second = 1.0;
  std::string error;
  if (!UnitFactor("s", Dimension::kTime, units_, &second, &error)) {
    return signal.table.Fail("file", error);
  }
  *later = (own.seconds - base.seconds) * second;
  return true;
}

// Aligns values from the grid of `file` to that of the record's file.
bool RecordFiles::Align(const SignalSection& signal, const Source& file,
                        bool is_input, Vector* values) {
  if (signal.file == section_.file) return true;
  if (std::abs(file.step - step_) > 1e-9 * step_) {
    if (!(static_cast<double>(file.num_samples) * (file.step / step_) <
          kMostSamples)) {
      return signal.table.Fail("file",
                               "at the record's rate it has 1e8 samples or "
                               "more, expected a lower rate");
    }
    *values = Resample(*values, file.step, step_);
    remarks_.push_back(signal.label + ": resampled from a step of " +
                       FormatNumber(file.step, 6) + " to " +
                       FormatNumber(step_, 6) + " " + units_.time + ".");
  }
  double later = 0.0;
  if (!AlignClocks(signal, file, &later)) return false;
  const double offset = (start_time_ - file.start_time - later) / step_;
  const double shift = std::round(offset);
  if (std::abs(offset - shift) > 1e-3) {
    return signal.table.Fail("file", "its samples lie between those of '" +
                                         section_.file +
                                         "', expected the same times");
  }
  Vector aligned = Vector::Constant(num_samples_, kNaN);
  Eigen::Index missing = 0;
  for (Eigen::Index i = 0; i < num_samples_; ++i) {
    const double source = shift + static_cast<double>(i);
    if (source < 0.0 || source >= static_cast<double>(values->size())) {
      ++missing;
      continue;
    }
    aligned[i] = (*values)[static_cast<Eigen::Index>(source)];
  }
  if (missing == num_samples_) {
    return signal.table.Fail(
        "file", "it has no sample in common with '" + section_.file + "'");
  }
  // Completeness of an excitation matters only within the window.
  if (missing > 0 && !is_input) {
    remarks_.push_back(signal.label + ": does not cover the record.");
  }
  *values = std::move(aligned);
  return true;
}

}  // namespace pinode
