// Problems with equations in place of networks.

#ifndef PINODE_STUDY_TERMS_DISCOVERED_PROBLEM_H_
#define PINODE_STUDY_TERMS_DISCOVERED_PROBLEM_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Return the name of the library of an equation, "<network>_<output>", and of
// the coefficient of one of its terms, "<library>.<basis>".
std::string LibraryName(const DiscoveredEquation& equation);
std::string CoefficientName(const DiscoveredEquation& equation,
                            const std::string& basis);

// Returns a basis of a valid equation as a function of its features.
LibraryFunction BasisFunction(const DiscoveredEquation& equation,
                              const std::string& basis);

// Checks that `equations` can replace networks of `problem`: the model has
// their features, by name in feature_names, and the bases are functions of
// these. On failure *error names the equation.
[[nodiscard]] bool AreEquationsOf(
    const IdentificationProblem& problem,
    const std::vector<DiscoveredEquation>& equations, std::string* error);

// Makes `problem` with libraries in place of the networks named in `equations`,
// and of their libraries of an earlier round. *initial has the parameters with
// which a fit begins: values, noise and starts of `model`, and coefficients of
// the equations. Steps per sample: `substeps` (one per record) if it is not
// empty; else chosen steps are chosen again. The problem keeps its own initial
// values, with 0 for coefficients that are not given: the initial model of a
// fit is the one before discovery, without networks.
//
// Returns false, with *error, if equations, model or steps do not fit the
// problem.
[[nodiscard]] bool MakeDiscoveredProblem(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const std::vector<int>& substeps, IdentificationProblem* discovered,
    IdentifiedModel* initial, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_DISCOVERED_PROBLEM_H_
