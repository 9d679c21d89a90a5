#include "pinode/report/restoring_force.h"

#include <algorithm>
#include <functional>

#include "pinode/base/logging.h"
#include "pinode/dynamics/feature.h"
#include "pinode/network/network.h"

namespace pinode {
namespace {

// Returns the value of a feature at one sample.
double FeatureAt(const Feature& feature, const Excitation& excitation,
                 const Matrix& states, int num_dofs, Eigen::Index sample) {
  const auto at = [&](int dof, int offset) {
    return dof == Feature::kGround ? 0.0 : states(offset + dof, sample);
  };
  switch (feature.kind) {
    case Feature::Kind::kDisplacement:
      return at(feature.a, 0);
    case Feature::Kind::kVelocity:
      return at(feature.a, num_dofs);
    case Feature::Kind::kDeformation:
      return at(feature.b, 0) - at(feature.a, 0);
    case Feature::Kind::kDeformationRate:
      return at(feature.b, num_dofs) - at(feature.a, num_dofs);
    case Feature::Kind::kTime:
      return excitation.time(sample);
    case Feature::Kind::kInput:
      return excitation.samples()(feature.input, sample);
  }
  return 0.0;
}

// Common description of a law or a network.
struct Term {
  std::string name, type;
  const std::vector<Feature>* features;
  const Matrix* outputs;  // num_dofs x outputs
  std::vector<std::string> output_names;
  bool is_acceleration;
  // Computes the outputs from features and the whole state at one sample.
  std::function<void(const Vector& features, const Vector& state, Vector*)>
      evaluate;
};

class LoopMaker {
 public:
  explicit LoopMaker(const ReportInput& input)
      : input_(input), dynamics_(*input.problem->dynamics) {}

  void Add(const Term& term, std::vector<RestoringForceLoop>* loops) const {
    const std::vector<Feature>& features = *term.features;
    int abscissa = 0, rate = -1;
    for (int i = static_cast<int>(features.size()) - 1; i >= 0; --i) {
      const Feature& feature = features[static_cast<size_t>(i)];
      if (feature.OnDisplacement()) abscissa = i;
      if (feature.OnVelocity()) rate = i;
    }
    if (rate == abscissa) rate = -1;
    const int record = WidestRecord(features[static_cast<size_t>(abscissa)]);
    if (record < 0) return;

    const Excitation& excitation =
        *input_.problem->records[static_cast<size_t>(record)].excitation;
    const Matrix& states =
        input_.summary->records[static_cast<size_t>(record)].states;
    const Eigen::Index samples = states.cols();
    Matrix values(features.size(), samples);
    Matrix outputs(term.outputs->cols(), samples);
    Vector time(samples);
    Vector result(term.outputs->cols());
    for (Eigen::Index i = 0; i < samples; ++i) {
      for (size_t f = 0; f < features.size(); ++f) {
        values(f, i) =
            FeatureAt(features[f], excitation, states, dynamics_.num_dofs(), i);
      }
      term.evaluate(values.col(i), states.col(i), &result);
      outputs.col(i) = result;
      time(i) = excitation.time(i);
    }

    RestoringForceLoop loop;
    loop.term = term.name;
    loop.type = term.type;
    loop.record = record;
    loop.known = KnownCurve(term.name);
    loop.is_acceleration = term.is_acceleration;
    if (loop.known != nullptr && term.is_acceleration) {
      loop.is_acceleration = false;
      outputs *= -DrivenMass(*term.outputs);
    }
    loop.force_unit = UnitName(
        loop.is_acceleration ? Dimension::kAcceleration : Dimension::kForce,
        input_.problem->description.units);
    loop.time = time;
    loop.deformation = values.row(abscissa);
    Name(features[static_cast<size_t>(abscissa)], &loop.deformation_name,
         &loop.deformation_unit);
    if (rate >= 0) {
      loop.rate = values.row(rate);
      Name(features[static_cast<size_t>(rate)], &loop.rate_name,
           &loop.rate_unit);
    }
    for (Eigen::Index o = 0; o < outputs.rows(); ++o) {
      loop.output.clear();
      if (static_cast<size_t>(o) < term.output_names.size()) {
        loop.output = term.output_names[static_cast<size_t>(o)];
      }
      loop.force = outputs.row(o);
      loops->push_back(loop);
    }
  }

 private:
  const ReferenceCurve* KnownCurve(const std::string& term) const {
    for (const ReferenceCurve& curve :
         input_.problem->description.reference_curves) {
      if (curve.term == term) return &curve;
    }
    return nullptr;
  }

  // Returns the force per acceleration that a term adds to its one DOF.
  double DrivenMass(const Matrix& outputs) const {
    const StructuralModel model = dynamics_.CorrectedModel(
        input_.model->parameters.head(dynamics_.num_parameters()));
    return (model.mass * outputs.col(0)).sum();
  }

  void Name(const Feature& feature, std::string* name,
            std::string* unit) const {
    std::vector<std::string> input_names;
    for (const InputSpec& spec : dynamics_.inputs()) {
      input_names.push_back(spec.name);
    }
    *name = feature.Name(dynamics_.model().dof_names, input_names);
    *unit = FeatureUnit(feature, input_.problem->description.units);
  }

  int WidestRecord(const Feature& feature) const {
    int widest = -1;
    double widest_range = -1.0;
    const std::vector<RecordScore>& scores = input_.summary->records;
    for (size_t r = 0; r < scores.size(); ++r) {
      const Matrix& states = scores[r].states;
      const Excitation& excitation = *input_.problem->records.at(r).excitation;
      if (!scores[r].finite || states.cols() != excitation.num_samples() ||
          states.rows() != dynamics_.num_states() || !states.allFinite()) {
        continue;
      }
      double lowest = 0.0, highest = 0.0;
      for (Eigen::Index i = 0; i < states.cols(); ++i) {
        const double value =
            FeatureAt(feature, excitation, states, dynamics_.num_dofs(), i);
        lowest = i == 0 ? value : std::min(lowest, value);
        highest = i == 0 ? value : std::max(highest, value);
      }
      if (highest - lowest > widest_range) {
        widest = static_cast<int>(r);
        widest_range = highest - lowest;
      }
    }
    return widest;
  }

  const ReportInput& input_;
  const StructuralDynamics& dynamics_;
};

}  // namespace

std::vector<RestoringForceLoop> ComputeRestoringForceLoops(
    const ReportInput& input) {
  std::vector<RestoringForceLoop> loops;
  const StructuralDynamics& dynamics = *input.problem->dynamics;
  if (input.model == nullptr ||
      input.model->parameters.size() < dynamics.num_parameters()) {
    return loops;
  }
  const Vector& theta = input.model->parameters;
  const LoopMaker maker(input);
  // Blocks of theta: the groups', if any, then one per law.
  int block = dynamics.groups().empty() ? 0 : 1;
  int internal = 2 * dynamics.num_dofs();
  for (const LawTerm& term : dynamics.laws()) {
    const double* parameters = theta.data() + dynamics.block_offset(block++);
    const int internal_offset = internal;
    internal += term.law->num_internal();
    Vector result(term.law->num_results());
    maker.Add({term.name,
               term.type,
               &term.features,
               &term.outputs,
               {},
               term.acts_as == ActsAs::kAcceleration,
               [&](const Vector& features, const Vector& state, Vector* force) {
                 term.law->Evaluate(features.data(),
                                    state.data() + internal_offset, parameters,
                                    result.data());
                 *force = result.head(force->size());
               }},
              &loops);
  }
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    // Over a motion a linear map of many inputs is a tangle of lines. It is a
    // share of K and C, and the result folder has these with the map folded in.
    if (term.network->architecture().hidden_widths.empty() &&
        term.features.size() > 2) {
      continue;
    }
    const double* weights =
        theta.data() +
        dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
    NetworkWorkspace workspace(*term.network);
    maker.Add(
        {term.name, "network", &term.features, &term.outputs, term.output_names,
         term.acts_as == NetworkTerm::ActsAs::kAcceleration,
         [&](const Vector& features, const Vector&, Vector* output) {
           term.network->Evaluate(features.data(), weights, output->data(),
                                  &workspace);
         }},
        &loops);
  }
  return loops;
}

}  // namespace pinode
