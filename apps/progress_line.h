// What a long run shows on standard error.

#ifndef PINODE_APPS_PROGRESS_LINE_H_
#define PINODE_APPS_PROGRESS_LINE_H_

#include <chrono>
#include <string>

#include "pinode/problem/identification_options.h"

namespace pinode {

// One line, rewritten on a terminal and printed once in a while elsewhere.
class ProgressLine {
 public:
  // Shows nothing where `enabled` is false.
  explicit ProgressLine(bool enabled) : enabled_(enabled) {}

  // `what` is being done, and nothing is known of how far it is.
  void Show(const std::string& what);

  // A fit. `prefix`: what stands before it, such as which fit it is.
  void Show(const std::string& prefix, const IdentificationProgress& progress);

  // What follows is printed below the line.
  void End();

 private:
  // Whether the last line has stood long enough.
  bool Due();
  void Print(const std::string& text);

  const bool enabled_;
  std::chrono::steady_clock::time_point last_;
  bool shown_ = false;
};

}  // namespace pinode

#endif  // PINODE_APPS_PROGRESS_LINE_H_
