#include "pinode/problem/parameter_layout.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

TEST(ParameterLayout, MapsFreeAndFixed) {
  testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const ParameterLayout& layout = *fit.layout;
  const StructuralDynamics& dynamics = *fit.problem.dynamics;
  ASSERT_EQ(layout.num_dynamics(), dynamics.num_parameters());
  ASSERT_EQ(layout.num_parameters(), dynamics.num_parameters() + 3);
  // The mass group, the exponent and the factor of the shape are fixed.
  EXPECT_EQ(layout.num_free(), layout.num_parameters() - 3);
  EXPECT_EQ(layout.num_free_dynamics(), layout.num_dynamics() - 3);
  std::set<std::string> fixed;
  int expected = 0;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (layout.parameter(i).free) {
      EXPECT_EQ(layout.FreeIndex(i), expected);
      EXPECT_EQ(layout.free()[static_cast<size_t>(expected)], i);
      ++expected;
    } else {
      EXPECT_EQ(layout.FreeIndex(i), -1);
      fixed.insert(layout.parameter(i).name);
    }
    EXPECT_EQ(layout.IsNamed(i),
              layout.parameter(i).name.substr(0, 4) != "net[");
  }
  EXPECT_EQ(fixed, (std::set<std::string>{"m2", "slip.n", "slip.beta"}));
  // Each tangent column belongs to its free parameter.
  ASSERT_EQ(layout.num_free_dynamics(), dynamics.num_tangent_columns());
  for (int j = 0; j < layout.num_free_dynamics(); ++j) {
    EXPECT_EQ(dynamics.tangent_columns()[static_cast<size_t>(j)],
              layout.free()[static_cast<size_t>(j)]);
  }

  const Vector all = layout.InitialValues();
  EXPECT_EQ(all.head(layout.num_dynamics()), dynamics.Parameters());
  EXPECT_EQ(all[layout.num_dynamics()], 1.1);
  Vector changed = all;
  const Vector values = Vector::LinSpaced(layout.num_free(), 1.0, 2.0);
  layout.SetFree(values, &changed);
  EXPECT_EQ(layout.Free(changed), values);
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (layout.FreeIndex(i) < 0) {
      EXPECT_EQ(changed[i], all[i]);
    }
  }
}

// Two inputs, two hidden layers of two and three, two outputs.
TEST(ParameterLayout, GroupsTheWeightsThatDecayTogether) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(2, 10.0, 0.1), std::vector<InputSpec>{});
  const auto add_network = [&](const std::string& name,
                               const std::vector<int>& widths, bool bias) {
    NetworkArchitecture architecture;
    architecture.num_inputs = 2;
    architecture.num_outputs = 2;
    architecture.hidden_widths = widths;
    architecture.bias = bias;
    NetworkTerm term;
    term.name = name;
    term.network = std::make_shared<Network>(architecture);
    term.features = {Feature::Displacement(0), Feature::Velocity(1)};
    term.outputs = Matrix::Identity(2, 2);
    term.weights.name = name;
    term.weights.named = false;
    term.weights.decays = architecture.NonlinearWeights();
    term.weights.parameters.resize(
        static_cast<size_t>(architecture.NumWeights()));
    for (size_t i = 0; i < term.weights.parameters.size(); ++i) {
      term.weights.parameters[i].name = name + "[" + std::to_string(i) + "]";
    }
    std::string error;
    ASSERT_TRUE(dynamics->AddNetwork(std::move(term), &error)) << error;
  };
  add_network("deep", {2, 3}, true);
  add_network("linear", {}, true);
  add_network("plain", {4}, false);
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  const ParameterLayout layout(problem);

  std::map<std::string, int> sizes;
  std::vector<bool> grouped;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    const int group = layout.DecayGroupOf(i);
    grouped.push_back(group >= 0);
    if (group >= 0) {
      const auto& entry = layout.decay_groups()[static_cast<size_t>(group)];
      ++sizes[entry.name];
      EXPECT_EQ(entry.network, entry.name.substr(0, 4) == "deep" ? 0 : 2);
    }
  }
  EXPECT_EQ(sizes, (std::map<std::string, int>{{"deep, input 1", 2},
                                               {"deep, input 2", 2},
                                               {"deep, layer 2", 6},
                                               {"deep, output 1", 3},
                                               {"deep, output 2", 3},
                                               {"deep, biases", 5},
                                               {"plain, input 1", 4},
                                               {"plain, input 2", 4},
                                               {"plain, output 1", 4},
                                               {"plain, output 2", 4}}));
  // Parameters decay if the networks allow it.
  std::vector<bool> expected;
  for (const NetworkTerm& term : dynamics->networks()) {
    expected.insert(expected.end(), term.weights.decays.begin(),
                    term.weights.decays.end());
  }
  EXPECT_EQ(grouped, expected);
  // W_1 of the deep network is column-major: its first column is input 1.
  EXPECT_EQ(layout.DecayGroupOf(0), layout.DecayGroupOf(1));
  EXPECT_NE(layout.DecayGroupOf(1), layout.DecayGroupOf(2));
  // W_3 has its outputs along rows.
  const int last = dynamics->networks()[0].network->layout().weights[2].offset;
  EXPECT_EQ(layout.DecayGroupOf(last), layout.DecayGroupOf(last + 2));
  EXPECT_NE(layout.DecayGroupOf(last), layout.DecayGroupOf(last + 1));
}

}  // namespace
}  // namespace pinode
