// Faults of the sensors with which mode shapes were measured.

#ifndef PINODE_STUDY_EXPLANATIONS_SHAPE_SUSPECTS_H_
#define PINODE_STUDY_EXPLANATIONS_SHAPE_SUSPECTS_H_

#include <optional>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Applies the changes to the shapes of *data. Covariances follow; a standard
// deviation of all entries becomes a covariance where one entry is scaled.
void ChangeShapes(const std::vector<Suspect::ShapeChange>& changes,
                  ModalData* data);

// Removes the entries at `dof` from all shapes that keep two entries or more.
void LeaveOutPlace(int dof, ModalData* data);

// DOFs at which any shape was measured, ascending.
std::vector<int> MeasuredPlaces(const ModalData& data);

// Returns discrete faults of sensors, at most `most` of each kind, after which
// the measured modes are more like those of the initial or of the fitted model:
//
// - a sensor mounted upside down, in all modes;
// - one entry of one mode with the wrong sign;
// - two sensors in each other's place;
// - two modes with each other's shape.
//
// Likeness is the sum over the pairs of MatchModes of
// MAC - 1/2 (ln ratio of frequencies)^2, the ratios relative to their median.
// No fit is made. The initial model counts because a fit may have adapted to
// the fault. Each suspect knows how many of its kind were compared. Nothing if
// there are more than 60 places or 20 modes.
std::vector<Suspect> MakeShapeSuspects(const IdentificationProblem& problem,
                                       const IdentifiedModel& model,
                                       size_t most);

// Returns a suspect that divides the entries at `dof` by the gain of their
// sensor. The gain is the regression of the measured entries on those of the
// model, whose parameters should be from a fit without these entries
// (LeaveOutPlace). Nothing if the gain is within 5 % of one, is negative, or if
// the entries are not proportional to those of the model.
std::optional<Suspect> MakeGainOfShapes(const IdentificationProblem& problem,
                                        const Vector& parameters, int dof);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_SHAPE_SUSPECTS_H_
