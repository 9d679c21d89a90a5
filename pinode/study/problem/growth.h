// Problems that are made from others, with the same records and other terms.

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

// Returns `text` as a valid name of a term. Names of DOFs, which may be part of
// it, may have characters that names of terms may not have.
std::string TermName(std::string text);

// Terms of a structure, without its matrices.
struct StructureTerms {
  std::vector<GroupTerm> groups;
  std::vector<LawTerm> laws;
  std::vector<UnknownForceTerm> unknown_forces;
  std::vector<NetworkTerm> networks;
  // Scales of forces, and terms of kinds that the library does not know
  // (StructuralDynamics::AddTerm).
  std::vector<std::shared_ptr<const Term>> others;
  // Curves by which groups follow covariates.
  std::vector<GroupCurve> group_curves;
};
// Returns copies of all terms of `dynamics`.
StructureTerms TermsOf(const StructuralDynamics& dynamics);

// Makes the dynamics of `model`, which must be valid, with `terms`. Returns
// false, with *error, if a term does not fit the model. Also returns false if
// the mass matrix with its groups is not positive definite.
[[nodiscard]] bool Assemble(const StructuralModel& model,
                            const std::vector<InputSpec>& inputs,
                            const StructureTerms& terms,
                            std::shared_ptr<const StructuralDynamics>* dynamics,
                            std::string* error);

// Sets the integration steps of a problem with new terms. If `substeps` is not
// empty, it has the steps per sample of each record. Otherwise steps that were
// chosen are chosen again, and steps that the user has given stay. Returns
// false, with *error, if steps are unstable or cannot be chosen.
[[nodiscard]] bool SetStepsAgain(const std::vector<int>& substeps,
                                 IdentificationProblem* problem,
                                 std::string* error);

// Checks that `summary` and `model` can come from a fit of `problem`: sizes
// match, and parameters are finite. On failure returns false, with a sentence
// in *error.
[[nodiscard]] bool IsFitOf(const IdentificationProblem& problem,
                           const FitSummary& summary,
                           const IdentifiedModel& model, std::string* error);

// Checks the same for a result of Identify, which must also be usable and have
// the covariance of its free named parameters.
[[nodiscard]] bool IsUsableResultOf(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    std::string* error);

// Returns the values of all parameters in `model` by name. `model` must have
// one value for each parameter of `problem`.
std::map<std::string, double> ParametersByName(
    const IdentificationProblem& problem, const IdentifiedModel& model);

// Returns the model with which a fit of `problem` begins. Parameters that are
// named in `values` get these values, others the problem's initial values.
// Noise levels and initial states are those of `model`, from a fit of the same
// records.
IdentifiedModel BeginFrom(const std::map<std::string, double>& values,
                          const IdentifiedModel& model,
                          const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_GROWTH_H_
