#include "tests/cases/other_units.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/feature_text.h"
#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/library_law.h"
#include "pinode/study/problem/network_scales.h"

namespace pinode {
namespace testing {
namespace {

double Power(const UnitFactors& unit, double force, double length,
             double time) {
  return std::pow(unit.force, force) * std::pow(unit.length, length) *
         std::pow(unit.time, time);
}

void Scale(double factor, Parameter* parameter) {
  parameter->value *= factor;
  parameter->lower *= factor;
  parameter->upper *= factor;
  parameter->prior_mean *= factor;
  parameter->prior_sigma *= factor;
}

double FactorOf(Quantity quantity, const UnitFactors& unit) {
  switch (DimensionOf(quantity)) {
    case Dimension::kLength:
      return unit.length;
    case Dimension::kVelocity:
      return Power(unit, 0, 1, -1);
    case Dimension::kAcceleration:
      return Power(unit, 0, 1, -2);
    case Dimension::kForce:
      return unit.force;
    default:
      return 1.0;
  }
}

double FactorOf(InputSpec::Kind kind, const UnitFactors& unit) {
  switch (kind) {
    case InputSpec::Kind::kGroundAcceleration:
    case InputSpec::Kind::kPrescribedAcceleration:
      return Power(unit, 0, 1, -2);
    case InputSpec::Kind::kPrescribedVelocity:
      return Power(unit, 0, 1, -1);
    case InputSpec::Kind::kGroundDisplacement:
    case InputSpec::Kind::kPrescribedDisplacement:
      return unit.length;
    case InputSpec::Kind::kForce:
      return unit.force;
    case InputSpec::Kind::kCovariate:
    case InputSpec::Kind::kRecordSwitch:
      break;
  }
  return 1.0;
}

double FactorOf(const Feature& feature, const std::vector<InputSpec>& inputs,
                const UnitFactors& unit) {
  if (feature.OnDisplacement()) return unit.length;
  if (feature.OnVelocity()) return Power(unit, 0, 1, -1);
  if (feature.kind == Feature::Kind::kTime) return unit.time;
  return FactorOf(inputs[static_cast<size_t>(feature.input)].kind, unit);
}

double FactorOf(MatrixGroup::Target target, const UnitFactors& unit) {
  switch (target) {
    case MatrixGroup::Target::kMass:
      return Power(unit, 1, -1, 2);
    case MatrixGroup::Target::kDamping:
      return Power(unit, 1, -1, 1);
    case MatrixGroup::Target::kStiffness:
      break;
  }
  return Power(unit, 1, -1, 0);
}

// Functions of the old features, and so coefficients in the output's unit.
LawTerm LibraryInOtherUnits(LawTerm term, const StructuralDynamics& old,
                            const UnitFactors& unit) {
  const auto& law = dynamic_cast<const LibraryLaw&>(*term.law);
  std::vector<std::string> names;
  for (const Feature& feature : term.features) {
    names.push_back(feature.Name(old.model().dof_names, InputNames(old)));
  }
  std::vector<LibraryFunction> functions;
  for (const LibraryFunction& function : law.functions()) {
    std::string text = function.text();
    for (size_t i = 0; i < names.size(); ++i) {
      const std::string scaled =
          "(" + names[i] + "/" +
          FormatNumber(FactorOf(term.features[i], old.inputs(), unit), 17) +
          ")";
      for (size_t at = text.find(names[i]); at != std::string::npos;
           at = text.find(names[i], at + scaled.size())) {
        text.replace(at, names[i].size(), scaled);
      }
    }
    std::string error;
    functions.emplace_back();
    EXPECT_TRUE(LibraryFunction::Parse(text, names, &functions.back(), &error))
        << error;
  }
  term.law = std::make_shared<LibraryLaw>(static_cast<int>(names.size()),
                                          std::move(functions));
  const double factor =
      term.acts_as == ActsAs::kForce ? unit.force : Power(unit, 0, 1, -2);
  for (Parameter& parameter : term.parameters.parameters) {
    Scale(factor, &parameter);
  }
  return term;
}

LawTerm LawInOtherUnits(LawTerm term, const StructuralDynamics& old,
                        const UnitFactors& unit) {
  if (term.type == "library") {
    return LibraryInOtherUnits(std::move(term), old, unit);
  }
  const auto infos = ElementParameters(term.type);
  for (size_t p = 0; p < infos.size(); ++p) {
    Scale(Power(unit, infos[p].force_power, infos[p].length_power,
                infos[p].time_power),
          &term.parameters.parameters[p]);
  }
  return term;
}

UnknownForceTerm ForceInOtherUnits(UnknownForceTerm term,
                                   const UnitFactors& unit) {
  if (const auto* spline =
          dynamic_cast<const SplineForce*>(term.history.get())) {
    SplineForce::Options options = spline->options();
    options.start *= unit.time;
    options.spacing *= unit.time;
    options.scale *= unit.force;
    term.history = std::make_shared<SplineForce>(options);
    return term;
  }
  const double factors[] = {unit.time, unit.time, unit.force};
  for (size_t p = 0; p < 3; ++p) {
    Scale(factors[p], &term.parameters.parameters[p]);
  }
  return term;
}

std::shared_ptr<StructuralDynamics> DynamicsInOtherUnits(
    const StructuralDynamics& old, const UnitFactors& unit) {
  StructuralModel model = old.model();
  using Target = MatrixGroup::Target;
  model.mass *= FactorOf(Target::kMass, unit);
  model.damping *= FactorOf(Target::kDamping, unit);
  model.stiffness *= FactorOf(Target::kStiffness, unit);
  model.support_mass_coupling *= FactorOf(Target::kMass, unit);
  auto dynamics = std::make_shared<StructuralDynamics>(model, old.inputs());
  std::string error;
  for (GroupTerm group : old.groups()) {
    group.group.matrix *= FactorOf(group.group.target, unit);
    if (group.follows == GroupTerm::Follows::kTime) {
      group.reference *= unit.time;
      group.group.matrix /= unit.time;
    }
    EXPECT_TRUE(dynamics->AddGroup(group, &error)) << error;
  }
  for (const LawTerm& law : old.laws()) {
    EXPECT_TRUE(dynamics->AddLaw(LawInOtherUnits(law, old, unit), &error))
        << error;
  }
  for (const UnknownForceTerm& force : old.unknown_forces()) {
    EXPECT_TRUE(
        dynamics->AddUnknownForce(ForceInOtherUnits(force, unit), &error))
        << error;
  }
  for (size_t j = 0; j < old.networks().size(); ++j) {
    EXPECT_TRUE(dynamics->AddNetwork(old.networks()[j], &error)) << error;
    EXPECT_TRUE(dynamics->SetNetworkScales(static_cast<int>(j), Vector(),
                                           Vector(), &error))
        << error;
  }
  EXPECT_EQ(dynamics->num_terms(), old.num_terms()) << "a term of another kind";
  EXPECT_EQ(dynamics->num_internal(), 0) << "a law with states of its own";
  return dynamics;
}

void RecordInOtherUnits(const StructuralDynamics& dynamics,
                        const UnitFactors& unit, IdentificationRecord* record,
                        ParameterBlock* sensors, std::set<int>* done) {
  Matrix samples = record->excitation->samples();
  for (int i = 0; i < dynamics.num_inputs(); ++i) {
    const double factor =
        FactorOf(dynamics.inputs()[static_cast<size_t>(i)].kind, unit);
    samples.row(i) *= factor;
    if (record->input_sigma.size() > 0) record->input_sigma[i] *= factor;
  }
  record->excitation.emplace(record->excitation->start_time() * unit.time,
                             record->excitation->step() * unit.time, samples,
                             record->excitation->interpolation(),
                             record->excitation->periodic());
  const int n = dynamics.num_dofs();
  if (record->known_start.size() > 0) {
    record->known_start.head(n) *= unit.length;
    record->known_start.segment(n, n) *= Power(unit, 0, 1, -1);
  }
  for (MeasuredChannel& channel : record->channels) {
    const double factor = FactorOf(channel.observation.quantity, unit);
    channel.values *= factor;
    channel.sigma *= factor;
    channel.description.factor *= factor;
    const auto scale = [&](int sensor, double by) {
      if (sensor < 0 || !done->insert(sensor).second) return;
      Scale(by, &sensors->parameters[static_cast<size_t>(sensor)]);
    };
    scale(channel.offset, factor);
    scale(channel.delay, unit.time);
  }
}

}  // namespace

IdentificationProblem InOtherUnits(const IdentificationProblem& problem,
                                   const UnitFactors& unit) {
  IdentificationProblem other = problem;
  const std::shared_ptr<StructuralDynamics> dynamics =
      DynamicsInOtherUnits(*problem.dynamics, unit);
  other.dynamics = dynamics;
  std::set<int> done;
  for (IdentificationRecord& record : other.records) {
    RecordInOtherUnits(*problem.dynamics, unit, &record, &other.sensors, &done);
  }
  for (MeasuredMode& mode : other.modal.modes) {
    mode.frequency /= unit.time;
    mode.frequency_sigma /= unit.time;
  }
  ScaleNetworks(other, dynamics.get());
  other.description.force_truths.clear();
  other.description.reference_curves.clear();
  return other;
}

double LargestChange(const CaseRun& here, const CaseRun& there) {
  double largest = 0.0;
  const auto compare = [&largest](double a, double b, double scale) {
    if (std::isnan(a) && std::isnan(b)) return;
    const double change = std::abs(a - b) / scale;
    if (!(change <= largest)) largest = change;  // not a number counts
  };
  EXPECT_EQ(here.summary.records.size(), there.summary.records.size());
  for (size_t r = 0; r < here.summary.records.size(); ++r) {
    const auto& a = here.summary.records[r].channels;
    const auto& b = there.summary.records[r].channels;
    for (size_t c = 0; c < a.size(); ++c) {
      compare(a[c].nrmse, b[c].nrmse, a[c].nrmse);
    }
  }
  EXPECT_EQ(here.summary.parameters.size(), there.summary.parameters.size());
  for (size_t p = 0; p < here.summary.parameters.size(); ++p) {
    const ParameterEstimate& a = here.summary.parameters[p];
    const ParameterEstimate& b = there.summary.parameters[p];
    if (!(a.sigma > 0.0)) continue;
    const double ratio = a.value / a.sigma;
    compare(ratio, b.value / b.sigma, std::max(1.0, std::abs(ratio)));
  }
  return largest;
}

}  // namespace testing
}  // namespace pinode
