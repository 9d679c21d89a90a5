// Measured modes whose frequencies are too close to tell their shapes apart.

#ifndef PINODE_PROBLEM_CLOSE_MODES_H_
#define PINODE_PROBLEM_CLOSE_MODES_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/measured_mode.h"

namespace pinode {

// Returns the sets of two or more measured modes, by index, that are compared
// as a whole. Any rotation of their shapes among each other is possible within
// the errors of the frequencies, so that the single shapes say nothing. Their
// span does.
//
// Neighbours by frequency belong together if the frequencies differ by less
// than three standard deviations of the difference, or by less than 0.1 % if
// none are given. All modes of a set have shapes at the same DOFs, more of
// these than modes, and the shapes are independent. The dynamic residual has no
// sets: it compares no shapes.
//
// MatchModes pairs them by their span. The MAC of a mode of the model is then
// that with the nearest shape in the span of the measured ones, and
// ModeMatch::mac that of the measured shape with the span of the partners.
std::vector<std::vector<int>> CloseModes(const ModalData& data);

// Returns the shapes of these modes as columns, of unit norm each.
Matrix UnitShapes(const ModalData& data, const std::vector<int>& set);

// Returns the squared cosine of the angle between a vector and the span of the
// columns of `basis`: the MAC of the vector and the nearest vector of the span.
double MacWithSpan(const Matrix& basis, const Vector& vector);

}  // namespace pinode

#endif  // PINODE_PROBLEM_CLOSE_MODES_H_
