#include "pinode/estimate/fit/pulse_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

struct Pulse {
  double start, duration, amplitude;
};

UnknownForceTerm PulseAt(const std::string& name, int dof, const Pulse& pulse) {
  UnknownForceTerm term;
  term.name = name;
  term.history = std::make_shared<HalfSinePulse>();
  term.outputs = Vector::Unit(2, dof);
  term.parameters.name = name;
  const std::vector<std::pair<const char*, double>> values = {
      {"start", pulse.start},
      {"duration", pulse.duration},
      {"amplitude", pulse.amplitude}};
  for (const auto& [key, value] : values) {
    Parameter parameter;
    parameter.name = name + "." + key;
    parameter.value = value;
    if (key == std::string("duration")) parameter.lower = 0.01;
    term.parameters.parameters.push_back(parameter);
  }
  return term;
}

// Two masses, 1.5 and 4 Hz, whose accelerations are measured for 4 s; pulses
// as in `truth` act, those in `guess` are where the search begins.
IdentificationProblem PulseProblem(const std::vector<Pulse>& truth,
                                   const std::vector<Pulse>& guess) {
  IdentificationRecord record;
  record.name = "r";
  record.start = IdentificationRecord::Start::kRest;
  record.excitation.emplace(0.0, 0.02, Matrix(0, 201), Interpolation::kLinear);
  record.substeps = 10;
  for (int i = 0; i < 2; ++i) {
    MeasuredChannel channel;
    channel.observation = {"a" + std::to_string(i + 1),
                           Quantity::kAbsoluteAcceleration, Vector::Unit(2, i)};
    channel.values = Vector::Zero(201);
    record.channels.push_back(channel);
  }
  const auto with = [&](const std::vector<Pulse>& pulses) {
    auto dynamics = std::make_shared<StructuralDynamics>(
        testing::MakeChain(2, 240.0, 0.4), std::vector<InputSpec>{});
    std::string error;
    for (size_t j = 0; j < pulses.size(); ++j) {
      EXPECT_TRUE(dynamics->AddUnknownForce(
          PulseAt("p" + std::to_string(j + 1), 1, pulses[j]), &error))
          << error;
    }
    return dynamics;
  };
  IdentificationProblem problem;
  problem.dynamics = with(truth);
  problem.records = {record};
  RecordScore score;
  ScoreRecord(problem, 0, problem.dynamics->Parameters(), Vector::Zero(4), 0,
              &score);
  EXPECT_TRUE(score.finite);
  testing::Gaussian random(7);
  for (int c = 0; c < 2; ++c) {
    Vector& values = problem.records[0].channels[static_cast<size_t>(c)].values;
    values = score.prediction.row(c);
    const double sigma = 0.01 * StandardDeviationOfPresent(values);
    values += sigma * random.Draw(201);
  }
  problem.dynamics = with(guess);
  return problem;
}

TEST(PulseScanFigures, FindsAPulseFarFromWhereItBegins) {
  const Pulse truth = {2.317, 0.06, 30.0};
  for (const double start : {0.0, 1.0, 3.5}) {
    const IdentificationProblem problem =
        PulseProblem({truth}, {{start, 0.1, 5.0}});
    Vector parameters = problem.dynamics->Parameters();
    ScanPulses(problem, &parameters);
    EXPECT_NEAR(parameters[0], truth.start, 0.06);
    // Its impulse.
    EXPECT_NEAR(parameters[1] * parameters[2] / 1.8, 1.0, 0.1);

    IdentificationSummary summary;
    IdentifiedModel model;
    IdentificationOptions options;
    options.shooting = IdentificationOptions::Shooting::kSingle;
    testing::FitAndJudge(problem, options, nullptr, &summary, &model);
    EXPECT_TRUE(summary.usable()) << summary.message;
    EXPECT_NEAR(model.parameters[0], truth.start, 0.004);
    EXPECT_NEAR(model.parameters[1] * model.parameters[2], 1.8, 0.02);
  }
}

TEST(PulseScan, FindsTwoPulses) {
  const IdentificationProblem problem =
      PulseProblem({{0.913, 0.06, 30.0}, {2.5, 0.08, -20.0}},
                   {{0.0, 0.06, 1.0}, {0.0, 0.06, 1.0}});
  Vector parameters = problem.dynamics->Parameters();
  ScanPulses(problem, &parameters);
  EXPECT_NEAR(parameters[0], 0.913, 0.06);
  EXPECT_NEAR(parameters[3], 2.5, 0.06);
  EXPECT_GT(parameters[2], 0.0);
  EXPECT_LT(parameters[5], 0.0);
}

// Bounds are kept, and what is fixed stays.
TEST(PulseScan, KeepsToWhatItIsTold) {
  IdentificationProblem problem =
      PulseProblem({{2.317, 0.06, 30.0}}, {{0.5, 0.1, 5.0}});
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(2, 240.0, 0.4), std::vector<InputSpec>{});
  UnknownForceTerm term = PulseAt("p1", 1, {0.5, 0.1, 5.0});
  std::vector<Parameter>& p = term.parameters.parameters;
  p[0].lower = 0.2;
  p[0].upper = 1.1;
  p[1].free = false;
  p[2].upper = 8.0;
  std::string error;
  ASSERT_TRUE(dynamics->AddUnknownForce(term, &error)) << error;
  problem.dynamics = dynamics;
  Vector parameters = dynamics->Parameters();
  ScanPulses(problem, &parameters);
  EXPECT_GE(parameters[0], 0.2);
  EXPECT_LE(parameters[0], 1.1);
  EXPECT_EQ(parameters[1], 0.1);
  EXPECT_LE(parameters[2], 8.0);

  p[0].free = false;
  auto fixed = std::make_shared<StructuralDynamics>(
      testing::MakeChain(2, 240.0, 0.4), std::vector<InputSpec>{});
  ASSERT_TRUE(fixed->AddUnknownForce(term, &error)) << error;
  problem.dynamics = fixed;
  parameters = fixed->Parameters();
  ScanPulses(problem, &parameters);
  EXPECT_EQ(parameters, fixed->Parameters());
}

}  // namespace
}  // namespace pinode
