// Measured shapes beside the span of several modes of a model.

#ifndef PINODE_ESTIMATE_OBJECTIVE_SPAN_COMPARISON_H_
#define PINODE_ESTIMATE_OBJECTIVE_SPAN_COMPARISON_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/mode_slopes.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

// Modes of a model as a set of measured shapes sees them. With Phi the shapes
// of the model's modes of the set, Phi_d these at the measured DOFs, y_i a
// measured shape and W_i the inverse of its covariance,
//
//   a_i = (Phi_d' W_i Phi_d)^-1 Phi_d' W_i y_i,   x_i = Phi_d a_i
//
// is the nearest shape in their span. Q, the orthogonal matrix nearest to the
// columns a_i / |a_i|, turns the model's modes to the measured ones, and
//
//   G = Q' Phi' K Phi Q
//
// has the squared frequencies of these on its diagonal. Neither x_i nor G
// depends on how the model's modes are turned among each other. Their
// derivatives therefore need no differences of the set's own eigenvalues, which
// may be equal.
class SpanComparison {
 public:
  // `set`: indices of the model's modes. `measured`: a column per shape.
  // `roots`: W_i = root' root for each shape. All are copied.
  SpanComparison(std::vector<int> set, std::vector<int> dofs, Matrix measured,
                 std::vector<Matrix> roots);

  // Computes x_i and G. Returns false, with a sentence, if the model's modes
  // have no independent shapes at the measured DOFs.
  [[nodiscard]] bool Compute(const UndampedModes& modes, std::string* error);

  const Matrix& nearest() const { return nearest_; }  // DOFs x shapes
  const Matrix& squares() const { return squares_; }  // G

  // Derivatives by the factor of one matrix in K or M: those of x_i and G.
  struct Slopes {
    Matrix nearest;
    Matrix squares;
  };
  // Computes them. Returns false, with a sentence, if a mode outside of the set
  // has the frequency of one of the set, and the matrix mixes the two.
  [[nodiscard]] bool Differentiate(const UndampedModes& modes,
                                   const Matrix& matrix, bool on_mass,
                                   Slopes* slopes, std::string* error) const;

 private:
  const std::vector<int> set_;
  const std::vector<int> dofs_;
  const Matrix measured_;
  const std::vector<Matrix> roots_;
  Matrix span_;          // Phi_d
  Matrix coefficients_;  // columns a_i
  Matrix nearest_;
  Matrix turn_;     // Q
  Matrix stretch_;  // of the polar decomposition, symmetric
  Matrix squares_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_SPAN_COMPARISON_H_
