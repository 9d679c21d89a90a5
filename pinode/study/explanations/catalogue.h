// Catalogue of what a model may lack.

#ifndef PINODE_STUDY_EXPLANATIONS_CATALOGUE_H_
#define PINODE_STUDY_EXPLANATIONS_CATALOGUE_H_

#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Returns the catalogue for `problem` near `model`, values of its unknowns.
// It leaves out unknowns that the problem has already. Single masses and
// springs are in it for structures with at most 40 DOFs, and springs for
// stiffness matrices that consist of them.
std::vector<Suspect> MakeSuspects(const IdentificationProblem& problem,
                                  const IdentifiedModel& model);

// Returns nonlinear forces at the springs that carry the most strain energy in
// `fit`, `most_places` of them. Its training records have states.
std::vector<Suspect> MakeForceSuspects(const IdentificationProblem& problem,
                                       const FitSummary& fit,
                                       const IdentifiedModel& model,
                                       size_t most_places);

// Sensors and excitation, a part of MakeSuspects.
void AddSensorSuspects(const IdentificationProblem& problem,
                       std::vector<Suspect>* suspects);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_CATALOGUE_H_
