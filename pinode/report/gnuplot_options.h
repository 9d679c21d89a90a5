// Options of gnuplot as a subprocess.

#ifndef PINODE_REPORT_GNUPLOT_OPTIONS_H_
#define PINODE_REPORT_GNUPLOT_OPTIONS_H_

#include <string>

namespace pinode {

// Program that draws the figures.
struct GnuplotOptions {
  // Looked for in PATH unless it holds a slash.
  std::string program = "gnuplot";
  // It is killed after that.
  double timeout_seconds = 20.0;
};

}  // namespace pinode

#endif  // PINODE_REPORT_GNUPLOT_OPTIONS_H_
