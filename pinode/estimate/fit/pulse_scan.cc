#include "pinode/estimate/fit/pulse_scan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

// Largest number of positions for one duration.
constexpr int kMostStarts = 400;

// Distance of two positions. If it is larger, a pulse that is too short but
// well placed looks better than one of the true length, and the fit stays
// there.
constexpr double kStepInDurations = 0.15;

// Integration steps in a pulse, enough to find it.
constexpr double kStepsPerPulse = 8.0;

class Scanner {
 public:
  explicit Scanner(const IdentificationProblem& problem)
      : problem_(problem), layout_(problem) {
    for (const IdentificationRecord& record : problem.records) {
      substeps_.push_back(record.substeps);
    }
  }

  void Scan(int force, Vector* parameters) {
    const StructuralDynamics& dynamics = *problem_.dynamics;
    offset_ = dynamics.block_offset(dynamics.unknown_force_block(force));
    const auto& term = dynamics.unknown_forces()[static_cast<size_t>(force)];
    const Parameter& start = layout_.parameter(offset_);
    const Parameter& duration = layout_.parameter(offset_ + 1);
    const Parameter& amplitude = layout_.parameter(offset_ + 2);
    SelectRecords(term);
    (*parameters)[offset_ + 2] = amplitude.value;
    if (records_.empty()) return;
    const double given_duration = (*parameters)[offset_ + 1];
    std::vector<double> durations = {given_duration};
    for (const double factor : {0.25, 0.5, 2.0, 4.0}) {
      const double value = factor * given_duration;
      if (duration.free && value >= duration.lower && value <= duration.upper) {
        durations.push_back(value);
      }
    }
    // A small response gives a poor amplitude of a nonlinear one, but a good
    // position.
    double unit = amplitude.value;
    if (unit == 0.0 && amplitude.free) unit = UnitAmplitude(term);

    Vector trial = *parameters;
    trial[offset_ + 2] = 0.0;
    SetSubsteps(given_duration);
    if (unit == 0.0 || !Predict(trial, &base_)) return;
    Vector best = *parameters;
    best[offset_ + 2] = amplitude.value;
    double best_gain = 0.0;
    const auto consider = [&](double at, double length) {
      trial[offset_] = at;
      trial[offset_ + 1] = length;
      trial[offset_ + 2] = unit;
      double factor = 1.0;
      const double gain = Gain(trial, amplitude.free, &factor);
      if (!(gain > best_gain)) return;
      trial[offset_ + 2] =
          std::clamp(factor * unit, amplitude.lower, amplitude.upper);
      if (trial[offset_ + 2] == 0.0) return;
      best = trial;
      best_gain = gain;
    };
    consider((*parameters)[offset_], given_duration);
    for (const double length : durations) {
      SetSubsteps(length);
      trial[offset_ + 2] = 0.0;
      if (!Predict(trial, &base_)) continue;
      const double first = std::max(start.lower, first_ - 0.5 * length);
      const double last = std::min(start.upper, last_);
      const double step =
          std::max(kStepInDurations * length, (last - first) / kMostStarts);
      for (double at = first; at <= last; at += step) consider(at, length);
    }
    VLOG(1) << term.name << ": begins at " << best[offset_] << ", lasts "
            << best[offset_ + 1] << ", amplitude " << best[offset_ + 2];
    *parameters = best;
  }

 private:
  // Selects the training records in which the force acts, and the time they
  // cover.
  void SelectRecords(const UnknownForceTerm& term) {
    records_.clear();
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      if (term.input >= 0 &&
          record.excitation->samples()(term.input, 0) == 0.0) {
        continue;
      }
      const double begin = record.excitation->time(0);
      const double end = record.excitation->time(record.num_samples() - 1);
      first_ = records_.empty() ? begin : std::min(first_, begin);
      last_ = records_.empty() ? end : std::max(last_, end);
      records_.push_back(static_cast<int>(r));
    }
  }

  // Returns an amplitude that moves the structure about as much as the sensors
  // show. For a linear structure any would do.
  double UnitAmplitude(const UnknownForceTerm& term) const {
    return (problem_.dynamics->model().mass * term.outputs).norm();
  }

  void SetSubsteps(double length) {
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const double wanted = std::ceil(
          kStepsPerPulse * problem_.records[r].sampling_step() / length);
      problem_.records[r].substeps = static_cast<int>(
          std::clamp(wanted, 1.0, static_cast<double>(substeps_[r])));
    }
  }

  bool Predict(const Vector& parameters, std::vector<Matrix>* predictions) {
    predictions->clear();
    for (const int r : records_) {
      const IdentificationRecord& record =
          problem_.records[static_cast<size_t>(r)];
      const Vector start = record.start == IdentificationRecord::Start::kKnown
                               ? record.known_start
                               : Vector::Zero(problem_.dynamics->num_states());
      RecordScore score;
      ScoreRecord(problem_, r, parameters, start, 0, &score, Keep::kChannels);
      if (!score.finite) {
        // The steps may be too long for the structure.
        IdentificationRecord& coarse = problem_.records[static_cast<size_t>(r)];
        coarse.substeps = substeps_[static_cast<size_t>(r)];
        ScoreRecord(problem_, r, parameters, start, 0, &score, Keep::kChannels);
        if (!score.finite) return false;
      }
      predictions->push_back(score.prediction);
    }
    return true;
  }

  // Returns the decrease of the sum of squares by the pulse, channels in units
  // of their noise or spread. With `scaled` the pulse is multiplied by the best
  // *factor, as if the response were linear in it.
  double Gain(const Vector& parameters, bool scaled, double* factor) {
    std::vector<Matrix> predictions;
    if (!Predict(parameters, &predictions)) return 0.0;
    double product = 0.0;
    double square = 0.0;
    for (size_t i = 0; i < records_.size(); ++i) {
      const IdentificationRecord& record =
          problem_.records[static_cast<size_t>(records_[i])];
      for (size_t c = 0; c < record.channels.size(); ++c) {
        const MeasuredChannel& channel = record.channels[c];
        const double scale = channel.sigma > 0.0
                                 ? channel.sigma
                                 : StandardDeviationOfPresent(channel.values);
        if (!channel.fit || !(scale > 0.0)) continue;
        const Eigen::Index row = static_cast<Eigen::Index>(c);
        for (Eigen::Index k = 0; k < channel.values.size(); ++k) {
          if (std::isnan(channel.values[k])) continue;
          const double effect =
              (predictions[i](row, k) - base_[i](row, k)) / scale;
          product += effect * (channel.values[k] - base_[i](row, k)) / scale;
          square += effect * effect;
        }
      }
    }
    if (!(square > 0.0) || !std::isfinite(square)) return 0.0;
    *factor = scaled ? product / square : 1.0;
    return *factor * (2.0 * product - *factor * square);
  }

  IdentificationProblem problem_;  // a copy: with steps of its own
  ParameterLayout layout_;
  std::vector<int> substeps_;  // of the problem itself
  int offset_ = 0;
  std::vector<int> records_;
  double first_ = 0.0;
  double last_ = 0.0;
  std::vector<Matrix> base_;
};

}  // namespace

void ScanPulses(const IdentificationProblem& problem, Vector* parameters) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<int> pulses;
  for (size_t j = 0; j < dynamics.unknown_forces().size(); ++j) {
    const UnknownForceTerm& term = dynamics.unknown_forces()[j];
    if (dynamic_cast<const HalfSinePulse*>(term.history.get()) == nullptr ||
        !term.parameters.parameters[0].free) {
      continue;
    }
    pulses.push_back(static_cast<int>(j));
    // Pulses that are still to be found must not disturb.
    const int offset =
        dynamics.block_offset(dynamics.unknown_force_block(pulses.back()));
    (*parameters)[offset + 2] = 0.0;
  }
  for (const int j : pulses) Scanner(problem).Scan(j, parameters);
}

}  // namespace pinode
