#include "tests/support/report_testing.h"

#include <cctype>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/integrate/free_run.h"
#include "pinode/structure/model/modal_analysis.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace testing {
namespace {

constexpr int kDofs = 3;
constexpr int kSamples = 3000;
constexpr double kStep = 0.01;
constexpr double kMass = 2000.0;
constexpr double kStiffness = 3.0e6;

// The truth: k1, k2, k3, c, cubic, Bouc-Wen k, a, b, g, n, beta.
std::vector<double> TrueNamedParameters() {
  return {0.2, -0.15, 0.1, 0.05, 6.0e9, 2.0e5, 1.0, 400.0, 400.0, 1.0, 1.0};
}

void AddGroup(const std::string& name, MatrixGroup::Target target,
              const Matrix& matrix, StructuralDynamics* dynamics) {
  GroupTerm term;
  term.group.name = name;
  term.group.target = target;
  term.group.matrix = matrix;
  term.alpha.name = name;
  term.alpha.lower = -0.9;
  std::string error;
  CHECK(dynamics->AddGroup(std::move(term), &error)) << error;
}

void AddLaw(const std::string& name, const std::string& type, int from, int to,
            const std::vector<double>& values,
            const std::vector<std::string>& units,
            StructuralDynamics* dynamics) {
  LawTerm term;
  term.name = name;
  term.type = type;
  std::string error;
  term.law = CreateElement(type, &error);
  CHECK(term.law != nullptr) << error;
  term.features = {Feature::Deformation(from, to),
                   Feature::DeformationRate(from, to)};
  term.outputs = Matrix::Zero(kDofs, 1);
  term.outputs(to, 0) = 1.0;
  if (from >= 0) term.outputs(from, 0) = -1.0;
  term.parameters.name = name;
  size_t i = 0;
  for (const ElementParameterInfo& info : ElementParameters(type)) {
    Parameter parameter;
    parameter.name = name + "." + info.name;
    parameter.unit = units.at(i);
    parameter.value = values.at(i);
    // The shape of the hysteresis is taken as known.
    parameter.free = info.name == "k3" || info.name == "k";
    term.parameters.parameters.push_back(parameter);
    ++i;
  }
  CHECK(dynamics->AddLaw(std::move(term), &error)) << error;
}

void AddNetwork(StructuralDynamics* dynamics) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 2;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {4};
  architecture.input_scale = Vector::Constant(2, 0.1);
  NetworkTerm term;
  term.name = "nn1";
  term.network = std::make_shared<Network>(architecture);
  term.features = {Feature::Displacement(2), Feature::Velocity(2)};
  term.outputs = Matrix::Identity(kDofs, kDofs).rightCols(1);
  term.output_names = {"u3"};
  term.weights.name = "nn1";
  term.weights.named = false;
  for (int i = 0; i < architecture.NumWeights(); ++i) {
    Parameter weight;
    weight.name = "nn1[" + std::to_string(i) + "]";
    term.weights.parameters.push_back(weight);
  }
  std::string error;
  CHECK(dynamics->AddNetwork(std::move(term), &error)) << error;
}

std::shared_ptr<StructuralDynamics> MakeDynamics() {
  Matrix stiffness = Matrix::Zero(kDofs, kDofs);
  for (int i = 0; i < kDofs; ++i) {
    stiffness += kStiffness * SpringMatrix(kDofs, i - 1, i);
  }
  const Matrix mass = kMass * Matrix::Identity(kDofs, kDofs);
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(mass, 1e-3 * stiffness, stiffness),
      std::vector<InputSpec>{
          {InputSpec::Kind::kGroundAcceleration, 0, "ground"}});
  for (int i = 0; i < kDofs; ++i) {
    AddGroup("k" + std::to_string(i + 1), MatrixGroup::Target::kStiffness,
             kStiffness * SpringMatrix(kDofs, i - 1, i), dynamics.get());
  }
  AddGroup("c", MatrixGroup::Target::kDamping, 1e-3 * stiffness,
           dynamics.get());
  AddLaw("spring1", "cubic", -1, 0, {0.0}, {"N/m^3"}, dynamics.get());
  AddLaw("slip2", "bouc_wen", 0, 1, {1.0e5, 1.0, 400.0, 400.0, 1.0, 1.0},
         {"N/m", "1", "1/m", "1/m", "1", "1"}, dynamics.get());
  AddNetwork(dynamics.get());
  return dynamics;
}

// Band-limited noise with a rise and a decay.
Matrix MakeGroundMotion(unsigned seed, double peak) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Matrix ground(1, kSamples);
  double low = 0.0, lower = 0.0, largest = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double t = i * kStep;
    low += 0.25 * (normal(random) - low);
    lower += 0.05 * (low - lower);
    ground(0, i) = (low - lower) * t * std::exp(-0.25 * t);
    largest = std::max(largest, std::abs(ground(0, i)));
  }
  return ground * (peak / largest);
}

void Run(const StructuralDynamics& dynamics, const Vector& theta,
         const IdentificationRecord& record, Trajectory* trajectory) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  CHECK(dynamics.Prepare(theta, &prepared, &error)) << error;
  std::vector<Observation> observations;
  for (const MeasuredChannel& channel : record.channels) {
    observations.push_back(channel.observation);
  }
  CHECK(FreeRun(dynamics, prepared, ObservationMap(dynamics, observations),
                IntegrationGrid(*record.excitation, record.substeps),
                Vector::Zero(dynamics.num_states()), 0, kSamples - 1,
                trajectory));
}

double RelativeError(const Vector& measured, const Vector& predicted) {
  return (measured - predicted).norm() /
         (measured.array() - measured.mean()).matrix().norm();
}

void AddRecord(const std::string& name, IdentificationRecord::Role role,
               unsigned seed, double peak, const Vector& truth,
               const Vector& identified, ReportExample* example) {
  const StructuralDynamics& dynamics = *example->problem.dynamics;
  IdentificationRecord record;
  record.name = name;
  record.role = role;
  record.start = IdentificationRecord::Start::kRest;
  record.substeps = 2;
  record.excitation.emplace(0.0, kStep, MakeGroundMotion(seed, peak),
                            Interpolation::kLinear);
  for (int i = 0; i < kDofs; ++i) {
    MeasuredChannel channel;
    channel.observation.name = "a" + std::to_string(i + 1);
    channel.observation.quantity = Quantity::kAbsoluteAcceleration;
    channel.observation.weights = Vector::Unit(kDofs, i);
    record.channels.push_back(channel);
  }
  Trajectory real, updated, prior;
  Run(dynamics, truth, record, &real);
  Run(dynamics, identified, record, &updated);
  Run(dynamics, dynamics.Parameters(), record, &prior);

  RecordScore score;
  score.name = name;
  score.role = role;
  score.finite = true;
  score.start = Vector::Zero(dynamics.num_states());
  score.prediction = updated.channels;
  score.states = updated.states;
  std::mt19937_64 random(seed + 1000);
  std::normal_distribution<double> normal;
  for (int c = 0; c < kDofs; ++c) {
    Vector values = real.channels.row(c);
    const double sigma =
        0.02 * std::sqrt((values.array() - values.mean()).square().mean());
    for (double& value : values) value += sigma * normal(random);
    record.channels[static_cast<size_t>(c)].values = values;
    ChannelScore channel;
    channel.name = record.channels[static_cast<size_t>(c)].observation.name;
    const Vector difference = values - updated.channels.row(c).transpose();
    channel.rmse = difference.norm() / std::sqrt(double{kSamples});
    channel.nrmse = RelativeError(values, updated.channels.row(c));
    channel.prior_nrmse = RelativeError(values, prior.channels.row(c));
    channel.sigma = sigma;
    score.nrmse += channel.nrmse / kDofs;
    score.prior_nrmse += channel.prior_nrmse / kDofs;
    score.channels.push_back(channel);
  }
  example->problem.records.push_back(record);
  example->summary.records.push_back(score);
  example->priors.push_back(prior.channels);
}

void AddEstimates(const Vector& identified, ReportExample* example) {
  IdentificationSummary& summary = example->summary;
  int index = 0;
  for (const ParameterBlock& block : example->problem.dynamics->blocks()) {
    for (const Parameter& parameter : block.parameters) {
      const double value = identified(index++);
      if (!block.named) continue;
      ParameterEstimate estimate;
      estimate.name = parameter.name;
      estimate.unit = parameter.unit;
      estimate.initial = parameter.value;
      estimate.value = value;
      estimate.free = parameter.free;
      estimate.sigma = parameter.free ? 0.004 * std::abs(value) + 2e-4 : 0.0;
      estimate.lower95 = value - 1.96 * estimate.sigma;
      estimate.upper95 = value + 1.96 * estimate.sigma;
      summary.parameters.push_back(estimate);
      if (parameter.free) summary.covariance_names.push_back(parameter.name);
    }
  }
  Vector sigmas(static_cast<int>(summary.covariance_names.size()));
  int j = 0;
  for (const ParameterEstimate& estimate : summary.parameters) {
    if (estimate.free) sigmas(j++) = estimate.sigma;
  }
  Matrix correlation = Matrix::Identity(j, j);
  correlation(0, 4) = correlation(4, 0) = -0.97;  // k1 and the cubic spring
  summary.covariance = sigmas.asDiagonal() * correlation * sigmas.asDiagonal();
  summary.covariance_method = "sandwich";
}

void AddModes(const Vector& identified, ReportExample* example) {
  const StructuralDynamics& dynamics = *example->problem.dynamics;
  ModalProperties initial, updated;
  std::string error;
  const StructuralModel before = dynamics.model();
  const StructuralModel after = dynamics.CorrectedModel(identified);
  CHECK(ComputeModes(before.mass, before.damping, before.stiffness, &initial,
                     &error))
      << error;
  CHECK(ComputeModes(after.mass, after.damping, after.stiffness, &updated,
                     &error))
      << error;
  for (int m = 0; m < kDofs; ++m) {
    ModePair mode;
    mode.initial_frequency = initial.frequency_hz(m);
    mode.updated_frequency = updated.frequency_hz(m);
    mode.updated_mode = m;
    mode.initial_damping = initial.damping_ratio(m);
    mode.updated_damping = updated.damping_ratio(m);
    mode.initial_shape = initial.mode_shapes.col(m);
    mode.updated_shape = updated.mode_shapes.col(m);
    mode.mac = Mac(mode.initial_shape, mode.updated_shape);
    example->input.prior.modes.push_back(mode);
  }
}

void AddCourse(IdentificationSummary* summary) {
  const int lengths[] = {25, 100, 400, 3000};
  const double errors[] = {0.31, 0.085, 0.0262, 0.0207};
  double cost = 4.2e6;
  for (int s = 0; s < 4; ++s) {
    StageRecord stage;
    stage.segment_samples = lengths[s];
    stage.num_segments = kSamples / lengths[s];
    stage.iterations = 9 - 2 * s;
    stage.free_run_error = errors[s];
    stage.largest_gap = s == 3 ? 0.0 : 4e-7;
    summary->stages.push_back(stage);
    for (int i = 0; i < stage.iterations; ++i) {
      IterationRecord iteration;
      iteration.stage = s + 1;
      iteration.segment_samples = lengths[s];
      iteration.iteration = static_cast<int>(summary->iterations.size());
      iteration.accepted = i != 2;
      cost = 4400.0 + (cost - 4400.0) * 0.4;
      iteration.cost = iteration.accepted ? cost : 3.0 * cost;
      summary->iterations.push_back(iteration);
    }
    cost *= 3.0;
  }
  summary->termination = Termination::kConverged;
  summary->message = "converged";
  summary->verdict = testing::Good();
  summary->num_iterations = static_cast<int>(summary->iterations.size());
  summary->rejected_steps = 4;
  summary->initial_cost = summary->iterations.front().cost;
  summary->final_cost = summary->iterations.back().cost;
  summary->single_shooting = true;
  summary->effective_parameters = 11.4;
  summary->seconds = 3.217;
  summary->jacobian_seconds = 1.9;
  summary->linear_solver_seconds = 0.71;
}

}  // namespace

std::unique_ptr<ReportExample> MakeReportExample() {
  auto example = std::make_unique<ReportExample>();
  const std::shared_ptr<StructuralDynamics> dynamics = MakeDynamics();
  example->problem.dynamics = dynamics;
  Vector truth = dynamics->Parameters();
  const std::vector<double> named = TrueNamedParameters();
  for (size_t i = 0; i < named.size(); ++i) {
    truth(static_cast<Eigen::Index>(i)) = named[i];
  }
  Vector identified = truth;
  for (int i = 0; i < 6; ++i) identified(i) *= 1.0 + 0.003 * (i % 3 - 1);
  // The network learned next to nothing, but not nothing.
  for (int i = 0; i + static_cast<int>(named.size()) < identified.size(); ++i) {
    identified(i + static_cast<int>(named.size())) = 2e-3 * std::sin(1.7 * i);
  }
  AddRecord("north_quake", IdentificationRecord::Role::kTrain, 1, 3.0, truth,
            identified, example.get());
  AddRecord("south_quake", IdentificationRecord::Role::kHoldout, 2, 3.6, truth,
            identified, example.get());
  AddEstimates(identified, example.get());
  AddModes(identified, example.get());
  AddCourse(&example->summary);
  example->model.parameters = identified;

  ReportInput& input = example->input;
  const std::vector<Matrix>& priors = example->priors;
  input.run_prior = [&priors](int record, const std::vector<int>& channels) {
    const Matrix& all = priors.at(static_cast<size_t>(record));
    Matrix some(static_cast<Eigen::Index>(channels.size()), all.cols());
    for (size_t i = 0; i < channels.size(); ++i) {
      some.row(static_cast<Eigen::Index>(i)) = all.row(channels[i]);
    }
    return some;
  };
  ProblemDescription& description = example->problem.description;
  description.title = "Three-storey frame, identified from two earthquakes";
  input.origin.case_path = "data/three_storey/three_storey.toml";
  input.origin.command_line =
      "pinode_update --case=data/three_storey/three_storey.toml "
      "--output_dir=three_storey";
  input.version = "0.1.0";
  input.origin.wall_seconds = 4.1;
  input.problem = &example->problem;
  input.summary = &example->summary;
  input.model = &example->model;
  description.remarks = {
      "record 'north_quake': the time column is uniform within 0.3 % of its "
      "step (rounded to three decimals); 0.01 s is used."};
  return example;
}

DiscoveredTerm MakeTerm(const std::string& basis, const std::string& unit,
                        double coefficient, double half_width,
                        double regressed) {
  DiscoveredTerm term;
  term.basis = basis;
  term.unit = unit;
  term.coefficient = coefficient;
  term.lower95 = coefficient - half_width;
  term.upper95 = coefficient + half_width;
  term.regressed = regressed;
  term.inclusion_probability = kNaN;
  return term;
}

void AddChange(const std::string& name, ChangeKind kind, double change,
               double lower95, double upper95, double probability, bool changed,
               DamageResult* damage) {
  ChangeSubject subject;
  subject.name = name;
  subject.kind = kind;
  damage->subjects.push_back(subject);
  GroupChange of_group;
  of_group.change = change;
  of_group.lower95 = lower95;
  of_group.upper95 = upper95;
  of_group.probability = probability;
  of_group.changed = changed;
  damage->estimate.groups.push_back(of_group);
}

std::string FindHtmlFault(const std::string& html) {
  static const std::set<std::string> kVoid = {"meta", "br", "hr", "img",
                                              "link"};
  std::vector<std::string> open;
  size_t at = 0;
  while ((at = html.find('<', at)) != std::string::npos) {
    const std::string where = " at offset " + std::to_string(at);
    if (html.compare(at, 2, "<!") == 0) {
      at = html.find('>', at);
      continue;
    }
    const bool closing = html.compare(at, 2, "</") == 0;
    size_t i = at + (closing ? 2 : 1);
    const size_t name_begin = i;
    while (i < html.size() && std::isalnum(static_cast<unsigned char>(html[i])))
      ++i;
    const std::string name = html.substr(name_begin, i - name_begin);
    if (name.empty()) return "a bare '<'" + where;
    // Attributes: only inside quotes may '<' or '>' stand.
    char quote = 0;
    for (; i < html.size(); ++i) {
      const char c = html[i];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        if (html[i - 1] != '=') return "a stray quote in <" + name + where;
        quote = c;
      } else if (c == '=' && html[i + 1] != '"' && html[i + 1] != '\'') {
        return "an unquoted attribute in <" + name + where;
      } else if (c == '<') {
        return "'<' inside <" + name + where;
      } else if (c == '>') {
        break;
      }
    }
    if (i >= html.size()) return "<" + name + " does not end" + where;
    const bool self_closing = html[i - 1] == '/';
    if (closing) {
      if (open.empty() || open.back() != name) {
        return "</" + name + "> closes " +
               (open.empty() ? "nothing" : "<" + open.back() + ">") + where;
      }
      open.pop_back();
    } else if (!self_closing && kVoid.count(name) == 0) {
      open.push_back(name);
    }
    at = i + 1;
    if (!closing && name == "style") at = html.find("</style", at);
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

}  // namespace testing
}  // namespace pinode
