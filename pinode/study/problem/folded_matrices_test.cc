#include "pinode/study/problem/folded_matrices.h"

#include <memory>
#include <string>

#include "gtest/gtest.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

TEST(FoldedMatricesTest, AreTheJacobianOfALinearNetwork) {
  for (const auto acts_as :
       {NetworkTerm::ActsAs::kAcceleration, NetworkTerm::ActsAs::kForce}) {
    const Matrix mass = Vector(Eigen::Vector2d(2.0, 1.0)).asDiagonal();
    const Matrix stiffness =
        (Matrix(2, 2) << 300.0, -100.0, -100.0, 100.0).finished();
    StructuralDynamics dynamics(
        MakeStructuralModel(mass, 0.01 * stiffness, stiffness), {});
    NetworkArchitecture architecture;
    architecture.num_inputs = 3;
    architecture.num_outputs = 1;
    architecture.input_scale = Vector(Eigen::Vector3d(0.5, 2.0, 4.0));
    NetworkTerm term;
    term.name = "nn";
    term.network = std::make_shared<Network>(architecture);
    term.features = {Feature::Displacement(0), Feature::Deformation(0, 1),
                     Feature::Velocity(1)};
    term.outputs = Vector(Eigen::Vector2d(0.0, 1.0));
    term.output_names = {"u2"};
    term.acts_as = acts_as;
    term.weights.name = "nn";
    for (int i = 0; i < architecture.NumWeights(); ++i) {
      Parameter weight;
      weight.name = "w";
      weight.value = 0.3 + 0.1 * i;
      term.weights.parameters.push_back(weight);
    }
    std::string error;
    ASSERT_TRUE(dynamics.AddNetwork(term, &error)) << error;
    const Vector theta = dynamics.Parameters();
    const FoldedMatrices folded = FoldNetworks(dynamics, theta);
    EXPECT_TRUE(folded.any);
    EXPECT_TRUE(folded.complete);
    StructuralDynamics::Prepared prepared;
    ASSERT_TRUE(dynamics.Prepare(theta, &prepared, &error)) << error;
    auto stage = dynamics.MakeLinearization();
    const Vector state = Vector::Constant(4, 0.3);
    dynamics.Linearize(prepared, 0.0, nullptr, state.data(), &stage);
    EXPECT_LT((-mass * stage.jacobian.bottomLeftCorner(2, 2) - folded.stiffness)
                  .norm(),
              1e-10);
    EXPECT_LT((-mass * stage.jacobian.bottomRightCorner(2, 2) - folded.damping)
                  .norm(),
              1e-10);
    EXPECT_GT((folded.stiffness - stiffness).norm(), 0.1);
  }
}

}  // namespace
}  // namespace pinode
