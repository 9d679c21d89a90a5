#include "pinode/case/sections/record_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/record_files.h"
#include "pinode/case/sections/unknown_force_section.h"
#include "pinode/record/prepare.h"
#include "pinode/record/resample.h"
#include "pinode/record/sample_faults.h"
#include "pinode/record/sampled_calculus.h"
#include "pinode/record/short_gaps.h"

namespace pinode {
namespace {

// Largest ratio of resampling. A larger one is probably a typing error, and
// would take days.
constexpr double kMostResampled = 100.0;  // times the record's own rate
// Error that interpolated samples may add to a load: less than a good sensor's
// noise, so that intervals need not know of it. A choice.
constexpr double kMostInterpolated = 0.01;

// True if all values that are present are equal.
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

class RecordDataReader {
 public:
  RecordDataReader(const RecordSection& section, const UnitSystem& units,
                   const StructuralDynamics& dynamics, bool simulation,
                   IdentificationRecord* record,
                   std::vector<std::string>* faults)
      : section_(section),
        table_(section.table),
        dynamics_(dynamics),
        simulation_(simulation),
        record_(record),
        faults_(faults),
        files_(section, units, &record->description.remarks) {}

  bool Read() {
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
    if (!files_.Read(simulation_)) return false;
    record_->description.time_unit = files_.time_unit();
    record_->description.time_factor = files_.time_factor();
    return CollectSignals() && LookForFaults() && ResampleAll() &&
           AddGroundDisplacements() && AddPrescribedDerivatives() &&
           CutWindow() && MakeExcitation() && MakeChannels() && ApplyFilter() &&
           SetNoise();
  }

 private:
  bool CollectSignals() {
    merged_.name = section_.name;
    merged_.start_time = files_.start_time();
    merged_.sampling_step = files_.step();
    for (const InputSection& input : section_.inputs) {
      if (input.value.has_value()) {
        AddConstant(input.signal.label, *input.value);
      } else if (!AddSignal(input.signal, /*is_input=*/true,
                            input.spec.kind == InputSpec::Kind::kCovariate)) {
        return false;
      }
    }
    for (const ChannelSection& channel : section_.channels) {
      if (simulation_) {
        AddConstant(channel.signal.label, kNaN);
      } else if (!AddSignal(channel.signal, /*is_input=*/false,
                            /*is_covariate=*/false)) {
        return false;
      }
    }
    files_.Clear();
    std::string error;
    if (!merged_.IsValid(&error)) {
      return table_.errors()->Fail(table_.line(), error);
    }
    return true;
  }

  void AddConstant(const std::string& label, double value) {
    merged_.channels.push_back(
        {label, "1", Vector::Constant(files_.num_samples(), value)});
  }

  bool AddSignal(const SignalSection& signal, bool is_input,
                 bool is_covariate) {
    Channel channel;
    if (!files_.Signal(signal, is_input, is_covariate, &channel)) return false;
    merged_.channels.push_back(std::move(channel));
    return true;
  }

  // Checks the samples of signals as originally recorded, but for unit and
  // mean.
  bool LookForFaults() {
    if (faults_ == nullptr || simulation_) return true;
    const double step = merged_.sampling_step;
    Eigen::Index first = 0;
    Eigen::Index last = merged_.num_samples() - 1;
    if (section_.window_from.has_value()) {
      const auto nearest = [&](double time) {
        const double sample = std::round((time - merged_.start_time) / step);
        return static_cast<Eigen::Index>(
            std::clamp(sample, 0.0, static_cast<double>(last)));
      };
      first = nearest(*section_.window_from);
      last = std::max(first, nearest(*section_.window_to));
    }
    std::vector<WatchedSignal> signals;
    // Channels whose samples are moved temporarily, by their signal.
    std::vector<std::pair<Channel*, size_t>> lent;
    const bool is_whole = first == 0 && last == merged_.num_samples() - 1;
    const auto add = [&](const SignalSection& section,
                         WatchedSignal::Kind kind) {
      WatchedSignal signal;
      signal.label = section.label;
      signal.unit = section.unit;
      signal.kind = kind;
      const auto channel = std::find_if(
          merged_.channels.begin(), merged_.channels.end(),
          [&](const Channel& c) { return c.name == section.label; });
      const double mean = files_.SubtractedMean(section.label);
      if (is_whole && mean == 0.0 && section.factor == 1.0) {
        signal.values = std::move(channel->values);
        lent.emplace_back(&*channel, signals.size());
      } else {
        signal.values = channel->values.segment(first, last - first + 1);
        signal.values.array() += mean;
        signal.values /= section.factor;
      }
      signals.push_back(std::move(signal));
    };
    for (const InputSection& input : section_.inputs) {
      if (input.value.has_value()) continue;
      add(input.signal, input.spec.kind == InputSpec::Kind::kCovariate
                            ? WatchedSignal::Kind::kCovariate
                            : WatchedSignal::Kind::kLoad);
    }
    for (const ChannelSection& channel : section_.channels) {
      add(channel.signal, WatchedSignal::Kind::kResponse);
    }
    for (const std::string& fault :
         FindSampleFaults(signals, merged_.time(first) / files_.time_factor(),
                          step / files_.time_factor(), files_.time_unit())) {
      faults_->push_back("Record '" + section_.name + "', " + fault);
    }
    for (const auto& [channel, signal] : lent) {
      channel->values = std::move(signals[signal].values);
    }
    return true;
  }

  bool ResampleAll() {
    if (section_.resampling_step == 0.0) return true;
    if (section_.resampling_step * kMostResampled < merged_.sampling_step) {
      return table_.Fail("resample_hz",
                         "'resample_hz' is more than 100 times the rate of the "
                         "record, expected less");
    }
    if (!FillGapsOfLoads()) return false;
    merged_ = ResampleRecord(merged_, section_.resampling_step);
    if (merged_.num_samples() < 2) {
      return table_.Fail("resample_hz",
                         "'resample_hz' leaves fewer than two "
                         "samples, expected a higher rate");
    }
    return true;
  }

  // Interpolates short gaps of loads. A record that is resampled is
  // interpolated anyhow, and samples that its logger dropped are too, while
  // this adds little to the load.
  bool FillGapsOfLoads() {
    for (const InputSection& input : section_.inputs) {
      if (input.spec.kind == InputSpec::Kind::kCovariate) continue;
      const auto channel = std::find_if(
          merged_.channels.begin(), merged_.channels.end(),
          [&](const Channel& c) { return c.name == input.signal.label; });
      if (channel == merged_.channels.end()) continue;
      const ShortGaps filled = FillShortGaps(&channel->values);
      if (filled.num_samples == 0) continue;
      const std::string number = std::to_string(filled.num_samples);
      if (std::isnan(filled.error)) {
        return table_.Fail(
            "resample_hz",
            "the excitation '" + input.signal.label +
                "' misses samples and has no complete stretch on which their "
                "interpolation can be tried; use a window without gaps");
      }
      if (filled.error > kMostInterpolated) {
        return table_.Fail(
            "resample_hz",
            "the excitation '" + input.signal.label + "' misses " + number +
                " samples in gaps of at most " + std::to_string(kMostShortGap) +
                ", and their interpolation would add an error of " +
                FormatNumber(100.0 * filled.error, 2) +
                " % to it, expected at most 1 %; use a window without gaps");
      }
      record_->description.remarks.push_back(
          input.signal.label + ": " + number + " missing samples, at most " +
          std::to_string(filled.longest) +
          " in a row, are interpolated. Tried on complete stretches near "
          "them, this adds an error of " +
          FormatNumber(100.0 * filled.error, 2) + " % to the load.");
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

  // Adds the derivatives of prescribed displacements that no column provides.
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

  // Returns the samples of an input; nullptr if the record lacks them.
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
            spec.name + " is not in this record and is set to zero.");
        continue;
      }
      std::string error;
      if (!IsCompleteExcitation(merged_, *channel, &error)) {
        return table_.Fail(
            signal != nullptr ? "window" : "ground",
            error +
                (spec.kind == InputSpec::Kind::kCovariate
                     ? "; expected readings from begin to end, a window with "
                       "readings, or one 'value'"
                     : "; expected every sample, or a window without the gap"));
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
      // The source is not used there any more.
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
      channel.values /= section.known_gain;
      channel.description = {section.signal.unit,
                             section.signal.factor / section.known_gain,
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
                               "' has missing samples and cannot be filtered; "
                               "choose a window without gaps, or no filter");
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
        channel.sigma = std::abs(signal.scale) * signal.sigma;
      } else if (channel.fit && !simulation_ && IsConstant(channel.values)) {
        // Without noise of its own it would outweigh all others.
        return signal.table.Fail(
            "column",
            "it has the same value in every sample, like a dead sensor; leave "
            "it out, set 'fit = false', or give its 'sigma'");
      }
    }
    return true;
  }

  const RecordSection& section_;
  const TomlTable& table_;
  const StructuralDynamics& dynamics_;
  const bool simulation_;
  IdentificationRecord* record_;
  std::vector<std::string>* faults_;  // may be nullptr

  RecordFiles files_;
  Record merged_;
};

}  // namespace

bool ReadRecordData(const RecordSection& section, const UnitSystem& units,
                    const StructuralDynamics& dynamics, bool simulation,
                    IdentificationRecord* record,
                    std::vector<std::string>* faults) {
  return RecordDataReader(section, units, dynamics, simulation, record, faults)
      .Read();
}

}  // namespace pinode
