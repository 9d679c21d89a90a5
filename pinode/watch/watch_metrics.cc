// State of a watched structure in the text format of Prometheus.

#include <cmath>
#include <string>

#include "pinode/base/strings.h"
#include "pinode/watch/watch_files.h"

namespace pinode {
namespace {

// Text between quotation marks.
std::string Quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '\\' || c == '"') quoted += '\\';
    if (c == '\n') {
      quoted += "\\n";
    } else {
      quoted += c;
    }
  }
  return quoted;
}

class Metrics {
 public:
  explicit Metrics(const std::string& structure)
      : labels_("{structure=\"" + Quoted(structure) + "\"}") {}

  // The name is without its prefix.
  void Add(const std::string& name, const std::string& help, double value,
           const char* type = "gauge") {
    const std::string full = "pinode_watch_" + name;
    text_ += "# HELP " + full + " " + help + "\n# TYPE " + full + " " + type +
             "\n" + full + labels_ + " " +
             (std::isnan(value) ? "NaN" : FormatNumber(value, 17)) + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  std::string labels_;
  std::string text_;
};

}  // namespace

std::string WatchMetrics(const WatchedStructure& structure,
                         const WatchAnalysis& analysis) {
  Metrics metrics(structure.name);
  metrics.Add("light", "0 learning, 1 normal, 2 notice, 3 alarm.",
              static_cast<double>(analysis.light));
  metrics.Add("records", "Records with modes.",
              static_cast<double>(analysis.records.size()));
  metrics.Add("refused_records", "Records without modes.",
              static_cast<double>(analysis.num_refused));
  metrics.Add("last_record_seconds",
              "Time of the last record with modes, in s since 1970.",
              analysis.records.empty() ? kNaN : analysis.records.back().time);
  double alarms = 0.0;
  for (const StoredEvent& event : analysis.events) {
    if (event.kind == "alarm") alarms += 1.0;
  }
  // A person may reject records, so their number can fall.
  metrics.Add("alarms", "Alarms since the first record.", alarms);
  if (!analysis.has_chart) return metrics.text();
  ChartValues last;
  for (const ChartValues& values : analysis.chart) {
    if (!std::isnan(values.t2)) last = values;
  }
  metrics.Add("t2", "Score of the last record alone.", last.t2);
  metrics.Add("t2_limit", "Its limit of an alarm.",
              analysis.thresholds.alarm.t2);
  metrics.Add("average", "Score of the moving average.", last.average);
  metrics.Add("average_limit", "Its limit of an alarm.",
              analysis.thresholds.alarm.average);
  return metrics.text();
}

}  // namespace pinode
