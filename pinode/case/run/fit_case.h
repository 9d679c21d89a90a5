// Identification of a case, with checkpoints.

#ifndef PINODE_CASE_RUN_FIT_CASE_H_
#define PINODE_CASE_RUN_FIT_CASE_H_

#include <string>
#include <vector>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/problem/identification_watch.h"

namespace pinode {

// Watch on the work with a case: an identification, its profiles, its files.
class CaseWatch : public IdentificationWatch {
 public:
  // As ProfileOptions::callback and ProfileOptions::stop.
  virtual void OnProfile(const std::vector<ParameterProfile>& done, int of) {
    (void)done, (void)of;
  }
  virtual bool StopsProfiles() { return false; }
  // Something went wrong beside the fit, such as a checkpoint that cannot be
  // written. `sentence` says what.
  virtual void OnTrouble(const std::string& sentence) { (void)sentence; }
};

// Identifies the case's unknowns by Identify (study/identify/identify.h), with
// a checkpoint in `folder` at most once a second where it writes. Starts from
// the checkpoint that `folder` resumes, else from `begin_from` (nullptr: from
// the case's own values). *c becomes the case as it was fitted: without terms
// that the choice left out, in the last basis, with the last steps and spectra.
// False, with *error and nothing done, if that checkpoint cannot be read or
// belongs to another case.
[[nodiscard]] bool FitCase(const ResultFolder& folder,
                           const IdentifiedModel* begin_from, CaseWatch* watch,
                           Case* c, IdentificationSummary* summary,
                           IdentifiedModel* model, std::string* error);

// Profiles the likelihood of the parameters that the case names (all free ones
// if it names none) around a fit that has converged, into summary->profiles.
// Each finished profile is in the checkpoint of `folder`; those in the
// checkpoint that it resumes are not made again. If there can be no profiles, a
// remark of the case says why.
void ProfileCase(const ResultFolder& folder, CaseWatch* watch, Case* c,
                 const IdentifiedModel& model, IdentificationSummary* summary);

}  // namespace pinode

#endif  // PINODE_CASE_RUN_FIT_CASE_H_
