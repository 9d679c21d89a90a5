// A network with a memory of its own, for devices of unknown law.

#ifndef PINODE_DYNAMICS_MEMORY_NETWORK_H_
#define PINODE_DYNAMICS_MEMORY_NETWORK_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/law.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Sizes of a network with memory.
struct MemoryNetworkShape {
  // Number of sliders in parallel. Each has one internal state, and all have
  // one more together.
  int sliders = 1;
  // Number of tanh units in the one hidden layer.
  int width = 6;
  // Typical deformation, rate and force, in the model's units. The internal
  // states and the weights are relative to these. 0: not known yet, taken as 1.
  double deformation = 0.0;
  double rate = 0.0;
  double force = 0.0;

  // Checks sizes and scales. On failure returns false, and *error says which
  // one is wrong.
  [[nodiscard]] bool IsValid(std::string* error) const;
  bool HasScales() const {
    return deformation > 0.0 && rate > 0.0 && force > 0.0;
  }
};

// Resisting force of a device with deformation d and rate w: m sliders behind
// springs in parallel, and a dashpot. A network decides how easily each slider
// slips. With x = d / deformation, y = w / rate, and time in units of
// deformation / rate:
//
//   force  = force scale * (sum_i k_i s_i + chi^2 y)
//   ds_i   = y - r_i s_i              elongation of spring i
//   de     = sum_i k_i r_i s_i^2      energy that the sliders dissipate
//   k_i    = softplus(kappa_i) / (1 + a_i^2 e)
//   r_i    = |y| softplus(c_i + V_i u) + t_i^2
//   u      = tanh(b + W [x, y / |y|, s_1 ... s_m, log(1 + e)])
//
// |y| is rounded near zero. The energy in the springs is
//
//   Psi = force scale * deformation * sum_i k_i s_i^2 / 2 >= 0.
//
// For all weights the work force * w minus dPsi/dt is not negative: each r_i
// and chi^2 is positive, and the springs only soften as e grows. The device
// therefore never gives more energy than it has taken up, beyond what its
// springs held at the start of the record (nothing at rest). The form is that
// of a material with internal variables (B. Halphen and Q. S. Nguyen 1975),
// with a network for the flow. Bouc-Wen's law with n = 1 is the case r = |y|
// times a function of the sign of y s.
//
// Parameters, in this order: kappa, a, t (m each), chi, b (width), W (width x
// (m + 3), by columns), c (m), V (m x width, by columns).
class MemoryNetwork final : public Law {
 public:
  // Largest sizes: the law's working memory is on the stack.
  static constexpr int kMostSliders = 4;
  static constexpr int kMostUnits = 32;

  // The shape must be valid.
  explicit MemoryNetwork(const MemoryNetworkShape& shape);

  // The shape as it was given.
  const MemoryNetworkShape& shape() const { return given_; }
  // The shape with the scales in use: those that were not known are 1.
  const MemoryNetworkShape& scaled_shape() const { return shape_; }
  int num_features() const override { return 2; }
  int num_internal() const override { return shape_.sliders + 1; }
  int num_parameters() const override;
  int num_outputs() const override { return 1; }

  void Evaluate(const double* features, const double* internal,
                const double* parameters, double* result) const override;
  void Evaluate(const WideJet* features, const WideJet* internal,
                const WideJet* parameters, WideJet* result) const override;
  void Linearize(const double* features, const double* internal,
                 const double* parameters, double* result,
                 double* jacobian) const override;

  // Returns the energy Psi in the springs.
  double StoredEnergy(const double* internal, const double* parameters) const;
  // Returns random weights; the same seed gives the same ones. The sliders
  // begin to slip at deformations about the scale, each at another one.
  Vector DrawWeights(std::uint64_t seed) const;

 private:
  MemoryNetworkShape given_;
  MemoryNetworkShape shape_;  // with all scales
};

// Describes a device of this shape as a term. Its force resists the deformation
// of `features`, a deformation and its rate, in a structure with num_dofs DOFs.
// Its `type` is kMemoryNetworkType. The weights are free parameters "<name>[i]"
// with Gaussian priors of mean zero and the deviation `prior_sigma`.
extern const char kMemoryNetworkType[];
LawTerm MakeMemoryNetwork(const std::string& name,
                          const MemoryNetworkShape& shape,
                          const std::vector<Feature>& features, int num_dofs,
                          const Vector& weights, double prior_sigma);

// Returns the network of a term, nullptr for any other law.
const MemoryNetwork* AsMemoryNetwork(const LawTerm& term);

// True if a law of `dynamics` is a network with memory.
// StructuralDynamics::networks() lists feed-forward networks alone.
bool HasMemoryNetwork(const StructuralDynamics& dynamics);
// True if one of them has free weights.
bool HasFreeMemoryNetwork(const StructuralDynamics& dynamics);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_MEMORY_NETWORK_H_
