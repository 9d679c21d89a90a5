// Progress of a long run on standard error.

#ifndef PINODE_APPS_PROGRESS_LINE_H_
#define PINODE_APPS_PROGRESS_LINE_H_

#include <chrono>
#include <string>

#include "pinode/problem/identification_options.h"

namespace pinode {

// One line, rewritten on a terminal and printed from time to time elsewhere.
class ProgressLine {
 public:
  // Shows nothing if `enabled` is false.
  explicit ProgressLine(bool enabled) : enabled_(enabled) {}

  // Shows `what` is being done, without a degree of completion.
  void Show(const std::string& what);

  // Shows the progress of a fit after `prefix`, such as the number of the fit.
  void Show(const std::string& prefix, const IdentificationProgress& progress);

  // Ends the line: later output is printed below it.
  void End();

 private:
  // True if the last line has been shown long enough.
  bool Due();
  void Print(const std::string& text);

  const bool enabled_;
  std::chrono::steady_clock::time_point last_;
  bool shown_ = false;
};

}  // namespace pinode

#endif  // PINODE_APPS_PROGRESS_LINE_H_
