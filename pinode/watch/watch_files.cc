#include "pinode/watch/watch_files.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/watch/mending.h"
#include "pinode/watch/watch.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// Factor of the standard deviation for 95 %.
constexpr double kTwoSigma = 1.96;

std::string Line(const std::vector<std::string>& cells) {
  return Join(cells, ",") + "\n";
}

std::string LightOf(const WatchAnalysis& analysis, size_t record) {
  return analysis.lights.empty() ? "learning"
                                 : WatchLightName(analysis.lights[record]);
}

std::string HistoriesAsCsv(const WatchAnalysis& analysis) {
  const std::vector<StoredColumn> columns = HistoryColumns(analysis);
  std::vector<std::string> header = {"time", "record", "light"};
  // The first two are the time and the light.
  for (size_t c = 2; c < columns.size(); ++c) {
    header.push_back(CsvCell(columns[c].name));
  }
  std::string text = Line(header);
  for (size_t r = 0; r < analysis.records.size(); ++r) {
    std::vector<std::string> row = {DateText(analysis.records[r].time),
                                    CsvCell(analysis.records[r].name),
                                    LightOf(analysis, r)};
    for (size_t c = 2; c < columns.size(); ++c) {
      row.push_back(CsvCell(columns[c].values[static_cast<Eigen::Index>(r)]));
    }
    text += Line(row);
  }
  return text;
}

std::string EventsAsCsv(const WatchAnalysis& analysis) {
  std::string text = "time,kind,text,acknowledged\n";
  for (const StoredEvent& event : analysis.events) {
    text += Line({DateText(event.time), event.kind, CsvCell(event.text),
                  CsvCell(Acknowledgement(analysis.mends, event))});
  }
  return text;
}

// Channels that the last record leaves out, with their faults.
std::vector<StoredChannel> LeftOut(const WatchAnalysis& analysis) {
  std::vector<StoredChannel> channels;
  if (analysis.records.empty()) return channels;
  for (StoredChannel channel : analysis.records.back().channels) {
    if (channel.fault.empty()) continue;
    if (channel.fault.back() == '.') channel.fault.pop_back();
    channels.push_back(std::move(channel));
  }
  return channels;
}

Json LimitAsJson(double limit, double lower, double upper) {
  return {{"limit", limit}, {"lower95", lower}, {"upper95", upper}};
}

Json AsJson(const WatchedStructure& structure, const WatchAnalysis& analysis) {
  Json json;
  json["schema"] = "pinode-watch-1";
  json["structure"] = structure.name;
  json["light"] = WatchLightName(analysis.light);
  json["reason"] = analysis.reason;
  json["records"] = analysis.records.size();
  json["refused_records"] = analysis.num_refused;
  json["rejected_records"] = analysis.num_rejected;
  json["repeated_records"] = analysis.num_repeated;
  json["reference_records"] = std::count(analysis.is_reference.begin(),
                                         analysis.is_reference.end(), true);
  json["histories"] = analysis.num_histories;
  Json features = Json::array();
  for (Eigen::Index f = 0; f < analysis.series.num_features(); ++f) {
    Json feature = {{"name", analysis.series.names[static_cast<size_t>(f)]},
                    {"reference_hz", analysis.reference_hz[f]}};
    if (analysis.has_chart) {
      feature["scatter"] = std::sqrt(analysis.model.scatter(f, f));
      feature["noise"] = analysis.model.noise_deviations[f];
    }
    features.push_back(std::move(feature));
  }
  json["features"] = std::move(features);
  if (analysis.has_chart) {
    const ChartThresholds& thresholds = analysis.thresholds;
    json["chart"] = {
        {"false_alarms_per_year", structure.chart.false_alarms_per_year},
        {"reference_years", thresholds.reference_years},
        {"simulated_years", thresholds.simulated_years},
        {"limits_are_extrapolated", thresholds.is_extrapolated},
        {"scatter_memory_days", analysis.model.memory / 86400.0},
        {"t2", LimitAsJson(thresholds.alarm.t2, thresholds.lower95.t2,
                           thresholds.upper95.t2)},
        {"average",
         LimitAsJson(thresholds.alarm.average, thresholds.lower95.average,
                     thresholds.upper95.average)},
        {"t2_notice", thresholds.notice.t2},
        {"average_notice", thresholds.notice.average}};
  }
  Json left_out = Json::array();
  for (const StoredChannel& channel : LeftOut(analysis)) {
    left_out.push_back({{"channel", channel.name}, {"fault", channel.fault}});
  }
  json["left_out"] = std::move(left_out);
  Json events = Json::array();
  for (const StoredEvent& event : analysis.events) {
    events.push_back(
        {{"time", DateText(event.time)},
         {"kind", event.kind},
         {"text", event.text},
         {"acknowledged", Acknowledgement(analysis.mends, event)}});
  }
  json["events"] = std::move(events);
  return json;
}

std::string LimitText(double limit, double lower, double upper) {
  return FormatNumber(limit, 3) + " (95 %: " + FormatNumber(lower, 3) + " to " +
         FormatNumber(upper, 3) + ")";
}

}  // namespace

std::vector<StoredColumn> HistoryColumns(const WatchAnalysis& analysis) {
  const FeatureSeries& series = analysis.series;
  const Eigen::Index count = series.num_records();
  Vector lights(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    lights[r] =
        analysis.lights.empty()
            ? 0.0
            : static_cast<double>(analysis.lights[static_cast<size_t>(r)]);
  }
  std::vector<StoredColumn> columns = {{"time", series.times},
                                       {"light", lights}};
  for (Eigen::Index f = 0; f < series.num_features(); ++f) {
    const std::string mode = "mode_" + std::to_string(f + 1);
    const auto hz = series.values.col(f).array().exp();
    columns.push_back({mode + "_hz", hz});
    columns.push_back({mode + "_sigma_hz", hz * series.sigmas.col(f).array()});
    if (!analysis.has_chart) continue;
    const auto expected = analysis.expected.col(f).array();
    const auto half = kTwoSigma * analysis.expected_deviations.col(f).array();
    columns.push_back({mode + "_expected_hz", expected.exp()});
    columns.push_back({mode + "_expected_lower95_hz", (expected - half).exp()});
    columns.push_back({mode + "_expected_upper95_hz", (expected + half).exp()});
  }
  for (Eigen::Index c = 0; c < series.covariates.cols(); ++c) {
    columns.push_back({series.covariate_names[static_cast<size_t>(c)],
                       series.covariates.col(c)});
  }
  if (!analysis.has_chart) return columns;
  Vector t2(count), average(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    t2[r] = analysis.chart[static_cast<size_t>(r)].t2;
    average[r] = analysis.chart[static_cast<size_t>(r)].average;
  }
  columns.push_back({"t2", t2});
  columns.push_back({"average", average});
  return columns;
}

std::string WatchSummary(const WatchedStructure& structure,
                         const WatchAnalysis& analysis) {
  const auto count = std::count(analysis.is_reference.begin(),
                                analysis.is_reference.end(), true);
  std::string text = structure.name + ": " + WatchLightName(analysis.light) +
                     ". " + std::to_string(analysis.records.size()) +
                     " records, " + std::to_string(count) + " in the reference";
  if (analysis.num_refused > 0) {
    text += ", " + std::to_string(analysis.num_refused) + " refused";
  }
  if (analysis.num_rejected > 0) {
    text += ", " + std::to_string(analysis.num_rejected) + " rejected by hand";
  }
  text += ".";
  if (!analysis.records.empty()) {
    text += " The last one with modes is of " +
            DateText(analysis.records.back().time) + ".";
  }
  text += "\n";
  std::vector<std::string> left_out;
  for (const StoredChannel& channel : LeftOut(analysis)) {
    left_out.push_back(channel.name + " (" + channel.fault + ")");
  }
  if (!left_out.empty()) text += "Left out: " + Join(left_out, ", ") + ".\n";
  if (!analysis.has_chart) {
    return text + "No alarm can be raised: " + analysis.reason + ".\n";
  }
  const ChartThresholds& thresholds = analysis.thresholds;
  text += "Watched: " + Join(analysis.series.names, ", ") + ".\n";
  text += "Limits for " +
          FormatNumber(structure.chart.false_alarms_per_year, 3) +
          (structure.chart.false_alarms_per_year == 1.0
               ? " false alarm per year: "
               : " false alarms per year: ") +
          "one record " +
          LimitText(thresholds.alarm.t2, thresholds.lower95.t2,
                    thresholds.upper95.t2) +
          ", moving average " +
          LimitText(thresholds.alarm.average, thresholds.lower95.average,
                    thresholds.upper95.average) +
          ".\n";
  if (thresholds.is_extrapolated) {
    text += "The " + FormatNumber(thresholds.simulated_years, 3) +
            " simulated years hold few alarms at this rate, so the limits are "
            "extrapolated from those of more frequent ones.\n";
  }
  const double needed = 1.0 / structure.chart.false_alarms_per_year;
  if (thresholds.reference_years < 0.8 * needed) {
    text += "The reference of " +
            FormatNumber(365.25 * thresholds.reference_years, 3) +
            " days is shorter than the time between two false alarms, so the "
            "true rate may be higher. Use a longer reference.\n";
  }
  return text;
}

bool WriteWatchFiles(const WatchedStructure& structure,
                     const WatchAnalysis& analysis,
                     const HtmlReportOptions& options,
                     const std::string& folder, std::string* error) {
  return WriteFileAtomically(folder + "/histories.csv",
                             HistoriesAsCsv(analysis), error) &&
         WriteFileAtomically(folder + "/alarms.csv", EventsAsCsv(analysis),
                             error) &&
         WriteFileAtomically(folder + "/watch.json",
                             AsJson(structure, analysis).dump(2) + "\n",
                             error) &&
         WriteFileAtomically(folder + "/watch.prom",
                             WatchMetrics(structure, analysis), error) &&
         WriteFileAtomically(folder + "/watch.html",
                             RenderWatchPage(structure, analysis, options),
                             error);
}

}  // namespace pinode
