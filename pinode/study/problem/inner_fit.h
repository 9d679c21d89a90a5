// Fits within the main job.

#ifndef PINODE_STUDY_PROBLEM_INNER_FIT_H_
#define PINODE_STUDY_PROBLEM_INNER_FIT_H_

#include <string>

#include "pinode/base/constants.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/identification_watch.h"

namespace pinode {

// Runs FitOnce under a watch. Everything inside the main job that fits (choice
// of terms, renewal of a basis, spectra of loads, finer steps, search for
// damage) calls it; none of these fits has a verdict. Tests derive from it.
class InnerFit {
 public:
  // `watch` may be nullptr and must outlive this object.
  explicit InnerFit(IdentificationWatch* watch = nullptr) : watch_(watch) {}
  virtual ~InnerFit() = default;

  // Fits `problem` from `begin` (nullptr: from the problem's own values).
  // `what` names the fit for the watch.
  virtual void Run(const std::string& what,
                   const IdentificationProblem& problem,
                   const IdentificationOptions& options,
                   const IdentifiedModel* begin, FitSummary* summary,
                   IdentifiedModel* model);

  IdentificationWatch* watch() const { return watch_; }

 private:
  IdentificationWatch* const watch_;
};

// Options of a fit that begins where one of much the same problem ended. It
// needs no stages: segments are for fits that begin far away.
void BeginNearTheEnd(IdentificationOptions* options);

// Options of a fit that only decides which terms stay. It need not be exact,
// and wrong terms have long valleys.
void DecideQuickly(IdentificationOptions* options);

// Facts about the fits before the last one, which goes on from them.
struct FitHistory {
  std::string way;
  double linear_error = kInfinity;
  double seconds = 0.0;

  static FitHistory Of(const FitSummary& summary);
  // Enters them into the summary of a fit that went on from there.
  void Enter(FitSummary* summary) const;
};

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_INNER_FIT_H_
