// Equations in place of networks.

#ifndef PINODE_STUDY_TERMS_DISCOVERED_PROBLEM_H_
#define PINODE_STUDY_TERMS_DISCOVERED_PROBLEM_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// The library that stands for an equation, "<network>_<output>", and the
// coefficient of one of its terms, "<library>.<basis>".
std::string LibraryName(const DiscoveredEquation& equation);
std::string CoefficientName(const DiscoveredEquation& equation,
                            const std::string& basis);

// A basis of a valid equation as a function of its features.
LibraryFunction BasisFunction(const DiscoveredEquation& equation,
                              const std::string& basis);

// Whether `equations` can stand for networks of `problem`: features that the
// model has, by name in feature_names, and bases of them. On failure *error
// names the equation.
[[nodiscard]] bool AreEquationsOf(
    const IdentificationProblem& problem,
    const std::vector<DiscoveredEquation>& equations, std::string* error);

// `problem` with libraries in place of the networks that `equations` speak of,
// and of their libraries of an earlier round, and the parameters with which a
// fit begins: values, noise and starts of `model`, coefficients of the
// equations. Steps a sample: `substeps` (one a record) where it is not empty,
// else those that were chosen are chosen again. The problem's own initial
// values are those that it had, and 0 for coefficients that are not given: the
// prior model of a fit is the one before discovery, without networks.
//
// False, with *error, where equations, model or steps do not fit the problem.
[[nodiscard]] bool MakeDiscoveredProblem(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const std::vector<int>& substeps, IdentificationProblem* discovered,
    IdentifiedModel* initial, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_DISCOVERED_PROBLEM_H_
