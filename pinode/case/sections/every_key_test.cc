// A case that has every key of pinode/case/README.md.

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

// Every key of the documentation once, and what became of it.
TEST(CaseFileTest, EveryKey) {
  TemporaryFolder folder;
  folder.Write("M.csv", "2, 0\n0, 1\n");
  folder.Write("K1.csv", "1, 0\n0, 0\n");
  std::string motion = "Ground\nNPTS= 401, DT= .005 SEC\n";
  std::string table = "time_ms,F,T,acc,strain,dabs\n";
  for (int i = 0; i < 401; ++i) {
    motion += FormatNumber(0.05 * std::sin(0.05 * i), 9) + "\n";
  }
  for (int i = 0; i < 201; ++i) {
    table += FormatNumber(10.0 * i) + "," +
             FormatNumber(3.0 * std::cos(0.1 * i), 9) + "," +
             FormatNumber(15.0 + 0.01 * i, 9) + "," +
             FormatNumber(5.0 + std::sin(0.1 * i), 9) + "," +
             FormatNumber(1e-3 * std::sin(0.2 * i), 9) + "," +
             FormatNumber(2.0 * std::sin(0.1 * i), 9) + "\n";
  }
  folder.Write("ground.at2", motion);
  folder.Write("record.csv", table);
  const std::string text = R"(
title = "Everything"
[units]
force = "kN"
length = "cm"
time = "s"
[model]
dofs = ["u1", "u2"]
mass = "M.csv"
stiffness = [[300, -100], [-100, 100]]
damping = {rayleigh = [0.1, 0.001]}
influence = {x = [1, 1], y = [0, 1]}
support_mass_coupling = {y = [0.5, 0]}
expected_hz = [1.1, 2.2]
[[group]]
name = "k1"
adds_to = "stiffness"
matrix = "K1.csv"
initial = 0.1
lower = -0.9
upper = 5.0
prior_mean = 0.05
prior_sigma = 0.3
free = true
[[group]]
name = "k1_temperature"
adds_to = "stiffness"
between = ["ground", "u1"]
follows = {covariate = "temperature", reference = 20.0}
[[group]]
name = "c_ageing"
adds_to = "damping"
between = ["u1", "u2"]
free = false
follows = {time = "linear", reference = 1.5}
[[element]]
name = "gap"
type = "bilinear"
between = ["u1", "u2"]
parameters.k = {initial = 3.0, lower = 0.0, upper = 9.0, prior_mean = 2.0, prior_sigma = 1.0, free = true}
parameters.gap = 0.5
[[element]]
name = "wen"
type = "bouc_wen"
between = ["ground", "u1"]
parameters = {k = {initial = 2.0}, b = 0.5, g = {initial = 0.4, free = false}}
[[network]]
name = "nn"
inputs = ["x[u2]", "w[u1,u2]", "d[ground, u1]", "v[u2]", "t", "input[temperature]"]
input_scale = [1, 2, 3, 4, 5, 20]
outputs = ["u2", "u1-u2"]
output_scale = [7, 8]
acts_as = "force"
layers = [4, 3]
activation = "softplus"
bias = false
skip = false
gauge = "off"
decay = 0.25
seed = 7
free = false
[[record]]
name = "r"
role = "train"
file = "record.csv"
time = "time_ms"
time_unit = "ms"
window = [0.5, 1.5]
resample_hz = 50.0
interpolation = "cubic"
start = {x = [0.1, 0.2], v = [0.3, 0.4]}
substeps = 3
  [[record.ground]]
  direction = "y"
  file = "ground.at2"
  scale = 0.5
  remove_offset = true
  sigma_percent = 2.0
  [[record.force]]
  dof = "u1"
  column = "F"
  unit = "N"
  sigma = 10.0
  [[record.covariate]]
  name = "temperature"
  column = "T"
  [[record.channel]]
  name = "a1"
  column = "acc"
  quantity = "relative_acceleration"
  dof = "u1"
  unit = "gal"
  sign = -1
  sigma = 0.02
  remove_offset = true
  gain = {initial = 1.1, free = true, prior_sigma = 0.1}
  offset = {initial = 2.0, lower = 1.0, upper = 4.0, free = true}
  delay = {initial = 0.002, free = false}
  [[record.channel]]
  column = "strain"
  quantity = "displacement"
  combination = {u1 = -0.01, u2 = 0.01}
  unit = "1"
  sigma_percent = 5.0
  fit = false
  [[record.channel]]
  column = "dabs"
  quantity = "absolute_displacement"
  dof = "u2"
  unit = "mm"
  [record.filter]
  type = "bandpass"
  corner_hz = [0.5, 20.0]
  order = 2
[options]
shooting = "single"
segment_samples = 5000000000
max_iterations = 17
robust_loss = "huber"
robust_scale = 2.5
derivatives = "jets"
covariance = "sandwich"
threads = 3
multistart = 4
seed = 9
tolerance = 1e-7
[simulate]
noise_percent = 2.0
seed = 5
)";
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  ASSERT_NE(c.problem.dynamics, nullptr);
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  const StructuralModel& model = dynamics.model();
  EXPECT_THAT(c.expected_hz, ElementsAre(1.1, 2.2));
  EXPECT_THAT(model.directions, ElementsAre("x", "y"));
  EXPECT_EQ(model.influence(0, 1), 0.0);
  EXPECT_EQ(model.support_mass_coupling(0, 1), 0.5);
  EXPECT_EQ(model.support_mass_coupling(1, 0), 0.0);
  EXPECT_DOUBLE_EQ(model.damping(0, 0), 0.1 * 2 + 0.001 * 300);

  ASSERT_EQ(dynamics.groups().size(), 3u);
  const Parameter& alpha = dynamics.groups()[0].alpha;
  EXPECT_EQ(alpha.value, 0.1);
  EXPECT_EQ(alpha.lower, -0.9);
  EXPECT_EQ(alpha.upper, 5.0);
  EXPECT_EQ(alpha.prior_mean, 0.05);
  EXPECT_EQ(alpha.prior_sigma, 0.3);
  EXPECT_EQ(dynamics.groups()[1].follows, GroupTerm::Follows::kCovariate);
  EXPECT_EQ(dynamics.groups()[1].reference, 20.0);
  EXPECT_EQ(
      dynamics.inputs()[static_cast<size_t>(dynamics.groups()[1].input)].name,
      "temperature");
  EXPECT_EQ(dynamics.groups()[2].follows, GroupTerm::Follows::kTime);
  EXPECT_EQ(dynamics.groups()[2].reference, 1.5);
  EXPECT_FALSE(dynamics.groups()[2].alpha.free);

  ASSERT_EQ(dynamics.laws().size(), 2u);
  const ParameterBlock& gap = dynamics.laws()[0].parameters;
  EXPECT_EQ(gap.parameters[0].name, "gap.k");
  EXPECT_EQ(gap.parameters[0].unit, "kN/cm");
  EXPECT_EQ(gap.parameters[0].upper, 9.0);
  EXPECT_EQ(gap.parameters[0].prior_mean, 2.0);
  EXPECT_TRUE(gap.parameters[0].free);
  EXPECT_EQ(gap.parameters[1].value, 0.5);
  EXPECT_EQ(gap.parameters[1].unit, "cm");
  EXPECT_FALSE(gap.parameters[1].free);
  EXPECT_EQ(dynamics.laws()[0].outputs(0, 0), -1.0);
  EXPECT_EQ(dynamics.laws()[0].outputs(1, 0), 1.0);
  const ParameterBlock& wen = dynamics.laws()[1].parameters;
  EXPECT_EQ(wen.parameters[1].value, 1.0);  // a, its default
  EXPECT_FALSE(wen.parameters[1].free);
  EXPECT_EQ(wen.parameters[3].value, 0.4);
  EXPECT_FALSE(wen.parameters[3].free);
  EXPECT_EQ(dynamics.num_states(), 5);

  ASSERT_EQ(dynamics.networks().size(), 1u);
  const NetworkTerm& network = dynamics.networks()[0];
  const NetworkArchitecture& architecture = network.network->architecture();
  EXPECT_THAT(architecture.hidden_widths, ElementsAre(4, 3));
  EXPECT_EQ(architecture.activation, Activation::kSoftplus);
  EXPECT_FALSE(architecture.bias);
  EXPECT_FALSE(architecture.skip);
  EXPECT_FALSE(architecture.gauge);
  EXPECT_EQ(architecture.input_scale[5], 20.0);
  EXPECT_EQ(architecture.output_scale, Vector(Eigen::Vector2d(7.0, 8.0)));
  EXPECT_EQ(network.acts_as, NetworkTerm::ActsAs::kForce);
  EXPECT_EQ(network.decay, 0.25);
  EXPECT_EQ(network.features[1].kind, Feature::Kind::kDeformationRate);
  EXPECT_EQ(network.features[2].a, Feature::kGround);
  EXPECT_EQ(network.features[4].kind, Feature::Kind::kTime);
  EXPECT_EQ(network.outputs(0, 1), 1.0);
  EXPECT_EQ(network.outputs(1, 1), -1.0);
  EXPECT_FALSE(network.weights.parameters[0].free);

  ASSERT_EQ(c.problem.records.size(), 1u);
  const IdentificationRecord& record = c.problem.records[0];
  EXPECT_NEAR(record.excitation->start_time(), 0.5, 1e-12);
  EXPECT_NEAR(record.sampling_step(), 0.02, 1e-12);
  EXPECT_EQ(record.num_samples(), 51);
  EXPECT_EQ(record.excitation->interpolation(), Interpolation::kCubic);
  EXPECT_EQ(record.substeps, 3);
  EXPECT_FALSE(c.problem.records[0].substeps_chosen);
  EXPECT_EQ(record.start, IdentificationRecord::Start::kKnown);
  ASSERT_EQ(record.known_start.size(), 5);
  EXPECT_EQ(record.known_start[1], 0.2);
  EXPECT_EQ(record.known_start[2], 0.3);
  EXPECT_EQ(record.known_start[4], 0.0);
  // ground_y, force_u1, temperature, ground_displacement_y
  ASSERT_EQ(dynamics.num_inputs(), 4);
  EXPECT_EQ(dynamics.inputs()[3].kind, InputSpec::Kind::kGroundDisplacement);
  ASSERT_EQ(record.input_sigma.size(), 4);
  EXPECT_GT(record.input_sigma[0], 0.0);
  EXPECT_DOUBLE_EQ(record.input_sigma[1], 0.01);
  EXPECT_EQ(record.input_sigma[2], 0.0);
  // Forces in kN at t = 0.6: sample 60 of the file.
  EXPECT_NEAR(record.excitation->samples()(1, 5), 0.003 * std::cos(6.0), 1e-6);
  EXPECT_NEAR(record.excitation->samples()(2, 5), 15.6, 1e-3);

  ASSERT_EQ(record.channels.size(), 3u);
  EXPECT_EQ(record.channels[0].observation.name, "a1");
  EXPECT_DOUBLE_EQ(record.channels[0].sigma, 0.02);
  EXPECT_DOUBLE_EQ(c.problem.records[0].channels[0].description.factor, -1.0);
  EXPECT_FALSE(record.channels[1].fit);
  EXPECT_GT(record.channels[1].sigma, 0.0);
  EXPECT_EQ(record.channels[1].observation.weights[0], -0.01);
  EXPECT_EQ(c.problem.records[0].channels[1].description.location,
            "-0.01 u1 + 0.01 u2");
  EXPECT_EQ(record.channels[2].observation.quantity,
            Quantity::kAbsoluteDisplacement);
  EXPECT_NE(record.filter, nullptr);
  const ParameterBlock& sensors = c.problem.sensors;
  ASSERT_EQ(sensors.size(), 3);
  const Parameter& gain =
      sensors.parameters[static_cast<size_t>(record.channels[0].gain)];
  EXPECT_EQ(gain.name, "gain.a1");
  EXPECT_EQ(gain.value, 1.1);
  EXPECT_EQ(gain.prior_mean, 1.1);
  EXPECT_TRUE(gain.free);
  const Parameter& offset =
      sensors.parameters[static_cast<size_t>(record.channels[0].offset)];
  EXPECT_EQ(offset.name, "offset.r.a1");
  EXPECT_EQ(offset.unit, "cm/s^2");
  // The sensor is upside down: bounds change places.
  EXPECT_DOUBLE_EQ(offset.value, -2.0);
  EXPECT_DOUBLE_EQ(offset.lower, -4.0);
  EXPECT_DOUBLE_EQ(offset.upper, -1.0);
  const Parameter& delay =
      sensors.parameters[static_cast<size_t>(record.channels[0].delay)];
  EXPECT_EQ(delay.value, 0.002);
  EXPECT_FALSE(delay.free);

  EXPECT_EQ(c.options.shooting, IdentificationOptions::Shooting::kSingle);
  EXPECT_EQ(c.options.segment_samples, 5000000000);
  EXPECT_EQ(c.options.max_num_iterations, 17);
  EXPECT_EQ(c.options.loss, RobustLoss::kHuber);
  EXPECT_EQ(c.options.loss_scale, 2.5);
  EXPECT_EQ(c.options.derivatives, DerivativeMethod::kJets);
  EXPECT_EQ(c.options.covariance, IdentificationOptions::Covariance::kSandwich);
  EXPECT_EQ(c.options.num_threads, 3);
  EXPECT_EQ(c.options.num_starts, 4);
  EXPECT_EQ(c.options.seed, 9u);
  EXPECT_EQ(c.options.function_tolerance, 1e-7);
  EXPECT_EQ(c.noise_percent, 2.0);
  EXPECT_EQ(c.noise_seed, 5u);
}

}  // namespace
}  // namespace pinode
