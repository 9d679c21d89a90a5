// The plain way: the equation of motion as a functor on any scalar, to be
// differentiated through all its steps by ceres::DynamicAutoDiffCostFunction.
//
// Written for speed as far as a functor allows: sizes known at compile time,
// nothing on the heap, springs instead of a matrix, each weight read once.

#ifndef PINODE_TESTS_BENCHMARKS_PLAIN_CHAIN_H_
#define PINODE_TESTS_BENCHMARKS_PLAIN_CHAIN_H_

#include <array>
#include <cmath>

#include "pinode/base/types.h"
#include "pinode/integrate/integration_grid.h"

namespace pinode {
namespace benchmarks {

// A chain of kDofs unit masses, held at the ground, a spring a link and a
// damper between each mass and the ground, with a tanh network 8-30-4 from x
// and v of the first four DOFs to their accelerations, and a force on the first
// DOF where the grid has an input. State [x; v]. Parameters, in this order:
// with kGroups the fractional changes of the springs and of the dampers; the
// network's weights in the order of WeightLayout, with W_skip where kSkip.
template <int kDofs, bool kGroups, bool kSkip>
class PlainChain {
 public:
  static constexpr int kStates = 2 * kDofs;
  static constexpr int kInputs = 8;
  static constexpr int kHidden = 30;
  static constexpr int kOutputs = 4;
  static constexpr int kGroupParameters = kGroups ? 2 * kDofs : 0;
  static constexpr int kWeights = kHidden * (kInputs + 1) +
                                  kOutputs * (kHidden + 1) +
                                  (kSkip ? kOutputs * kInputs : 0);
  static constexpr int kParameters = kGroupParameters + kWeights;

  // `stiffness` of every link, `damping` of every mass; the network's scales
  // are those of `architecture`. `grid` must outlive this object.
  PlainChain(double stiffness, double damping,
             const NetworkArchitecture& architecture,
             const IntegrationGrid* grid)
      : stiffness_(stiffness), damping_(damping), grid_(grid) {
    inverse_scale_.fill(1.0);
    output_scale_.fill(1.0);
    const Vector& input = architecture.input_scale;
    for (int i = 0; i < input.size(); ++i) inverse_scale_[i] = 1.0 / input[i];
    const Vector& output = architecture.output_scale;
    for (int o = 0; o < output.size(); ++o) output_scale_[o] = output[o];
  }

  // Runge-Kutta steps from `start` at sample `first` to sample `last`; writes
  // the states at the samples first ... last, one after the other.
  template <typename T>
  void Propagate(const T* start, const T* parameters, int first, int last,
                 T* states) const {
    const double dt = grid_->step();
    std::array<T, kStates> h, k1, k2, k3, k4, stage;
    for (int j = 0; j < kStates; ++j) states[j] = h[j] = start[j];
    for (int i = first; i < last; ++i) {
      for (int s = 0; s < grid_->substeps(); ++s) {
        Rate(Force(i, s, 0), h.data(), parameters, k1.data());
        for (int j = 0; j < kStates; ++j) stage[j] = h[j] + 0.5 * dt * k1[j];
        Rate(Force(i, s, 1), stage.data(), parameters, k2.data());
        for (int j = 0; j < kStates; ++j) stage[j] = h[j] + 0.5 * dt * k2[j];
        Rate(Force(i, s, 1), stage.data(), parameters, k3.data());
        for (int j = 0; j < kStates; ++j) stage[j] = h[j] + dt * k3[j];
        Rate(Force(i, s, 2), stage.data(), parameters, k4.data());
        for (int j = 0; j < kStates; ++j) {
          h[j] += dt / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
        }
      }
      states += kStates;
      for (int j = 0; j < kStates; ++j) states[j] = h[j];
    }
  }

 private:
  double Force(int interval, int substep, int node) const {
    return grid_->num_inputs() > 0 ? *grid_->AtNode(interval, substep, node)
                                   : 0.0;
  }

  template <typename T>
  void Rate(double force, const T* h, const T* parameters, T* rate) const {
    const T* x = h;
    const T* v = h + kDofs;
    T* a = rate + kDofs;
    // The spring of each link pulls at both its ends.
    for (int i = 0; i < kDofs; ++i) {
      rate[i] = v[i];
      T elastic = stiffness_ * (i == 0 ? x[i] : x[i] - x[i - 1]);
      T viscous = damping_ * v[i];
      if constexpr (kGroups) {
        elastic *= 1.0 + parameters[i];
        viscous *= 1.0 + parameters[kDofs + i];
      }
      a[i] = -(elastic + viscous);
      if (i > 0) a[i - 1] += elastic;
    }
    a[0] += force;
    AddNetwork(x, v, parameters + kGroupParameters, a);
  }

  template <typename T>
  void AddNetwork(const T* x, const T* v, const T* weights, T* a) const {
    using std::tanh;
    std::array<T, kInputs> q;
    for (int j = 0; j < 4; ++j) {
      q[j] = x[j] * inverse_scale_[j];
      q[4 + j] = v[j] * inverse_scale_[4 + j];
    }
    const T* w1 = weights;
    const T* b1 = w1 + kHidden * kInputs;
    const T* w2 = b1 + kHidden;
    const T* b2 = w2 + kOutputs * kHidden;
    std::array<T, kOutputs> sum;
    for (int o = 0; o < kOutputs; ++o) sum[o] = b2[o];
    for (int i = 0; i < kHidden; ++i) {
      T z = b1[i];
      for (int j = 0; j < kInputs; ++j) z += w1[j * kHidden + i] * q[j];
      const T activation = tanh(z);
      for (int o = 0; o < kOutputs; ++o) {
        sum[o] += w2[i * kOutputs + o] * activation;
      }
    }
    if constexpr (kSkip) {
      const T* skip = b2 + kOutputs;
      for (int j = 0; j < kInputs; ++j) {
        for (int o = 0; o < kOutputs; ++o) {
          sum[o] += skip[j * kOutputs + o] * q[j];
        }
      }
    }
    for (int o = 0; o < kOutputs; ++o) a[o] += output_scale_[o] * sum[o];
  }

  double stiffness_;
  double damping_;
  std::array<double, kInputs> inverse_scale_;
  std::array<double, kOutputs> output_scale_;
  const IntegrationGrid* grid_;
};

}  // namespace benchmarks
}  // namespace pinode

#endif  // PINODE_TESTS_BENCHMARKS_PLAIN_CHAIN_H_
