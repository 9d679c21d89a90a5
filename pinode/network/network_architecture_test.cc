#include "pinode/network/network_architecture.h"

#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// The network of the four-degree-of-freedom example, eq. (14).
NetworkArchitecture PaperNetwork() {
  NetworkArchitecture architecture;
  architecture.num_inputs = 8;
  architecture.num_outputs = 4;
  architecture.hidden_widths = {30};
  return architecture;
}

TEST(NetworkArchitecture, LaysOutTheWeightsInTheDocumentedOrder) {
  const WeightLayout layout = PaperNetwork().Layout();
  ASSERT_EQ(layout.num_layers(), 2);
  EXPECT_EQ(layout.weights[0].offset, 0);
  EXPECT_EQ(layout.weights[0].rows, 30);
  EXPECT_EQ(layout.weights[0].cols, 8);
  EXPECT_EQ(layout.biases[0].offset, 240);
  EXPECT_EQ(layout.biases[0].size(), 30);
  EXPECT_EQ(layout.weights[1].offset, 270);
  EXPECT_EQ(layout.weights[1].size(), 120);
  EXPECT_EQ(layout.biases[1].offset, 390);
  EXPECT_EQ(layout.biases[1].size(), 4);
  EXPECT_EQ(layout.skip.offset, 394);
  EXPECT_EQ(layout.skip.rows, 4);
  EXPECT_EQ(layout.skip.cols, 8);
  EXPECT_EQ(layout.size, 426);
}

TEST(NetworkArchitecture, CountsWeights) {
  NetworkArchitecture architecture = PaperNetwork();
  EXPECT_EQ(architecture.NumWeights(), 426);
  architecture.skip = false;
  EXPECT_EQ(architecture.NumWeights(), 394);
  architecture.gauge = true;  // No output bias.
  EXPECT_EQ(architecture.NumWeights(), 390);
  architecture.bias = false;
  EXPECT_EQ(architecture.NumWeights(), 360);
  architecture = PaperNetwork();
  architecture.hidden_widths = {};  // A skip path would be W_1 again.
  EXPECT_EQ(architecture.NumWeights(), 36);
}

TEST(NetworkArchitecture, DecayLeavesTheLinearPathAndTheOutputBiasAlone) {
  NetworkArchitecture architecture = PaperNetwork();
  const std::vector<bool> nonlinear = architecture.NonlinearWeights();
  ASSERT_EQ(nonlinear.size(), 426u);
  for (int i = 0; i < 426; ++i) EXPECT_EQ(nonlinear[i], i < 390) << i;

  architecture.skip = false;
  architecture.gauge = true;
  EXPECT_EQ(architecture.NonlinearWeights(), std::vector<bool>(390, true));

  architecture.gauge = false;
  architecture.hidden_widths = {};
  EXPECT_EQ(architecture.NonlinearWeights(), std::vector<bool>(36, false));
}

TEST(NetworkArchitecture, RefusesWhatMakesNoSense) {
  struct Case {
    void (*spoil)(NetworkArchitecture*);
    const char* expected;
  };
  const Case kCases[] = {
      {[](NetworkArchitecture* a) { a->num_inputs = 0; }, "num_inputs is 0"},
      {[](NetworkArchitecture* a) { a->num_outputs = -1; },
       "num_outputs is -1"},
      {[](NetworkArchitecture* a) {
         a->hidden_widths = {3, 0};
       },
       "width 0"},
      {[](NetworkArchitecture* a) { a->input_scale = Vector::Ones(3); },
       "input_scale has 3 entries"},
      {[](NetworkArchitecture* a) {
         a->input_scale = Vector::Ones(8);
         a->input_scale[5] = 0.0;
       },
       "input_scale[5]"},
      {[](NetworkArchitecture* a) { a->output_scale = Vector::Ones(7); },
       "output_scale has 7 entries"},
      {[](NetworkArchitecture* a) {
         a->output_scale = Vector::Constant(a->num_outputs, -1.0);
       },
       "output_scale[0] is -1"},
      {[](NetworkArchitecture* a) {
         a->input_scale =
             Vector::Constant(8, std::numeric_limits<double>::quiet_NaN());
       },
       "input_scale[0] is nan"},
      {[](NetworkArchitecture* a) { a->gauge = true; }, "skip = false"},
      {[](NetworkArchitecture* a) {
         a->gauge = true;
         a->skip = false;
         a->hidden_widths = {};
       },
       "at least one hidden layer"},
      {[](NetworkArchitecture* a) { a->hidden_widths = {2000000000}; },
       "smaller network"},
  };
  std::string error;
  ASSERT_TRUE(PaperNetwork().IsValid(&error)) << error;
  for (const Case& c : kCases) {
    NetworkArchitecture architecture = PaperNetwork();
    c.spoil(&architecture);
    EXPECT_FALSE(architecture.IsValid(&error)) << c.expected;
    EXPECT_THAT(error, HasSubstr(c.expected));
  }
}

TEST(NetworkArchitecture, LinearPartIsInTheFeaturesUnits) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 2;
  architecture.num_outputs = 2;
  architecture.input_scale = Vector(2);
  architecture.input_scale << 2.0, 10.0;
  Vector weights(6);
  weights << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  Matrix expected(2, 2);
  expected << 0.5, 0.3, 1.0, 0.4;
  EXPECT_TRUE(LinearPart(architecture, weights).isApprox(expected, 1e-15));
  EXPECT_EQ(ConstantPart(architecture, weights), Vector(weights.tail(2)));

  architecture.bias = false;
  EXPECT_EQ(ConstantPart(architecture, weights.head(4)), Vector::Zero(2));

  // With hidden layers only the skip path is folded into the model.
  architecture.hidden_widths = {3};
  ASSERT_EQ(architecture.NumWeights(), 16);
  Vector more = Vector::Constant(16, 99.0);
  more.tail(4) = weights.head(4);
  EXPECT_TRUE(LinearPart(architecture, more).isApprox(expected, 1e-15));
  architecture.skip = false;
  EXPECT_EQ(LinearPart(architecture, more.head(12)), Matrix::Zero(2, 2));
}

TEST(NetworkArchitecture, LinearPartIsInTheOutputsUnits) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 1;
  architecture.num_outputs = 2;
  architecture.output_scale = Vector(2);
  architecture.output_scale << 100.0, 0.5;
  Vector weights(4);
  weights << 1.0, 2.0, 3.0, 4.0;
  EXPECT_EQ(LinearPart(architecture, weights),
            Matrix(Eigen::Vector2d(100.0, 1.0)));
  EXPECT_EQ(ConstantPart(architecture, weights),
            Vector(Eigen::Vector2d(300.0, 2.0)));
}

}  // namespace
}  // namespace pinode
