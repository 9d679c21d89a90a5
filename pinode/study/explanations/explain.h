// Search for what a model may lack.

#ifndef PINODE_STUDY_EXPLANATIONS_EXPLAIN_H_
#define PINODE_STUDY_EXPLANATIONS_EXPLAIN_H_

#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

struct Explained {
  // Refits that describe the records better than the fit does, best first.
  std::vector<Explanation> explanations;
  // Findings against the fit.
  std::vector<Finding> findings;
  // For each named unknown of the fit, an interval for a result that lacks
  // something: it holds the fit's own, that of the best explanation where it
  // has odds of 20, and that of the fit linearised with all suspects as
  // unknowns, each with a prior of the size that such errors usually have.
  std::vector<ExplainedValue> intervals;
  // The unknown forces of the fit, with bounds that hold those of the best
  // explanation where it has odds of 20.
  std::vector<ForceEstimate> forces;
};

// True for problems of records alone, whose intervals can be widened by the
// scores of suspects and by blocks: without measured modes and ambient records,
// and not on several ranks.
bool CanExplain(const IdentificationProblem& problem,
                const IdentificationOptions& options);

// Looks for what `problem` lacks, after a sound fit of it (`fit`, `model`).
// Score tests rank the catalogue (MakeSuspects, MakeForceSuspects) at the price
// of one linearisation; the best few that they promise something of are
// refitted with all unknowns of the problem, singly and added to the best of
// them. The odds of a refit with k unknowns among n candidates are
//
//   log odds = sum_c N_c / m  log(e_c / e'_c) - k / 2 log(N / m) - log n
//
// with the number of samples N_c and RMS errors e_c, e'_c of each fitted
// channel before and after, and the memory m of the residuals of the refit
// (mean autocorrelation time, in samples): Schwarz's criterion (G. Schwarz,
// Ann. Statist. 6 (1978) 461-464). Ambient records and measured modes beside
// records add the gain of their own log-likelihood; that of an ambient record
// is divided by the refit's chi^2 per degree of freedom, if this is above 1.
// Measured modes alone are explained by ModesSearch. Beside other data, modes
// without standard deviations have no likelihood, and problems with them no
// explanations.
Explained Explain(const IdentificationProblem& problem,
                  const IdentificationOptions& options, const FitSummary& fit,
                  const IdentifiedModel& model, InnerFit* inner);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_EXPLAIN_H_
