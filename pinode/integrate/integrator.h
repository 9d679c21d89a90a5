// How motion is integrated: methods, derivatives, stability of the steps.

#ifndef PINODE_INTEGRATE_INTEGRATOR_H_
#define PINODE_INTEGRATE_INTEGRATOR_H_

namespace pinode {

// How a state is taken from one sample to the next.
enum class Integrator {
  kRungeKutta,  // classical steps of fourth order
  kExact,  // linear dynamics with constant matrices: no error but that of a
           // polynomial for the inputs between two samples
  kExponential,  // exact for the linear part of dynamics with laws at a few
                 // DOFs, see ExponentialStep
};

// "rk4", "exact" or "exponential".
const char* IntegratorName(Integrator integrator);

// How the derivatives of a segment are computed. Both give the derivative of
// the discrete steps and agree up to rounding.
enum class DerivativeMethod {
  kTangents,  // TangentStep: laws by narrow Jets, networks by hand;
              // LinearSegment where the dynamics are linear
  kJets,      // the step on wide Jets through the whole segment; only
              // Runge-Kutta has it
};

// RK4 is stable where |R(z)| <= 1, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 (E.
// Hairer and G. Wanner, Solving Ordinary Differential Equations II, IV.2).
struct StabilityReport {
  // max |lambda| of the linearised state matrix, rad/s (1/s).
  double largest_eigenvalue = 0.0;
  // Largest growth factor max |R(dt lambda)| over the modes that should not
  // grow; 1 is the limit.
  double growth = 0.0;
  int substeps = 1;
  double step = 0.0;  // s
  bool stable = false;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_INTEGRATOR_H_
