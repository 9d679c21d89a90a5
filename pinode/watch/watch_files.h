// Files of pinode_watch: histories.csv, alarms.csv, watch.json, watch.prom and
// watch.html.

#ifndef PINODE_WATCH_WATCH_FILES_H_
#define PINODE_WATCH_WATCH_FILES_H_

#include <string>
#include <vector>

#include "pinode/report/html_report.h"
#include "pinode/watch/structure_file.h"
#include "pinode/watch/watch_analysis.h"

namespace pinode {

// Returns the first sentences: the light, the records and the limits. One line
// each.
std::string WatchSummary(const WatchedStructure& structure,
                         const WatchAnalysis& analysis);

// Returns the histories as columns, a value for each record: "time" in s since
// 1970, "light" as WatchLight counts, and those of histories.csv.
std::vector<StoredColumn> HistoryColumns(const WatchAnalysis& analysis);

// Writes all files into a folder that exists.
[[nodiscard]] bool WriteWatchFiles(const WatchedStructure& structure,
                                   const WatchAnalysis& analysis,
                                   const HtmlReportOptions& options,
                                   const std::string& folder,
                                   std::string* error);

// Returns the light, the number of records and the scores in the text format of
// Prometheus.
std::string WatchMetrics(const WatchedStructure& structure,
                         const WatchAnalysis& analysis);

// Returns the page: the light, the histories with their bands, the chart and
// the alarms. It has no external references.
std::string RenderWatchPage(const WatchedStructure& structure,
                            const WatchAnalysis& analysis,
                            const HtmlReportOptions& options);

}  // namespace pinode

#endif  // PINODE_WATCH_WATCH_FILES_H_
