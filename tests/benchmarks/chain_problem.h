// Synthetic chains of any length, with records of any length.

#ifndef PINODE_TESTS_BENCHMARKS_CHAIN_PROBLEM_H_
#define PINODE_TESTS_BENCHMARKS_CHAIN_PROBLEM_H_

#include <memory>

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {
namespace benchmarks {

// Of the spring of every link and of the damper between every mass and the
// ground, in the model (N/m, N s/m; masses are 1 kg).
inline constexpr double kStiffness = 10.0;
inline constexpr double kDamping = 0.5;

// The model that PlainChain writes out: `num_dofs` unit masses, a tanh network
// 8-30-4 without skip path as accelerations of the first four DOFs, with
// `groups` also one correction per spring and per damper, with `force` an input
// on the first DOF. The network's weights are seeded and not zero.
std::unique_ptr<StructuralDynamics> MakeChain(int num_dofs, bool groups,
                                              bool force);

// That chain, with a force, and one training record of it: the full state at
// 20 Hz under a sum of sines, noise of 1 % in each channel, of known sigma. In
// truth there is a cubic spring at the first DOF, and with `groups` springs and
// dampers are 5 % off.
IdentificationProblem MakeChainProblem(int num_dofs, bool groups,
                                       int num_samples);

}  // namespace benchmarks
}  // namespace pinode

#endif  // PINODE_TESTS_BENCHMARKS_CHAIN_PROBLEM_H_
