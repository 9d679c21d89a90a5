// A case's fit as the programs run it.

#ifndef PINODE_APPS_FITTING_H_
#define PINODE_APPS_FITTING_H_

#include <string>

#include "pinode/case/case_file.h"
#include "pinode/case/result_folder.h"
#include "pinode/estimate/identification_summary.h"
#include "pinode/study/growth.h"

namespace pinode {

// Identifies the case's unknowns with progress on standard error, a checkpoint
// in `folder` at most once a second, and an end at an interrupt. Begins from
// the checkpoint that `folder` resumes, else from `begin_from` (nullptr: from
// the case's own values). False, with *error, where that checkpoint is of no
// use: nothing has been done then.
//
// Where the case has candidates, those that the training records support are
// chosen after the fit (study/term_choice.h), with a checkpoint after each step
// from which the choice goes on; *c is then the case without the others. Where
// there can be no choice, a remark of the case says why.
//
// Where the case renews the basis of its reduction, it is fitted again with
// that of the values found, and begins in that of a checkpoint's values; *c is
// then the case with the last one.
[[nodiscard]] bool FitCase(const ResultFolder& folder,
                           const IdentifiedModel* begin_from,
                           bool show_progress, Case* c,
                           IdentificationSummary* summary,
                           IdentifiedModel* model, std::string* error);

// Profiles the likelihood of the parameters that the case names (all free ones
// where it names none) around a fit that has converged, into summary->profiles,
// with progress on standard error and an end at an interrupt. Those that are
// done stand in the checkpoint of `folder`, and those in the checkpoint that it
// resumes are not made again. Where profiles cannot be, a remark of the case
// says why.
void ProfileCase(const ResultFolder& folder, bool show_progress, Case* c,
                 const IdentifiedModel& model, IdentificationSummary* summary);

// Fits with progress and an end at an interrupt as FitCase, without a
// checkpoint.
FitFunction FitWithProgress(bool show_progress);

}  // namespace pinode

#endif  // PINODE_APPS_FITTING_H_
