// Checks of a fit, from which its verdict follows.

#ifndef PINODE_ESTIMATE_FIT_FIT_CHECKS_H_
#define PINODE_ESTIMATE_FIT_FIT_CHECKS_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/tuning.h"
#include "pinode/problem/verdict.h"

namespace pinode {

// Returns a finding for each check that the fit fails; none: the fit is sound.
// A sound fit has converged, and to a minimum, with its gaps closed. No other
// solution of a multistart does about as well. Its modes lose energy unless
// bounds allow otherwise. And
//
// - its free runs are finite, better than no motion, better than the initial
//   model on training records and not worse on hold-out records, and leave
//   little unexplained motion;
// - its modes are like the measured ones that they are paired with, most of
//   which have a partner in the initial model, at frequencies of the same unit;
//   frequencies are met; modes alone are met better than before;
// - it describes the spectra of its ambient records, which determine a group.
//
// The limits stand in problem/verdict_limits.h. A fit that failed or was
// interrupted has that finding alone.
std::vector<Finding> CheckFit(const GapTuning& gaps, const FitSummary& fit);

// Returns a finding if the frequencies of a fit to modes alone are many times
// their standard deviations off, and by a size that matters: a start in the
// wrong valley, or a model that cannot have these modes.
std::vector<Finding> CheckMeasuredFrequencies(
    const IdentificationProblem& problem, const FitSummary& fit);

// Returns what is doubtful about a sound fit: training records with more than a
// little unexplained motion; another solution for frequencies alone. Such a fit
// is usable with care.
std::vector<Finding> CheckDoubts(const FitSummary& fit);

// Returns the first finding of CheckFit as a sentence; empty: the fit is sound.
std::string WhyNotSound(const GapTuning& gaps, const FitSummary& fit);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_FIT_CHECKS_H_
