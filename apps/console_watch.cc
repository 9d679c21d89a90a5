#include "apps/console_watch.h"

#include "apps/print.h"
#include "apps/program.h"

namespace pinode {

bool ConsoleWatch::OnIteration(const std::string& what,
                               const IdentificationProblem&,
                               const IdentificationProgress& progress) {
  line_.Show(what.empty() ? what : what + "  ", progress);
  return !Interrupted();
}

void ConsoleWatch::OnFitEnd(Termination) { line_.End(); }

void ConsoleWatch::OnProfile(const std::vector<ParameterProfile>& done,
                             int of) {
  if (!show_progress_) return;
  PrintError("profiles: %zu of %d", done.size(), of);
}

bool ConsoleWatch::StopsProfiles() { return Interrupted(); }

void ConsoleWatch::OnTrouble(const std::string& sentence) {
  PrintError("%s", sentence.c_str());
}

}  // namespace pinode
