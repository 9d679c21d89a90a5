// Ensembles: how often a term is found again.

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

// A sparse regression: free unknowns from a condensed problem, 0 where a term
// is not in the model. Columns that are all 0 are not offered. Called from
// several threads at a time.
using SparseLearner =
    std::function<Vector(const LeastSquaresSystem&, const CoefficientMap&)>;

// Options must be valid.
SparseLearner StlsqLearner(const StlsqOptions& options);

// The support that BIC chooses on the LASSO's path (penalty_weights and
// criterion are ignored), fitted without penalty. independent_fraction: how
// many of the residuals are independent, Selection::num_independent over their
// number. In BIC they count half of that: a bag strays from the truth as far
// as its samples do, and once more as far from these, for what it draws twice.
SparseLearner LassoLearner(const LassoOptions& lasso,
                           const SelectionOptions& selection,
                           double independent_fraction = 1.0);

// The same, but of the supports the one with the fewest terms that lose at most
// `tolerance`, an RMS of residuals, against all candidates (SelectByLoss).
SparseLearner LassoLearnerWithin(double tolerance, const LassoOptions& lasso,
                                 const SelectionOptions& selection,
                                 double independent_fraction = 1.0);

struct EnsembleOptions {
  int num_bags = 100;
  // Data bagging: each bag draws, with replacement, as many time blocks as
  // there are. Blocks, not samples, because neighbouring samples say the same
  // (Kunsch 1989).
  int num_blocks = 20;
  // Library bagging: the fraction of the free candidates that each bag is
  // offered, drawn without replacement; 1: all.
  double library_fraction = 1.0;
  // Terms included at least so often make up the support.
  double inclusion_threshold = 0.6;
  uint64_t seed = 1;
  int num_threads = 1;
  // Ranks that share the bags, each of which calls RunEnsemble with the same
  // problem; nullptr: a single process.
  Communicator* communicator = nullptr;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

struct Ensemble {
  // One an entry of the coefficients: the bags that were offered it, and the
  // fraction of these that included it (0 where there were none, 1 for given
  // ones).
  std::vector<int> num_offered;
  Vector inclusion_probability;
  // Over the bags that included it: median and the percentiles 2.5 and 97.5; 0
  // where there were none. How far the coefficient moves with the data; not a
  // confidence interval, for which see the refit.
  Vector median;
  Vector lower;
  Vector upper;
  // Coefficients, not given, with inclusion_probability >= inclusion_threshold,
  // and the fit of these to all samples, without penalty.
  std::vector<int> support;
  Vector coefficients;
};

// Ensemble SINDy (U. Fasel, J. N. Kutz, B. W. Brunton, S. L. Brunton,
// Proceedings of the Royal Society A 478 (2022) 20210904; bagging: L. Breiman
// 1996): runs `learner` on many bags of time blocks and candidates.
// Coefficients bound by an equality are offered together. The same seed gives
// the same bags with any number of threads and ranks. False for an invalid
// problem or option, or where a rank does not answer.
[[nodiscard]] bool RunEnsemble(const RegressionProblem& problem,
                               const SparseLearner& learner,
                               const EnsembleOptions& options,
                               Ensemble* ensemble, std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_ENSEMBLE_H_
