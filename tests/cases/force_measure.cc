#include "tests/cases/force_measure.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"

namespace pinode {
namespace testing {
namespace {

const char kFolder[] = "data/three_storey_force/";

nlohmann::json ReadTruth() {
  std::ifstream file(std::string(PINODE_SOURCE_DIR) + "/" + kFolder +
                     "truth.json");
  return nlohmann::json::parse(file);
}

const nlohmann::json& TruthTree() {
  static const auto* const kTree = new nlohmann::json(ReadTruth());
  return *kTree;
}

// A force that is known, times one parameter.
class GivenForce final : public ForceHistory {
 public:
  explicit GivenForce(std::string record) : record_(std::move(record)) {}
  int num_parameters() const override { return 1; }
  Local Evaluate(double time, const double* parameters) const override {
    Local local;
    local.count = 1;
    local.derivatives[0] = TrueForce(record_, time);
    local.value = parameters[0] * local.derivatives[0];
    return local;
  }
  WideJet Evaluate(double time, const WideJet* parameters) const override {
    return TrueForce(record_, time) * parameters[0];
  }
  std::string Description() const override { return "given"; }

 private:
  std::string record_;
};

}  // namespace

Case ForceCase(const std::string& name) {
  return ReadCaseOrFail(kFolder + name + ".toml");
}

double ForceTruthNumber(const std::string& pointer) {
  return TruthTree()
      .at(nlohmann::json::json_pointer("/" + pointer))
      .get<double>();
}

double TrueForce(const std::string& record, double time) {
  const nlohmann::json& truth = TruthTree();
  if (record == "impact") {
    const nlohmann::json& pulse = truth["pulse"];
    const double phase =
        (time - pulse["start"].get<double>()) / pulse["duration"].get<double>();
    if (phase <= 0.0 || phase >= 1.0) return 0.0;
    return pulse["amplitude"].get<double>() * std::sin(kPi * phase);
  }
  if (record == "gust") {
    const nlohmann::json& gust = truth["gust"];
    double force = 0.0;
    for (size_t i = 0; i < gust["peaks"].size(); ++i) {
      const double s = (time - gust["times"][i].get<double>()) /
                       gust["widths"][i].get<double>();
      force += gust["peaks"][i].get<double>() * std::exp(-s * s);
    }
    return force;
  }
  const nlohmann::json& sweeps = truth["sweeps"];
  const double first = sweeps[record]["first"].get<double>();
  const double last = sweeps[record]["last"].get<double>();
  const double duration = sweeps["duration"].get<double>();
  const double edge = std::clamp(
      std::min(time, duration - time) / sweeps["taper"].get<double>(), 0.0,
      1.0);
  const double phase =
      2.0 * kPi *
      (first * time + (last - first) * time * time / (2.0 * duration));
  return sweeps["force"].get<double>() * std::sin(phase) * 0.5 *
         (1.0 - std::cos(kPi * edge));
}

void DrawNoiseAnew(uint64_t seed, Case* c) {
  IdentificationProblem problem = c->problem;
  const StructuralDynamics& given = *problem.dynamics;
  auto dynamics =
      std::make_shared<StructuralDynamics>(given.model(), given.inputs());
  std::string error;
  for (const LawTerm& law : given.laws()) {
    ASSERT_TRUE(dynamics->AddLaw(law, &error)) << error;
  }
  UnknownForceTerm term;
  term.name = "given";
  term.history = std::make_shared<GivenForce>(problem.records[0].name);
  term.outputs = given.unknown_forces().empty()
                     ? Vector(given.networks()[0].outputs.col(0))
                     : given.unknown_forces()[0].outputs;
  term.parameters.name = "given";
  Parameter one;
  one.name = "given.factor";
  one.value = 1.0;
  term.parameters.parameters = {one};
  ASSERT_TRUE(dynamics->AddUnknownForce(term, &error)) << error;
  problem.dynamics = dynamics;
  // Steps that a blow between the samples does not notice.
  problem.records[0].substeps = 100;
  RecordScore score;
  ScoreRecord(problem, 0, dynamics->Parameters(),
              Vector::Zero(dynamics->num_states()), 0, &score);
  ASSERT_TRUE(score.finite);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  auto& channels = c->problem.records[0].channels;
  for (size_t i = 0; i < channels.size(); ++i) {
    Vector values = score.prediction.row(static_cast<Eigen::Index>(i));
    const double sigma = 0.01 * StandardDeviationOfPresent(values);
    for (double& value : values) value += sigma * normal(random);
    channels[i].values = values;
  }
}

ForceScore ScoreForce(const CaseRun& run) {
  const ForceEstimate& force = run.summary.forces.at(0);
  const std::string& record =
      run.c.problem.records[static_cast<size_t>(force.record)].name;
  const Vector truth = force.times.unaryExpr(
      [&](double time) { return TrueForce(record, time); });
  const double peak = truth.cwiseAbs().maxCoeff();
  ForceScore score;
  score.nrmse = (force.value - truth).norm() /
                (truth.array() - truth.mean()).matrix().norm();
  double inside = 0.0, acting = 0.0, inside_acting = 0.0;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const bool held =
        truth[i] >= force.lower95[i] && truth[i] <= force.upper95[i];
    inside += held;
    if (std::abs(truth[i]) < 0.02 * peak) continue;
    acting += 1.0;
    inside_acting += held;
  }
  score.coverage = inside / static_cast<double>(truth.size());
  score.coverage_acting = inside_acting / std::max(1.0, acting);
  if (record != "impact") return score;
  const double start = ForceTruthNumber("pulse/start");
  const double duration = ForceTruthNumber("pulse/duration");
  const double step = force.times[1] - force.times[0];
  Eigen::Index largest = 0;
  force.value.maxCoeff(&largest);
  double impulse = 0.0;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const double t = force.times[i];
    if (t > start - 0.03 && t < start + duration + 0.03) {
      impulse += step * force.value[i];
    }
  }
  score.impulse_error =
      std::abs(impulse / ForceTruthNumber("pulse/impulse") - 1.0);
  score.peak_error = std::abs(force.times[largest] - start - 0.5 * duration);
  for (const ParameterEstimate& parameter : run.summary.parameters) {
    const auto relative_error = [&](const char* name) {
      return std::abs(parameter.value / ForceTruthNumber(name) - 1.0);
    };
    if (parameter.name == "blow.start") {
      score.start_error = std::abs(parameter.value - start);
    } else if (parameter.name == "blow.duration") {
      score.duration_error = relative_error("pulse/duration");
    } else if (parameter.name == "blow.amplitude") {
      score.amplitude_error = relative_error("pulse/amplitude");
    }
  }
  return score;
}

}  // namespace testing
}  // namespace pinode
