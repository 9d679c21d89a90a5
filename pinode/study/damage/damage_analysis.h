// Damage analysis: changes between baselines and a fit of new records.

#ifndef PINODE_STUDY_DAMAGE_DAMAGE_ANALYSIS_H_
#define PINODE_STUDY_DAMAGE_DAMAGE_ANALYSIS_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/damage_search.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/problem/identification_watch.h"

namespace pinode {

// Options of AnalyseDamage.
struct DamageAnalysisOptions {
  ChangeOptions change;
  // Places at which to search for added masses and nonlinear forces. Default:
  // none. LookEverywhere returns all possible places.
  DamageSearch search;
  // Options of further fits, and their observer (may be nullptr).
  IdentificationOptions identification;
  IdentificationWatch* watch = nullptr;
};

// Result of AnalyseDamage.
struct DamageResult {
  std::vector<std::string> baselines;  // names
  ChangeOptions options;
  // Subjects of possible changes: the free groups, then other kinds of change
  // that were found, then their rivals. `estimate` and `judgement` have one
  // entry for each.
  std::vector<ChangeSubject> subjects;
  ChangeEstimate estimate;
  Judgement judgement;
  // Names of the places at which masses, nonlinear forces or other kinds of
  // change were searched for.
  std::vector<std::string> places;
  // Remarks for the user, one sentence each, for instance the reason why kinds
  // of change were not distinguished.
  std::vector<std::string> remarks;

  // Fit from which the changes come. It is the given one. If other kinds of
  // change were found, it is a fit with these as further unknowns, which
  // `added` lists.
  std::vector<ChangeCandidate> added;
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
};

// Finds the changes between `baselines` (at least one) and the new records of
// `problem`. `summary` and `model` are a usable result of `problem` with a
// covariance.
//
// The search has two parts. Changes of groups alone get 80 % of the false-alarm
// rate. Masses and nonlinear forces at the places of options.search get the
// rest. For the second part, all problems are linearised at their fits, with
// these masses and forces as further unknowns. If one of them is found, the new
// records are identified again with it.
//
// If motion is still unexplained, dampers are fitted: instead of the nonlinear
// forces that were found, or at each of few springs (DampersToTry). They are
// taken if they leave less than half of it.
//
// The second part needs Baseline::fit, which is fitted first if necessary. If
// it is missing, a remark says so.
//
// Returns false, with *error:
//
// - if fits, groups, places or options do not match;
// - if faults of the measurement explain the new records as well as more
//   changes of the structure do (FaultInsteadOfChanges): the case is wrong;
// - if nothing explains the new records, or EstimateChange fails.
[[nodiscard]] bool AnalyseDamage(const IdentificationProblem& problem,
                                 const IdentificationSummary& summary,
                                 const IdentifiedModel& model,
                                 const std::vector<Baseline>& baselines,
                                 const DamageAnalysisOptions& options,
                                 DamageResult* result, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_DAMAGE_ANALYSIS_H_
