#include "pinode/study/problem/folded_matrices.h"

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Returns the offset of the network's block: blocks are groups, laws and
// networks.
int NetworkOffset(const StructuralDynamics& dynamics, size_t network) {
  const size_t first = dynamics.blocks().size() - dynamics.networks().size();
  return dynamics.block_offset(static_cast<int>(first + network));
}

}  // namespace

FoldedMatrices FoldNetworks(const StructuralDynamics& dynamics,
                            const Vector& theta) {
  CHECK_EQ(theta.size(), dynamics.num_parameters());
  const int n = dynamics.num_dofs();
  const StructuralModel model = dynamics.CorrectedModel(theta);
  FoldedMatrices folded;
  folded.stiffness = model.stiffness;
  folded.damping = model.damping;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    const NetworkArchitecture& architecture = term.network->architecture();
    folded.complete = folded.complete && architecture.IsLinear();
    if (!architecture.IsLinear() && !architecture.HasSkipPath()) continue;
    folded.any = true;
    const Matrix linear = LinearPart(
        architecture,
        theta.segment(NetworkOffset(dynamics, j), term.weights.size()));
    Matrix of_displacement = Matrix::Zero(architecture.num_inputs, n);
    Matrix of_velocity = Matrix::Zero(architecture.num_inputs, n);
    for (int i = 0; i < architecture.num_inputs; ++i) {
      const Feature& feature = term.features[static_cast<size_t>(i)];
      if (feature.OnDisplacement())
        of_displacement.row(i) = feature.Selector(n);
      if (feature.OnVelocity()) of_velocity.row(i) = feature.Selector(n);
    }
    const Matrix force = term.acts_as == NetworkTerm::ActsAs::kForce
                             ? Matrix(term.outputs * linear)
                             : Matrix(-model.mass * term.outputs * linear);
    folded.stiffness += force * of_displacement;
    folded.damping += force * of_velocity;
  }
  return folded;
}

}  // namespace pinode
