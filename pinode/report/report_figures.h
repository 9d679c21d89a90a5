// Figures of a report, drawn several at a time.

#ifndef PINODE_REPORT_REPORT_FIGURES_H_
#define PINODE_REPORT_REPORT_FIGURES_H_

#include <string>
#include <vector>

#include "pinode/report/figure.h"
#include "pinode/report/html_report.h"
#include "pinode/report/report.h"

namespace pinode {

// Figures of a report. Numbers are indices into `pictures`, -1 without such a
// figure.
struct ReportFigures {
  struct Picture {
    Figure figure;
    std::string svg;    // empty: it could not be drawn
    std::string error;  // reason
  };
  // Figures of a record's channels with the largest errors.
  struct History {
    int record = -1;
    std::vector<int> figures;
    int num_left_out = 0;
  };

  std::vector<Picture> pictures;
  int changes = -1;
  int parameters = -1;
  std::vector<int> forces;
  std::vector<int> profiles;
  std::vector<int> ambient;
  std::vector<int> frfs;
  int modes = -1;
  int convergence = -1;
  std::vector<History> histories;  // hold-out records first
  std::vector<int> loops;
  int num_loops_left_out = 0;
  std::vector<std::vector<int>> equations;  // per equation
};

ReportFigures PlanFigures(const ReportInput& input,
                          const HtmlReportOptions& options);

// Draws the figures with gnuplot.
void DrawFigures(const HtmlReportOptions& options, ReportFigures* figures);

}  // namespace pinode

#endif  // PINODE_REPORT_REPORT_FIGURES_H_
