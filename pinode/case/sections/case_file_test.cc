#include "pinode/case/sections/case_file.h"

#include <cmath>
#include <ostream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/problem/record_grid.h"
#include "pinode/structure/model/shear_building.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

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

// As mass and stiffness may be given.
TEST(CaseFileTest, DampingOfAFileInATable) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  folder.Write("C.csv", "3, -1\n-1, 1\n");
  const Case c = ReadOrFail(folder.Write(
      "case.toml", Replaced(SmallCase(), "damping = {ratios = [0.02]}",
                            "damping = {file = \"C.csv\"}")));
  ASSERT_NE(c.problem.dynamics, nullptr);
  EXPECT_EQ(c.problem.dynamics->model().damping(0, 0), 3.0);
  EXPECT_EQ(c.problem.dynamics->model().damping(0, 1), -1.0);
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
  EXPECT_THAT(error, HasSubstr("needs adds_to = \"damping\""));
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

  // The start of a training record is estimated from its first samples.
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
  EXPECT_THAT(error, HasSubstr("needs start = \"free\""));
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
      "eternal.toml", Replaced(text, "duration = 2.0", "duration = 1e99"));
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
  EXPECT_THAT(error, HasSubstr("integrator = \"exact\" needs a linear model "
                               "with constant matrices"));
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

}  // namespace
}  // namespace pinode
