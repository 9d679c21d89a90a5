#include "pinode/case/sections/memory_network_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

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

class MemoryNetworkSection : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  bool Read(const std::string& text, Case* c) {
    error_.clear();
    return ReadCase(
        folder_.Write("case.toml", Replaced(SmallCase(), "[[record]]\n",
                                            text + "[[record]]\n")),
        c, &error_);
  }
  std::string Refusal(const std::string& from, const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(kDevice, from, to), &c)) << to;
    return error_;
  }

  TemporaryFolder folder_;
  std::string error_;
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
  EXPECT_THAT(Refusal("layers", "values = [1.0]\nlayers"), HasSubstr("values"));
  EXPECT_THAT(Refusal("memory = 2", "values = [1.0]"),
              HasSubstr("the weights of a network with 'memory'"));
}

}  // namespace
}  // namespace pinode
