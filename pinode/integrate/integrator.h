// Methods of time integration, their derivatives, and the stability of steps.

#ifndef PINODE_INTEGRATE_INTEGRATOR_H_
#define PINODE_INTEGRATE_INTEGRATOR_H_

namespace pinode {

// Method that takes the state from one sample to the next.
enum class Integrator {
  kRungeKutta,  // classical Runge-Kutta method of fourth order
  kExact,  // linear dynamics with constant matrices: no error but that of a
           // polynomial for the inputs between two samples
  kExponential,  // exact for the linear part of dynamics with laws at a few
                 // DOFs, see ExponentialStep
};

// Returns "rk4", "exact" or "exponential".
const char* IntegratorName(Integrator integrator);

// Method for the derivatives of a segment with respect to its start and the
// parameters. Both methods differentiate the discrete steps and agree up to
// rounding.
enum class DerivativeMethod {
  kTangents,  // TangentStep: laws by narrow Jets, networks by hand;
              // LinearSegment where the dynamics are linear
  kJets,      // the step on wide Jets through the whole segment; only
              // Runge-Kutta has it
};

// Stability of Runge-Kutta steps. The method is stable if |R(z)| <= 1 for z =
// dt lambda, with R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 (E. Hairer and G.
// Wanner, Solving Ordinary Differential Equations II, 1996, section IV.2). dt
// is the step, lambda an eigenvalue of the linearised state matrix.
struct StabilityReport {
  // Largest |lambda|, in rad per unit of the model's time.
  double largest_eigenvalue = 0.0;
  // Largest |R(dt lambda)| of the modes that do not grow in exact integration.
  // A value above 1 means that steps are too long.
  double growth = 0.0;
  // Steps per sampling interval.
  int substeps = 1;
  double step = 0.0;  // step dt, in the model's unit of time
  bool stable = false;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_INTEGRATOR_H_
