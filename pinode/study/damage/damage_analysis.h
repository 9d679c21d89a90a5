// From healthy fits and a fit of new records to what has changed.

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

struct DamageAnalysisOptions {
  ChangeOptions change;
  // Places at which masses and nonlinear forces are looked for. Default: none;
  // see LookEverywhere.
  DamageSearch search;
  // Options of further fits, and a watch on them (may be nullptr).
  IdentificationOptions identification;
  IdentificationWatch* watch = nullptr;
};

struct DamageResult {
  std::vector<std::string> baselines;  // names
  ChangeOptions options;
  // The free groups, then other kinds of change that were found, then those
  // that are rivals of what was found.
  std::vector<ChangeSubject> subjects;
  ChangeEstimate estimate;
  Judgement judgement;
  // Subjects that masses or nonlinear forces were looked for in.
  std::vector<std::string> places;
  // One sentence each, such as why kinds of change were not told apart.
  std::vector<std::string> remarks;

  // The result that the changes are taken from: that of the given problem, or,
  // where other kinds of change were found, of Identify with these as further
  // unknowns.
  std::vector<ChangeCandidate> added;
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
};

// Finds the changes between `baselines`, at least one, and the new records of
// `problem`. `summary` and `model` are a usable result of it with a covariance.
//
// Four fifths of the false-alarm rate are for changes of the groups alone. The
// rest is for masses and nonlinear forces at the places of options.search. The
// records of the baselines and the new ones are each linearised at their fit
// with all of these as further unknowns. If one of them is found in place of
// groups, or beside them, the new records are identified again with it. This
// needs the records of the baselines (Baseline::fit, which is fitted first if
// necessary); if they are missing, a remark says so.
//
// False, with *error, if the fits, groups, places or options do not fit
// together, or if EstimateChange fails.
[[nodiscard]] bool AnalyseDamage(const IdentificationProblem& problem,
                                 const IdentificationSummary& summary,
                                 const IdentifiedModel& model,
                                 const std::vector<Baseline>& baselines,
                                 const DamageAnalysisOptions& options,
                                 DamageResult* result, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_DAMAGE_ANALYSIS_H_
