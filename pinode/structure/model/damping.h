// Damping matrices from what engineers know: Rayleigh coefficients or modal
// damping ratios.

#ifndef PINODE_STRUCTURE_MODEL_DAMPING_H_
#define PINODE_STRUCTURE_MODEL_DAMPING_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Rayleigh's proportional damping C = a0 M + a1 K, which damps the mode of
// circular frequency w with the ratio
//
//   zeta(w) = a0 / (2 w) + a1 w / 2
//
// (A. K. Chopra, Dynamics of Structures, section 11.4).
struct RayleighCoefficients {
  // a0, 1 / time.
  double mass = 0.0;
  // a1, time.
  double stiffness = 0.0;
};

// C, n x n, from M and K of the same size.
Matrix RayleighDamping(const Matrix& mass, const Matrix& stiffness,
                       const RayleighCoefficients& coefficients);

// The coefficients that give the damping ratio ratio_a (a fraction of critical)
// at frequency_a_hz, and likewise b. Fails if the frequencies are not positive
// and different, if a ratio is negative, or if the ratios are so different that
// one coefficient comes out negative: modes outside the two frequencies would
// then gain energy.
[[nodiscard]] bool RayleighFromRatios(double frequency_a_hz, double ratio_a,
                                      double frequency_b_hz, double ratio_b,
                                      RayleighCoefficients* coefficients,
                                      std::string* error);

// C = M Phi diag(2 zeta_i w_i) Phi' M with the mass-normalised mode shapes Phi
// and circular frequencies w_i of (K, M), ascending: each mode keeps its shape
// and has its own damping ratio zeta_i (Chopra, section 11.4.3). The last ratio
// serves all modes above. Rigid-body modes (w = 0) are not damped.
//
// Fails if there is no ratio, more ratios than modes, a negative one, or if the
// modes cannot be computed or one has negative stiffness.
[[nodiscard]] bool ModalDamping(const Matrix& mass, const Matrix& stiffness,
                                const Vector& ratios, Matrix* damping,
                                std::string* error);

// How a model is damped, for whatever M and K it turns out to have.
struct DampingRule {
  enum class Kind { kNone, kRayleigh, kRatios, kMatrix };
  Kind kind = Kind::kNone;
  RayleighCoefficients rayleigh;
  Vector ratios;  // as in ModalDamping
  Matrix matrix;  // kMatrix: C itself
};

// C by the rule, n x n as M and K. Fails as ModalDamping does, and where a
// given matrix is of another size.
[[nodiscard]] bool DampingBy(const DampingRule& rule, const Matrix& mass,
                             const Matrix& stiffness, Matrix* damping,
                             std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_DAMPING_H_
