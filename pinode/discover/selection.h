// Selection among several supports.

#ifndef PINODE_DISCOVER_SELECTION_H_
#define PINODE_DISCOVER_SELECTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/lasso.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/discover/stlsq.h"

namespace pinode {

struct SelectionOptions {
  enum class Criterion { kBic, kHeldBack };

  // kBic: the fewest terms whose BIC is within 2 of the least. A smaller
  // difference is "not worth more than a bare mention" (Kass and Raftery 1995).
  //
  // kHeldBack: the fewest terms whose error on the blocks held back exceeds the
  // least by no more than num_standard_errors standard errors of that excess
  // (as the one-standard-error rule of Breiman et al. 1984, of paired
  // differences: blocks at the end of a decaying record have less to explain
  // than the first, which must not count as uncertainty).
  //
  // Among equally many terms, those with the smaller criterion are chosen.
  Criterion criterion = Criterion::kBic;

  // Number of held-back blocks over all records.
  int num_blocks = 10;
  // Number of standard errors. One lets a term in by chance if many are
  // offered: prediction alone does not distinguish the true model from one with
  // a little more (Shao 1993).
  double num_standard_errors = 2.0;

  // True: BIC counts as many samples as the residuals have independent ones.
  // Residuals of smoothed or integrated signals are correlated over many
  // samples. If they are taken for independent, any term looks significant.
  bool autocorrelation = true;

  // True: adds the supports below the chosen one, made by repeatedly removing
  // the term with the smallest loss, and repeats the choice. A LASSO path may
  // miss the true support, though not all supports that contain it.
  bool backward_elimination = true;

  // Fraction of the output's RMS below which a residual RMS is rounding error.
  double noise_floor = 1e-8;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Support with its least-squares fit.
struct SelectionEntry {
  // Coefficients, ascending, without given ones.
  std::vector<int> support;
  // Number of free unknowns: coefficients bound by an equality count once.
  int num_terms = 0;
  // Coefficients fitted to all samples without penalty, under the constraints.
  Vector coefficients;
  // Sum of squares |y - Theta xi|^2, residuals in units of sigma.
  double sum_of_squares = 0.0;
  // BIC, m ln(sum_of_squares / n) + num_terms ln(m), with n residuals of which
  // m are independent (G. Schwarz, Annals of Statistics 6 (1978) 461).
  double bic = 0.0;
  // Mean over the held-back blocks of their mean squared residual, with the
  // coefficients fitted to the other blocks; its excess over that of the best
  // entry, and the standard error of this excess.
  double held_back = 0.0;
  double held_back_excess = 0.0;
  double held_back_error = 0.0;
};

struct Selection {
  // Entries by ascending num_terms, then sum_of_squares: the Pareto curve and
  // the points above it. The first has only given terms.
  std::vector<SelectionEntry> entries;
  int chosen = -1;
  double num_independent = 0.0;  // m

  const SelectionEntry& best() const {
    return entries[static_cast<size_t>(chosen)];
  }
};

// Return the supports along a path.
std::vector<std::vector<int>> Supports(const LassoPath& path);
std::vector<std::vector<int>> Supports(const std::vector<StlsqSolution>& path);

// Fits and rates each of `supports` (coefficients of the problem; duplicates
// count once, the empty one is added) and chooses one. The supports come from
// all samples; blocks are held back only from the fit of coefficients. Returns
// false for an invalid problem or option, or fewer than two blocks.
[[nodiscard]] bool SelectSupport(const RegressionProblem& problem,
                                 const std::vector<std::vector<int>>& supports,
                                 const SelectionOptions& options,
                                 Selection* selection, std::string* error);

// Selects as SelectSupport by BIC, for a condensed problem, without held-back
// blocks and with `num_independent` given (at most system.num_residuals).
// Supports are of free unknowns; returns the chosen one.
std::vector<int> SelectByBic(const LeastSquaresSystem& system,
                             const CoefficientMap& map,
                             const std::vector<std::vector<int>>& supports,
                             double num_independent,
                             const SelectionOptions& options);

// Selects among the same supports the fewest terms whose |y - Theta xi|^2
// exceeds that of all candidates together by at most `loss`. BIC determines
// where backward elimination begins, and chooses if no support is as close.
std::vector<int> SelectByLoss(const LeastSquaresSystem& system,
                              const CoefficientMap& map,
                              const std::vector<std::vector<int>>& supports,
                              double num_independent, double loss,
                              const SelectionOptions& options);

// Returns the number of independent values in correlated series: their length
// over 1 + 2 (the sum of their autocorrelations), at most the length. The sum
// ends where two neighbours add up to a negative value (C. J. Geyer,
// Statistical Science 7 (1992) 473). The series are separate records of one
// process without mean.
double NumIndependent(const std::vector<Vector>& series);

}  // namespace pinode

#endif  // PINODE_DISCOVER_SELECTION_H_
