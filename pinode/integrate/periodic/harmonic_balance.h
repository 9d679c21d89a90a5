// Periodic response of dynamics with laws to a harmonic input.

#ifndef PINODE_INTEGRATE_PERIODIC_HARMONIC_BALANCE_H_
#define PINODE_INTEGRATE_PERIODIC_HARMONIC_BALANCE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/local_laws.h"

namespace pinode {

// Inputs u(t) = mean + amplitude cos(omega t), num_inputs() entries each, in
// the model's units.
struct HarmonicInput {
  Vector mean;
  Vector amplitude;
};

// Equations of the periodic response with the period of the input,
//
//   dy/dt = F y + G u + L r(w, t),   dz/dt = s(w, t),   y = [x; v],
//
// in which r and s, the results of the laws, depend on few states w. Only the
// Fourier coefficients of w are unknowns. Those of the other states follow
// through F, in the frequency domain. The coefficients of r and s come from
// samples over one period, and so do their derivatives: the alternating
// frequency/time method of T. M. Cameron and J. H. Griffin (J. Appl. Mech. 56
// (1989) 149-154).
//
// Coefficients of a vector w with `harmonics` H are a matrix with 2 H + 1
// columns, the mean, then cosine and sine of each harmonic:
//
//   w(t) = c_0 + sum_k (c_(2k-1) cos(k omega t) + c_(2k) sin(k omega t)).
//
// The unknowns are this matrix as one vector, column after column. An object
// has working memory: use one per thread.
class HarmonicBalance {
 public:
  // Returns nullptr, with a sentence in *error, if the dynamics have other
  // terms than laws and constant groups, if a law depends on the time, or if a
  // motion of the linear part has no stiffness, so that its mean is not
  // determined, or no mode of its own (ModalBasis). `dynamics` and `prepared`
  // must outlive the object.
  [[nodiscard]] static std::unique_ptr<HarmonicBalance> Create(
      const StructuralDynamics& dynamics,
      const StructuralDynamics::Prepared& prepared, HarmonicInput input,
      std::string* error);

  // Number of states w; 0 for linear dynamics.
  int num_active() const { return static_cast<int>(active_.size()); }
  int num_unknowns(int harmonics) const {
    return num_active() * (2 * harmonics + 1);
  }
  // The amplitude of the input is multiplied by this factor, 1 at first.
  void SetScale(double scale) { scale_ = scale; }

  // Residuals of the equations of w, and their derivatives.
  struct Equations {
    Vector residual;  // num_unknowns
    Matrix jacobian;  // by the unknowns
    Vector by_omega;  // by omega
    // RMS of the next harmonics of w, as many again, over the RMS of w. They
    // would come from the laws at the present w.
    double neglected = 0.0;
  };
  // Computes the equations at `unknowns` (num_unknowns(harmonics) entries).
  // Returns false if a law is not finite.
  [[nodiscard]] bool Evaluate(int harmonics, double omega,
                              const Vector& unknowns, Equations* equations);

  // Returns the coefficients of all states h, num_states x (2 * harmonics + 1).
  // `unknowns` must solve the equations.
  Matrix StateCoefficients(int harmonics, double omega, const Vector& unknowns);

  // Largest modulus of the Floquet multipliers, the eigenvalues of the
  // linearised motion over one period about the solution. Above 1 the solution
  // is unstable; 1 is the value of motion without damping. NaN if it could not
  // be computed. At most 1e299.
  double LargestMultiplier(int harmonics, double omega, const Vector& unknowns);

 private:
  HarmonicBalance(const StructuralDynamics& dynamics,
                  const StructuralDynamics::Prepared& prepared,
                  HarmonicInput input);
  [[nodiscard]] bool Factor(std::string* error);
  // Evaluates the laws at a phase of the input, for the states w. `results` has
  // [r; dz/dt + shift_ z], `slopes` its derivative by w, column after column.
  // Returns false if one is not finite.
  [[nodiscard]] bool EvaluateLaws(double phase, const Vector& active,
                                  double* results, double* slopes);
  // Does so at each of `samples` instants of a period, one column each.
  [[nodiscard]] bool Sample(int harmonics, int samples, const Vector& unknowns,
                            Matrix* results, Matrix* slopes);
  // Returns (i k omega - F)^-1 times `right`, both in modal coordinates.
  ComplexMatrix Solve(int k, double omega, const ComplexMatrix& right) const;
  // The largest multiplier with so many steps of the linear motion.
  double LargestMultiplierWith(int harmonics, double omega, int steps,
                               const Vector& unknowns);

  // True if a mode and the next one are a conjugate pair.
  bool BeginsPair(int mode) const { return poles_[mode].imag() != 0.0; }

  const StructuralDynamics& dynamics_;
  const StructuralDynamics::Prepared& prepared_;
  HarmonicInput input_;
  double scale_ = 1.0;
  LocalLaws laws_;
  std::vector<int> active_;  // indices of w in h
  // Internal states have no linear part. Theirs is -shift_ z, and is added back
  // to the laws.
  double shift_ = 0.0;
  // Modes of F with the part of z: poles, modes, the rows of the modes of the
  // states w, and modal coordinates of the actions and of two loads. Actions
  // are the columns of L, then unit vectors of z. The loads are G u of the mean
  // and of the amplitude.
  ComplexVector poles_;
  ComplexMatrix modes_, active_modes_, right_;
  // The same with real and imaginary part of a mode as two coordinates:
  // rows of the states w, and the actions.
  Matrix real_active_, real_actions_;
  Vector state_;  // for the laws
  Matrix law_slopes_;
};

// Returns the value at the phase omega t of a signal with these coefficients.
Vector ValueAt(const Matrix& coefficients, double phase);
// Returns the coefficients of its derivative by the time.
Matrix DerivativeCoefficients(const Matrix& coefficients, double omega);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_PERIODIC_HARMONIC_BALANCE_H_
