#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/case/results/choice_json.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/results/verdict_json.h"
#include "pinode/problem/motion_levels.h"
#include "pinode/problem/record_grid.h"
#include "pinode/problem/result_fields.h"
#include "pinode/structure/model/mode_comparison.h"
#include "pinode/study/problem/checkpoint.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity; nlohmann writes null for it and for NaN.
Json Records(const IdentificationProblem& problem,
             const IdentificationSummary& summary) {
  Json records = Json::array();
  for (size_t r = 0; r < summary.records.size(); ++r) {
    const RecordScore& score = summary.records[r];
    Json record;
    record["name"] = score.name;
    record["role"] =
        score.role == IdentificationRecord::Role::kTrain ? "train" : "holdout";
    record["finite"] = score.finite;
    record["first_scored_sample"] = score.first_scored_sample;
    record["nrmse"] = score.nrmse;
    record["prior_nrmse"] = score.prior_nrmse;
    const Integrator integrator =
        IntegratorOf(*problem.dynamics, problem.records[r]);
    record["integrator"] = IntegratorName(integrator);
    if (integrator == Integrator::kRungeKutta) {
      record["substeps"] = problem.records[r].substeps;
    } else if (integrator == Integrator::kExponential) {
      record["substeps"] = problem.records[r].exponential_steps;
    }
    record["channels"] = Json::array();
    for (size_t i = 0; i < score.channels.size(); ++i) {
      const ChannelScore& channel_score = score.channels[i];
      const MeasuredChannel& measured = problem.records[r].channels[i];
      const double to_file = 1.0 / std::abs(measured.description.factor);
      Json entry;
      entry["name"] = channel_score.name;
      entry["dof"] = problem.LocationOf(measured);
      entry["quantity"] = QuantityName(measured.observation.quantity);
      entry["unit"] = problem.UnitOf(measured);
      entry["rmse"] = channel_score.rmse * to_file;
      entry["nrmse"] = channel_score.nrmse;
      entry["prior_nrmse"] = channel_score.prior_nrmse;
      entry["sigma"] = channel_score.sigma * to_file;
      entry["band_coverage"] = channel_score.band_coverage;
      entry["fit"] = measured.fit;
      record["channels"].push_back(std::move(entry));
    }
    records.push_back(std::move(record));
  }
  return records;
}

template <typename T>
Json FieldsOf(const T& fields) {
  Json entry;
  VisitFields(fields, [&entry](const char* name, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, std::vector<ExplainedValue>>) {
      entry[name] = Json::array();
      for (const ExplainedValue& one : value) {
        entry[name].push_back(FieldsOf(one));
      }
    } else {
      entry[name] = value;
    }
  });
  return entry;
}

Json Explanations(const IdentificationSummary& summary) {
  Json explanations = Json::array();
  for (const Explanation& explanation : summary.explanations) {
    explanations.push_back(FieldsOf(explanation));
  }
  return explanations;
}

Json Levels(const IdentificationProblem& problem) {
  Json levels = Json::array();
  for (const MotionLevel& level : MotionLevels(problem)) {
    levels.push_back(FieldsOf(level));
  }
  return levels;
}

Json Parameters(const IdentificationSummary& summary) {
  Json parameters = Json::array();
  for (const ParameterEstimate& estimate : summary.parameters) {
    parameters.push_back(FieldsOf(estimate));
  }
  return parameters;
}

// Infinite ends are null.
Json Profiles(const IdentificationSummary& summary) {
  Json profiles = Json::array();
  for (const ParameterProfile& profile : summary.profiles) {
    profiles.push_back(
        {{"name", profile.name},
         {"unit", profile.unit},
         {"value", profile.estimate},
         {"lower95", profile.lower95},
         {"upper95", profile.upper95},
         {"lower99", profile.lower99},
         {"upper99", profile.upper99},
         {"determination", DeterminationName(profile.determination)},
         {"combinations", profile.combinations},
         {"differs_from_linear", profile.DiffersFromLinear()},
         {"found_lower", profile.found_lower},
         {"unsettled", profile.unsettled},
         {"linearizations", profile.linearizations}});
  }
  return profiles;
}

// Histories are in force_<name>.csv.
Json Forces(const IdentificationProblem& problem,
            const IdentificationSummary& summary) {
  Json forces = Json::array();
  for (const ForceEstimate& force : summary.forces) {
    const size_t record = static_cast<size_t>(force.record);
    const double to_file =
        1.0 / problem.records[record].description.time_factor;
    const Eigen::Index last = force.times.size() - 1;
    Eigen::Index peak = 0;
    force.value.cwiseAbs().maxCoeff(&peak);
    // Trapezoidal rule between the integration's steps.
    const double step =
        (force.times[last] - force.times[0]) / static_cast<double>(last);
    const double impulse =
        step * (force.value.sum() - 0.5 * (force.value[0] + force.value[last]));
    Json entry = {{"name", force.name},
                  {"record", problem.records[record].name},
                  {"unit", problem.description.units.force},
                  {"file", "force_" + force.name + ".csv"},
                  {"peak", force.value[peak]},
                  {"peak_lower95", force.lower95[peak]},
                  {"peak_upper95", force.upper95[peak]},
                  {"peak_time", force.times[peak] * to_file},
                  {"impulse", impulse * to_file}};
    forces.push_back(std::move(entry));
  }
  return forces;
}

bool Modes(const IdentificationProblem& problem,
           const IdentificationSummary& summary, const IdentifiedModel& model,
           Json* json, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<ModePair> pairs;
  if (!CompareModes(
          dynamics.HeldModel(dynamics.Parameters()),
          dynamics.HeldModel(model.parameters.head(dynamics.num_parameters())),
          &pairs, error)) {
    return false;
  }
  const double hz = problem.description.HzPerModelFrequency();
  *json = Json::array();
  for (const ModePair& pair : pairs) {
    Json entry = {{"initial_hz", pair.initial_frequency * hz},
                  {"updated_hz", pair.updated_frequency * hz},
                  {"initial_damping", pair.initial_damping},
                  {"updated_damping", pair.updated_damping},
                  {"mac", pair.mac}};
    for (Eigen::Index d = 0; d < pair.updated_mass_shares.size(); ++d) {
      const std::string& direction =
          dynamics.model().directions[static_cast<size_t>(d)];
      entry["updated_mass_share"][direction] = pair.updated_mass_shares[d];
    }
    for (const ModeScore& mode : summary.modes) {
      if (!mode.InUse() || mode.updated.mode != pair.updated_mode) continue;
      entry["measured_hz"] = mode.frequency * hz;
      entry["measured_mac"] = mode.updated.mac;
    }
    json->push_back(std::move(entry));
  }
  return true;
}

// Returns each measured mode with its partners in the initial and the fitted
// model.
Json MeasuredModes(const IdentificationProblem& problem,
                   const IdentificationSummary& summary) {
  const double hz = problem.description.HzPerModelFrequency();
  Json modes = Json::array();
  for (const ModeScore& mode : summary.modes) {
    modes.push_back({{"name", mode.name},
                     {"measured_hz", mode.frequency * hz},
                     {"initial_hz", mode.initial.frequency * hz},
                     {"updated_hz", mode.updated.frequency * hz},
                     {"initial_mac", mode.initial.mac},
                     {"updated_mac", mode.updated.mac}});
  }
  return modes;
}

// Returns means over an ambient record.
Json Covariates(const IdentificationProblem& problem,
                const std::string& record_name) {
  Json means = Json::object();
  for (const AmbientRecord& record : problem.ambient) {
    if (record.name != record_name || !record.inputs.has_value()) continue;
    for (int i = 0; i < problem.dynamics->num_inputs(); ++i) {
      const InputSpec& input =
          problem.dynamics->inputs()[static_cast<size_t>(i)];
      if (input.kind != InputSpec::Kind::kCovariate) continue;
      means[input.name] = record.inputs->samples().row(i).mean();
    }
  }
  return means;
}

Json EvidenceAsJson(const LoadEvidence& evidence) {
  Json json = {{"log_likelihood", evidence.log_likelihood},
               {"price", evidence.price}};
  if (evidence.finer_knots > 0) {
    json["finer"] = {{"knots", evidence.finer_knots},
                     {"gain", evidence.finer_gain},
                     {"price", evidence.finer_price}};
  }
  return json;
}

Json AmbientAsJson(const IdentificationProblem& problem,
                   const IdentificationSummary& summary) {
  const double hz = problem.description.HzPerModelFrequency();
  Json records = Json::array();
  for (const AmbientScore& score : summary.ambient) {
    Json channels = Json::array();
    for (size_t c = 0; c < score.channels.size(); ++c) {
      const Eigen::Index row = static_cast<Eigen::Index>(c);
      channels.push_back({{"name", score.channels[c]},
                          {"explained", score.explained[row]},
                          {"noise_sigma", score.noise_sigma[row]}});
      if (score.by_measured_loads.size() > 0) {
        channels.back()["by_measured_loads"] = score.by_measured_loads[row];
      }
    }
    Json left = Json::object();
    for (size_t g = 0; g < score.groups.size(); ++g) {
      left[score.groups[g]] =
          score.information_left[static_cast<Eigen::Index>(g)];
    }
    records.push_back({{"name", score.name},
                       {"information_left", left},
                       {"lowest_hz", score.lowest_frequency * hz},
                       {"highest_hz", score.highest_frequency * hz},
                       {"lines", score.num_lines},
                       {"knots", score.num_knots},
                       {"chi_square", score.chi_square},
                       {"degrees_of_freedom", score.degrees_of_freedom},
                       {"probability", score.probability},
                       {"evidence", EvidenceAsJson(score.evidence)},
                       {"channels", channels}});
    if (score.by_measured_loads.size() > 0) {
      records.back()["coherence_probability"] = score.coherence_probability;
    }
    const Json covariates = Covariates(problem, score.name);
    if (!covariates.empty()) records.back()["covariates"] = covariates;
  }
  return records;
}

Json FrfsAsJson(const IdentificationProblem& problem,
                const IdentificationSummary& summary) {
  const double hz = problem.description.HzPerModelFrequency();
  Json all = Json::array();
  for (const FrfScore& score : summary.frfs) {
    Json pairs = Json::array();
    for (size_t p = 0; p < score.pairs.size(); ++p) {
      const auto pair = static_cast<Eigen::Index>(p);
      pairs.push_back({{"name", score.pairs[p]},
                       {"error", score.errors[pair]},
                       {"initial_error", score.prior_errors[pair]},
                       {"unexplained", score.unexplained[pair]},
                       {"sigma", score.sigma[pair]}});
      if (score.noise_ratios.size() > 0) {
        pairs.back()["noise_ratio"] = score.noise_ratios[pair];
      }
    }
    all.push_back({{"name", score.name},
                   {"lowest_hz", score.lowest_frequency * hz},
                   {"highest_hz", score.highest_frequency * hz},
                   {"lines", score.num_lines},
                   {"probability", score.probability},
                   {"log_likelihood", score.log_likelihood},
                   {"memory", score.memory},
                   {"pairs", pairs}});
  }
  return all;
}

}  // namespace

bool FormatResultJson(const IdentificationProblem& problem,
                      const IdentificationSummary& summary,
                      const IdentifiedModel& model, std::string* text,
                      std::string* error) {
  Json json;
  json["schema"] = "pinode-result-1";
  json["title"] = problem.description.title;
  WriteVerdict(summary.verdict, &json);
  json["termination"] = TerminationName(summary.termination);
  json["message"] = summary.message;
  json["problem"] = ProblemIdentity(problem);
  json["units"] = {{"force", problem.description.units.force},
                   {"length", problem.description.units.length},
                   {"time", problem.description.units.time}};
  json["records"] = Records(problem, summary);
  json["parameters"] = Parameters(summary);
  json["explanations"] = Explanations(summary);
  if (!problem.records.empty() || !problem.ambient.empty()) {
    json["levels_of_motion"] = Levels(problem);
  }
  if (!summary.profiles.empty()) json["profiles"] = Profiles(summary);
  if (!summary.choice.empty()) json["choice"] = ChoiceToJson(summary.choice);
  if (!summary.forces.empty()) json["forces"] = Forces(problem, summary);
  json["covariance_method"] = summary.covariance_method;
  json["undetermined"] = summary.undetermined;
  if (!Modes(problem, summary, model, &json["modes"], error)) return false;
  if (!summary.modes.empty()) {
    json["measured_modes"] = MeasuredModes(problem, summary);
  }
  if (!summary.ambient.empty()) {
    json["ambient"] = AmbientAsJson(problem, summary);
  }
  if (!summary.frfs.empty()) json["frfs"] = FrfsAsJson(problem, summary);
  Json& solver = json["solver"];
  solver["iterations"] = summary.num_iterations;
  solver["initial_cost"] = summary.initial_cost;
  solver["final_cost"] = summary.final_cost;
  if (!summary.modes.empty()) {
    solver["initial_modal_cost"] = summary.initial_modal_cost;
    solver["final_modal_cost"] = summary.final_modal_cost;
  }
  solver["starts"] = summary.num_starts;
  solver["starts_at_best"] = summary.num_starts_at_best;
  solver["gradient_cosine"] = summary.gradient_cosine;
  solver["promised_share"] = summary.promised_share;
  if (!summary.way.empty()) {
    solver["way"] = summary.way;
    solver["linear_error"] = summary.linear_error;
  }
  solver["largest_gap"] = summary.largest_gap;
  solver["single_shooting"] = summary.single_shooting;
  solver["rejected_steps"] = summary.rejected_steps;
  solver["failed_evaluations"] = summary.failed_evaluations;
  solver["effective_parameters"] = summary.effective_parameters;
  solver["decays"] = summary.decays;
  solver["seconds"] = summary.seconds;
  solver["jacobian_seconds"] = summary.jacobian_seconds;
  solver["linear_solver_seconds"] = summary.linear_solver_seconds;
  if (!summary.profiles.empty()) {
    solver["profile_seconds"] = summary.profile_seconds;
  }
  solver["stages"] = Json::array();
  for (const StageRecord& stage : summary.stages) {
    solver["stages"].push_back({{"segment_samples", stage.segment_samples},
                                {"num_segments", stage.num_segments},
                                {"iterations", stage.iterations},
                                {"free_run_error", stage.free_run_error},
                                {"largest_gap", stage.largest_gap},
                                {"rolled_back", stage.rolled_back}});
  }
  json["remarks"] = problem.description.remarks;
  for (const std::string& remark : summary.remarks) {
    json["remarks"].push_back(remark);
  }
  *text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return true;
}

bool WriteSimulationSummary(const std::string& path,
                            const SimulationSummary& summary,
                            std::string* error) {
  Json json;
  json["schema"] = "pinode-simulate-1";
  json["case"] = summary.case_path;
  json["noise_percent"] = summary.noise_percent;
  json["seed"] = summary.seed;
  json["records"] = Json::array();
  for (const SimulationSummary::Record& record : summary.records) {
    json["records"].push_back({{"name", record.name},
                               {"samples", record.num_samples},
                               {"finite", record.finite}});
  }
  const SimulationSummary::Sweep& sweep = summary.sweep;
  if (sweep.num_points > 0) {
    json["sweep"] = {
        {"load", sweep.load},         {"amplitude", sweep.amplitude},
        {"from_hz", sweep.from_hz},   {"to_hz", sweep.to_hz},
        {"points", sweep.num_points}, {"finished", sweep.finished}};
  }
  return WriteFileAtomically(
      path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
      error);
}

}  // namespace pinode
