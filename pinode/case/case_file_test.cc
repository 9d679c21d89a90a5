#include "pinode/case/case_file.h"

#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/testing.h"
#include "pinode/case/toml_value.h"
#include "pinode/estimate/record_grid.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kGravity = 9.80665;

TEST(CaseFileTest, SmallCase) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  const Case c = ReadOrFail(folder.Write("case.toml", SmallCase()));
  ASSERT_NE(c.problem.dynamics, nullptr);
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  EXPECT_EQ(c.problem.description.title, "Two storeys");
  EXPECT_EQ(c.problem.description.units.force, "kN");
  EXPECT_EQ(dynamics.num_dofs(), 2);
  EXPECT_EQ(dynamics.model().stiffness(0, 1), -100.0);
  ASSERT_EQ(dynamics.groups().size(), 1u);
  const GroupTerm& group = dynamics.groups()[0];
  EXPECT_EQ(group.group.matrix(0, 0), 200.0);
  EXPECT_EQ(group.alpha.lower, -0.9);
  EXPECT_TRUE(group.alpha.free);
  ASSERT_EQ(dynamics.num_inputs(), 1);
  EXPECT_EQ(dynamics.inputs()[0].name, "ground_x");

  ASSERT_EQ(c.problem.records.size(), 1u);
  const IdentificationRecord& record = c.problem.records[0];
  EXPECT_EQ(record.num_samples(), 200);
  EXPECT_DOUBLE_EQ(record.sampling_step(), 0.01);
  EXPECT_EQ(record.start, IdentificationRecord::Start::kRest);
  EXPECT_EQ(record.excitation->interpolation(), Interpolation::kLinear);
  EXPECT_EQ(record.input_sigma.size(), 0);
  // gal, g and mm become m/s^2 and m.
  EXPECT_NEAR(record.excitation->samples()(0, 20), 0.8 * std::sin(1.8), 1e-9);
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_NEAR(record.channels[0].values[20], 0.1 * kGravity * std::sin(1.5),
              1e-8);
  EXPECT_NEAR(record.channels[1].values[20],
              0.001 * (4.0 * std::sin(1.6) + 1.0), 1e-11);
  EXPECT_EQ(record.channels[0].observation.quantity,
            Quantity::kAbsoluteAcceleration);
  EXPECT_EQ(record.channels[1].observation.weights[1], 1.0);
  EXPECT_EQ(record.channels[0].gain, -1);
  ASSERT_EQ(c.problem.records.size(), 1u);
  EXPECT_DOUBLE_EQ(c.problem.records[0].channels[0].description.factor,
                   kGravity);
  EXPECT_EQ(c.problem.records[0].channels[1].description.location, "u2");
  EXPECT_TRUE(c.problem.IsDriven(c.problem.records[0]));
  EXPECT_TRUE(c.problem.records[0].substeps_chosen);
  EXPECT_GE(record.substeps, 1);
}

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

// Units of time other than the second reach everything that is stated in
// seconds or Hz.
TEST(CaseFileTest, MillisecondsAsTheModelsTime) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  std::string text =
      Replaced(SmallCase(), "length = \"m\"", "length = \"m\"\ntime = \"ms\"");
  text = Replaced(text, "start = \"rest\"",
                  "start = \"rest\"\nwindow = [0.5, 1.0]");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  ASSERT_EQ(c.problem.records.size(), 1u);
  const IdentificationRecord& record = c.problem.records[0];
  EXPECT_NEAR(record.sampling_step(), 10.0, 1e-9);
  EXPECT_NEAR(record.excitation->start_time(), 500.0, 1e-9);
  EXPECT_EQ(record.num_samples(), 51);
  EXPECT_DOUBLE_EQ(c.problem.description.HzPerModelFrequency(), 1000.0);
  EXPECT_DOUBLE_EQ(c.problem.records[0].description.time_factor, 1000.0);
}

TEST(CaseFileTest, ShearBuilding) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  std::string text = SmallCase();
  text = Replaced(text, "mass = {diagonal = [2.0, 1.0]}\n", "");
  text = Replaced(text, "stiffness = [[300.0, -100.0], [-100.0, 100.0]]\n", "");
  text = Replaced(text, "damping = {ratios = [0.02]}\n",
                  "[model.shear_building]\nmasses = [2.0, 1.0]\n"
                  "stiffnesses = [200.0, 100.0]\ndampers = [2.0, 1.0]\n");
  text = Replaced(text, "between = [\"ground\", \"u1\"]\nscale = 200.0\n",
                  "storey = 2\n");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  ASSERT_NE(c.problem.dynamics, nullptr);
  const StructuralModel& model = c.problem.dynamics->model();
  EXPECT_EQ(model.stiffness(0, 0), 300.0);
  EXPECT_EQ(model.damping(0, 1), -1.0);
  EXPECT_EQ(c.problem.dynamics->groups()[0].group.matrix(1, 1), 100.0);
}

// Rayleigh's damping with unknown factors: groups that are the model's mass and
// stiffness.
TEST(CaseFileTest, DampingInProportion) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  std::string text = Replaced(SmallCase(), "damping = {ratios = [0.02]}",
                              "damping = {rayleigh = [0.5, 0.25]}");
  const auto group = [](const std::string& name, const std::string& of) {
    return "[[group]]\nname = \"" + name +
           "\"\nadds_to = \"damping\"\nproportional_to = \"" + of + "\"\n";
  };
  const Case c = ReadOrFail(folder.Write(
      "case.toml", text + group("c_mass", "mass") + "scale = 0.5\n" +
                       group("c_stiffness", "stiffness") + "scale = 0.25\n"));
  const std::vector<GroupTerm>& groups = c.problem.dynamics->groups();
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[1].group.target, MatrixGroup::Target::kDamping);
  const StructuralModel& model = c.problem.dynamics->model();
  // Together they are all of it.
  EXPECT_NEAR((groups[1].group.matrix + groups[2].group.matrix - model.damping)
                  .cwiseAbs()
                  .maxCoeff(),
              0.0, 1e-12);
  EXPECT_EQ(groups[1].group.matrix(0, 1), 0.0);
  EXPECT_EQ(groups[2].group.matrix(0, 1), -25.0);

  Case unread;
  std::string error;
  EXPECT_FALSE(ReadCase(
      folder.Write("case.toml", text + Replaced(group("c", "mass"), "\"damping",
                                                "\"stiffness")),
      &unread, &error));
  EXPECT_THAT(error, HasSubstr("is for groups that add to damping"));
  EXPECT_FALSE(ReadCase(folder.Write("case.toml", text + group("c", "masses")),
                        &unread, &error));
  EXPECT_THAT(error, HasSubstr("mass"));
}

// A sensor's gain is one unknown over all records; an offset is not.
TEST(CaseFileTest, GainsAreSharedOffsetsAreNot) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  const std::string channel =
      "[[record.channel]]\ncolumn = \"a1\"\nquantity = "
      "\"absolute_acceleration\"\ndof = \"u1\"\nunit = \"g\"\n"
      "offset = {free = true}\n";
  const std::string second =
      "[[record]]\nname = \"again\"\nfile = \"quake.csv\"\ntime = \"t\"\n"
      "interpolation = \"linear\"\n[[record.ground]]\ndirection = \"x\"\n"
      "column = \"ag\"\nunit = \"gal\"\n" +
      channel;
  const std::string first = Replaced(SmallCase(), "  unit = \"g\"\n",
                                     "  unit = \"g\"\n  gain = {free = true}\n"
                                     "  offset = {free = true}\n");
  const Case c = ReadOrFail(folder.Write("case.toml", first + second));
  ASSERT_EQ(c.problem.records.size(), 2u);
  EXPECT_EQ(c.problem.sensors.size(), 3);
  const MeasuredChannel& a = c.problem.records[0].channels[0];
  const MeasuredChannel& b = c.problem.records[1].channels[0];
  EXPECT_GE(a.gain, 0);
  EXPECT_EQ(a.gain, b.gain);
  EXPECT_NE(a.offset, b.offset);
  EXPECT_EQ(c.problem.records[1].start, IdentificationRecord::Start::kFree);
}

// Modes of a model need a model and nothing else.
TEST(CaseFileTest, AModelAloneCanBeLookedAt) {
  TemporaryFolder folder;
  const std::string path = folder.Write(
      "model.toml",
      "[model]\ndofs = [\"u1\", \"u2\"]\nmass = {diagonal = [2.0, 1.0]}\n"
      "stiffness = [[300.0, -100.0], [-100.0, 100.0]]\n");
  Case c;
  std::string error;
  ASSERT_TRUE(ReadCaseForCheck(path, &c, &error)) << error;
  EXPECT_TRUE(c.problem.dynamics->model().damping.isZero(0.0));
  EXPECT_TRUE(c.problem.records.empty());
  EXPECT_FALSE(ReadCase(path, &c, &error));
  EXPECT_THAT(error, HasSubstr("no parameter is free"));
}

// A hold-out sees its first samples alone: the offset is its sensor's.
TEST(CaseFileTest, HoldoutsHaveTheOffsetsOfTheirSensors) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  const auto record = [](const std::string& name, const std::string& keys,
                         const std::string& offset) {
    return "[[record]]\nname = \"" + name + "\"\n" + keys +
           "file = \"quake.csv\"\ntime = \"t\"\n"
           "interpolation = \"linear\"\n[[record.ground]]\n"
           "direction = \"x\"\ncolumn = \"ag\"\nunit = \"gal\"\n"
           "[[record.channel]]\ncolumn = \"a1\"\nquantity = "
           "\"absolute_acceleration\"\ndof = \"u1\"\nunit = \"g\"\n" +
           offset;
  };
  const std::string holdout = "role = \"holdout\"\n";
  const std::string free = "offset = {free = true}\n";
  const Case c = ReadOrFail(folder.Write(
      "case.toml",
      SmallCase() + record("before", holdout, "") + record("one", "", free) +
          record("two", "", free) +
          record("after", holdout + "start_samples = 50\n", "") +
          record("own", holdout + "start = {from = \"first\", samples = 20}\n",
                 "offset = {initial = 0.1}\n")));
  ASSERT_EQ(c.problem.records.size(), 6u);
  const auto offset = [&](size_t r) {
    return c.problem.sensors
        .parameters[static_cast<size_t>(
            c.problem.records[r].channels[0].offset)]
        .name;
  };
  EXPECT_EQ(c.problem.records[0].channels[0].offset, -1);
  EXPECT_EQ(offset(1), "offset.one.a1");
  EXPECT_EQ(offset(4), "offset.two.a1");
  EXPECT_EQ(offset(5), "offset.own.a1");
  EXPECT_THAT(c.problem.records[4].description.remarks.back(),
              HasSubstr("its offset is 'offset.two.a1'"));
  EXPECT_EQ(c.problem.records[1].start_samples, 0);
  EXPECT_EQ(c.problem.records[4].start_samples, 50);
  EXPECT_EQ(c.problem.records[5].start_samples, 20);

  const std::string shared = "offset = {free = true, shared = true}\n";
  const Case s = ReadOrFail(folder.Write(
      "shared.toml", SmallCase() + record("one", "", shared) +
                         record("two", "", shared) + record("three", "", "")));
  ASSERT_EQ(s.problem.sensors.size(), 1);
  EXPECT_EQ(s.problem.sensors.parameters[0].name, "offset.a1");
  for (const IdentificationRecord& each : s.problem.records) {
    EXPECT_EQ(each.channels[0].offset, 0) << each.name;
  }

  // Of a training record the start is what its first samples say.
  const Case t = ReadOrFail(folder.Write(
      "known.toml", SmallCase() + record("one", "start_samples = 50\n", "")));
  EXPECT_EQ(t.problem.records.back().start,
            IdentificationRecord::Start::kKnown);
  EXPECT_EQ(t.problem.records.back().start_samples, 50);

  Case unread;
  std::string error;
  EXPECT_FALSE(ReadCase(
      folder.Write("bad.toml", SmallCase() + record("one",
                                                    "start = \"rest\"\n"
                                                    "start_samples = 50\n",
                                                    "")),
      &unread, &error));
  EXPECT_THAT(error, HasSubstr("what a free start is found from"));
  EXPECT_FALSE(ReadCase(
      folder.Write("steady.toml", SmallCase() + record("one",
                                                       "periodic = true\n"
                                                       "start = \"rest\"\n",
                                                       "")),
      &unread, &error));
  EXPECT_THAT(error, HasSubstr("in its steady state, expected no 'start'"));
}

constexpr char kNetwork[] =
    "[[network]]\nname = \"nn\"\ninputs = [\"x[u1]\", \"v[u1]\"]\n"
    "outputs = [\"u1\"]\nlayers = [5]\n";

TEST(CaseFileTest, GaugeWhereAFreeGroupIsSpanned) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  Case c = ReadOrFail(folder.Write("case.toml", SmallCase() + kNetwork));
  ASSERT_NE(c.problem.dynamics, nullptr);
  EXPECT_TRUE(c.problem.dynamics->networks()[0].network->architecture().gauge);
  ASSERT_EQ(c.problem.description.remarks.size(), 1u);
  EXPECT_THAT(c.problem.description.remarks[0],
              HasSubstr("so that k1 means the tangent"));

  const auto gauge_of = [&](const std::string& text) {
    const Case read = ReadOrFail(folder.Write("case.toml", text));
    return read.problem.dynamics != nullptr &&
           read.problem.dynamics->networks()[0].network->architecture().gauge;
  };
  // Fixed, not spanned, acting elsewhere, or told not to.
  EXPECT_FALSE(gauge_of(Replaced(SmallCase(), "lower = -0.9", "free = false") +
                        kNetwork));
  EXPECT_FALSE(gauge_of(
      Replaced(SmallCase(), "[\"ground\", \"u1\"]", "[\"u1\", \"u2\"]") +
      kNetwork));
  EXPECT_FALSE(
      gauge_of(SmallCase() + Replaced(kNetwork, "[\"u1\"]", "[\"u2\"]")));
  EXPECT_FALSE(gauge_of(SmallCase() + kNetwork + "gauge = \"off\"\n"));
  // A relative displacement spans a spring between the same two DOFs, and a
  // linear element is like a group.
  const std::string element =
      "[[element]]\nname = \"s\"\ntype = \"linear\"\n"
      "between = [\"u1\", \"u2\"]\nparameters.k = {initial = 1.0}\n";
  EXPECT_TRUE(gauge_of(
      Replaced(SmallCase(), "lower = -0.9", "free = false") + element +
      Replaced(Replaced(kNetwork, "\"x[u1]\", \"v[u1]\"", "\"d[u1,u2]\""),
               "[\"u1\"]", "[\"u1-u2\"]")));
  EXPECT_FALSE(
      gauge_of(Replaced(SmallCase(), "lower = -0.9", "free = false") +
               Replaced(element, "{initial = 1.0}", "1.0") +
               Replaced(kNetwork, "\"x[u1]\", \"v[u1]\"", "\"d[u1,u2]\"")));
}

TEST(CaseFileTest, LastLayerIsZeroWherePhysicsIsPresent) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  const auto last_weight = [](const Case& c) {
    const NetworkTerm& term = c.problem.dynamics->networks()[0];
    const WeightLayout layout = term.network->layout();
    return term.weights.Values()
        .segment(layout.weights.back().offset, layout.weights.back().size())
        .norm();
  };
  const std::string with_network = SmallCase() + kNetwork;
  EXPECT_EQ(last_weight(ReadOrFail(folder.Write("case.toml", with_network))),
            0.0);
  std::string bare =
      Replaced(with_network, "[[300.0, -100.0], [-100.0, 100.0]]",
               "{diagonal = [0, 0]}");
  bare = Replaced(bare, "{ratios = [0.02]}", "\"none\"");
  const size_t begin = bare.find("[[group]]");
  bare.erase(begin, bare.find("[[record]]") - begin);
  // Nor a linear path, which stands in for physics.
  const size_t network = bare.find("[[network]]\n");
  ASSERT_NE(network, std::string::npos);
  bare.insert(network + std::string("[[network]]\n").size(), "skip = false\n");
  EXPECT_GT(last_weight(ReadOrFail(folder.Write("case.toml", bare))), 0.0);
}

TEST(CaseFileTest, Profiles) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  EXPECT_FALSE(
      ReadOrFail(folder.Write("case.toml", SmallCase())).profiles.has_value());
  const auto read = [&folder](const std::string& section) {
    return ReadOrFail(folder.Write("case.toml", SmallCase() + section));
  };
  EXPECT_TRUE(read("[profiles]\n").profiles->empty());
  EXPECT_EQ(read("[profiles]\nparameters = [\"k1\"]\n").profiles->front(),
            "k1");
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(
      folder.Write("case.toml",
                   SmallCase() + "[profiles]\nparameters = [\"k7\"]\n"),
      &c, &error));
  EXPECT_THAT(error, HasSubstr("'k7', expected the names of free parameters"));
}

TEST(CaseFileTest, Simulation) {
  TemporaryFolder folder;
  std::string text = Replaced(SmallCase(), "file = \"quake.csv\"\n", "");
  text = Replaced(text, "time = \"t\"\n",
                  "sampling_rate_hz = 50.0\nduration = 2.0\n");
  const size_t begin = text.find("  [[record.ground]]");
  text.erase(begin, text.find("  [[record.channel]]") - begin);
  text = Replaced(text, "\"rest\"", "{x = [0.01, 0.0]}");
  const std::string path = folder.Write("case.toml", text);
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(path, &c, &error));
  ASSERT_TRUE(ReadCaseForSimulation(path, &c, &error)) << error;
  const IdentificationRecord& record = c.problem.records[0];
  EXPECT_EQ(record.num_samples(), 101);
  EXPECT_DOUBLE_EQ(record.sampling_step(), 0.02);
  EXPECT_TRUE(std::isnan(record.channels[0].values[0]));
  EXPECT_FALSE(c.problem.IsDriven(c.problem.records[0]));
  EXPECT_GE(record.substeps, 1);

  const std::string eternal = folder.Write(
      "eternal.toml", Replaced(text, "duration = 2.0", "duration = 1e300"));
  EXPECT_FALSE(ReadCaseForSimulation(eternal, &c, &error));
  EXPECT_THAT(error, HasSubstr("'duration' holds 1e8 samples or more"));
}

// Linear models have no steps unless they are asked for.
TEST(CaseFileTest, IntegratesLinearModelsExactly) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  const auto with = [&](const std::string& keys, const std::string& more) {
    return folder.Write("case.toml", Replaced(SmallCase(), "start = \"rest\"",
                                              "start = \"rest\"\n" + keys) +
                                         more);
  };
  const auto integrator = [](const Case& c) {
    EXPECT_EQ(c.substeps[0].integrator,
              IntegratorOf(*c.problem.dynamics, c.problem.records[0]));
    return c.substeps[0].integrator;
  };
  EXPECT_EQ(integrator(ReadOrFail(with("", ""))), Integrator::kExact);
  EXPECT_EQ(integrator(ReadOrFail(with("integrator = \"auto\"", ""))),
            Integrator::kExact);
  EXPECT_EQ(integrator(ReadOrFail(with("integrator = \"rk4\"", ""))),
            Integrator::kRungeKutta);
  EXPECT_EQ(integrator(ReadOrFail(with("substeps = 3", ""))),
            Integrator::kRungeKutta);
  EXPECT_EQ(
      integrator(ReadOrFail(with("substeps = 3\nintegrator = \"exact\"", ""))),
      Integrator::kExact);

  const std::string spring =
      "[[element]]\nname = \"s\"\ntype = \"cubic\"\n"
      "between = [\"ground\", \"u1\"]\nparameters = {k3 = {initial = 1.0}}\n";
  EXPECT_EQ(integrator(ReadOrFail(with("", spring))), Integrator::kRungeKutta);
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(with("integrator = \"exact\"", spring), &c, &error));
  EXPECT_THAT(error, HasSubstr("integrator = \"exact\" is for models that are "
                               "linear with constant matrices"));
  EXPECT_FALSE(ReadCase(with("integrator = \"euler\"", ""), &c, &error));
  EXPECT_THAT(error, HasSubstr("euler"));
}

// The hold-out is not integrated more coarsely than the training records.
TEST(CaseFileTest, HoldOutTakesTheTrainingStep) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  std::string rest = SmallCase().substr(SmallCase().find("[[record]]"));
  rest = Replaced(rest, "name = \"quake\"", "name = \"h\"\nrole = \"holdout\"");
  const Case c = ReadOrFail(
      folder.Write("case.toml", Replaced(SmallCase(), "start = \"rest\"",
                                         "start = \"rest\"\nsubsteps = 37") +
                                    rest));
  ASSERT_EQ(c.problem.records.size(), 2u);
  EXPECT_EQ(c.problem.records[1].substeps, 37);
}

TEST(CaseFileTest, ReadsEveryCaseOfTheProject) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(
           fs::path(PINODE_SOURCE_DIR) / "data",
           fs::directory_options::follow_directory_symlink)) {
    if (entry.path().extension() != ".toml") continue;
    // The frame's differ by their records alone, and read a dozen exports each.
    if (entry.path().parent_path().filename() == "frame" &&
        entry.path().stem() != "gap") {
      continue;
    }
    Case c;
    std::string error;
    EXPECT_TRUE(ReadCase(entry.path().string(), &c, &error)) << error;
    ++count;
  }
  EXPECT_GE(count, 8);
}

// One thing wrong with the small case at a time.
struct BadCase {
  const char* name;
  const char* from;  // in the case
  const char* to;
  const char* message;
  const char* data_from = "";  // in the record
  const char* data_to = "";
};

void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }

class BadCaseTest : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadCaseTest, IsRefusedWithItsPlace) {
  const BadCase& bad = GetParam();
  TemporaryFolder folder;
  const std::string data = SmallRecord();
  folder.Write("quake.csv", *bad.data_from == '\0'
                                ? data
                                : Replaced(data, bad.data_from, bad.data_to));
  folder.Write("bad.csv", "1, nan\nnan, 2\n");
  folder.Write("small.csv", "1\n");
  folder.Write("empty.csv", "");
  folder.Write("header.csv", "t,ag,a1,d2\n");
  folder.Write("one.csv", "t,ag,a1,d2\n0,1,2,3\n");
  const std::string path = folder.Write(
      "case.toml", *bad.from == '\0' ? SmallCase()
                                     : Replaced(SmallCase(), bad.from, bad.to));
  Case c;
  c.problem.description.title = "untouched";
  std::string error;
  EXPECT_FALSE(ReadCase(path, &c, &error));
  EXPECT_THAT(error, HasSubstr(bad.message));
  EXPECT_THAT(error, HasSubstr(folder.Path("")));
  EXPECT_THAT(error, Not(HasSubstr("\n")));
  EXPECT_EQ(c.problem.description.title, "untouched");
}

const BadCase kBadCases[] = {
    {"UnknownKey", "scale = 200.0", "scael = 200.0",
     "case.toml:14: [[group]] 1: unknown key 'scael'; did you mean 'scale'?"},
    {"UnknownSection", "[[group]]", "[[groups]]",
     "case.toml:10: unknown key 'groups'; did you mean 'group'?"},
    {"NotToml", "[units]", "[units", "case.toml:2: "},
    {"NotUtf8", "Two storeys", "Two \xff", "case.toml:1: "},
    {"WrongType", "scale = 200.0", "scale = \"200\"",
     "case.toml:14: group 'k1': 'scale' is the text '200', expected a finite"},
    {"TooLargeNumber", "[units]",
     "[options]\nmax_iterations = 5000000000\n[units]",
     "expected a whole number of at most 2147483647"},
    {"UnknownUnit", "force = \"kN\"", "force = \"KN\"", "case.toml:3: [units]"},
    {"EmptyUnit", "force = \"kN\"", "force = \"\"", "case.toml:3: [units]"},
    {"UnknownDof", "between = [\"ground\", \"u1\"]",
     "between = [\"ground\", \"u11\"]",
     "case.toml:13: group 'k1': 'u11' is not a DOF of the model; did you mean"},
    {"UnknownDofOfChannel", "dof = \"u2\"", "dof = \"w2\"", "case.toml:34: "},
    {"WrongMatrixSize", "{diagonal = [2.0, 1.0]}", "{diagonal = [2.0]}",
     "case.toml:7: [model]: the mass matrix is 1 x 1, expected 2 x 2"},
    {"WrongMatrixSizeInFile", "{diagonal = [2.0, 1.0]}", "\"small.csv\"",
     "small.csv: the mass matrix is 1 x 1, expected 2 x 2"},
    {"RaggedRows", "[-100.0, 100.0]", "[-100.0]",
     "case.toml:8: [model]: row 2 of 'stiffness'"},
    {"UnsymmetricMass", "{diagonal = [2.0, 1.0]}", "[[2.0, 0.5], [0.0, 1.0]]",
     "case.toml:7: [model]: the mass matrix is not symmetric"},
    {"IndefiniteMass", "{diagonal = [2.0, 1.0]}", "{diagonal = [2.0, -1.0]}",
     "case.toml:7: [model]: the mass matrix is not positive definite"},
    {"UnsymmetricStiffness", "[-100.0, 100.0]", "[-90.0, 100.0]",
     "case.toml:8: [model]: the stiffness matrix is not symmetric"},
    {"NanInMatrix", "{diagonal = [2.0, 1.0]}", "\"bad.csv\"", "bad.csv"},
    {"NanInText", "{diagonal = [2.0, 1.0]}", "{diagonal = [2.0, nan]}",
     "case.toml:7: "},
    {"MissingMatrixFile", "{diagonal = [2.0, 1.0]}", "\"no.csv\"",
     "case.toml:7: [model]: 'mass' names the file 'no.csv', which does not"},
    {"MissingDamping", "damping = {ratios = [0.02]}\n", "",
     "case.toml:5: [model]: 'damping' is missing"},
    {"MissingFile", "file = \"quake.csv\"", "file = \"none.csv\"",
     "case.toml:18: record 'quake': the file"},
    {"EmptyRecord", "file = \"quake.csv\"", "file = \"empty.csv\"",
     "empty.csv"},
    {"HeaderOnly", "file = \"quake.csv\"", "file = \"header.csv\"",
     "header.csv"},
    {"OneSample", "file = \"quake.csv\"", "file = \"one.csv\"", "one.csv"},
    {"DecreasingTime", "", "", "quake.csv:6: ", "\n0.04,", "\n0.02,"},
    {"TextInAChannel", "", "", "quake.csv:6: ", "\n0.04,", "\n0.04,x"},
    {"MissingExcitation", "", "", "case.toml:16: record 'quake'",
     "t,ag,a1,d2\n0,0,", "t,ag,a1,d2\n0,,"},
    {"UnknownColumn", "column = \"d2\"", "column = \"d3\"", "quake.csv:1: "},
    {"UnitMismatch", "unit = \"mm\"", "unit = \"mm/s\"",
     "case.toml:35: record 'quake', channel 'd2': unit 'mm/s' is "
     "that of a velocity, expected that of a length"},
    {"UnitMismatchOfGround", "unit = \"gal\"", "unit = \"kN\"",
     "case.toml:25: "},
    {"NoInterpolation", "interpolation = \"linear\"\n", "",
     "'interpolation' is missing, expected one of held, linear, cubic"},
    {"UnknownChoice", "\"linear\"", "\"spline\"",
     "case.toml:20: record 'quake': 'interpolation' is 'spline', expected one"},
    {"NoFreeParameter", "lower = -0.9", "free = false",
     "case.toml: no parameter is free"},
    {"CrossedBounds", "lower = -0.9", "lower = 0.9\nupper = 0.5",
     "case.toml:15: group 'k1': the bounds of 'k1' are crossed"},
    {"OutsideBounds", "lower = -0.9", "lower = 0.9",
     "the initial value of 'k1', 0, lies outside its bounds"},
    {"CoarseSampling", "start = \"rest\"",
     "start = \"rest\"\nsubsteps = 1\nresample_hz = 4.0",
     "case.toml:22: record 'quake': its sampling is too coarse for the model's "
     "highest mode"},
    {"ResampledToAbsurdity", "start = \"rest\"",
     "start = \"rest\"\nresample_hz = 1e9",
     "case.toml:22: record 'quake': 'resample_hz' is more than 100 times"},
    {"WindowOutside", "start = \"rest\"",
     "start = \"rest\"\nwindow = [0.0, 99.0]",
     "case.toml:22: record 'quake': window [0, 99] reaches beyond"},
    {"FilterAboveNyquist", "start = \"rest\"",
     "start = \"rest\"\nfilter = {type = \"lowpass\", corner_hz = 80.0}",
     "case.toml:22: "},
    {"TwoOfAName", "column = \"d2\"", "column = \"d2\"\n  name = \"a1\"",
     "its name is used twice in this record"},
    {"NameWithASlash", "name = \"quake\"", "name = \"../quake\"",
     "case.toml:17: record '../quake': '../quake' cannot be a name here"},
    {"NoTime", "time = \"t\"\n", "", "'time' is missing"},
    {"UnknownQuantity", "quantity = \"displacement\"", "quantity = \"strian\"",
     "case.toml:33: "},
    {"OnlyHoldOut", "name = \"quake\"", "name = \"quake\"\nrole = \"holdout\"",
     "no training record has a fitted channel"},
};

std::string BadCaseName(const ::testing::TestParamInfo<BadCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(All, BadCaseTest, ::testing::ValuesIn(kBadCases),
                         BadCaseName);

TEST(CaseFileTest, MissingCaseFile) {
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase("/nonexistent/case.toml", &c, &error));
  EXPECT_THAT(error, HasSubstr("/nonexistent/case.toml"));
}

}  // namespace
}  // namespace pinode
