#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/gnuplot.h"
#include "pinode/report/page_data.h"
#include "pinode/report/report_figures.h"
#include "pinode/watch/control_chart.h"
#include "pinode/watch/mending.h"
#include "pinode/watch/watch.h"
#include "pinode/watch/watch_files.h"

namespace pinode {
namespace {

using Align = TextTable::Align;

constexpr char kWatchTemplate[] = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{title}}</title>
{{>style}}
</head>
<body>
<h1>{{title}}</h1>
<p class="source">{{source}}</p>
<p class="verdict{{#alarm}} bad{{/alarm}}">{{verdict}}</p>
{{#lines}}<p>{{text}}</p>
{{/lines}}
{{#events}}
<h2>Alarms and notices</h2>
<div class="wide">{{>table}}</div>
{{/events}}
{{#decisions}}
<h2>Decisions</h2>
<div class="wide">{{>table}}</div>
{{/decisions}}
{{#chart}}
<h2>Chart</h2>
{{>figure}}
{{/chart}}
<h2>Histories</h2>
{{#histories}}{{>figure}}
{{/histories}}
<footer>{{footer}}</footer>
</body>
</html>
)html";

// Points of a figure. A longer history shows the lowest and highest of
// neighbouring records.
constexpr Eigen::Index kMostPoints = 1000;
constexpr size_t kMostEvents = 200;

// Returns the extremes of neighbouring values over time, NaN left out.
std::vector<std::vector<double>> Thinned(const Vector& times,
                                         const Vector& values) {
  std::vector<std::vector<double>> columns(2);
  const Eigen::Index bucket = values.size() / (kMostPoints / 2) + 1;
  for (Eigen::Index begin = 0; begin < values.size(); begin += bucket) {
    Eigen::Index low = -1;
    Eigen::Index high = -1;
    const Eigen::Index end = std::min(begin + bucket, values.size());
    for (Eigen::Index i = begin; i < end; ++i) {
      if (std::isnan(values[i])) continue;
      if (low < 0 || values[i] < values[low]) low = i;
      if (high < 0 || values[i] > values[high]) high = i;
    }
    if (low < 0) continue;
    for (const Eigen::Index i : {std::min(low, high), std::max(low, high)}) {
      columns[0].push_back(times[i]);
      columns[1].push_back(values[i]);
      if (low == high) break;
    }
  }
  return columns;
}

void UseDates(const Vector& times, FigureScript* script) {
  script->Line("set xdata time");
  script->Line("set timefmt '%s'");
  const double first = times[0];
  const double last = times[times.size() - 1];
  script->Line(last - first > 20.0 * kDay ? "set format x \"%Y-%m-%d\""
                                          : "set format x \"%m-%d\\n%H:%M\"");
  script->Line("set xtics autofreq");
  script->Line("set xrange ['" + ScriptNumber(first) + "':'" +
               ScriptNumber(std::max(last, first + 1.0)) + "']");
  script->Line("set key outside bottom center horizontal");
}

Vector DaysAsFrequencies(const Vector& logs) {
  return logs.array().exp().matrix();
}

Figure HistoryFigure(const WatchAnalysis& analysis, Eigen::Index feature) {
  const FeatureSeries& series = analysis.series;
  Figure figure;
  figure.id = "history" + std::to_string(feature + 1);
  figure.caption = series.names[static_cast<size_t>(feature)] +
                   ": frequency of each record.";
  FigureScript script(figure.id, 900, 300);
  UseDates(series.times, &script);
  script.Line("set ylabel 'frequency, Hz'");
  std::vector<std::string> parts;
  const Vector values = DaysAsFrequencies(series.values.col(feature));
  Interval range;
  range.Add(values);
  if (range.empty()) return Figure();
  if (analysis.has_chart) {
    figure.caption +=
        " The band holds 95 % of the records as long as nothing changes.";
    const Vector expected = analysis.expected.col(feature);
    const Vector half = 1.96 * analysis.expected_deviations.col(feature);
    const Vector lower = DaysAsFrequencies(expected - half);
    const Vector upper = DaysAsFrequencies(expected + half);
    for (const auto& [edge, title] : {std::make_pair(&lower, "expected, 95 %"),
                                      std::make_pair(&upper, "")}) {
      parts.push_back(Lines(script.Data(Thinned(series.times, *edge)),
                            kUpdatedLine, title));
    }
  }
  parts.push_back(script.Data(Thinned(series.times, values)) +
                  " using 1:2 with points pt 7 ps 0.25 lc rgb '#888888' title "
                  "'measured'");
  const double margin = 0.1 * range.width() + 1e-6 * range.high;
  script.Line(Range("y", range.low - margin, range.high + margin));
  script.Line("plot " + Join(parts, ", "));
  figure.script = script.text();
  return figure;
}

Figure ChartFigure(const WatchAnalysis& analysis) {
  const Vector& times = analysis.series.times;
  Figure figure;
  figure.id = "chart";
  figure.caption =
      "Scores of each record and of the moving average. An alarm rises when "
      "one of them is above its limit (dashed).";
  FigureScript script(figure.id, 900, 340);
  UseDates(times, &script);
  script.Line("set ylabel 'score'");
  Vector t2(times.size()), average(times.size());
  for (Eigen::Index r = 0; r < times.size(); ++r) {
    t2[r] = analysis.chart[static_cast<size_t>(r)].t2;
    average[r] = analysis.chart[static_cast<size_t>(r)].average;
  }
  const auto limit = [&](double value, const std::string& colour) {
    return Lines(
        script.Data({{times[0], times[times.size() - 1]}, {value, value}}),
        "lc rgb '" + colour + "' lw 1.2 dt (6,3)", "");
  };
  const std::vector<std::string> parts = {
      script.Data(Thinned(times, t2)) +
          " using 1:2 with points pt 7 ps 0.25 lc rgb '#888888' title "
          "'one record'",
      Lines(script.Data(Thinned(times, average)), kUpdatedLine,
            "moving average"),
      limit(analysis.thresholds.alarm.t2, "#888888"),
      limit(analysis.thresholds.alarm.average, "#0072B2")};
  script.Line("plot " + Join(parts, ", "));
  figure.script = script.text();
  return figure;
}

TextTable EventsTable(const WatchAnalysis& analysis) {
  TextTable table({{"time, UTC", Align::kLeft},
                   {"what", Align::kLeft},
                   {"reason", Align::kLeft},
                   {"acknowledged by", Align::kLeft}});
  // The latest first.
  const size_t count = std::min(kMostEvents, analysis.events.size());
  for (size_t i = 0; i < count; ++i) {
    const StoredEvent& event = analysis.events[analysis.events.size() - 1 - i];
    table.AddRow({DateText(event.time), event.kind, event.text,
                  Acknowledgement(analysis.mends, event)});
  }
  return table;
}

TextTable DecisionsTable(const WatchAnalysis& analysis) {
  TextTable table({{"time, UTC", Align::kLeft},
                   {"by", Align::kLeft},
                   {"decision", Align::kLeft},
                   {"reason", Align::kLeft}});
  // The latest first.
  const size_t count = std::min(kMostEvents, analysis.mends.size());
  for (size_t i = 0; i < count; ++i) {
    const StoredMend& mend = analysis.mends[analysis.mends.size() - 1 - i];
    table.AddRow(
        {DateText(mend.time), mend.person, DecisionText(mend), mend.reason});
  }
  return table;
}

// Returns the last event of a kind; one without a text if there is none.
StoredEvent LastEvent(const WatchAnalysis& analysis, const std::string& kind) {
  const auto last = std::find_if(
      analysis.events.rbegin(), analysis.events.rend(),
      [&kind](const StoredEvent& event) { return event.kind == kind; });
  return last == analysis.events.rend() ? StoredEvent() : *last;
}

std::string LightSentence(const WatchAnalysis& analysis) {
  switch (analysis.light) {
    case WatchLight::kAlarm: {
      const StoredEvent alarm = LastEvent(analysis, "alarm");
      return "Alarm since " + DateText(alarm.time) + ": " + alarm.text + ".";
    }
    case WatchLight::kNotice: {
      const StoredEvent notice = LastEvent(analysis, "notice");
      return "Notice: " +
             (notice.text.empty() ? std::string("see the chart")
                                  : notice.text) +
             ".";
    }
    case WatchLight::kNormal:
      return "Normal: no change was found.";
    case WatchLight::kLearning:
      break;
  }
  return analysis.has_chart
             ? "Learning: there is no record after the reference yet."
             : "Learning: " + analysis.reason + ".";
}

}  // namespace

std::string RenderWatchPage(const WatchedStructure& structure,
                            const WatchAnalysis& analysis,
                            const HtmlReportOptions& options) {
  ReportFigures figures;
  const auto plan = [&figures](Figure figure) {
    if (!figure.empty())
      figures.pictures.push_back({std::move(figure), "", ""});
  };
  if (analysis.has_chart) plan(ChartFigure(analysis));
  const size_t num_charts = figures.pictures.size();
  for (Eigen::Index f = 0; f < analysis.series.num_features(); ++f) {
    plan(HistoryFigure(analysis, f));
  }
  DrawFigures(options, &figures);

  PageData page;
  page.set("title", structure.name);
  page.set("source", "Watched by pinode " + PinodeVersion());
  page.set("alarm", analysis.light == WatchLight::kAlarm);
  page.set("verdict", LightSentence(analysis));
  PageData lines = PageList();
  const std::string summary = WatchSummary(structure, analysis);
  for (size_t begin = 0; begin < summary.size();) {
    const size_t end = summary.find('\n', begin);
    lines.push_back(PageText(summary.substr(begin, end - begin)));
    begin = end + 1;
  }
  page.set("lines", lines);
  SetIf("events", !analysis.events.empty(), TableData(EventsTable(analysis)),
        &page);
  SetIf("decisions", !analysis.mends.empty(),
        TableData(DecisionsTable(analysis)), &page);
  SetIf("chart", num_charts > 0,
        num_charts > 0 ? PictureData(figures.pictures[0]) : PageData(), &page);
  PageData histories = PageList();
  for (size_t i = num_charts; i < figures.pictures.size(); ++i) {
    histories.push_back(PictureData(figures.pictures[i]));
  }
  page.set("histories", histories);
  page.set("footer", "pinode " + PinodeVersion());
  return RenderPage(kWatchTemplate, page);
}

}  // namespace pinode
