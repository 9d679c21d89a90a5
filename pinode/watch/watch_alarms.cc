#include "pinode/watch/watch_alarms.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Features that an alarm names.
constexpr size_t kMostNamed = 3;

std::string Percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof(text), "%+.2f %%", 100.0 * fraction);
  return text;
}

// Tells when a feature was not found for long: a change may be so large that
// its mode begins another history.
class AbsenceKeeper {
 public:
  AbsenceKeeper(const FeatureSeries& series, double clear_days)
      : series_(series),
        limit_(clear_days * kDay),
        last_seen_(Vector::Constant(series.num_features(), kNaN)),
        is_absent_(static_cast<size_t>(series.num_features()), false),
        is_told_(is_absent_) {}

  void Add(Eigen::Index record) {
    const double time = series_.times[record];
    for (Eigen::Index f = 0; f < series_.num_features(); ++f) {
      const size_t at = static_cast<size_t>(f);
      if (!std::isnan(series_.values(record, f))) {
        last_seen_[f] = time;
        is_absent_[at] = false;
        is_told_[at] = false;
      } else if (time - last_seen_[f] >= limit_) {
        is_absent_[at] = true;
      }
    }
  }
  // Returns the names of the absent features that it has not returned before.
  std::vector<std::string> Tell() {
    std::vector<std::string> absent;
    for (size_t f = 0; f < is_absent_.size(); ++f) {
      if (!is_absent_[f] || is_told_[f]) continue;
      is_told_[f] = true;
      absent.push_back(series_.names[f]);
    }
    return absent;
  }
  bool Any() const {
    return std::find(is_absent_.begin(), is_absent_.end(), true) !=
           is_absent_.end();
  }

 private:
  const FeatureSeries& series_;
  double limit_;
  Vector last_seen_;
  std::vector<bool> is_absent_, is_told_;
};

// Raises alarms and ends them.
class AlarmKeeper {
 public:
  AlarmKeeper(const WatchedStructure& structure,
              const std::vector<Innovation>& innovations,
              WatchAnalysis* analysis)
      : options_(structure.chart),
        innovations_(innovations),
        analysis_(*analysis),
        absences_(analysis->series, structure.chart.clear_days),
        covariance_(CovarianceWithOutside(analysis->model)),
        average_(analysis->series.num_features(), covariance_.rows(),
                 structure.chart.memory_days * kDay) {}

  void Run() {
    reference_end_ = EndOfReference();
    for (size_t r = 0; r < innovations_.size(); ++r) {
      const double time = analysis_.series.times[static_cast<Eigen::Index>(r)];
      PassRefused(time);
      time_ = time;
      const bool is_charted = innovations_[r].valid;
      if (is_charted) {
        const double step = std::isnan(last_) ? 0.0 : time_ - last_;
        average_.Add(step, innovations_[r]);
        quiet_ += std::min(step, kDay);
        last_ = time_;
      }
      absences_.Add(static_cast<Eigen::Index>(r));
      if (time_ <= reference_end_) {
        analysis_.lights.push_back(WatchLight::kLearning);
        continue;
      }
      TellSensors(static_cast<int>(r));
      // The first record after the reference tells also what ended within it.
      const std::vector<std::string> absent = absences_.Tell();
      if (!absent.empty()) {
        Notice("not found for " + FormatNumber(options_.clear_days, 3) +
               " days: " + Join(absent, ", ") +
               "; look whether another mode has taken its place");
      }
      if (is_charted) {
        is_blind_ = false;
        Judge(r);
      } else if (HasBecomeBlind()) {
        Notice(BlindText(r));
      }
      analysis_.lights.push_back(light_);
      analysis_.light = light_;
    }
    PassRefused(kInfinity);
  }

 private:
  // Tells about sensors that the history shows to have changed.
  void TellSensors(int record) {
    for (const SensorChange& change : analysis_.sensor_changes) {
      if (change.record != record) continue;
      // It may come and go in single records.
      const auto told = told_sensors_.find(change.channel);
      const bool is_new = told == told_sensors_.end() ||
                          time_ - told->second >= options_.clear_days * kDay;
      told_sensors_[change.channel] = time_;
      if (!is_new) continue;
      std::string fault = change.fault;
      if (fault.back() == '.') fault.pop_back();
      Notice("a sensor has changed: channel '" + change.channel + "' " + fault +
             "; it is left out");
    }
  }

  // Passes the refused records before `time`. When all sensors fail, no other
  // records are left to show it.
  void PassRefused(double time) {
    const std::vector<StoredRecord>& refused = analysis_.refused;
    for (; next_refused_ < refused.size() && refused[next_refused_].time < time;
         ++next_refused_) {
      const StoredRecord& record = refused[next_refused_];
      time_ = record.time;
      if (time_ <= reference_end_ || !HasBecomeBlind()) continue;
      std::string reason = record.refusal;
      if (!reason.empty() && reason.back() == '.') reason.pop_back();
      Notice("no record could be used for " +
             FormatNumber(options_.clear_days, 3) +
             " days; the last refusal: " + reason);
      analysis_.light = light_;
    }
  }

  // Returns true once in each long time without a chart.
  bool HasBecomeBlind() {
    if (is_blind_ || !(time_ - last_ >= options_.clear_days * kDay)) {
      return false;
    }
    is_blind_ = true;
    return true;
  }

  // Adds an event that changes the light, unless that is an alarm.
  void Notice(const std::string& text) {
    AddEvent("notice", text);
    if (light_ != WatchLight::kAlarm) light_ = WatchLight::kNotice;
    last_notice_ = time_;
  }

  double EndOfReference() const {
    double end = -kInfinity;
    for (size_t r = 0; r < analysis_.is_reference.size(); ++r) {
      if (analysis_.is_reference[r]) {
        end = analysis_.series.times[static_cast<Eigen::Index>(r)];
      }
    }
    return end;
  }

  bool Exceeds(size_t r, const ChartLimits& limits) const {
    const ChartValues& values = analysis_.chart[r];
    return values.t2 > limits.t2 || values.average > limits.average;
  }

  void Judge(size_t r) {
    const std::string outside = OutsideText(r);
    // Outside of the learned range one record is no evidence. The moving
    // average allows for the unknown slope there.
    const bool is_alarm =
        outside.empty()
            ? Exceeds(r, analysis_.thresholds.alarm)
            : analysis_.chart[r].average > analysis_.thresholds.alarm.average;
    const bool is_notice = Exceeds(r, analysis_.thresholds.notice);
    const bool goes_outside = !outside.empty() && !(time_ - last_outside_ <
                                                    options_.clear_days * kDay);
    if (!outside.empty()) last_outside_ = time_;
    if (is_alarm) {
      if (light_ != WatchLight::kAlarm) {
        AddEvent("alarm", AlarmText(r, outside));
      } else if (goes_outside) {
        AddEvent("notice", outside);
      }
      light_ = WatchLight::kAlarm;
      quiet_ = 0.0;
    } else if (light_ == WatchLight::kAlarm) {
      // The mode that moved may be the one that is gone, with its scores.
      if (quiet_ < options_.clear_days * kDay || absences_.Any()) {
        if (goes_outside) AddEvent("notice", outside);
        return;
      }
      light_ = WatchLight::kNormal;
      AddEvent("all-clear", "no record exceeded the limits for " +
                                FormatNumber(options_.clear_days, 3) + " days");
    }
    if (light_ == WatchLight::kAlarm) return;
    if (is_notice || !outside.empty()) {
      if (light_ != WatchLight::kNotice || goes_outside) {
        AddEvent("notice", is_notice ? AlarmText(r, outside) : outside);
      }
      light_ = WatchLight::kNotice;
      last_notice_ = time_;
    } else if (absences_.Any()) {
      light_ = WatchLight::kNotice;
      last_notice_ = time_;
    } else if (light_ == WatchLight::kNotice &&
               time_ - last_notice_ >= options_.clear_days * kDay) {
      light_ = WatchLight::kNormal;
    }
  }

  void AddEvent(const std::string& kind, const std::string& text) {
    analysis_.events.push_back({time_, kind, text});
  }

  // Returns a sentence on what the chart lacks.
  std::string BlindText(size_t r) const {
    const FeatureSeries& series = analysis_.series;
    std::vector<std::string> missing;
    for (Eigen::Index c = 0; c < series.covariates.cols(); ++c) {
      if (std::isnan(series.covariates(static_cast<Eigen::Index>(r), c))) {
        missing.push_back(series.covariate_names[static_cast<size_t>(c)]);
      }
    }
    return "no alarm could be raised for " +
           FormatNumber(options_.clear_days, 3) + " days, because " +
           (missing.empty() ? std::string("no watched mode was found")
                            : Join(missing, ", ") + " is missing");
  }

  // Returns a sentence on covariates outside of the learned range.
  std::string OutsideText(size_t r) const {
    const FeatureSeries& series = analysis_.series;
    const Eigen::Index record = static_cast<Eigen::Index>(r);
    const Vector outside = analysis_.model.Outside(series, record);
    std::vector<std::string> parts;
    for (Eigen::Index c = 0; c < outside.size(); ++c) {
      if (outside[c] <= 0.0) continue;
      parts.push_back(series.covariate_names[static_cast<size_t>(c)] + " = " +
                      FormatNumber(series.covariates(record, c), 4) +
                      " is outside of the learned range " +
                      FormatNumber(analysis_.model.lowest[c], 4) + " to " +
                      FormatNumber(analysis_.model.highest[c], 4));
    }
    return Join(parts, "; ");
  }

  // Returns the reasons: faulty sensors and covariates first, then the features
  // that moved most. Changes are printed in full, although the chart limits
  // residuals.
  std::string AlarmText(size_t r, const std::string& outside) const {
    std::vector<std::string> parts;
    for (const StoredChannel& channel : analysis_.records[r].channels) {
      if (channel.fault.empty()) continue;
      std::string fault = channel.fault;
      if (fault.back() == '.') fault.pop_back();
      parts.push_back("channel '" + channel.name + "' is left out: it " +
                      fault);
    }
    if (!outside.empty()) parts.push_back(outside);
    const bool by_average =
        analysis_.chart[r].average - analysis_.thresholds.alarm.average >=
        analysis_.chart[r].t2 - analysis_.thresholds.alarm.t2;
    const Eigen::Index record = static_cast<Eigen::Index>(r);
    const Vector now =
        (analysis_.series.values.row(record) - analysis_.expected.row(record))
            .transpose();
    Vector change = now;
    Vector deviation = analysis_.expected_deviations.row(record).transpose();
    if (by_average) average_.Change(covariance_, &change, &deviation);
    std::vector<std::pair<double, Eigen::Index>> moved;
    for (Eigen::Index f = 0; f < change.size(); ++f) {
      const double size = std::abs(change[f]) / deviation[f];
      if (std::isfinite(size)) moved.emplace_back(-size, f);
    }
    std::sort(moved.begin(), moved.end());
    for (size_t i = 0; i < std::min(kMostNamed, moved.size()); ++i) {
      const Eigen::Index f = moved[i].second;
      parts.push_back(analysis_.series.names[static_cast<size_t>(f)] + " " +
                      Percent(change[f]) + " (" +
                      FormatNumber(-moved[i].first, 2) + " deviations" +
                      // The average lags behind a sudden change.
                      (by_average && std::isfinite(now[f])
                           ? "; " + Percent(now[f]) + " in this record)"
                           : std::string(")")));
    }
    return (by_average ? "lasting change: " : "this record: ") +
           Join(parts, "; ");
  }

  const ChartOptions& options_;
  const std::vector<Innovation>& innovations_;
  WatchAnalysis& analysis_;
  AbsenceKeeper absences_;
  const Matrix covariance_;
  ScoreAverage average_;
  double reference_end_ = -kInfinity;
  size_t next_refused_ = 0;
  double time_ = 0.0;
  double last_ = kNaN;  // time of the last record with a chart
  WatchLight light_ = WatchLight::kNormal;
  // Time since the last exceedance, s. A gap counts as a day at most: without
  // records nothing is quiet.
  double quiet_ = 0.0;
  // True if there was no chart for long.
  bool is_blind_ = false;
  double last_notice_ = 0.0;
  double last_outside_ = kNaN;  // time of the last record outside
  // Times at which a changed sensor was told last, by channel.
  std::map<std::string, double> told_sensors_;
};

}  // namespace

void RaiseAlarms(const WatchedStructure& structure,
                 const std::vector<Innovation>& innovations,
                 WatchAnalysis* analysis) {
  AlarmKeeper(structure, innovations, analysis).Run();
}

}  // namespace pinode
