// Functions that make problems from matrices and arrays.
//
// A problem is a plain struct and can also be filled by hand. These functions
// save lines. They report errors on which the constructors of the problem's
// parts would abort.

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

// Makes a group: alpha times `matrix` (num_dofs x num_dofs, in the model's
// units) is added to the matrix `target`. alpha is free and begins at 0.
GroupTerm MakeFreeGroup(const std::string& name, MatrixGroup::Target target,
                        const Matrix& matrix);

// Makes the channel of a sensor that measures the sum of `weights` (one per
// DOF) times `quantity`. `values` has one value per sample, in the model's
// units; NaN: missing.
MeasuredChannel MakeMeasuredChannel(const std::string& name, Quantity quantity,
                                    const Vector& weights,
                                    const Vector& values);

// Makes one channel per DOF from the columns of `values` (samples x DOFs). The
// channels are named "<prefix>1", "<prefix>2", ...
std::vector<MeasuredChannel> MakeChannels(const std::string& prefix,
                                          Quantity quantity,
                                          const Matrix& values);

// Returns one input per direction of `model`: the acceleration of the ground,
// named "ground_<direction>".
std::vector<InputSpec> GroundMotion(const StructuralModel& model);

// Makes a problem of the structure `model` with these inputs and terms, without
// records. On failure returns false, sets *error, and leaves *problem
// unchanged. It fails if the model is not valid, or if an input or a term does
// not fit it.
[[nodiscard]] bool MakeProblem(const StructuralModel& model,
                               const std::vector<InputSpec>& inputs,
                               const StructureTerms& terms,
                               IdentificationProblem* problem,
                               std::string* error);

// Adds a training record that begins at rest. `inputs` has one row per input of
// the dynamics and one column per sample, in the model's units. `step` is the
// time between samples in the model's unit. On failure returns false, sets
// *error, and leaves *problem unchanged. It fails if sizes or numbers are
// wrong. PrepareProblem checks the channels.
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
// ReadCase returns a prepared problem. Preparing it again changes nothing.
//
// Returns false, with the problem unchanged, on an error. *error names the
// record, channel or mode, and the expected value.
[[nodiscard]] bool PrepareProblem(IdentificationProblem* problem,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_MAKE_PROBLEM_H_
