// Forces that nobody measured, and a stiffness that follows time:
// data/three_storey_force.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/figure_testing.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {
namespace {

const char kFolder[] = "data/three_storey_force/";

Case ForceCase(const std::string& name) {
  return ReadCaseOrFail(kFolder + name + ".toml");
}

double ForceTruth(const std::string& pointer) {
  return Truth(std::string(kFolder) + "truth.json", "/" + pointer);
}

void Expect(const std::string& what, const Asked& asked, double measured) {
  ReportFigure(what, asked, measured);
  EXPECT_GE(measured, asked.least) << what;
  EXPECT_LE(measured, asked.most) << what;
}

Vector TruePulse(const Vector& times) {
  const double start = ForceTruth("pulse/start");
  const double duration = ForceTruth("pulse/duration");
  const double amplitude = ForceTruth("pulse/amplitude");
  return times.unaryExpr([&](double t) {
    const double phase = (t - start) / duration;
    return phase > 0.0 && phase < 1.0
               ? amplitude * std::sin(3.141592653589793 * phase)
               : 0.0;
  });
}

// The column F of a record's file: what acted, at the samples.
Vector ForceThatActed(const Case& c, const std::string& file) {
  const std::filesystem::path path =
      std::filesystem::path(c.path).parent_path() / file;
  std::ifstream stream(path);
  std::string line;
  std::vector<double> values;
  std::getline(stream, line);
  EXPECT_EQ(line.substr(line.rfind(',') + 1), "F") << path;
  while (std::getline(stream, line)) {
    values.push_back(std::stod(line.substr(line.rfind(',') + 1)));
  }
  return Eigen::Map<const Vector>(values.data(),
                                  static_cast<Eigen::Index>(values.size()));
}

double ErrorOf(const Vector& estimate, const Vector& truth) {
  return (estimate - truth).norm() /
         (truth.array() - truth.mean()).matrix().norm();
}

// Share of the values that lie within their 95 % band.
double Coverage(const Vector& truth, const Vector& lower, const Vector& upper) {
  return ((truth.array() >= lower.array()) && (truth.array() <= upper.array()))
      .cast<double>()
      .mean();
}

struct Blow {
  double impulse_error = 0.0;  // within 30 ms of the blow, relative
  double peak_error = 0.0;     // s
  double nrmse = 0.0;
  double coverage = 0.0;
};

Blow MeasureBlow(const CaseRun& run) {
  const ForceEstimate& force = run.summary.forces.at(0);
  const double start = ForceTruth("pulse/start");
  const double duration = ForceTruth("pulse/duration");
  const double step = force.times[1] - force.times[0];
  const Vector truth = TruePulse(force.times);
  Eigen::Index peak = 0;
  force.value.maxCoeff(&peak);
  double impulse = 0.0;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const double t = force.times[i];
    if (t > start - 0.03 && t < start + duration + 0.03) {
      impulse += step * force.value[i];
    }
  }
  Blow blow;
  blow.impulse_error = std::abs(impulse / ForceTruth("pulse/impulse") - 1.0);
  blow.peak_error = std::abs(force.times[peak] - start - 0.5 * duration);
  blow.nrmse = ErrorOf(force.value, truth);
  blow.coverage = Coverage(truth, force.lower95, force.upper95);
  return blow;
}

TEST(ForceCases, ABlowIsFoundWithLocalSmoothness) {
  const CaseRun run = RunCase(ForceCase("impact"));
  ASSERT_TRUE(run.summary.usable) << run.summary.message;
  const Blow blow = MeasureBlow(run);
  Expect("impact, local smoothness: impulse, relative error", AtMost(0.05),
         blow.impulse_error);
  Expect("impact, local smoothness: peak time, s (a sample is 0.01)",
         AtMost(0.01), blow.peak_error);
  Expect("impact, local smoothness: force, share within its 95 % band",
         AtLeast(0.9), blow.coverage);
  ReportFigure("impact, local smoothness: force, nrmse", Nothing(), blow.nrmse);

  // One precision for all knots smears the blow.
  Case global = ForceCase("impact");
  StructuralDynamics dynamics(global.problem.dynamics->model(),
                              global.problem.dynamics->inputs());
  std::string error;
  for (const LawTerm& law : global.problem.dynamics->laws()) {
    ASSERT_TRUE(dynamics.AddLaw(law, &error)) << error;
  }
  UnknownForceTerm term = global.problem.dynamics->unknown_forces()[0];
  const double spacing =
      dynamic_cast<const SplineForce&>(*term.history).options().spacing;
  term.prior = SmoothnessPrior(term.parameters.size(), term.parameters.size(),
                               spacing / 0.1);
  ASSERT_TRUE(dynamics.AddUnknownForce(term, &error)) << error;
  global.problem.dynamics = std::make_shared<StructuralDynamics>(dynamics);
  const Blow smeared = MeasureBlow(RunCase(std::move(global)));
  ReportFigure("impact, one smoothness for all: impulse, relative error",
               Nothing(), smeared.impulse_error);
  ReportFigure("impact, one smoothness for all: force, nrmse", Nothing(),
               smeared.nrmse);
  EXPECT_GT(smeared.nrmse, 3.0 * blow.nrmse);
}

TEST(ForceCases, ABlowIsFoundAsAPulse) {
  const CaseRun run = RunCase(ForceCase("impact_pulse"));
  ASSERT_TRUE(run.summary.usable) << run.summary.message;
  const double impulse = run.Parameter("blow.amplitude").value *
                         run.Parameter("blow.duration").value * 2.0 /
                         3.141592653589793;
  Expect("impact, half-sine pulse: impulse, relative error", AtMost(0.005),
         std::abs(impulse / ForceTruth("pulse/impulse") - 1.0));
  Expect("impact, half-sine pulse: peak time, s", AtMost(0.01),
         MeasureBlow(run).peak_error);
  // Ninety-five per cent intervals, three of them, one seed.
  for (const char* name : {"start", "duration", "amplitude"}) {
    const ParameterEstimate& p = run.Parameter(std::string("blow.") + name);
    EXPECT_LT(std::abs(p.value - ForceTruth(std::string("pulse/") + name)),
              3.5 * p.sigma)
        << name;
  }
}

void ExpectSweep(const std::string& name, const std::string& file,
                 double limit) {
  const CaseRun run = RunCase(ForceCase(name));
  ASSERT_TRUE(run.summary.usable) << run.summary.message;
  const ForceEstimate& force = run.summary.forces.at(0);
  const int substeps = run.c.problem.records[0].substeps;
  const Vector truth = ForceThatActed(run.c, file);
  Vector value(truth.size()), lower(truth.size()), upper(truth.size());
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    value[i] = force.value[substeps * i];
    lower[i] = force.lower95[substeps * i];
    upper[i] = force.upper95[substeps * i];
  }
  Expect(name + ": force, nrmse", AtMost(limit), ErrorOf(value, truth));
  Expect(name + ": force, share within its 95 % band", AtLeast(0.85),
         Coverage(truth, lower, upper));
}

TEST(ForceCases, ASweptSineIsFoundFromAccelerations) {
  ExpectSweep("sweep", "sweep.csv", 0.06);
}

TEST(ForceCases, ASweptSineIsFoundWithOneDisplacement) {
  ExpectSweep("sweep_displacement", "sweep_wide.csv", 0.05);
}

TEST(ForceCases, TheStaticPartIsSaidToBeUnseen) {
  const auto unseen =
      ::testing::HasSubstr("The static part of the unknown force");
  EXPECT_THAT(ForceCase("sweep").remarks, ::testing::Contains(unseen));
  EXPECT_THAT(ForceCase("impact").remarks, ::testing::Contains(unseen));
  EXPECT_THAT(ForceCase("sweep_displacement").remarks,
              ::testing::Not(::testing::Contains(unseen)));
}

TEST(ForceCases, DegradingStiffnessIsFollowed) {
  const CaseRun run = RunCase(ForceCase("degrading"));
  ASSERT_TRUE(run.summary.usable) << run.summary.message;
  Expect("degrading stiffness: initial value, relative error", AtMost(0.001),
         std::abs(run.Parameter("k1").value - ForceTruth("degrading/initial")));
  Expect(
      "degrading stiffness: rate, relative error", AtMost(0.003),
      std::abs(run.Parameter("k1_rate").value / ForceTruth("degrading/rate") -
               1.0));
}

}  // namespace
}  // namespace testing
}  // namespace pinode
