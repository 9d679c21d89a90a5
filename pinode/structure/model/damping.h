// Damping matrices from Rayleigh coefficients or modal damping ratios.

#ifndef PINODE_STRUCTURE_MODEL_DAMPING_H_
#define PINODE_STRUCTURE_MODEL_DAMPING_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Rayleigh's proportional damping C = a0 M + a1 K. It damps the mode of
// circular frequency w with the ratio
//
//   zeta(w) = a0 / (2 w) + a1 w / 2
//
// (A. K. Chopra, Dynamics of Structures, section 11.4).
struct RayleighCoefficients {
  // a0, in 1 / time.
  double mass = 0.0;
  // a1, in units of time.
  double stiffness = 0.0;
};

// Returns C, n x n, from M and K of the same size.
Matrix RayleighDamping(const Matrix& mass, const Matrix& stiffness,
                       const RayleighCoefficients& coefficients);

// Computes the coefficients that give the damping ratio ratio_a (a fraction of
// critical) at frequency_a_hz, and likewise for b. Fails if the frequencies are
// not positive and different, or if a ratio is negative. Also fails if one
// coefficient would be negative because the ratios are too different: modes
// outside the two frequencies would then gain energy.
[[nodiscard]] bool RayleighFromRatios(double frequency_a_hz, double ratio_a,
                                      double frequency_b_hz, double ratio_b,
                                      RayleighCoefficients* coefficients,
                                      std::string* error);

// Computes C = M Phi diag(2 zeta_i w_i) Phi' M, with the mass-normalised mode
// shapes Phi and the circular frequencies w_i of (K, M), ascending. Each mode
// keeps its shape and has its own damping ratio zeta_i (Chopra, section
// 11.4.3). The last ratio applies to all higher modes. Rigid-body modes (w = 0)
// are not damped.
//
// Fails if there is no ratio, if there are more ratios than modes, or if one is
// negative. Fails too if the modes cannot be computed or one has negative
// stiffness.
[[nodiscard]] bool ModalDamping(const Matrix& mass, const Matrix& stiffness,
                                const Vector& ratios, Matrix* damping,
                                std::string* error);

// Computes the part of ModalDamping of some modes: C has `ratio` in the modes
// `first` to `last` and none in the others. Modes count from 1, as in
// ModalDamping; `last` = 0 is the highest. Fails as ModalDamping does, and if
// there are no such modes.
[[nodiscard]] bool DampingOfModes(const Matrix& mass, const Matrix& stiffness,
                                  int first, int last, double ratio,
                                  Matrix* damping, std::string* error);

// Rule that gives the damping of a model for any M and K.
struct DampingRule {
  enum class Kind { kNone, kRayleigh, kRatios, kMatrix };
  Kind kind = Kind::kNone;
  RayleighCoefficients rayleigh;
  Vector ratios;  // as in ModalDamping
  Matrix matrix;  // kMatrix: C itself
};

// Computes C by the rule, n x n as M and K. Fails as ModalDamping does, and if
// a given matrix has another size.
[[nodiscard]] bool DampingBy(const DampingRule& rule, const Matrix& mass,
                             const Matrix& stiffness, Matrix* damping,
                             std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_DAMPING_H_
