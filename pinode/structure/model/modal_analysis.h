// Modes of a structure, and the agreement of two sets of modes.

#ifndef PINODE_STRUCTURE_MODEL_MODAL_ANALYSIS_H_
#define PINODE_STRUCTURE_MODEL_MODAL_ANALYSIS_H_

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// The n modes of M a + C v + K x = 0, ascending by the eigenvalue w^2 of K phi
// = w^2 M phi.
//
// Shapes and undamped frequencies are those of (K, M), without C. Damped
// frequencies and ratios are those of the complex eigenvalues s of the damped
// structure. Its damping need not be proportional. Each pair of eigenvalues is
// assigned to the undamped mode that takes most part in it, in kinetic and
// strain energy. The assignment is the best for all modes together. Under
// strong non-proportional damping a pair may spread over several modes; it is
// still assigned to one.
//
// Results for a mode
//
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
  // Damping ratios, as fractions of critical damping.
  Vector damping_ratio;
  // Mode shapes, n x n, one column per mode, mass-normalised: Phi' M Phi = I.
  // The entry of largest magnitude in each column is positive.
  Matrix mode_shapes;
};

// Computes all modes. M, C and K are n x n and symmetric (only the lower
// triangles of M and K are used). M is positive definite; K and C need not be
// definite. Fails, with *modes unchanged, if an entry is not finite, if M is
// not positive definite, or if an eigenvalue iteration does not converge.
[[nodiscard]] bool ComputeModes(const Matrix& mass, const Matrix& damping,
                                const Matrix& stiffness, ModalProperties* modes,
                                std::string* error);

// Modes without damping, the first step of ComputeModes.
struct UndampedModes {
  Vector eigenvalues;  // w^2 (1 / time^2), ascending; 0 below rounding
  Matrix shapes;       // as ModalProperties::mode_shapes
};

// Computes the undamped modes of M and K (n x n, finite; only the lower
// triangles are used). Fails as ComputeModes does.
[[nodiscard]] bool ComputeUndampedModes(const Matrix& mass,
                                        const Matrix& stiffness,
                                        UndampedModes* modes,
                                        std::string* error);

// Returns the 2 n eigenvalues s (1 / time) of the state matrix [0, I; -M^-1 K,
// -M^-1 C], in no particular order. M must be symmetric positive definite
// (CHECKed: validate the model first). K and C may be unsymmetric, for example
// if a network is included in them.
Eigen::VectorXcd StateEigenvalues(const Matrix& mass, const Matrix& damping,
                                  const Matrix& stiffness);

// Returns max |s| of StateEigenvalues, which limits the step of an explicit
// integrator.
double LargestStateEigenvalue(const Matrix& mass, const Matrix& damping,
                              const Matrix& stiffness);

// Returns the modal assurance criterion (a'b)^2 / ((a'a) (b'b)) of two shapes
// of equal size. It is 1 for the same shape at any scale and sign. It is 0 for
// orthogonal shapes, and if a shape is zero. R. J. Allemang and D. L. Brown, "A
// correlation coefficient for modal vector analysis", Proc. 1st International
// Modal Analysis Conference (1982).
double Mac(const Vector& a, const Vector& b);

// Returns the MAC of every column of A (row of the result) with every column of
// B. Both have the same DOFs as rows.
Matrix MacMatrix(const Matrix& shapes_a, const Matrix& shapes_b);

// Returns for each column of A its partner among the columns of B, one to one.
// The sum of the MACs is as large as possible. A greedy choice, mode by mode,
// could leave poor partners for the last modes. The entry is -1 for columns of
// A without a partner because B has fewer columns.
std::vector<int> PairModes(const Matrix& shapes_a, const Matrix& shapes_b);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_MODAL_ANALYSIS_H_
