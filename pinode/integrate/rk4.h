// One step of the classical Runge-Kutta method on any scalar.

#ifndef PINODE_INTEGRATE_RK4_H_
#define PINODE_INTEGRATE_RK4_H_

#include <cstddef>
#include <vector>

namespace pinode {

// Working memory of Rk4Step.
template <typename T>
struct Rk4Scratch {
  explicit Rk4Scratch(int num_states)
      : k1(static_cast<std::size_t>(num_states)),
        k2(k1),
        k3(k1),
        k4(k1),
        stage(k1) {}
  std::vector<T> k1, k2, k3, k4, stage;  // num_states each
};

// Performs one step of the classical scheme of order four,
//
//    0  |
//   1/2 | 1/2
//   1/2 |  0   1/2
//    1  |  0    0    1
//   ----+--------------------
//       | 1/6  1/3  1/3  1/6
//
// in place on state (num_states entries). rate(node, time, state, rate)
// computes dh/dt. node is 0, 1 or 2 for the beginning, the middle and the end
// of the step. Inputs that jump at samples can thus be taken from the right
// side.
template <typename T, typename RateFunction>
void Rk4Step(const RateFunction& rate, double time, double dt, T* state,
             Rk4Scratch<T>* scratch) {
  const std::size_t n = scratch->k1.size();
  T* stage = scratch->stage.data();
  const auto move = [&](double step, const std::vector<T>& k) {
    for (std::size_t i = 0; i < n; ++i) stage[i] = state[i] + step * k[i];
  };
  rate(0, time, state, scratch->k1.data());
  move(0.5 * dt, scratch->k1);
  rate(1, time + 0.5 * dt, stage, scratch->k2.data());
  move(0.5 * dt, scratch->k2);
  rate(1, time + 0.5 * dt, stage, scratch->k3.data());
  move(dt, scratch->k3);
  rate(2, time + dt, stage, scratch->k4.data());
  for (std::size_t i = 0; i < n; ++i) {
    state[i] += dt / 6.0 *
                (scratch->k1[i] + 2.0 * scratch->k2[i] + 2.0 * scratch->k3[i] +
                 scratch->k4[i]);
  }
}

}  // namespace pinode

#endif  // PINODE_INTEGRATE_RK4_H_
