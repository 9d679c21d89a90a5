// Options of gnuplot, which runs as a subprocess.

#ifndef PINODE_REPORT_GNUPLOT_OPTIONS_H_
#define PINODE_REPORT_GNUPLOT_OPTIONS_H_

#include <string>

namespace pinode {

// Options of the program that draws the figures.
struct GnuplotOptions {
  // Name of the program, found in PATH, or a path with a slash.
  std::string program = "gnuplot";
  // Time after which the program is killed.
  double timeout_seconds = 20.0;
};

}  // namespace pinode

#endif  // PINODE_REPORT_GNUPLOT_OPTIONS_H_
