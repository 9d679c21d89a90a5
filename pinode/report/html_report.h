// The report as one HTML file.

#ifndef PINODE_REPORT_HTML_REPORT_H_
#define PINODE_REPORT_HTML_REPORT_H_

#include <string>

#include "pinode/report/gnuplot_options.h"
#include "pinode/report/report.h"

namespace pinode {

struct HtmlReportOptions {
  GnuplotOptions gnuplot;
  // Figures drawn per record: of the channels that the updated model predicts
  // worst. The tables hold all of them.
  int max_channels_per_record = 12;
  int max_loops = 24;
  // gnuplot processes at a time.
  int num_threads = 1;
};

// The whole page: nothing outside of it is referred to, all names and sentences
// of the user escaped; no scripts but that of the structure's view. A figure
// that cannot be drawn is replaced by a sentence that says why.
std::string RenderHtmlReport(const ReportInput& input,
                             const HtmlReportOptions& options);

// Renders and writes it to `path`, all or nothing.
[[nodiscard]] bool WriteHtmlReport(const ReportInput& input,
                                   const HtmlReportOptions& options,
                                   const std::string& path, std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_HTML_REPORT_H_
