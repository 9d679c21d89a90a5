#include "tests/support/dynamics_testing.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/library_law.h"

namespace pinode {
namespace testing {
namespace {

// Deterministic numbers of order one without a random generator.
double Wiggle(int i) { return std::sin(1.7 * i + 0.3); }

ParameterBlock MakeWeights(const std::string& name,
                           const NetworkArchitecture& architecture,
                           double scale) {
  ParameterBlock block;
  block.name = name;
  block.named = false;
  block.parameters.resize(static_cast<size_t>(architecture.NumWeights()));
  for (int i = 0; i < block.size(); ++i) {
    Parameter& parameter = block.parameters[static_cast<size_t>(i)];
    parameter.name = name + "[" + std::to_string(i) + "]";
    parameter.value = scale * Wiggle(i);
  }
  block.decays = architecture.NonlinearWeights();
  return block;
}

void AddNetwork(const std::string& name, std::vector<int> hidden, bool skip,
                bool gauge, NetworkTerm::ActsAs acts_as,
                std::vector<Feature> features, const Matrix& outputs,
                StructuralDynamics* dynamics) {
  NetworkArchitecture architecture;
  architecture.num_inputs = static_cast<int>(features.size());
  architecture.num_outputs = static_cast<int>(outputs.cols());
  architecture.hidden_widths = std::move(hidden);
  architecture.skip = skip;
  architecture.gauge = gauge;
  architecture.input_scale = Vector::Constant(architecture.num_inputs, 0.8);
  NetworkTerm term;
  term.name = name;
  term.network = std::make_shared<Network>(architecture);
  term.features = std::move(features);
  term.outputs = outputs;
  term.acts_as = acts_as;
  term.weights = MakeWeights(name, architecture, 0.6);
  std::string error;
  CHECK(dynamics->AddNetwork(std::move(term), &error)) << error;
}

void AddLibrary(const std::string& name, ActsAs acts_as,
                const std::vector<Feature>& features,
                const std::vector<std::string>& feature_names,
                const std::vector<std::string>& terms, const Matrix& output,
                StructuralDynamics* dynamics) {
  LawTerm term;
  term.name = name;
  term.type = "library";
  term.features = features;
  term.outputs = output;
  term.acts_as = acts_as;
  term.parameters.name = name;
  std::string error;
  std::vector<LibraryFunction> functions(terms.size());
  for (size_t k = 0; k < terms.size(); ++k) {
    CHECK(
        LibraryFunction::Parse(terms[k], feature_names, &functions[k], &error))
        << error;
    Parameter parameter;
    parameter.name = name + "." + terms[k];
    parameter.value = 0.4 * Wiggle(static_cast<int>(k));
    term.parameters.parameters.push_back(parameter);
  }
  term.law = std::make_shared<LibraryLaw>(static_cast<int>(features.size()),
                                          functions);
  CHECK(dynamics->AddLaw(std::move(term), &error)) << error;
}

void AddForce(const std::string& name, const SplineForce::Options& options,
              int input, StructuralDynamics* dynamics) {
  UnknownForceTerm term;
  term.name = name;
  term.history = std::make_shared<SplineForce>(options);
  term.outputs = Vector::LinSpaced(3, -0.4, 1.0);
  term.input = input;
  term.parameters.name = name;
  term.parameters.named = false;
  for (int k = 0; k < options.num_knots; ++k) {
    Parameter parameter;
    parameter.name = name + "[" + std::to_string(k) + "]";
    parameter.value = Wiggle(k + options.degree);
    term.parameters.parameters.push_back(parameter);
  }
  std::string error;
  CHECK(dynamics->AddUnknownForce(std::move(term), &error)) << error;
}

void AddCurve(const std::string& name, size_t group,
              const std::vector<double>& knots, int reference,
              StructuralDynamics* dynamics) {
  GroupCurve curve;
  curve.name = name;
  curve.group = dynamics->groups()[group].group;
  curve.input = 2;
  curve.knots = knots;
  curve.reference = reference;
  curve.parameters.name = name + ".temperature";
  for (size_t k = 0; k < knots.size(); ++k) {
    if (static_cast<int>(k) == reference) continue;
    Parameter parameter;
    parameter.name = KnotName(name, "temperature", knots[k]);
    parameter.value = 0.3 * Wiggle(static_cast<int>(k));
    curve.parameters.parameters.push_back(parameter);
  }
  std::string error;
  CHECK(dynamics->AddGroupCurve(std::move(curve), &error)) << error;
}

}  // namespace

StructuralModel MakeChain(int n, double k, double c) {
  Matrix stiffness = Matrix::Zero(n, n);
  for (int i = 0; i < n; ++i) stiffness += SpringMatrix(n, i - 1, i);
  return MakeStructuralModel(Matrix::Identity(n, n), c * stiffness,
                             k * stiffness);
}

std::unique_ptr<StructuralDynamics> MakeEverything() {
  StructuralModel model = MakeChain(3, 10.0, 0.5);
  model.mass(0, 1) = model.mass(1, 0) = 0.1;
  model.support_mass_coupling(0, 0) = 0.2;
  auto dynamics = std::make_unique<StructuralDynamics>(
      std::move(model), std::vector<InputSpec>{
                            {InputSpec::Kind::kGroundAcceleration, 0, "ground"},
                            {InputSpec::Kind::kForce, 1, "force"},
                            {InputSpec::Kind::kCovariate, 0, "temperature"}});
  std::string error;
  const auto add_group = [&](const std::string& name,
                             MatrixGroup::Target target, const Matrix& matrix,
                             double alpha, GroupTerm::Follows follows) {
    GroupTerm term;
    term.group.name = name;
    term.group.target = target;
    term.group.matrix = matrix;
    term.alpha.value = alpha;
    term.follows = follows;
    term.input = follows == GroupTerm::Follows::kCovariate ? 2 : -1;
    term.reference = 0.7;
    CHECK(dynamics->AddGroup(std::move(term), &error)) << error;
  };
  using Target = MatrixGroup::Target;
  using Follows = GroupTerm::Follows;
  add_group("k1", Target::kStiffness, 10.0 * SpringMatrix(3, -1, 0), -0.1,
            Follows::kNothing);
  add_group("k2", Target::kStiffness, 10.0 * SpringMatrix(3, 0, 1), 0.2,
            Follows::kTime);
  add_group("c2", Target::kDamping, SpringMatrix(3, 0, 1), 0.3,
            Follows::kNothing);
  add_group("c3", Target::kDamping, SpringMatrix(3, 1, 2), 0.15,
            Follows::kCovariate);
  Matrix mass = Matrix::Zero(3, 3);
  mass(2, 2) = 1.0;
  mass(1, 2) = mass(2, 1) = 0.05;
  add_group("m3", Target::kMass, mass, 0.25, Follows::kNothing);

  int place = 0;
  for (const std::string& type : ElementTypes()) {
    LawTerm term;
    term.name = type;
    term.type = type;
    term.law = CreateElement(type, &error);
    const int from = place % 3 - 1;
    const int to = place % 3;
    ++place;
    term.features = {Feature::Deformation(from, to),
                     Feature::DeformationRate(from, to)};
    term.outputs = Matrix::Zero(3, 1);
    term.outputs(to, 0) = 1.0;
    if (from >= 0) term.outputs(from, 0) = -1.0;
    term.parameters.name = type;
    for (const ElementParameterInfo& info : ElementParameters(type)) {
      Parameter parameter;
      parameter.name = type + "." + info.name;
      parameter.value = info.name == "gap" ? 0.05
                        : info.name == "n" ? 1.6
                                           : 0.7;
      term.parameters.parameters.push_back(parameter);
    }
    CHECK(dynamics->AddLaw(std::move(term), &error)) << error;
  }

  const Feature x0 = Feature::Displacement(0);
  const Feature v2 = Feature::Velocity(2);
  const Feature d01 = Feature::Deformation(0, 1);
  const Feature w12 = Feature::DeformationRate(1, 2);
  const Matrix first = Matrix::Identity(3, 3).leftCols(1);
  const Matrix two = Matrix::Identity(3, 3).rightCols(2);
  AddLibrary("library force", ActsAs::kForce, {x0, v2, d01},
             {"x[u1]", "v[u3]", "d[u1,u2]"},
             {"x[u1]^3", "d[u1,u2]*v[u3]", "sin(v[u3])"}, first,
             dynamics.get());
  AddLibrary("library acceleration", ActsAs::kAcceleration,
             {w12, Feature::Time(), Feature::Input(2)},
             {"w[u2,u3]", "t", "input[temperature]"},
             {"w[u2,u3]^2*t", "input[temperature]*w[u2,u3]"},
             first - Matrix::Identity(3, 3).col(2), dynamics.get());
  // Within the time that the tests integrate: a spline of each degree, one in
  // every record and one switched by an input, and a blow that begins and
  // ends between the stages of the steps.
  AddForce("hats", {1, 0.31, 0.055, 8, 1.3}, -1, dynamics.get());
  AddForce("cubic", {3, 0.33, 0.08, 6, 0.7}, 2, dynamics.get());
  {
    UnknownForceTerm term;
    term.name = "blow";
    term.history = std::make_shared<HalfSinePulse>();
    term.outputs = Vector::Unit(3, 2);
    term.parameters.name = term.name;
    const double values[] = {0.406, 0.238, 1.9};
    const char* names[] = {"start", "duration", "amplitude"};
    for (int i = 0; i < 3; ++i) {
      Parameter parameter;
      parameter.name = term.name + "." + names[i];
      parameter.value = values[i];
      term.parameters.parameters.push_back(parameter);
    }
    CHECK(dynamics->AddUnknownForce(std::move(term), &error)) << error;
  }
  AddCurve("k1", 0, {1.0, 1.3, 1.5, 2.6}, 1, dynamics.get());
  AddCurve("c2", 2, {0.1, 0.4}, 0, dynamics.get());
  // One scale of a force in all records, and one in a part of them.
  for (const int record_switch : {-1, 2}) {
    ForceScaleTerm term;
    term.name = record_switch < 0 ? "scale" : "scale in a record";
    term.forces = {{1, record_switch}};
    term.parameters.name = term.name;
    Parameter parameter;
    parameter.name = term.name;
    parameter.value = -2.5;
    term.parameters.parameters = {parameter};
    CHECK(dynamics->AddForceScale(std::move(term), &error)) << error;
  }
  AddNetwork("skip", {5}, true, false, NetworkTerm::ActsAs::kAcceleration,
             {x0, v2, d01, w12}, two, dynamics.get());
  AddNetwork("force", {4, 3}, false, false, NetworkTerm::ActsAs::kForce,
             {x0, v2, Feature::Time(), Feature::Input(2)}, first,
             dynamics.get());
  AddNetwork("gauged", {6}, false, true, NetworkTerm::ActsAs::kForce,
             {d01, w12}, first - Matrix::Identity(3, 3).col(1), dynamics.get());
  AddNetwork("linear", {}, true, false, NetworkTerm::ActsAs::kAcceleration,
             {x0, d01}, first, dynamics.get());
  return dynamics;
}

Matrix JetJacobian(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared, double time,
                   const double* input, const Vector& state) {
  const int ns = dynamics.num_states();
  const int np = dynamics.num_parameters();
  const int columns = ns + dynamics.num_tangent_columns();
  constexpr int kWidth = WideJet::DIMENSION;
  Matrix jacobian(ns, columns);
  std::vector<WideJet> h(static_cast<size_t>(ns)), rate(h.size());
  std::vector<WideJet> theta(static_cast<size_t>(np));
  for (int begin = 0; begin < columns; begin += kWidth) {
    for (int i = 0; i < ns; ++i) h[i] = WideJet(state[i]);
    for (int i = 0; i < np; ++i) theta[i] = WideJet(prepared.theta[i]);
    const int count = std::min(kWidth, columns - begin);
    for (int k = 0; k < count; ++k) {
      const int column = begin + k;
      (column < ns ? h[column] : theta[dynamics.tangent_columns()[column - ns]])
          .v[k] = 1.0;
    }
    dynamics.Rate(prepared, time, input, h.data(), theta.data(), rate.data());
    for (int i = 0; i < ns; ++i) {
      for (int k = 0; k < count; ++k) jacobian(i, begin + k) = rate[i].v[k];
    }
  }
  return jacobian;
}

}  // namespace testing
}  // namespace pinode
