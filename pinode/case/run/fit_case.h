// A case's fit, with the choice of its terms, its basis and its steps.

#ifndef PINODE_CASE_RUN_FIT_CASE_H_
#define PINODE_CASE_RUN_FIT_CASE_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/problem/growth.h"

namespace pinode {

// What fits tell whoever runs them, and ask. Each may be empty.
struct FitWatch {
  // After each iteration, as IdentificationOptions::callback: false stops.
  // `what`: which fit it is, empty for that of a case as it is read.
  std::function<bool(const std::string& what,
                     const IdentificationProgress& progress)>
      on_iteration;
  // A fit is over.
  std::function<void()> on_end;
  // As ProfileOptions::callback and ProfileOptions::stop.
  std::function<void(const std::vector<ParameterProfile>& done, int of)>
      on_profile;
  std::function<bool()> stop;
  // A sentence on what goes wrong beside the fit, such as a checkpoint that
  // cannot be written.
  std::function<void(const std::string& sentence)> on_trouble;
};

// Identify under a watch; the callback of the options comes first.
FitFunction WatchedFit(const FitWatch& watch);

// Identifies the case's unknowns, with a checkpoint in `folder` at most once a
// second where it writes. Begins from the checkpoint that `folder` resumes,
// else from `begin_from` (nullptr: from the case's own values). False, with
// *error, where that checkpoint is of no use: nothing has been done then.
//
// Where the case has candidates, those that the training records support are
// chosen after the fit (study/terms/term_choice.h), with a checkpoint after
// each step from which the choice goes on; *c is then the case without the
// others. Where there can be no choice, a remark of the case says why.
//
// Where the case renews the basis of its reduction, it is fitted again with
// that of the values found, and begins in that of a checkpoint's values; *c is
// then the case with the last one.
//
// Where the spectra of loads that nobody measured are too coarse for the
// records, and the case does not say how fine they are, it is fitted again with
// finer ones (study/identify/load_spectra.h).
//
// Where finer steps would move what was found, a fit goes on with them.
[[nodiscard]] bool FitCase(const ResultFolder& folder,
                           const IdentifiedModel* begin_from,
                           const FitWatch& watch, Case* c,
                           IdentificationSummary* summary,
                           IdentifiedModel* model, std::string* error);

// Profiles the likelihood of the parameters that the case names (all free ones
// where it names none) around a fit that has converged, into summary->profiles.
// Those that are done stand in the checkpoint of `folder`, and those in the
// checkpoint that it resumes are not made again. Where profiles cannot be, a
// remark of the case says why.
void ProfileCase(const ResultFolder& folder, const FitWatch& watch, Case* c,
                 const IdentifiedModel& model, IdentificationSummary* summary);

}  // namespace pinode

#endif  // PINODE_CASE_RUN_FIT_CASE_H_
