// gnuplot as a subprocess.

#ifndef PINODE_REPORT_GNUPLOT_H_
#define PINODE_REPORT_GNUPLOT_H_

#include <string>

#include "pinode/report/gnuplot_options.h"

namespace pinode {

// Runs gnuplot on `script` (its standard input) and returns what it writes to
// standard output. No shell takes part, user settings (~/.gnuplot) are not
// read, and the caller's signals are left alone. False if it cannot be started,
// takes too long, ends with an error (*error then holds the first lines of its
// complaint) or writes nothing.
[[nodiscard]] bool RunGnuplot(const std::string& script,
                              const GnuplotOptions& options,
                              std::string* output, std::string* error);

// Returns `text` as a gnuplot string: in single quotes, where gnuplot expands
// nothing. Control characters become blanks, and apostrophes their typographic
// form. Safe for any text.
std::string GnuplotString(const std::string& text);

}  // namespace pinode

#endif  // PINODE_REPORT_GNUPLOT_H_
