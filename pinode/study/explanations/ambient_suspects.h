// Sensors of ambient records that may be wrong.

#ifndef PINODE_STUDY_EXPLANATIONS_AMBIENT_SUSPECTS_H_
#define PINODE_STUDY_EXPLANATIONS_AMBIENT_SUSPECTS_H_

#include <vector>

#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Returns the sensors that describe the ambient records better at the fit
// `model` if they are swapped, turned round or scaled. A line Y has the density
// S = P^-1 there, and the change T of the channels the gain
//
//   sum over lines of  tr P Y Y^H - tr P T Y Y^H T'.
//
// It is counted where it is positive. The scale of a channel is that of its
// regression on the value that the other channels and S predict,
// Y_c - (P Y)_c / P_cc; scales within a twentieth of 1 are left out.
//
// `is_poor` has one flag per ambient record, true if the fit does not describe
// it. Its loads have then adapted to a wrong sensor. The exchanges, and the
// turns, are therefore also counted by what they gain at the initial values
// with loads of their own: all if there are up to ten, else the three
// likeliest.
//
// Each way of counting gives up to `most` of each kind, best first: at the
// initial values, there with loads of their own, and at the fit. A change that
// several ways find is there once.
std::vector<Suspect> MakeAmbientSuspects(const IdentificationProblem& problem,
                                         const IdentifiedModel& model,
                                         const std::vector<bool>& is_poor,
                                         int num_threads, size_t most);

// Returns the factor by which this channel's samples should be multiplied, by
// that regression; 1 if it is not known.
double AmbientScale(const IdentificationProblem& problem,
                    const IdentifiedModel& model, int record, int channel,
                    int num_threads);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_AMBIENT_SUSPECTS_H_
