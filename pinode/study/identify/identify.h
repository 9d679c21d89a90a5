// The main job: from a problem to an identified model and a verdict on it.

#ifndef PINODE_STUDY_IDENTIFY_IDENTIFY_H_
#define PINODE_STUDY_IDENTIFY_IDENTIFY_H_

#include <memory>
#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/identification_watch.h"
#include "pinode/study/terms/model_candidate.h"

namespace pinode {

struct ReducedStructure;

// Further input of an identification.
struct IdentificationExtras {
  // Model to start from: of an earlier identification, of a baseline, or of a
  // checkpoint. nullptr: the problem's initial values.
  const IdentifiedModel* start = nullptr;
  // `start` is a checkpoint of this problem, to be continued.
  bool resumed = false;
  // Choice that was made before the checkpoint. `start` is then a model of the
  // problem without choice.left_out.
  ModelChoice choice;
  // Terms of the problem among which the training records choose. Empty: all
  // terms stay.
  std::vector<ModelCandidate> candidates;
  // Finite-element structure that the problem's model is a reduction of.
  // nullptr: the model is not reduced, or its basis stays.
  std::shared_ptr<const ReducedStructure> reduced;
};

// Outcome of an identification.
struct Identification {
  // Problem that the summary and the model belong to: without the terms that
  // were left out, in the last basis, with the last steps and spectra.
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
  // Structure with the last basis; as in the extras.
  std::shared_ptr<const ReducedStructure> reduced;
};

// Identifies the unknowns of `problem`:
//
//   1. fits it (estimate/fit/fit_once.h),
//   2. chooses among the candidates, where there are any
//      (study/terms/term_choice.h),
//   3. renews the basis of a reduced structure that asks for it, until it
//   settles
//      (study/reduction/renewed_basis.h),
//   4. refines spectra of unmeasured loads that are too coarse for the ambient
//      records (study/identify/load_spectra.h),
//   5. refines integration steps that are too long
//      (study/identify/step_check.h),
//   6. makes the verdict from the findings of all checks
//      (estimate/fit/fit_checks.h).
//
// Programs, Python, damage analysis, the refit of discovered equations and
// users' programs all call this function. `watch` (may be nullptr) hears of
// each iteration and can stop the work. Never throws and never aborts on data:
// an invalid problem, start or option gives a summary that failed, with a
// sentence.
Identification Identify(IdentificationProblem problem,
                        const IdentificationOptions& options = {},
                        const IdentificationExtras& extras = {},
                        IdentificationWatch* watch = nullptr);

}  // namespace pinode

#endif  // PINODE_STUDY_IDENTIFY_IDENTIFY_H_
