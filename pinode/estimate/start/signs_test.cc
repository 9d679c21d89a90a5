#include "pinode/estimate/start/signs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/parameter_layout.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Three storeys, 1.4, 4 and 5.7 Hz, 1 % damping in the first mode, under a
// ground motion and a force at the top, both white.
struct Frame {
  // `change`: of the storeys' stiffness in truth, which the model does not
  // know. What was measured is as if the force were its column times `scale`,
  // and the sensors read gains times the absolute accelerations.
  Frame(const std::vector<double>& change, double scale,
        const std::vector<double>& gains, double ground, uint64_t seed) {
    const StructuralModel model = ::pinode::testing::MakeChain(3, 400.0, 1.0);
    const std::vector<InputSpec> inputs = {
        {InputSpec::Kind::kGroundAcceleration, 0, "ground_x"},
        {InputSpec::Kind::kForce, 2, "force_u3"}};
    StructuralModel truth = model;
    for (int i = 0; i < 3; ++i) {
      truth.stiffness +=
          change[static_cast<size_t>(i)] * 400.0 * SpringMatrix(3, i - 1, i);
    }
    testing::Gaussian random(seed);
    Matrix columns(2, 1500);
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      columns(0, i) = ground * random.Next();
      columns(1, i) = random.Next();
    }
    IdentificationRecord record;
    record.name = "shake";
    record.substeps = 2;
    record.start = IdentificationRecord::Start::kRest;
    for (int i = 0; i < 3; ++i) {
      record.channels.push_back(testing::MakeChannel(
          "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, 3, i));
    }
    Matrix acted = columns;
    acted.row(1) *= scale;
    record.excitation.emplace(0.0, 0.02, acted, Interpolation::kLinear);
    testing::Simulate(StructuralDynamics(truth, inputs), Vector(),
                      Vector::Zero(6), 0.0, 1, &record);
    record.excitation.emplace(0.0, 0.02, columns, Interpolation::kLinear);
    for (size_t c = 0; c < 3; ++c) record.channels[c].values *= gains[c];

    dynamics = std::make_shared<StructuralDynamics>(model, inputs);
    problem.dynamics = dynamics;
    problem.records = {record};
    problem.sensors.name = "sensors";
  }

  Parameter* AddGain(int channel) {
    Parameter gain;
    gain.name = "gain.a" + std::to_string(channel + 1);
    gain.value = gain.prior_mean = 1.0;
    problem.records[0].channels[static_cast<size_t>(channel)].gain =
        problem.sensors.size();
    problem.sensors.parameters.push_back(gain);
    return &problem.sensors.parameters.back();
  }

  void AddScale(double lower = -kInfinity) {
    ForceScaleTerm term;
    term.name = "scale.force_u3";
    term.forces = {{1, -1}};
    term.parameters.name = term.name;
    Parameter parameter;
    parameter.name = term.name;
    parameter.value = 1.0;
    parameter.lower = lower;
    term.parameters.parameters = {parameter};
    std::string error;
    ASSERT_TRUE(dynamics->AddForceScale(std::move(term), &error)) << error;
  }

  std::vector<double> Found() const {
    Vector parameters = ParameterLayout(problem).InitialValues();
    FindSigns(problem, &parameters);
    return {parameters.begin(), parameters.end()};
  }
  std::vector<std::string> Remarks() const {
    return SignRemarks(problem, ParameterLayout(problem).InitialValues());
  }

  std::shared_ptr<StructuralDynamics> dynamics;
  IdentificationProblem problem;
};

// Found alike at all sensors, it is the excitation's.
TEST(Signs, DelaysOfAllSensors) {
  Frame frame({0.0, 0.0, 0.0}, 1.0, {1.0, 1.0, 1.0}, 1.0, 1);
  for (size_t i = 0; i < 3; ++i) {
    Parameter delay;
    delay.name = "delay.a" + std::to_string(i + 1);
    frame.problem.records[0].channels[i].delay = frame.problem.sensors.size();
    frame.problem.sensors.parameters.push_back(delay);
  }
  EXPECT_THAT(frame.Remarks(), IsEmpty());
  const auto remarks = [&frame](const std::vector<double>& delays) {
    return SignRemarks(frame.problem,
                       Eigen::Map<const Vector>(delays.data(), 3));
  };
  EXPECT_THAT(remarks({0.0401, 0.04, 0.0399}),
              ElementsAre(HasSubstr("All sensors are late by the same time, "
                                    "0.04 s")));
  EXPECT_THAT(remarks({-0.0401, -0.04, -0.0399}),
              ElementsAre(HasSubstr("All sensors are early")));
  EXPECT_THAT(remarks({0.04, 0.01, 0.04}), IsEmpty());
  EXPECT_THAT(remarks({0.004, 0.004, 0.004}), IsEmpty());
}

const std::vector<double> kSameStoreys = {0.0, 0.0, 0.0};

// Storeys that are off by up to 40 % put every resonance elsewhere; the
// correlation of the records in time with the model's own response, damped as
// it is, is then next to nothing.
TEST(Signs, GainsOfAModelThatIsFarOff) {
  const std::vector<std::vector<double>> changes = {
      kSameStoreys,     {-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4},
      {-0.3, 0.2, 0.1}, {0.4, -0.4, 0.0},   {-0.4, 0.3, -0.3}};
  for (const std::vector<double>& change : changes) {
    for (const uint64_t seed : {1u, 2u, 3u}) {
      SCOPED_TRACE(seed);
      Frame frame(change, 1.0, {-1.3, 1.0, -0.8}, 1.0, seed);
      for (int i = 0; i < 3; ++i) frame.AddGain(i);
      EXPECT_THAT(frame.Found(), ElementsAre(-1.0, 1.0, -1.0));
    }
  }
}

TEST(Signs, OfAForceAndASensor) {
  for (const double ground : {0.0, 1.0}) {
    for (const double scale : {-2.5, 2.5}) {
      for (const double gain : {-1.0, 1.0}) {
        SCOPED_TRACE(gain);
        Frame frame({-0.3, 0.2, 0.1}, scale, {1.0, gain, 1.0}, ground, 4);
        frame.AddScale();
        frame.AddGain(1);
        EXPECT_THAT(frame.Found(),
                    ElementsAre(std::copysign(1.0, scale), gain));
      }
    }
  }
}

// Given signs stay, and so do signs that the record does not determine.
TEST(Signs, StayWhereTheyAreSaid) {
  {
    Frame frame(kSameStoreys, 1.0, {-1.0, -1.0, -1.0}, 1.0, 5);
    frame.AddGain(0)->lower = 0.0;
    frame.AddGain(1)->prior_sigma = 0.1;
    frame.AddGain(2)->free = false;
    EXPECT_THAT(frame.Found(), ElementsAre(1.0, 1.0, 1.0));
  }
  {
    Frame frame(kSameStoreys, -1.0, {1.0, 1.0, 1.0}, 0.0, 5);
    frame.AddScale(0.0);
    EXPECT_THAT(frame.Found(), ElementsAre(1.0));
  }
  {
    Frame frame(kSameStoreys, 1.0, {1.0, 1.0, 1.0}, 1.0, 5);
    frame.AddGain(0);
    testing::Gaussian random(11);
    for (double& value : frame.problem.records[0].channels[0].values) {
      value = random.Next();
    }
    EXPECT_THAT(frame.Found(), ElementsAre(1.0));
  }
}

// A gain whose bounds leave little room on the other side begins there.
TEST(Signs, StayWithinBounds) {
  Frame frame(kSameStoreys, 1.0, {-1.0, 1.0, 1.0}, 1.0, 5);
  frame.AddGain(0)->lower = -0.5;
  EXPECT_THAT(frame.Found(), ElementsAre(-0.5));
}

TEST(Signs, RemarksOnSensorsThatGoAgainstTheModel) {
  const std::vector<double> change = {-0.2, 0.1, 0.1};
  EXPECT_THAT(Frame(change, 1.0, {1.0, 1.0, 1.0}, 1.0, 6).Remarks(), IsEmpty());
  EXPECT_THAT(Frame(change, 1.0, {1.0, 1.0, -1.0}, 1.0, 6).Remarks(),
              ElementsAre(AllOf(HasSubstr("Channel 'a3' (agreement -0."),
                                HasSubstr("probably upside down"),
                                HasSubstr("sign = -1"))));
  EXPECT_THAT(Frame(change, 1.0, {-1.0, -1.0, -1.0}, 1.0, 6).Remarks(),
              ElementsAre(HasSubstr("All channels have the opposite sign")));
  // One whose gain is unknown takes no part.
  Frame frame(change, 1.0, {1.0, 1.0, -1.0}, 1.0, 6);
  frame.AddGain(2);
  EXPECT_THAT(frame.Remarks(), IsEmpty());
}

// Several in one line.
TEST(Signs, OneRemarkOnAllThatGoAgainstTheModel) {
  const std::vector<std::string> remarks =
      Frame({-0.2, 0.1, 0.1}, 1.0, {1.0, -1.0, -1.0}, 1.0, 6).Remarks();
  EXPECT_THAT(remarks, ElementsAre(AllOf(HasSubstr("Channels 'a2' ("),
                                         HasSubstr(", 'a3' ("),
                                         HasSubstr("They are probably"))));
}

// Two masses that move along x and along y, each under a force of its own, and
// storeys that are 30 % too stiff in the model.
std::vector<std::string> RemarksOnAxes(bool are_exchanged, double noise) {
  StructuralModel model = ::pinode::testing::MakeChain(4, 400.0, 1.0);
  for (const int i : {1, 3}) {
    model.stiffness.row(i).setZero();
    model.stiffness.col(i).setZero();
  }
  model.stiffness(0, 0) = model.stiffness(2, 2) = 300.0;
  model.stiffness(0, 2) = model.stiffness(2, 0) = -100.0;
  model.stiffness(1, 1) = model.stiffness(3, 3) = 700.0;
  model.stiffness(1, 3) = model.stiffness(3, 1) = -250.0;
  model.damping = 0.002 * model.stiffness;
  const std::vector<InputSpec> inputs = {{InputSpec::Kind::kForce, 2, "fx"},
                                         {InputSpec::Kind::kForce, 3, "fy"}};
  StructuralModel truth = model;
  truth.stiffness /= 1.3;
  testing::Gaussian random(3);
  Matrix columns(2, 1500);
  for (double& value : columns.reshaped()) value = random.Next();
  IdentificationRecord record;
  record.name = "shaker";
  record.substeps = 2;
  record.start = IdentificationRecord::Start::kRest;
  const char* const names[] = {"x1", "y1", "x2", "y2"};
  for (int i = 0; i < 4; ++i) {
    record.channels.push_back(
        testing::MakeChannel(names[i], Quantity::kAbsoluteAcceleration, 4, i));
  }
  record.excitation.emplace(0.0, 0.02, columns, Interpolation::kLinear);
  testing::Simulate(StructuralDynamics(truth, inputs), Vector(),
                    Vector::Zero(8), noise, 1, &record);
  if (are_exchanged) {
    std::swap(record.channels[2].values, record.channels[3].values);
  }
  IdentificationProblem problem;
  problem.dynamics = std::make_shared<StructuralDynamics>(model, inputs);
  problem.records = {record};
  return SignRemarks(problem, ParameterLayout(problem).InitialValues());
}

TEST(Signs, RemarksOnExchangedAxes) {
  for (const double noise : {0.0, 0.2}) {
    EXPECT_THAT(RemarksOnAxes(false, noise), IsEmpty());
    EXPECT_THAT(RemarksOnAxes(true, noise),
                ElementsAre(AllOf(HasSubstr("Channels 'x2' and 'y2' agree"),
                                  HasSubstr("They are probably exchanged"))));
  }
}

// Noise free, all is found to rounding, and told.
TEST(Signs, FitOfAScaleAndAGain) {
  Frame frame({0.0, 0.0, 0.0}, -2.5, {1.0, 1.0, -1.3}, 0.0, 7);
  GroupTerm group;
  group.group.name = "k1";
  group.group.matrix = 400.0 * SpringMatrix(3, -1, 0);
  group.alpha.value = 0.25;
  std::string error;
  ASSERT_TRUE(frame.dynamics->AddGroup(group, &error)) << error;
  frame.AddScale();
  frame.AddGain(2);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(frame.problem, IdentificationOptions(), nullptr,
                       &summary, &model);
  ASSERT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(model.parameters.size(), 3);
  EXPECT_NEAR(model.parameters[0], 0.0, 1e-6);
  EXPECT_NEAR(model.parameters[1], -2.5, 1e-6);
  EXPECT_NEAR(model.parameters[2], -1.3, 1e-6);
  EXPECT_THAT(summary.remarks,
              ElementsAre(AllOf(HasSubstr("'scale.force_u3'"),
                                HasSubstr("scale = -2.5")),
                          "Sensor 'a3' is mounted upside down: gain = -1.3."));
}

}  // namespace
}  // namespace pinode
