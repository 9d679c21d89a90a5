#include "pinode/discover/network_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "pinode/network/network.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

// x'' = -4 x + w x with the network w x, w = -1, from x = 1; its displacement
// is measured.
class LinearNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    auto dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Identity(1, 1), Matrix::Zero(1, 1),
                            Matrix::Constant(1, 1, 4.0)),
        std::vector<InputSpec>());
    NetworkArchitecture architecture;
    architecture.num_inputs = 1;
    architecture.num_outputs = 1;
    architecture.bias = false;
    NetworkTerm term;
    term.name = "nn";
    term.network = std::make_shared<Network>(architecture);
    term.features = {Feature::Displacement(0)};
    term.outputs = Matrix::Identity(1, 1);
    term.output_names = {"u1"};
    term.weights.name = "nn";
    term.weights.named = false;
    term.weights.parameters.resize(1);
    term.weights.parameters[0].name = "nn[0]";
    term.weights.parameters[0].value = -1.0;
    ASSERT_TRUE(dynamics->AddNetwork(std::move(term), &error_)) << error_;
    problem_.dynamics = dynamics;
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, 0.05, Matrix(0, 81), Interpolation::kLinear);
    record.substeps = 2;
    record.start = IdentificationRecord::Start::kKnown;
    record.known_start = Vector::Unit(2, 0);
    MeasuredChannel channel;
    channel.observation.weights = Vector::Ones(1);
    channel.values = Vector::Zero(81);
    record.channels = {channel};
    problem_.records = {record};
    const ParameterLayout layout(problem_);
    model_.parameters = layout.InitialValues();
    model_.starts = {record.known_start};
    model_.sigmas = {Vector::Constant(1, 0.01)};
    model_.decays = Vector::Constant(layout.num_decay_groups(), 1e-12);
    ASSERT_TRUE(SampleTrajectories(problem_, model_, &samples_, &error_))
        << error_;
  }

  IdentificationProblem problem_;
  IdentifiedModel model_;
  TrajectorySamples samples_;
  std::string error_;
};

// sigma_y = |x| sigma_w, and sigma_w is as large as the noise.
TEST_F(LinearNetwork, OutputIsAsUncertainAsItsWeight) {
  const Matrix sigma = NetworkUncertainty(problem_, model_, samples_)[0];
  ASSERT_EQ(sigma.rows(), 1);
  ASSERT_EQ(sigma.cols(), 81);
  EXPECT_GT(sigma(0, 0), 0.0);
  for (int i = 0; i < 81; ++i) {
    ASSERT_NEAR(sigma(0, i), std::abs(samples_.states(0, 2 * i)) * sigma(0, 0),
                1e-9 * sigma(0, 0));
  }
  model_.sigmas[0] *= 2.0;
  const Matrix twice = NetworkUncertainty(problem_, model_, samples_)[0];
  EXPECT_NEAR(twice(0, 0), 2.0 * sigma(0, 0), 1e-6 * sigma(0, 0));
}

TEST_F(LinearNetwork, NothingIsSaidWithoutNoiseLevels) {
  model_.sigmas.clear();
  const std::vector<Matrix> sigma =
      NetworkUncertainty(problem_, model_, samples_);
  ASSERT_EQ(sigma.size(), 1u);
  EXPECT_EQ(sigma[0], Matrix(Matrix::Zero(1, 81)));
}

}  // namespace
}  // namespace pinode
