// Identify: from a problem to an identified model with a verdict.

#ifndef PINODE_STUDY_IDENTIFY_IDENTIFY_H_
#define PINODE_STUDY_IDENTIFY_IDENTIFY_H_

#include <memory>
#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/problem/identification_watch.h"
#include "pinode/study/terms/model_candidate.h"

namespace pinode {

struct ReducedStructure;

// Further inputs of an identification.
struct IdentificationExtras {
  // Model with which the fit begins, from an earlier identification, a baseline
  // or a checkpoint. nullptr: the problem's initial values.
  const IdentifiedModel* start = nullptr;
  // True: `start` is a checkpoint of this problem, and the fit continues from
  // it.
  bool resumed = false;
  // Choice among candidates that was made before the checkpoint. `start` is
  // then a model of the problem without choice.left_out.
  ModelChoice choice;
  // Terms of the problem that stay only if the training records support them.
  // Empty: all terms stay.
  std::vector<ModelCandidate> candidates;
  // Findings of earlier checks, such as those on discovered terms. The verdict
  // follows from these too.
  std::vector<Finding> findings;
  // Finite-element model that was reduced to the problem's model. nullptr:
  // there is none, or the basis of the reduction is kept.
  std::shared_ptr<const ReducedStructure> reduced;
};

// Result of an identification.
struct Identification {
  // Problem that summary and model belong to. It is the given one without the
  // terms that were left out, with the final basis, steps and spectra.
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
  // Finite-element model with the final basis, see
  // IdentificationExtras::reduced.
  std::shared_ptr<const ReducedStructure> reduced;
};

// Identifies the unknowns of `problem`:
//
// 1. Fits the problem (pinode/estimate/fit/fit_once.h).
// 2. Chooses among the candidates, if there are any
//    (pinode/study/terms/term_choice.h).
// 3. Renews the basis of a reduced structure that requests it, until the basis
//    settles (pinode/study/reduction/renewed_basis.h).
// 4. Refines spectra of unmeasured loads that are too coarse for the ambient
//    records (pinode/study/identify/load_spectra.h).
// 5. Refines integration steps that are too long, and chooses among the
//    candidates again with the finer ones
//    (pinode/study/identify/step_check.h).
// 6. Makes the verdict from the findings of all checks
//    (pinode/estimate/fit/fit_checks.h).
//
// `watch` observes each iteration and can stop the work; it may be nullptr. All
// programs, the Python package and the damage analysis use this function.
//
// The function does not throw, and does not abort on bad data. For an invalid
// problem, start or option, `summary` has Termination::kFailure and a message.
// An option without intervals (Covariance::kNone) is invalid here.
Identification Identify(IdentificationProblem problem,
                        const IdentificationOptions& options = {},
                        const IdentificationExtras& extras = {},
                        IdentificationWatch* watch = nullptr);

}  // namespace pinode

#endif  // PINODE_STUDY_IDENTIFY_IDENTIFY_H_
