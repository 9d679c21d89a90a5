#include "pinode/case/sections/memory_network_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pinode/base/strings.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

const char kDevice[] = R"toml([[network]]
name = "device"
inputs = ["x[u1]", "v[u1]"]
outputs = ["u1"]
memory = 2
layers = [3]
output_scale = [5.0]
)toml";

class MemoryNetworkSection : public SectionInSmallCase {
 protected:
  MemoryNetworkSection() : SectionInSmallCase(kDevice) {}
};

TEST_F(MemoryNetworkSection, AddsALawAndItsScales) {
  Case c;
  ASSERT_TRUE(Read(kDevice, &c)) << error_;
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  ASSERT_EQ(dynamics.laws().size(), 1u);
  EXPECT_TRUE(dynamics.networks().empty());
  const LawTerm& term = dynamics.laws()[0];
  const MemoryNetwork* network = AsMemoryNetwork(term);
  ASSERT_NE(network, nullptr);
  EXPECT_EQ(network->shape().sliders, 2);
  EXPECT_EQ(network->shape().width, 3);
  EXPECT_EQ(network->shape().force, 5.0);
  EXPECT_GT(network->shape().deformation, 0.0);
  EXPECT_GT(network->shape().rate, 0.0);
  EXPECT_EQ(dynamics.num_internal(), 3);
  EXPECT_EQ(term.parameters.Values(), network->DrawWeights(c.options.seed));
  EXPECT_NEAR(term.parameters.parameters[0].prior_sigma, std::sqrt(10.0),
              1e-12);
}

TEST_F(MemoryNetworkSection, ModelCaseReadsBack) {
  Case c;
  ASSERT_TRUE(Read(kDevice, &c)) << error_;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  const int first = c.problem.dynamics->block_offset(1);  // after the groups
  model.parameters[first] += 0.25;
  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  const LawTerm& before = c.problem.dynamics->laws()[0];
  const LawTerm& after = again.problem.dynamics->laws()[0];
  EXPECT_EQ(AsMemoryNetwork(after)->shape().deformation,
            AsMemoryNetwork(before)->shape().deformation);
  EXPECT_EQ(AsMemoryNetwork(after)->shape().rate,
            AsMemoryNetwork(before)->shape().rate);
  EXPECT_EQ(after.parameters.Values(),
            Vector(model.parameters.segment(first, before.parameters.size())));
}

// Neither scale is known then.
TEST_F(MemoryNetworkSection, ModelCaseWithoutMotionReadsBack) {
  std::string still = "t,ag,a1,d2\n";
  for (int i = 0; i < 200; ++i) still += FormatNumber(0.01 * i, 6) + ",0,0,0\n";
  folder_.Write("quake.csv", still);
  const std::string device = Replaced(kDevice, "output_scale = [5.0]\n", "");
  std::string text =
      Replaced(SmallCase(), "[[record]]\n", device + "[[record]]\n");
  for (const std::string column : {"\"a1\"\n", "\"d2\"\n"}) {
    text = Replaced(text, column, column + "  sigma = 0.1\n");
  }
  Case c;
  ASSERT_TRUE(ReadCase(folder_.Write("case.toml", text), &c, &error_))
      << error_;
  const LawTerm& before = c.problem.dynamics->laws()[0];
  ASSERT_FALSE(AsMemoryNetwork(before)->shape().HasScales());
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  const LawTerm& after = again.problem.dynamics->laws()[0];
  const double point[] = {0.3, -0.2};
  const double internal[] = {0.1, 0.2, 0.05};
  const Vector weights = after.parameters.Values();
  EXPECT_EQ(weights, before.parameters.Values());
  Vector forces[2] = {Vector(4), Vector(4)};
  before.law->Evaluate(point, internal, weights.data(), forces[0].data());
  after.law->Evaluate(point, internal, weights.data(), forces[1].data());
  EXPECT_EQ(forces[0], forces[1]);
}

TEST_F(MemoryNetworkSection, ModelCaseWithOtherTermsReadsBack) {
  Case c;
  ASSERT_TRUE(Read(std::string(kDevice) + R"toml([[network]]
name = "nn"
inputs = ["x[u2]"]
outputs = ["u2"]
layers = [2]
[[element]]
name = "spring"
type = "cubic"
between = ["u1", "u2"]
parameters = {k3 = 3.0}
[[library]]
name = "sum"
inputs = ["x[u1]"]
output = "u1"
terms = ["x[u1]^3"]
)toml",
                   &c))
      << error_;
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  ASSERT_EQ(dynamics.laws().size(), 3u);
  ASSERT_EQ(dynamics.networks().size(), 1u);
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  for (int i = 0; i < dynamics.num_parameters(); ++i) {
    if (ParameterLayout(c.problem).FreeIndex(i) >= 0) {
      model.parameters[i] += 0.001 * (i + 1);
    }
  }
  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  const StructuralDynamics& found = *again.problem.dynamics;
  ASSERT_EQ(found.laws().size(), 3u);
  for (size_t j = 0; j < 3; ++j) {
    EXPECT_EQ(found.laws()[j].name, dynamics.laws()[j].name);
    const MemoryNetwork* before = AsMemoryNetwork(dynamics.laws()[j]);
    const MemoryNetwork* after = AsMemoryNetwork(found.laws()[j]);
    ASSERT_EQ(before == nullptr, after == nullptr);
    if (before == nullptr) continue;
    EXPECT_EQ(after->shape().deformation, before->shape().deformation);
    EXPECT_EQ(after->shape().rate, before->shape().rate);
    EXPECT_EQ(after->shape().force, before->shape().force);
  }
  // The group is part of the matrix now.
  ASSERT_EQ(found.num_parameters(), dynamics.num_parameters());
  const int rest = dynamics.num_parameters() - dynamics.block_offset(1);
  EXPECT_EQ(Vector(found.Parameters().tail(rest)),
            Vector(model.parameters.segment(dynamics.block_offset(1), rest)));
}

TEST_F(MemoryNetworkSection, DiscoveryDoesNotReplaceIt) {
  Case c;
  EXPECT_FALSE(
      Read(std::string("[discover]\nnetworks = [\"device\"]\n") + kDevice, &c));
  EXPECT_THAT(error_, HasSubstr("'device' is a network with memory"));
}

TEST_F(MemoryNetworkSection, SaysWhatItCannotBe) {
  EXPECT_THAT(Refusal("\"v[u1]\"", "\"v[u2]\""),
              HasSubstr("expected a displacement and its velocity"));
  EXPECT_THAT(Refusal("outputs = [\"u1\"]", "outputs = [\"u2\"]"),
              HasSubstr("expected the DOF of its inputs"));
  EXPECT_THAT(Refusal("layers = [3]", "layers = [3, 3]"),
              HasSubstr("2 hidden layers, expected one"));
  EXPECT_THAT(Refusal("[5.0]", "[-5.0]"), HasSubstr("is not positive"));
  EXPECT_THAT(Refusal("layers", "gauge = \"on\"\nlayers"),
              HasSubstr("a network with memory has no 'gauge'"));
  EXPECT_THAT(Refusal("layers", "acts_as = \"acceleration\"\nlayers"),
              HasSubstr("acts as a force"));
  EXPECT_THAT(Refusal("layers", "decay = \"evidence\"\nlayers"),
              HasSubstr("expected a number"));
  EXPECT_THAT(Refusal("output_scale = [5.0]",
                      "input_scale = [0.1, 1.0]\noutput_scale = [5.0]\n"
                      "values = [1.0]"),
              HasSubstr("values"));
  // Scales of these records would give learned weights another meaning.
  EXPECT_THAT(Refusal("layers", "values = [1.0]\nlayers"),
              HasSubstr("give 'input_scale' and 'output_scale' too"));
  EXPECT_THAT(Refusal("inputs = [\"x[u1]\", \"v[u1]\"]",
                      "inputs = [\"d[u1,ground]\", \"w[u1,ground]\"]"),
              HasSubstr("write d[ground,u1] and w[ground,u1]"));
  EXPECT_THAT(Refusal("memory = 2", "values = [1.0]"),
              HasSubstr("the weights of a network with 'memory'"));
}

}  // namespace
}  // namespace pinode
