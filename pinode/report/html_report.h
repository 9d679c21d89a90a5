// The report as one HTML file.

#ifndef PINODE_REPORT_HTML_REPORT_H_
#define PINODE_REPORT_HTML_REPORT_H_

#include <string>

#include "pinode/report/gnuplot_options.h"
#include "pinode/report/report.h"

namespace pinode {

struct HtmlReportOptions {
  GnuplotOptions gnuplot;
  // Number of figures per record, for the channels with the worst prediction by
  // the updated model. The tables have all channels.
  int max_channels_per_record = 12;
  int max_loops = 24;
  // Number of gnuplot processes at a time.
  int num_threads = 1;
};

// Returns the whole page. It has no external references; all names and
// sentences of the user are escaped; its only script is that of the structure's
// view. A figure that cannot be drawn is replaced by a sentence with the
// reason.
std::string RenderHtmlReport(const ReportInput& input,
                             const HtmlReportOptions& options);

// Renders the page and writes it to `path`, completely or not at all.
[[nodiscard]] bool WriteHtmlReport(const ReportInput& input,
                                   const HtmlReportOptions& options,
                                   const std::string& path, std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_HTML_REPORT_H_
