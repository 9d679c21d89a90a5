// Problems that are made from others: the same records, other terms.

#ifndef PINODE_STUDY_PROBLEM_GROWTH_H_
#define PINODE_STUDY_PROBLEM_GROWTH_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// `text` as the name of a term: names of DOFs, of which it may be made, are
// freer.
std::string TermName(std::string text);

// The terms of a structure apart from its matrices.
struct StructureTerms {
  std::vector<GroupTerm> groups;
  std::vector<LawTerm> laws;
  std::vector<UnknownForceTerm> unknown_forces;
  std::vector<NetworkTerm> networks;
  // Scales of forces, and kinds that the library does not know
  // (StructuralDynamics::AddTerm).
  std::vector<std::shared_ptr<const Term>> others;
  // Curves that groups follow.
  std::vector<GroupCurve> group_curves;
};
StructureTerms TermsOf(const StructuralDynamics& dynamics);

// `model`, which is valid, with `terms`. False, with *error, where one of them
// does not fit it, or the mass matrix with the groups is not positive definite.
[[nodiscard]] bool Assemble(const StructuralModel& model,
                            const std::vector<InputSpec>& inputs,
                            const StructureTerms& terms,
                            std::shared_ptr<const StructuralDynamics>* dynamics,
                            std::string* error);

// The steps of a problem whose terms are new: `substeps`, one a record, where
// it is not empty, given then; else those that were chosen, again. False, with
// *error, where they are unstable or cannot be chosen.
[[nodiscard]] bool SetStepsAgain(const std::vector<int>& substeps,
                                 IdentificationProblem* problem,
                                 std::string* error);

// Checks that `summary` and `model` can come from a fit of `problem`: their
// sizes, and that parameters are finite. On failure *error says what is wrong.
[[nodiscard]] bool IsFitOf(const IdentificationProblem& problem,
                           const FitSummary& summary,
                           const IdentifiedModel& model, std::string* error);

// The same for the outcome of Identify, which must also be usable and have the
// covariance of its free named parameters.
[[nodiscard]] bool IsUsableResultOf(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    std::string* error);

// The parameters of `problem` by name, as in `model`, which has one value per
// parameter of it.
std::map<std::string, double> ParametersByName(
    const IdentificationProblem& problem, const IdentifiedModel& model);

// Returns the model with which a fit of `problem` begins: `values` where it has
// parameters of these names, its own initial values elsewhere; noise and starts
// of `model`, a fit of the same records.
IdentifiedModel BeginFrom(const std::map<std::string, double>& values,
                          const IdentifiedModel& model,
                          const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_GROWTH_H_
