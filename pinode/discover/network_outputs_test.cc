#include "pinode/discover/network_outputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "pinode/network/network.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr int kNumOutputSamples = 301;
constexpr double kOutputStep = 0.02;

// 2 x'' = -8 x + 2 y with networks for y, each of one weight -1 on x.
class OutputsOfNetworks : public ::testing::Test {
 protected:
  void MakeProblem(int num_networks) {
    auto dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Constant(1, 1, 2.0), Matrix::Zero(1, 1),
                            Matrix::Constant(1, 1, 8.0)),
        std::vector<InputSpec>());
    for (int j = 0; j < num_networks; ++j) {
      NetworkArchitecture architecture;
      architecture.num_inputs = 1;
      architecture.num_outputs = 1;
      architecture.bias = false;
      NetworkTerm term;
      term.name = "nn" + std::to_string(j);
      term.network = std::make_shared<Network>(architecture);
      term.features = {Feature::Displacement(0)};
      term.outputs = Matrix::Identity(1, 1);
      term.output_names = {"u1"};
      term.weights.name = term.name;
      term.weights.named = false;
      term.weights.parameters.resize(1);
      term.weights.parameters[0].name = term.name + "[0]";
      term.weights.parameters[0].value = -1.0;
      ASSERT_TRUE(dynamics->AddNetwork(std::move(term), &error_)) << error_;
    }
    problem_.dynamics = dynamics;
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, kOutputStep, Matrix(0, kNumOutputSamples),
                              Interpolation::kLinear);
    record.substeps = 1;
    MeasuredChannel channel;
    channel.observation.weights = Vector::Ones(1);
    channel.values.resize(kNumOutputSamples);
    for (int i = 0; i < kNumOutputSamples; ++i) {
      channel.values[i] = Motion(kOutputStep * i);
    }
    record.channels = {channel};
    problem_.records = {record};
  }

  static double Motion(double t) {
    return 3.0 * std::sin(2.0 * t) + 0.5 * std::cos(7.0 * t);
  }

  IdentificationProblem problem_;
  NetworkOutputs outputs_;
  IdentifiedModel model_;
  std::string error_;
};

TEST_F(OutputsOfNetworks, TrainedOnesAlongTheFreeRun) {
  MakeProblem(1);
  model_.parameters = ParameterLayout(problem_).InitialValues();
  model_.starts = {Vector::Unit(2, 0)};
  ASSERT_TRUE(OutputsOfTrainedNetworks(problem_, model_, &outputs_, &error_))
      << error_;
  EXPECT_EQ(outputs_.samples.num_samples(), kNumOutputSamples);
  EXPECT_EQ(outputs_.outputs[0],
            Matrix(-outputs_.samples.states.row(0).transpose()));
  EXPECT_EQ(outputs_.uncertainty[0][0], 0.0);  // no noise levels in the model
  EXPECT_EQ(outputs_.mass(0, 0), 2.0);
}

// x'' + 4 x is what the stiffness leaves, whatever the weights of the network.
TEST_F(OutputsOfNetworks, MissingInTheRecords) {
  MakeProblem(1);
  ASSERT_TRUE(OutputsFromRecords(problem_, &outputs_, &model_, &error_))
      << error_;
  EXPECT_GT(outputs_.samples.num_samples(), kNumOutputSamples - 40);
  EXPECT_LT(outputs_.samples.num_samples(), kNumOutputSamples);
  for (int i = 0; i < outputs_.samples.num_samples(); ++i) {
    ASSERT_NEAR(outputs_.outputs[0](i, 0),
                0.5 * (4.0 - 49.0) * std::cos(7.0 * outputs_.samples.times[i]),
                0.1);
  }
  EXPECT_GT(outputs_.uncertainty[0][0], 0.0);
  EXPECT_LT(outputs_.uncertainty[0][0], 0.1);
  EXPECT_NEAR(model_.starts[0][0], Motion(0.0), 1e-2);
  EXPECT_NEAR(model_.starts[0][1], 6.0, 0.1);
  EXPECT_GT(model_.sigmas[0][0], 0.0);
}

TEST_F(OutputsOfNetworks, AccelerationsMustTellThemApart) {
  MakeProblem(2);
  EXPECT_FALSE(OutputsFromRecords(problem_, &outputs_, &model_, &error_));
  EXPECT_THAT(error_, HasSubstr("the networks have 2 outputs, but"));
}

}  // namespace
}  // namespace pinode
