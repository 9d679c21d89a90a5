// Ensembles: the frequency with which a term is found again.

#ifndef PINODE_DISCOVER_ENSEMBLE_H_
#define PINODE_DISCOVER_ENSEMBLE_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/lasso.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/discover/selection.h"
#include "pinode/discover/stlsq.h"

namespace pinode {

// A sparse regression: returns free unknowns of a condensed problem, 0 for a
// term outside the model. Columns that are all 0 are not offered. Called from
// several threads at a time.
using SparseLearner =
    std::function<Vector(const LeastSquaresSystem&, const CoefficientMap&)>;

// Returns a learner by STLSQ. Options must be valid.
SparseLearner StlsqLearner(const StlsqOptions& options);

// Returns a learner that fits, without penalty, the support chosen by BIC on
// the LASSO's path (penalty_weights and criterion are ignored).
// independent_fraction: fraction of independent residuals,
// Selection::num_independent over their number. In BIC they count half of that.
// A bag deviates from the truth as much as its samples do, and by as much again
// from these, because it draws some twice.
SparseLearner LassoLearner(const LassoOptions& lasso,
                           const SelectionOptions& selection,
                           double independent_fraction = 1.0);

// Returns the same, but chooses the support with the fewest terms that lose at
// most `tolerance`, an RMS of residuals, against all candidates (SelectByLoss).
SparseLearner LassoLearnerWithin(double tolerance, const LassoOptions& lasso,
                                 const SelectionOptions& selection,
                                 double independent_fraction = 1.0);

struct EnsembleOptions {
  int num_bags = 100;
  // Data bagging: each bag draws, with replacement, as many time blocks as
  // there are. It draws blocks because neighbouring samples are correlated
  // (Kunsch 1989).
  int num_blocks = 20;
  // Library bagging: fraction of the free candidates that each bag is offered,
  // drawn without replacement; 1: all.
  double library_fraction = 1.0;
  // Smallest inclusion probability of the terms in the support.
  double inclusion_threshold = 0.6;
  uint64_t seed = 1;
  int num_threads = 1;
  // Ranks that share the bags; each calls RunEnsemble with the same problem.
  // nullptr: a single process.
  Communicator* communicator = nullptr;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

struct Ensemble {
  // Per coefficient: the number of bags that were offered it, and the fraction
  // of these that included it (0 without such bags, 1 for given ones).
  std::vector<int> num_offered;
  Vector inclusion_probability;
  // Median and percentiles 2.5 and 97.5 over the bags that included the
  // coefficient; 0 without such bags. They show the variation with the data and
  // are not a confidence interval; the refit gives that.
  Vector median;
  Vector lower;
  Vector upper;
  // Coefficients, not given, with inclusion_probability >= inclusion_threshold,
  // and their fit to all samples, without penalty.
  std::vector<int> support;
  Vector coefficients;
};

// Runs `learner` on many bags of time blocks and candidates: ensemble SINDy (U.
// Fasel, J. N. Kutz, B. W. Brunton, S. L. Brunton, Proceedings of the Royal
// Society A 478 (2022) 20210904; bagging: L. Breiman 1996). Coefficients bound
// by an equality are offered together. The same seed gives the same bags with
// any number of threads and ranks. Returns false for an invalid problem or
// option, or if a rank does not answer.
[[nodiscard]] bool RunEnsemble(const RegressionProblem& problem,
                               const SparseLearner& learner,
                               const EnsembleOptions& options,
                               Ensemble* ensemble, std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_ENSEMBLE_H_
