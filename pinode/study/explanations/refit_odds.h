// Odds of refits against the fit that they explain.

#ifndef PINODE_STUDY_EXPLANATIONS_REFIT_ODDS_H_
#define PINODE_STUDY_EXPLANATIONS_REFIT_ODDS_H_

#include <cstddef>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/explanations/refit.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Returns the mean autocorrelation time of the residuals of fitted channels in
// samples, at least 1.
double ResidualMemory(const IdentificationProblem& problem,
                      const FitSummary& fit);

// Odds of refits against a fit without their suspects. With k unknowns, N
// samples and n suspects in the catalogue (G. Schwarz 1978):
//
//   log odds = gain - k / 2 log(N / m) - log n for each suspect.
//
// The gain is that of the logarithm of the likelihood, m the memory of the
// refit's residuals (ResidualMemory).
class RefitOdds {
 public:
  // Refers to both.
  RefitOdds(const IdentificationProblem& problem, const FitSummary& fit);

  // Number of measured values that the fit describes: samples of training
  // records, lines of spectra and numbers of modes.
  double num_samples() const { return num_samples_; }
  // Returns what a suspect with these unknowns must gain for even odds, with a
  // memory of 1.
  double Penalty(int num_unknowns, size_t num_suspects) const;
  // Returns the logarithm of the odds of `refit`, whose suspects are those of
  // the catalogue `suspects`. Minus infinity: its values cannot be what they
  // stand for, or its simulation diverges. NaN: nothing is known of the odds.
  double LogOddsOf(const Refit& refit,
                   const std::vector<Suspect>& suspects) const;

 private:
  const IdentificationProblem& problem_;
  const FitSummary& fit_;
  double num_samples_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_REFIT_ODDS_H_
