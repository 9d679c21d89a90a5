#include "pinode/case/record_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/case/unknown_force_section.h"
#include "pinode/record/array_table.h"
#include "pinode/record/at2.h"
#include "pinode/record/prepare.h"
#include "pinode/record/resample.h"
#include "pinode/record/time_column.h"

namespace pinode {
namespace {

// Beyond these somebody has mistyped, and would wait for days.
constexpr double kMostResampled = 100.0;  // times the record's own rate
constexpr double kMostSamples = 1e8;

// Whether all values that are present are the same.
bool IsConstant(const Vector& values) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  return lowest == highest;
}

// One file on its own grid.
struct SourceFile {
  double start_time = 0.0;
  double step = 0.0;
  Eigen::Index num_samples = 0;
  Vector motion;  // of an AT2
  Table table;    // of any other
  TimeGrid grid;

  // As it is.
  Vector Column(const std::string& name) const {
    return table.columns.empty()
               ? motion
               : OnTimeGrid(table, table.FindColumn(name), grid);
  }
};

class RecordDataReader {
 public:
  RecordDataReader(const RecordSection& section, const UnitSystem& units,
                   const StructuralDynamics& dynamics, bool simulation,
                   IdentificationRecord* record)
      : section_(section),
        table_(section.table),
        units_(units),
        dynamics_(dynamics),
        simulation_(simulation),
        record_(record) {}

  bool Read() {
    record_->description.time_unit = section_.time_unit;
    record_->description.time_factor = section_.time_factor;
    record_->name = section_.name;
    record_->role = section_.role;
    record_->start = section_.start;
    record_->start_samples = section_.start_samples;
    if (section_.start == IdentificationRecord::Start::kKnown) {
      record_->known_start = Vector::Zero(dynamics_.num_states());
      record_->known_start.head(dynamics_.num_dofs()) = section_.start_x;
      record_->known_start.segment(dynamics_.num_dofs(), dynamics_.num_dofs()) =
          section_.start_v;
    }
    return ReadFiles() && CollectSignals() && ResampleAll() &&
           AddGroundDisplacements() && AddPrescribedDerivatives() &&
           CutWindow() && MakeExcitation() && MakeChannels() && ApplyFilter() &&
           SetNoise();
  }

 private:
  bool ReadFiles() {
    std::map<std::string, std::vector<std::string>> wanted;
    if (!section_.file.empty()) wanted[section_.file];
    for (const InputSection& input : section_.inputs) {
      if (input.value.has_value()) continue;
      wanted[input.signal.file].push_back(input.signal.column);
    }
    for (const ChannelSection& channel : section_.channels) {
      if (simulation_) continue;
      wanted[channel.signal.file].push_back(channel.signal.column);
    }
    for (const auto& [path, columns] : wanted) {
      if (!ReadFile(path, columns)) return false;
    }
    if (section_.file.empty()) {
      base_step_ = section_.sampling_step;
      const double steps = std::floor(section_.duration / base_step_ + 1e-6);
      if (!(steps < kMostSamples)) {
        return table_.Fail("duration",
                           "'duration' holds 1e8 samples or more, expected "
                           "fewer");
      }
      num_samples_ = 1 + static_cast<Eigen::Index>(steps);
      if (num_samples_ < 2) {
        return table_.Fail("duration",
                           "'duration' holds fewer than two "
                           "samples, expected more");
      }
      return true;
    }
    const SourceFile& base = files_.at(section_.file);
    base_start_ = base.start_time;
    base_step_ = base.step;
    num_samples_ = base.num_samples;
    return true;
  }

  bool ReadFile(const std::string& path, std::vector<std::string> columns) {
    SourceFile file;
    std::string error;
    if (IsAt2File(path)) {
      At2Motion motion;
      if (!ReadAt2(path, &motion, &error)) {
        return table_.errors()->FailAsIs(error);
      }
      double second = 1.0;
      if (!UnitFactor("s", Dimension::kTime, units_, &second, &error)) {
        return table_.Fail("file", error);
      }
      file.step = motion.sampling_step * second;
      file.num_samples = motion.acceleration.size();
      file.motion = std::move(motion.acceleration);
      if (file.num_samples < 2) {
        return table_.errors()->FailAsIs(
            path + ": has fewer than two samples, expected a time history");
      }
      files_.emplace(path, std::move(file));
      return true;
    }
    if (!section_.time_column.empty()) {
      columns.insert(columns.begin(), section_.time_column);
    }
    Table& table = file.table;
    const std::map<std::string, Table>& arrays = table_.errors()->data().tables;
    const auto array = arrays.find(path);
    if (!(array != arrays.end()
              ? SelectColumns(array->second, columns, &table, &error)
              : ReadTable(path, columns, &table, &error))) {
      return table_.errors()->FailAsIs(error);
    }
    TimeGrid& grid = file.grid;
    TimeColumnOptions options;
    options.factor = section_.time_factor;
    options.unit = units_.time;
    options.interpolate_irregular = section_.resampling_step > 0.0;
    const bool found =
        section_.time_column.empty()
            ? TimeGridFromStep(table, section_.sampling_step, &grid, &error)
            : FindTimeGrid(table, section_.time_column, options, &grid, &error);
    if (!found) return table_.errors()->FailAsIs(error);
    for (const std::string& remark : grid.remarks) {
      record_->description.remarks.push_back(
          (path == section_.file
               ? std::string()
               : std::filesystem::path(path).filename().string() + ": ") +
          remark);
    }
    file.start_time = grid.start_time;
    file.step = grid.step;
    file.num_samples = grid.num_samples();
    files_.emplace(path, std::move(file));
    return true;
  }

  // A thermometer is read now and then, and what it measures is slow: straight
  // lines between readings, and before the first and behind the last one for as
  // long as there is between two.
  void FillReadings(const std::string& label, Vector* values) {
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
      values->segment(gap.first, gap.size) =
          filled.segment(gap.first, gap.size);
    }
    record_->description.remarks.push_back(
        label + ": " + std::to_string(present) + " of " + std::to_string(size) +
        " samples are there, the others on straight lines between them.");
  }

  // In model units, on the grid of the record's file.
  bool AddSignal(const SignalSection& signal, bool is_input,
                 bool is_covariate = false) {
    const SourceFile& file = files_.at(signal.file);
    Channel channel;
    channel.name = signal.label;
    channel.unit = signal.unit;
    channel.values = file.Column(signal.column);
    std::string error;
    if (!ConvertChannel(signal.dimension, units_, signal.sign, &channel,
                        &error)) {
      return signal.table.Fail("unit", error);
    }
    channel.values *= signal.scale;
    if (CountPresent(channel.values) == 0) {
      return table_.errors()->FailAsIs(signal.file + ": column '" +
                                       signal.column +
                                       "' holds no number, expected a time "
                                       "history");
    }
    if (signal.remove_offset) {
      const double mean = RemoveOffset(&channel.values);
      record_->description.remarks.push_back(
          signal.label + ": mean " + FormatNumber(mean / signal.factor, 4) +
          " " + signal.unit + " subtracted.");
    }
    if (is_covariate) FillReadings(signal.label, &channel.values);
    if (!Align(signal, file, is_input, &channel.values)) return false;
    merged_.channels.push_back(std::move(channel));
    return true;
  }

  // From the grid of `file` to that of the record's file.
  bool Align(const SignalSection& signal, const SourceFile& file, bool is_input,
             Vector* values) {
    if (signal.file == section_.file) return true;
    if (std::abs(file.step - base_step_) > 1e-9 * base_step_) {
      if (!(static_cast<double>(file.num_samples) * (file.step / base_step_) <
            kMostSamples)) {
        return signal.table.Fail("file",
                                 "at the record's rate it has 1e8 samples or "
                                 "more, expected a record that is sampled less "
                                 "often");
      }
      *values = Resample(*values, file.step, base_step_);
      record_->description.remarks.push_back(
          signal.label + ": resampled from a step of " +
          FormatNumber(file.step, 6) + " to " + FormatNumber(base_step_, 6) +
          " " + units_.time + ".");
    }
    const double offset = (base_start_ - file.start_time) / base_step_;
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
    // Whether an excitation is complete is asked within the window only.
    if (missing > 0 && !is_input) {
      record_->description.remarks.push_back(signal.label +
                                             ": does not cover the record.");
    }
    *values = std::move(aligned);
    return true;
  }

  bool CollectSignals() {
    merged_.name = section_.name;
    merged_.start_time = base_start_;
    merged_.sampling_step = base_step_;
    for (const InputSection& input : section_.inputs) {
      if (input.value.has_value()) {
        merged_.channels.push_back(
            {input.signal.label, "1",
             Vector::Constant(num_samples_, *input.value)});
      } else if (!AddSignal(input.signal, /*is_input=*/true,
                            input.spec.kind == InputSpec::Kind::kCovariate)) {
        return false;
      }
    }
    for (const ChannelSection& channel : section_.channels) {
      if (simulation_) {
        merged_.channels.push_back(
            {channel.signal.label, "1", Vector::Constant(num_samples_, kNaN)});
      } else if (!AddSignal(channel.signal, false)) {
        return false;
      }
    }
    files_.clear();
    std::string error;
    if (!merged_.IsValid(&error)) {
      return table_.errors()->Fail(table_.line(), error);
    }
    return true;
  }

  bool ResampleAll() {
    if (section_.resampling_step == 0.0) return true;
    if (section_.resampling_step * kMostResampled < merged_.sampling_step) {
      return table_.Fail("resample_hz",
                         "'resample_hz' is more than 100 times the record's "
                         "own rate, expected less");
    }
    merged_ = ResampleRecord(merged_, section_.resampling_step);
    if (merged_.num_samples() < 2) {
      return table_.Fail("resample_hz",
                         "'resample_hz' leaves fewer than two "
                         "samples, expected a higher rate");
    }
    return true;
  }

  bool AddGroundDisplacements() {
    for (const InputSpec& spec : dynamics_.inputs()) {
      if (spec.kind != InputSpec::Kind::kGroundDisplacement) continue;
      for (const InputSection& input : section_.inputs) {
        if (input.spec.kind != InputSpec::Kind::kGroundAcceleration ||
            input.spec.index != spec.index) {
          continue;
        }
        const Channel& acceleration = *merged_.FindChannel(input.signal.label);
        Channel displacement;
        displacement.name = spec.name;
        displacement.values = IntegrateTwice(
            acceleration.values, merged_.sampling_step, section_.interpolation);
        merged_.channels.push_back(std::move(displacement));
        record_->description.remarks.push_back(
            "the ground displacement is the double integral of " +
            input.signal.label +
            " from rest at the file's first sample, without a baseline "
            "correction.");
      }
    }
    return true;
  }

  // The derivatives of prescribed displacements that no column has.
  bool AddPrescribedDerivatives() {
    for (const InputSpec& spec : dynamics_.inputs()) {
      const bool velocity = spec.kind == InputSpec::Kind::kPrescribedVelocity;
      if (!velocity && spec.kind != InputSpec::Kind::kPrescribedAcceleration) {
        continue;
      }
      const Channel* lower = FindInput(
          PrescribedInput(dynamics_.model(), spec.index, velocity ? 0 : 1));
      if (lower == nullptr || FindInput(spec) != nullptr) continue;
      Channel derivative;
      derivative.name = spec.name;
      derivative.values = Differentiate(lower->values, merged_.sampling_step);
      record_->description.remarks.push_back(
          "the prescribed " +
          std::string(velocity ? "velocity of " : "acceleration of ") +
          dynamics_.model().dof_names[static_cast<size_t>(spec.index)] +
          " is the derivative of " + lower->name +
          " by differences over five samples.");
      merged_.channels.push_back(std::move(derivative));
    }
    return true;
  }

  // The samples of an input; nullptr where the record does not have them.
  const Channel* FindInput(const InputSpec& spec) const {
    for (const InputSection& input : section_.inputs) {
      if (input.spec.name == spec.name) {
        return merged_.FindChannel(input.signal.label);
      }
    }
    return merged_.FindChannel(spec.name);
  }

  bool CutWindow() {
    if (!section_.window_from.has_value()) return true;
    Record window;
    std::string error;
    if (!SelectWindow(merged_, *section_.window_from, *section_.window_to,
                      &window, &error)) {
      return table_.Fail("window", error);
    }
    merged_ = std::move(window);
    return true;
  }

  bool MakeExcitation() {
    const Eigen::Index samples = merged_.num_samples();
    Matrix inputs = Matrix::Zero(dynamics_.num_inputs(), samples);
    record_->input_sigma = Vector::Zero(dynamics_.num_inputs());
    for (int i = 0; i < dynamics_.num_inputs(); ++i) {
      const InputSpec& spec = dynamics_.inputs()[static_cast<size_t>(i)];
      if (spec.kind == InputSpec::Kind::kRecordSwitch) {
        inputs.row(i).setConstant(
            spec.name == RecordSwitchName(section_.name) ? 1.0 : 0.0);
        continue;
      }
      const SignalSection* signal = nullptr;
      for (const InputSection& input : section_.inputs) {
        if (input.spec.name == spec.name) signal = &input.signal;
      }
      const Channel* channel = FindInput(spec);
      if (channel == nullptr) {
        if (spec.kind == InputSpec::Kind::kPrescribedDisplacement) {
          return table_.Fail(
              "motion",
              "it has no motion of DOF '" +
                  dynamics_.model().dof_names[static_cast<size_t>(spec.index)] +
                  "', which other records prescribe; expected one in every "
                  "record");
        }
        if (spec.kind == InputSpec::Kind::kCovariate) {
          return table_.Fail("covariate", "it has no covariate '" + spec.name +
                                              "', expected one in every "
                                              "record");
        }
        record_->description.remarks.push_back(
            spec.name +
            " is not in this record and is taken as "
            "zero.");
        continue;
      }
      std::string error;
      if (!IsCompleteExcitation(merged_, *channel, &error)) {
        return table_.Fail(
            signal != nullptr ? "window" : "ground",
            error + (spec.kind == InputSpec::Kind::kCovariate
                         ? "; expected readings from begin to end, a window "
                           "that has them, or one 'value'"
                         : "; expected every sample, or a window that leaves "
                           "the gap out"));
      }
      inputs.row(i) = channel->values.transpose();
      if (signal == nullptr) continue;
      record_->input_sigma[i] =
          signal->sigma_percent > 0.0
              ? signal->sigma_percent / 100.0 *
                    StandardDeviationOfPresent(channel->values)
              : std::abs(signal->scale) * signal->sigma;
    }
    if (record_->input_sigma.isZero(0.0)) record_->input_sigma.resize(0);
    record_->excitation.emplace(merged_.start_time, merged_.sampling_step,
                                std::move(inputs), section_.interpolation,
                                section_.periodic);
    return true;
  }

  bool MakeChannels() {
    const Eigen::Index samples = merged_.num_samples();
    for (const ChannelSection& section : section_.channels) {
      MeasuredChannel channel;
      channel.observation.name = section.name;
      channel.observation.quantity = section.quantity;
      channel.observation.weights = section.weights;
      channel.fit = section.fit;
      // Nobody looks at it there any more.
      const auto source = std::find_if(
          merged_.channels.begin(), merged_.channels.end(),
          [&](const Channel& c) { return c.name == section.signal.label; });
      channel.values = std::move(source->values);
      const Eigen::Index present = CountPresent(channel.values);
      if (!simulation_ && present < 2) {
        return section.signal.table.Fail(
            "column", "it has " + std::to_string(present) +
                          " samples in the window, expected at least two");
      }
      if (!simulation_ && present < samples) {
        record_->description.remarks.push_back(
            section.signal.label + ": " + std::to_string(samples - present) +
            " of " + std::to_string(samples) + " samples are missing.");
      }
      channel.description = {section.signal.unit, section.signal.factor,
                             section.location};
      record_->channels.push_back(std::move(channel));
    }
    return true;
  }

  bool ApplyFilter() {
    if (!section_.filter.has_value()) return true;
    std::string error;
    if (!section_.filter->IsValid(merged_.sampling_step, &error)) {
      return table_.Fail("filter", error);
    }
    auto filter = std::make_shared<ZeroPhaseFilter>(*section_.filter,
                                                    merged_.sampling_step);
    for (MeasuredChannel& channel : record_->channels) {
      if (simulation_) continue;
      if (CountPresent(channel.values) != channel.values.size()) {
        return table_.Fail("filter",
                           "channel '" + channel.observation.name +
                               "' has missing samples and cannot be filtered, "
                               "expected a window without gaps, or no filter");
      }
      filter->Apply(&channel.values);
    }
    record_->filter = std::move(filter);
    return true;
  }

  bool SetNoise() {
    for (size_t c = 0; c < record_->channels.size(); ++c) {
      const SignalSection& signal = section_.channels[c].signal;
      MeasuredChannel& channel = record_->channels[c];
      if (signal.sigma_percent > 0.0 && !simulation_) {
        channel.sigma = signal.sigma_percent / 100.0 *
                        StandardDeviationOfPresent(channel.values);
      } else if (signal.sigma > 0.0) {
        channel.sigma = signal.sigma;
      } else if (channel.fit && !simulation_ && IsConstant(channel.values)) {
        // With no noise of its own it would outweigh all others.
        return signal.table.Fail(
            "column",
            "it has the same value in every sample, as a dead sensor has; "
            "expected one that works, 'fit = false', or its 'sigma'");
      }
    }
    return true;
  }

  const RecordSection& section_;
  const TomlTable& table_;
  const UnitSystem& units_;
  const StructuralDynamics& dynamics_;
  const bool simulation_;
  IdentificationRecord* record_;

  std::map<std::string, SourceFile> files_;
  double base_start_ = 0.0;
  double base_step_ = 0.0;
  Eigen::Index num_samples_ = 0;
  Record merged_;
};

}  // namespace

Vector Differentiate(const Vector& values, double step) {
  const Eigen::Index n = values.size();
  Vector derivative(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    // Differences of the fourth order, of the second beside the ends.
    const Eigen::Index room = std::min(i, n - 1 - i);
    if (room >= 2) {
      derivative[i] = (8.0 * (values[i + 1] - values[i - 1]) -
                       (values[i + 2] - values[i - 2])) /
                      (12.0 * step);
    } else if (room == 1) {
      derivative[i] = (values[i + 1] - values[i - 1]) / (2.0 * step);
    } else if (n == 1) {
      derivative[i] = 0.0;
    } else if (n == 2) {
      derivative[i] = (values[1] - values[0]) / step;
    } else {
      const Eigen::Index inward = i == 0 ? 1 : -1;
      derivative[i] = static_cast<double>(inward) *
                      (4.0 * values[i + inward] - 3.0 * values[i] -
                       values[i + 2 * inward]) /
                      (2.0 * step);
    }
  }
  return derivative;
}

Vector IntegrateTwice(const Vector& acceleration, double step,
                      Interpolation interpolation) {
  const Eigen::Index n = acceleration.size();
  Vector displacement = Vector::Zero(n);
  double velocity = 0.0;
  const auto at = [&](Eigen::Index i) {
    return acceleration[std::min(std::max<Eigen::Index>(i, 0), n - 1)];
  };
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    // In an interval a(s) = c0 + c1 s + c2 s^2 + c3 s^3, s from 0 to 1.
    const double a = at(i);
    const double b = at(i + 1);
    double c0 = a;
    double c1 = 0.0;
    double c2 = 0.0;
    double c3 = 0.0;
    if (interpolation == Interpolation::kLinear) {
      c1 = b - a;
    } else if (interpolation != Interpolation::kHeld) {
      const double slope_a = 0.5 * (b - at(i - 1));
      const double slope_b = 0.5 * (at(i + 2) - a);
      c1 = slope_a;
      c2 = 3.0 * (b - a) - 2.0 * slope_a - slope_b;
      c3 = 2.0 * (a - b) + slope_a + slope_b;
    }
    displacement[i + 1] =
        displacement[i] + step * velocity +
        step * step * (c0 / 2.0 + c1 / 6.0 + c2 / 12.0 + c3 / 20.0);
    velocity += step * (c0 + c1 / 2.0 + c2 / 3.0 + c3 / 4.0);
  }
  return displacement;
}

bool ReadRecordData(const RecordSection& section, const UnitSystem& units,
                    const StructuralDynamics& dynamics, bool simulation,
                    IdentificationRecord* record) {
  return RecordDataReader(section, units, dynamics, simulation, record).Read();
}

}  // namespace pinode
