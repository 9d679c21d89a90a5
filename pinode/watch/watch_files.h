// Files of pinode_watch: histories.csv, alarms.csv, watch.json and watch.html.

#ifndef PINODE_WATCH_WATCH_FILES_H_
#define PINODE_WATCH_WATCH_FILES_H_

#include <string>

#include "pinode/report/html_report.h"
#include "pinode/watch/structure_file.h"
#include "pinode/watch/watch_analysis.h"

namespace pinode {

// Returns the first sentences: the light, the records and the limits. One line
// each.
std::string WatchSummary(const WatchedStructure& structure,
                         const WatchAnalysis& analysis);

// Writes all files into a folder that exists.
[[nodiscard]] bool WriteWatchFiles(const WatchedStructure& structure,
                                   const WatchAnalysis& analysis,
                                   const HtmlReportOptions& options,
                                   const std::string& folder,
                                   std::string* error);

// Returns the page: the light, the histories with their bands, the chart and
// the alarms. It has no external references.
std::string RenderWatchPage(const WatchedStructure& structure,
                            const WatchAnalysis& analysis,
                            const HtmlReportOptions& options);

}  // namespace pinode

#endif  // PINODE_WATCH_WATCH_FILES_H_
