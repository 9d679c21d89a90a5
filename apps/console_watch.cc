#include "apps/console_watch.h"

#include <cstdio>
#include <memory>

#include "apps/program.h"
#include "apps/progress_line.h"

namespace pinode {

FitWatch ConsoleWatch(bool show_progress) {
  const auto line = std::make_shared<ProgressLine>(show_progress);
  FitWatch watch;
  watch.on_iteration = [line](const std::string& what,
                              const IdentificationProgress& progress) {
    line->Show(what.empty() ? what : what + "  ", progress);
    return !Interrupted();
  };
  watch.on_end = [line] { line->End(); };
  if (show_progress) {
    watch.on_profile = [](const std::vector<ParameterProfile>& done, int of) {
      std::fprintf(stderr, "profiles: %zu of %d\n", done.size(), of);
    };
  }
  watch.stop = Interrupted;
  watch.on_trouble = [](const std::string& sentence) {
    std::fprintf(stderr, "%s\n", sentence.c_str());
  };
  return watch;
}

}  // namespace pinode
