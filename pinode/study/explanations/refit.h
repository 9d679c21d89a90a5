// A fit with entries of the catalogue among its unknowns.

#ifndef PINODE_STUDY_EXPLANATIONS_REFIT_H_
#define PINODE_STUDY_EXPLANATIONS_REFIT_H_

#include <vector>

#include "pinode/base/constants.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

struct Refit {
  std::vector<size_t> suspects;  // of the catalogue
  IdentificationProblem problem;
  FitSummary fit;
  IdentifiedModel model;
  // Logarithm of its odds against the fit without them, see Explain.
  double log_odds = -kInfinity;
};

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_REFIT_H_
