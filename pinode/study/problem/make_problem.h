// Problems from matrices and arrays.
//
// A problem is a plain struct and can be filled by hand; these functions check
// what the constructors of its parts would abort on, and save lines.

#ifndef PINODE_STUDY_PROBLEM_MAKE_PROBLEM_H_
#define PINODE_STUDY_PROBLEM_MAKE_PROBLEM_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/record/excitation.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/study/problem/growth.h"

namespace pinode {

// Makes a free unknown alpha that begins at 0: the model's `target` plus alpha
// times `matrix` (num_dofs x num_dofs).
GroupTerm MakeFreeGroup(const std::string& name, MatrixGroup::Target target,
                        const Matrix& matrix);

// Makes the channel of a sensor that measures `quantity` times `weights` (one
// per DOF). `values`: one per sample, in the model's units.
MeasuredChannel MakeMeasuredChannel(const std::string& name, Quantity quantity,
                                    const Vector& weights,
                                    const Vector& values);

// Makes one such channel per DOF from the columns of `values` (samples x DOFs),
// named "<prefix>1", "<prefix>2", ...
std::vector<MeasuredChannel> MakeChannels(const std::string& prefix,
                                          Quantity quantity,
                                          const Matrix& values);

// Returns an acceleration of the ground in each direction of `model`,
// ground_<name>.
std::vector<InputSpec> GroundMotion(const StructuralModel& model);

// Makes a problem of the structure `model` with these inputs and terms, without
// records. Returns false, with *error and *problem untouched, if the model is
// not valid, or if an input or a term does not fit it.
[[nodiscard]] bool MakeProblem(const StructuralModel& model,
                               const std::vector<InputSpec>& inputs,
                               const StructureTerms& terms,
                               IdentificationProblem* problem,
                               std::string* error);

// Adds a training record that begins at rest, with one row of `inputs` per
// input of the model and one column per sample, `step` apart. Returns false,
// with *error and *problem untouched, if sizes or numbers are wrong.
// PrepareProblem checks that the channels fit.
[[nodiscard]] bool AddRecord(const std::string& name, double step,
                             const Matrix& inputs, Interpolation interpolation,
                             const std::vector<MeasuredChannel>& channels,
                             IdentificationProblem* problem,
                             std::string* error);

// Checks and completes the problem, in this order:
//
// - checks it (IdentificationProblem::IsValid);
// - sets the steps of all records whose `substeps` is 0, and checks given ones
//   (see SetSubsteps in study/problem/substeps.h);
// - sets the scales of networks that have none (ScaleNetworks);
// - fixes the starts of training records that have `start_samples`
//   (FixTrainingStarts).
//
// A problem from a case file is prepared already; repeating it changes nothing.
//
// Returns false, with the problem untouched, on an error. *error names the
// record, channel or mode, and what was expected.
[[nodiscard]] bool PrepareProblem(IdentificationProblem* problem,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_MAKE_PROBLEM_H_
