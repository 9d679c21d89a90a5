// Modes of a structure, and how well two sets of modes agree.

#ifndef PINODE_STRUCTURE_MODEL_MODAL_ANALYSIS_H_
#define PINODE_STRUCTURE_MODEL_MODAL_ANALYSIS_H_

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// The n modes of M a + C v + K x = 0, ascending by the eigenvalue w^2 of
// K phi = w^2 M phi.
//
// Shapes and undamped frequencies are those of (K, M), without C. Damped
// frequencies and ratios are those of the complex eigenvalues s of the damped
// structure, which need not be proportionally damped: each pair of them is
// given to the undamped mode that takes most part in it (in kinetic and strain
// energy, all modes together as well as possible). Under strong
// non-proportional damping a pair may spread over several modes; it is still
// given to one.
//
// What is reported for a mode
//   vibrating       frequency > 0; s = s1, conj(s1): damped frequency
//                   |Im s1| / (2 pi), ratio -Re s1 / |s1|.
//   overdamped      s1, s2 real, of one sign: damped frequency 0, ratio
//                   -(s1 + s2) / (2 sqrt(s1 s2)), at least 1 in magnitude.
//   rigid body      frequency exactly 0 (w^2 below rounding); damped frequency
//                   0 and ratio NaN: there is no oscillation to which a ratio
//                   could refer.
//   negative stiffness (w^2 < 0)  frequency NaN; with real s1, s2 of unlike
//                   sign (the shape diverges) damped frequency 0, ratio NaN.
// A negative ratio means that the mode gains energy.
struct ModalProperties {
  // Undamped natural frequencies, in cycles per time unit (Hz for seconds).
  Vector frequency_hz;
  Vector damped_frequency_hz;
  // Fractions of critical damping.
  Vector damping_ratio;
  // n x n, a column per mode, mass-normalised: Phi' M Phi = I. The entry of
  // largest magnitude in each column is positive.
  Matrix mode_shapes;
};

// Computes all modes. M, C and K are n x n and symmetric (lower triangles are
// used for M and K); M is positive definite, K and C are anything. Fails, with
// *modes untouched, if an entry is not finite, if M is not positive definite,
// or if an eigenvalue iteration does not converge.
[[nodiscard]] bool ComputeModes(const Matrix& mass, const Matrix& damping,
                                const Matrix& stiffness, ModalProperties* modes,
                                std::string* error);

// Modes without damping: what ComputeModes begins with.
struct UndampedModes {
  Vector eigenvalues;  // w^2 (1 / time^2), ascending; 0 below rounding
  Matrix shapes;       // as ModalProperties::mode_shapes
};

// The undamped modes of M and K (n x n, finite; lower triangles are used).
// Fails as ComputeModes does.
[[nodiscard]] bool ComputeUndampedModes(const Matrix& mass,
                                        const Matrix& stiffness,
                                        UndampedModes* modes,
                                        std::string* error);

// The 2 n eigenvalues s (1 / time) of the state matrix
// [0, I; -M^-1 K, -M^-1 C], in no particular order. M must be symmetric
// positive definite (CHECKed: validate the model first); K and C may be
// unsymmetric, as with a network folded in.
Eigen::VectorXcd StateEigenvalues(const Matrix& mass, const Matrix& damping,
                                  const Matrix& stiffness);

// max |s| of StateEigenvalues: what limits the step of an explicit integrator.
double LargestStateEigenvalue(const Matrix& mass, const Matrix& damping,
                              const Matrix& stiffness);

// Modal assurance criterion (a'b)^2 / ((a'a) (b'b)) of two shapes of equal
// size: 1 for the same shape at whatever scale and sign, 0 for orthogonal ones
// and where a shape is zero. R. J. Allemang and D. L. Brown, "A correlation
// coefficient for modal vector analysis", Proc. 1st International Modal
// Analysis Conference (1982).
double Mac(const Vector& a, const Vector& b);

// The MAC of every column of A (row of the result) with every column of B. Both
// have the same DOFs as rows.
Matrix MacMatrix(const Matrix& shapes_a, const Matrix& shapes_b);

// For each column of A its partner among the columns of B, one to one, so that
// the sum of the MACs is as large as possible: a greedy choice, mode by mode,
// can leave the last modes with nonsense. Entry -1 for columns of A that go
// without because B has fewer.
std::vector<int> PairModes(const Matrix& shapes_a, const Matrix& shapes_b);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_MODAL_ANALYSIS_H_
