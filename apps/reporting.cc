#include "apps/reporting.h"

#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/score.h"
#include "pinode/structure/mode_comparison.h"

namespace pinode {

ReportInput MakeReportInput(const Case& c, const IdentificationSummary& summary,
                            const IdentifiedModel& model,
                            const std::string& command_line,
                            double wall_seconds) {
  ReportInput input;
  input.title = c.problem.description.title;
  input.case_path = c.path;
  input.command_line = command_line;
  input.version = PINODE_VERSION;
  input.units = c.problem.description.units;
  input.wall_seconds = wall_seconds;
  input.hz_per_model_frequency = c.problem.description.HzPerModelFrequency();
  input.problem = &c.problem;
  input.summary = &summary;
  input.model = &model;
  input.remarks = c.problem.description.remarks;
  for (const ReferenceCurve& curve : c.problem.description.reference_curves) {
    input.curves.push_back(
        {curve.term, curve.name, curve.deformation, curve.force});
  }

  for (const ForceTruth& truth : c.problem.description.force_truths) {
    input.force_truths.push_back({truth.name, truth.times, truth.values});
  }

  const ParameterLayout layout(c.problem);
  const Vector prior = layout.InitialValues();
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    ReportRecord record;
    if (r < summary.records.size()) {
      Vector start;
      const int index = static_cast<int>(r);
      const Vector sigmas =
          r < model.sigmas.size() && model.sigmas[r].size() > 0
              ? model.sigmas[r]
              : Vector::Ones(
                    static_cast<int>(c.problem.records[r].channels.size()));
      const int first = FreeRunStart(c.problem, index, prior, sigmas, &start);
      RecordScore score;
      ScoreRecord(c.problem, index, prior, start, first, &score);
      if (score.finite) record.prior_prediction = std::move(score.prediction);
    }
    input.records.push_back(std::move(record));
    for (const std::string& remark : c.problem.records[r].description.remarks) {
      input.remarks.push_back("Record " + c.problem.records[r].name + ": " +
                              remark);
    }
  }

  const StructuralDynamics& dynamics = *c.problem.dynamics;
  std::vector<ModePair> pairs;
  std::string error;
  if (model.parameters.size() == layout.num_parameters() &&
      CompareModes(
          dynamics.CorrectedModel(prior.head(layout.num_dynamics())),
          dynamics.CorrectedModel(model.parameters.head(layout.num_dynamics())),
          &pairs, &error)) {
    const double to_hz = c.problem.description.HzPerModelFrequency();
    for (ModePair& pair : pairs) {
      ReportMode mode;
      mode.initial_hz = to_hz * pair.initial_frequency;
      mode.updated_hz = to_hz * pair.updated_frequency;
      mode.initial_damping = pair.initial_damping;
      mode.updated_damping = pair.updated_damping;
      mode.mac = pair.mac;
      mode.initial_shape = std::move(pair.initial_shape);
      mode.updated_shape = std::move(pair.updated_shape);
      input.modes.push_back(std::move(mode));
    }
  } else if (!error.empty()) {
    input.remarks.push_back("No modes: " + error);
  }
  return input;
}

std::vector<ReportEquation> MakeReportEquations(const Case& c,
                                                const Discovery& discovery) {
  const bool from_networks =
      c.discover.source == DiscoveryOptions::Source::kNetwork;
  std::vector<ReportEquation> result;
  for (size_t e = 0; e < discovery.equations.size(); ++e) {
    const DiscoveredEquation& equation = discovery.equations[e];
    ReportEquation report;
    report.output = equation.output;
    report.source = from_networks
                        ? "network " + equation.network
                        : "what smoothed records ask for beside the model";
    report.unit =
        UnitName(equation.acts_as == ActsAs::kForce ? Dimension::kForce
                                                    : Dimension::kAcceleration,
                 c.problem.description.units);
    report.num_candidates = equation.num_candidates;
    report.num_regressed_terms = equation.num_regressed_terms;
    for (const DiscoveryParetoPoint& point : equation.pareto) {
      report.pareto.push_back({point.num_terms, point.residual});
    }
    report.source_values = equation.sample_outputs;
    report.equation_values = Vector::Zero(equation.sample_outputs.size());
    std::vector<Vector> parts(equation.features.size());
    for (const EquationTerm& term : discovery.terms[e]) {
      report.terms.push_back({term.basis, term.unit, term.coefficient,
                              term.lower95, term.upper95, term.from_network,
                              term.inclusion_probability});
      LibraryFunction function;
      std::string error;
      CHECK(LibraryFunction::Parse(term.basis, equation.feature_names,
                                   &function, &error))
          << error;
      Vector values(report.equation_values.size());
      for (Eigen::Index i = 0; i < values.size(); ++i) {
        const Vector at = equation.sample_features.row(i).transpose();
        values[i] = term.coefficient * function.Evaluate(at.data());
      }
      report.equation_values += values;
      for (size_t f = 0; f < parts.size(); ++f) {
        if (!function.DependsOn(static_cast<int>(f))) continue;
        if (parts[f].size() == 0) parts[f] = Vector::Zero(values.size());
        parts[f] += values;
      }
    }
    for (size_t f = 0; f < parts.size(); ++f) {
      if (parts[f].size() == 0) continue;
      const Feature& feature = equation.features[f];
      report.features.push_back(
          {equation.feature_names[f],
           feature.OnDisplacement()
               ? UnitName(Dimension::kLength, c.problem.description.units)
           : feature.OnVelocity()
               ? UnitName(Dimension::kVelocity, c.problem.description.units)
           : feature.kind == Feature::Kind::kTime
               ? c.problem.description.units.time
               : "",
           equation.sample_features.col(static_cast<Eigen::Index>(f)),
           parts[f]});
    }
    result.push_back(std::move(report));
  }
  return result;
}

ReportDamage MakeReportDamage(const DamageResult& result) {
  ReportDamage damage;
  damage.sentence = result.judgement.sentence;
  damage.alarm = result.judgement.verdict != DamageVerdict::kNoDamage;
  damage.threshold = result.options.threshold;
  damage.baselines = result.baselines;
  damage.places = result.places;
  damage.remarks = result.remarks;
  for (size_t j = 0; j < result.subjects.size(); ++j) {
    const ChangeSubject& subject = result.subjects[j];
    const GroupChange& change = result.estimate.groups[j];
    if (!subject.place.empty() && !change.changed) continue;
    ReportDamage::Change reported;
    reported.name = subject.name;
    reported.change = change.change;
    reported.lower95 = change.lower95;
    reported.upper95 = change.upper95;
    if (subject.kind == ChangeKind::kStiffness) {
      reported.probability = change.probability;
    }
    reported.changed = change.changed;
    damage.changes.push_back(std::move(reported));
  }
  return damage;
}

}  // namespace pinode
