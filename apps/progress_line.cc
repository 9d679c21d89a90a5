#include "apps/progress_line.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "apps/print.h"

namespace pinode {
namespace {

bool IsTerminal() { return isatty(STDERR_FILENO) != 0; }

}  // namespace

void ProgressLine::Show(const std::string& what) {
  if (enabled_) Print(what);
}

void ProgressLine::Show(const std::string& prefix,
                        const IdentificationProgress& progress) {
  if (!enabled_ || !Due()) return;
  char text[256];
  std::snprintf(text, sizeof(text),
                "stage %d of %d, iteration %d, cost %.4g, simulation error "
                "%.3g %%, %.0f s",
                progress.stage, progress.num_stages, progress.iteration,
                progress.cost, 100.0 * progress.free_run_error,
                progress.elapsed_seconds);
  // The time that is left is not known: a stage ends when it has converged.
  Print(prefix + text);
}

void ProgressLine::End() {
  if (shown_ && IsTerminal()) std::fputc('\n', stderr);
  shown_ = false;
}

bool ProgressLine::Due() {
  const auto now = std::chrono::steady_clock::now();
  const double wait = IsTerminal() ? 0.2 : 5.0;
  return !shown_ || std::chrono::duration<double>(now - last_).count() >= wait;
}

void ProgressLine::Print(const std::string& text) {
  last_ = std::chrono::steady_clock::now();
  shown_ = true;
  if (IsTerminal()) {
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  std::fflush(stderr);
}

}  // namespace pinode
