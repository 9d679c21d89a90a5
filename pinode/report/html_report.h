// Report as one HTML file.

#ifndef PINODE_REPORT_HTML_REPORT_H_
#define PINODE_REPORT_HTML_REPORT_H_

#include <string>

#include "pinode/report/gnuplot_options.h"
#include "pinode/report/report.h"

namespace pinode {

// Options of the HTML report.
struct HtmlReportOptions {
  GnuplotOptions gnuplot;
  // Largest number of channels with a figure per record. These are the channels
  // that the updated model predicts worst. The tables have all channels.
  int max_channels_per_record = 12;
  // Largest number of figures of force over deformation.
  int max_loops = 24;
  // Number of gnuplot processes that run at the same time.
  int num_threads = 1;
};

// Returns the page as text. It has no external references. Names and sentences
// of the user are escaped. Its only script is that of the structure's view. If
// a figure cannot be drawn, a sentence gives the reason in its place.
std::string RenderHtmlReport(const ReportInput& input,
                             const HtmlReportOptions& options);

// Writes the page to `path`, completely or not at all. Returns false, with
// *error, if the file cannot be written.
[[nodiscard]] bool WriteHtmlReport(const ReportInput& input,
                                   const HtmlReportOptions& options,
                                   const std::string& path, std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_HTML_REPORT_H_
