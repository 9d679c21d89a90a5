#include "pinode/watch/watch_analysis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/watch/watch_alarms.h"

namespace pinode {
namespace {

bool ComesFirst(const StoredRecord& a, const StoredRecord& b) {
  if (a.time != b.time) return a.time < b.time;
  if (a.duration != b.duration) return a.duration > b.duration;
  return a.content < b.content;
}

// Orders the records and leaves those that can be used.
void SelectRecords(std::vector<StoredRecord> records, WatchAnalysis* analysis) {
  std::sort(records.begin(), records.end(), ComesFirst);
  std::sort(analysis->refused.begin(), analysis->refused.end(), ComesFirst);
  for (StoredRecord& record : records) {
    if (!analysis->records.empty() &&
        analysis->records.back().time == record.time) {
      // A file that was read while it grew.
      ++analysis->num_repeated;
      continue;
    }
    analysis->records.push_back(std::move(record));
  }
}

void MarkReference(const ReferencePeriod& reference, WatchAnalysis* analysis) {
  const size_t count = analysis->records.size();
  analysis->is_reference.assign(count, false);
  int marked = 0;
  for (size_t r = 0; r < count; ++r) {
    const double time = analysis->records[r].time;
    const bool is_reference =
        time >= reference.from &&
        (reference.num_records > 0 ? marked < reference.num_records
                                   : time < reference.to);
    analysis->is_reference[r] = is_reference;
    marked += is_reference ? 1 : 0;
  }
  analysis->reference_is_complete =
      reference.num_records > 0
          ? marked == reference.num_records
          : count > 0 && analysis->records.back().time >= reference.to;
}

// Returns the names that people gave to the watched modes; empty: none. Each
// name goes to the nearest mode, and the last one of a mode counts.
std::vector<std::string> NamesOfWatched(const WatchedStructure& structure,
                                        const std::vector<double>& watched_hz) {
  std::vector<std::string> names(watched_hz.size());
  for (const auto& [hz, text] : structure.mode_names) {
    // The frequency may be that of a single record.
    double least = std::log1p(structure.tracking.largest_step);
    size_t nearest = names.size();
    for (size_t f = 0; f < watched_hz.size(); ++f) {
      const double step = std::abs(std::log(hz / watched_hz[f]));
      if (step > least) continue;
      least = step;
      nearest = f;
    }
    if (nearest < names.size()) names[nearest] = text;
  }
  return names;
}

// Turns the histories that are present often enough into features.
void MakeSeries(const WatchedStructure& structure, WatchAnalysis* analysis) {
  const std::vector<StoredRecord>& records = analysis->records;
  const std::vector<ModeHistory> histories =
      JoinModes(records, structure.tracking);
  analysis->num_histories = static_cast<int>(histories.size());
  const double num_reference = static_cast<double>(std::count(
      analysis->is_reference.begin(), analysis->is_reference.end(), true));
  std::vector<std::pair<double, size_t>> watched;  // by frequency
  for (size_t h = 0; h < histories.size(); ++h) {
    double count = 0.0;
    double sum = 0.0;
    for (const ModeHistory::Point& point : histories[h].points) {
      const size_t r = static_cast<size_t>(point.record);
      if (!analysis->is_reference[r]) continue;
      count += 1.0;
      sum += records[r].modes[static_cast<size_t>(point.mode)].frequency_hz;
    }
    if (count > 0.0 &&
        count >= structure.tracking.least_presence * num_reference) {
      watched.emplace_back(sum / count, h);
    }
  }
  std::sort(watched.begin(), watched.end());

  FeatureSeries& series = analysis->series;
  const Eigen::Index num_records = static_cast<Eigen::Index>(records.size());
  const Eigen::Index num_features = static_cast<Eigen::Index>(watched.size());
  const Eigen::Index num_covariates =
      static_cast<Eigen::Index>(structure.covariates.size());
  series.times.resize(num_records);
  series.values = Matrix::Constant(num_records, num_features, kNaN);
  series.sigmas = series.values;
  series.covariates.resize(num_records, num_covariates);
  series.kinks.resize(num_covariates);
  analysis->reference_hz.resize(num_features);
  for (Eigen::Index c = 0; c < num_covariates; ++c) {
    const WatchedCovariate& covariate =
        structure.covariates[static_cast<size_t>(c)];
    series.covariate_names.push_back(covariate.name);
    series.kinks[c] = covariate.kink;
    for (Eigen::Index r = 0; r < num_records; ++r) {
      series.covariates(r, c) =
          records[static_cast<size_t>(r)].Covariate(covariate.name);
    }
  }
  for (Eigen::Index r = 0; r < num_records; ++r) {
    series.times[r] = records[static_cast<size_t>(r)].time;
  }
  std::vector<double> watched_hz;
  for (const auto& entry : watched) watched_hz.push_back(entry.first);
  const std::vector<std::string> names = NamesOfWatched(structure, watched_hz);
  for (Eigen::Index f = 0; f < num_features; ++f) {
    const auto& [hz, h] = watched[static_cast<size_t>(f)];
    analysis->reference_hz[f] = hz;
    std::string name = names[static_cast<size_t>(f)];
    if (!name.empty()) name = ", " + name;
    series.names.push_back("mode " + std::to_string(f + 1) + " (" +
                           FormatNumber(hz, 4) + " Hz" + name + ")");
    for (const ModeHistory::Point& point : histories[h].points) {
      const StoredMode& mode = records[static_cast<size_t>(point.record)]
                                   .modes[static_cast<size_t>(point.mode)];
      series.values(point.record, f) = std::log(mode.frequency_hz);
      series.sigmas(point.record, f) = mode.frequency_sigma / mode.frequency_hz;
    }
  }
}

void SetExpected(WatchAnalysis* analysis) {
  const FeatureSeries& series = analysis->series;
  const NormalModel& model = analysis->model;
  const Matrix covariance = CovarianceWithOutside(model);
  const Eigen::Index terms = model.num_terms();
  const Eigen::Index covariates = model.centres.size();
  analysis->expected =
      Matrix::Constant(series.num_records(), series.num_features(), kNaN);
  analysis->expected_deviations = analysis->expected;
  for (Eigen::Index r = 0; r < series.num_records(); ++r) {
    const RowVector row = model.Terms(series, r);
    if (!row.allFinite()) continue;
    const Vector outside = model.Outside(series, r);
    for (Eigen::Index f = 0; f < series.num_features(); ++f) {
      double variance =
          model.scatter(f, f) +
          model.noise_deviations[f] * model.noise_deviations[f] +
          row.dot(model.covariance.block(f * terms, f * terms, terms, terms) *
                  row.transpose());
      for (Eigen::Index c = 0; c < covariates; ++c) {
        const Eigen::Index at = model.covariance.rows() + f * covariates + c;
        variance += covariance(at, at) * outside[c] * outside[c];
      }
      analysis->expected(r, f) = row.dot(model.coefficients.col(f));
      analysis->expected_deviations(r, f) = std::sqrt(variance);
    }
  }
}

}  // namespace

const char* WatchLightName(WatchLight light) {
  switch (light) {
    case WatchLight::kLearning:
      return "learning";
    case WatchLight::kNormal:
      return "normal";
    case WatchLight::kNotice:
      return "notice";
    case WatchLight::kAlarm:
      return "alarm";
  }
  return "";
}

void AnalyseSeries(const WatchedStructure& structure, WatchAnalysis* analysis) {
  analysis->has_chart = false;
  if (!analysis->reference_is_complete) {
    analysis->reason = "the reference period is not complete yet";
    return;
  }
  if (!LearnNormal(analysis->series, analysis->is_reference, &analysis->model,
                   &analysis->reason)) {
    return;
  }
  const std::vector<Innovation> innovations =
      FilterSeries(analysis->series, analysis->model);
  std::vector<Innovation> reference;
  std::vector<double> times;
  for (size_t r = 0; r < innovations.size(); ++r) {
    if (!innovations[r].valid || !analysis->is_reference[r]) continue;
    reference.push_back(innovations[r]);
    times.push_back(analysis->series.times[static_cast<Eigen::Index>(r)]);
  }
  if (!FindThresholds(
          reference,
          Eigen::Map<const Vector>(times.data(),
                                   static_cast<Eigen::Index>(times.size())),
          analysis->model.memory, structure.chart, &analysis->thresholds,
          &analysis->reason)) {
    return;
  }
  analysis->chart = MakeChart(innovations, analysis->series.times,
                              analysis->model, structure.chart);
  SetExpected(analysis);
  analysis->has_chart = true;
  RaiseAlarms(structure, innovations, analysis);
}

WatchAnalysis AnalyseRecords(const WatchedStructure& structure,
                             std::vector<StoredRecord> records) {
  WatchAnalysis analysis;
  std::vector<StoredRecord> usable;
  for (StoredRecord& record : records) {
    if (!record.refusal.empty() || std::isnan(record.time)) {
      ++analysis.num_refused;
      if (!std::isnan(record.time)) {
        analysis.refused.push_back(std::move(record));
      }
      continue;
    }
    usable.push_back(std::move(record));
  }
  SelectRecords(std::move(usable), &analysis);
  MarkReference(structure.reference, &analysis);
  if (analysis.reference_is_complete) {
    analysis.sensor_changes = LeaveOutChangedSensors(
        analysis.is_reference, structure.tracking, &analysis.records);
  }
  MakeSeries(structure, &analysis);
  AnalyseSeries(structure, &analysis);
  return analysis;
}

}  // namespace pinode
