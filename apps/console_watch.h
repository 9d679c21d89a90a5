// Fits watched on a console.

#ifndef PINODE_APPS_CONSOLE_WATCH_H_
#define PINODE_APPS_CONSOLE_WATCH_H_

#include <string>
#include <vector>

#include "apps/progress_line.h"
#include "pinode/case/run/fit_case.h"

namespace pinode {

// Returns a watch that prints progress on standard error if `show_progress`,
// prints problems in any case, and ends the fit at an interrupt.
class ConsoleWatch : public CaseWatch {
 public:
  explicit ConsoleWatch(bool show_progress)
      : show_progress_(show_progress), line_(show_progress) {}

  bool OnIteration(const std::string& what,
                   const IdentificationProblem& problem,
                   const IdentificationProgress& progress) override;
  void OnFitEnd(Termination termination) override;
  void OnProfile(const std::vector<ParameterProfile>& done, int of) override;
  bool StopsProfiles() override;
  void OnTrouble(const std::string& sentence) override;

 protected:
  ProgressLine* line() { return &line_; }

 private:
  const bool show_progress_;
  ProgressLine line_;
};

}  // namespace pinode

#endif  // PINODE_APPS_CONSOLE_WATCH_H_
