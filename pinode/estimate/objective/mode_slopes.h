// Derivatives of modes by the factor of a matrix in M or K.

#ifndef PINODE_ESTIMATE_OBJECTIVE_MODE_SLOPES_H_
#define PINODE_ESTIMATE_OBJECTIVE_MODE_SLOPES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

// Computes d phi_j = sum_k parts[k] phi_k by the factor of `matrix`, without
// the modes in `left_out`, whose parts are zero. Returns false, with a
// sentence, if there is no derivative: another mode has the frequency of j, and
// the matrix mixes the two.
[[nodiscard]] bool PartsOfSlope(const UndampedModes& modes, int j,
                                const std::vector<int>& left_out,
                                const Matrix& matrix, bool on_mass,
                                Vector* parts, std::string* error);

// Derivatives of a mode by columns: its eigenvalue, and its shape at DOFs.
struct ModeSlopes {
  RowVector eigenvalue;
  Matrix shape;
};

// Sets column `column` of *slopes to the derivatives of mode j. Fails as
// PartsOfSlope does.
[[nodiscard]] bool DifferentiateMode(const UndampedModes& modes, int j,
                                     const std::vector<int>& dofs,
                                     const Matrix& matrix, bool on_mass,
                                     int column, ModeSlopes* slopes,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_MODE_SLOPES_H_
