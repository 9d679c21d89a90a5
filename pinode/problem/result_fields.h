// Tables of the fields of result structs: one list per struct, in the order of
// its declaration. Files, archives and Python read the fields by these tables.

#ifndef PINODE_PROBLEM_RESULT_FIELDS_H_
#define PINODE_PROBLEM_RESULT_FIELDS_H_

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/model_choice.h"
#include "pinode/problem/parameter_profile.h"
#include "pinode/problem/verdict.h"

namespace pinode {

// A field by the name that it has in files.
template <typename Struct, typename Value>
struct Field {
  const char* name;
  Value Struct::*member;
};
template <typename Struct, typename Value>
constexpr Field<Struct, Value> MakeField(const char* name,
                                         Value Struct::*member) {
  return {name, member};
}

// Table of the fields of a struct; specialised below.
template <typename Struct>
struct FieldTable {
  static constexpr bool kExists = false;
};

template <>
struct FieldTable<ChannelScore> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("name", &ChannelScore::name),
                      MakeField("fitted", &ChannelScore::fitted),
                      MakeField("rmse", &ChannelScore::rmse),
                      MakeField("nrmse", &ChannelScore::nrmse),
                      MakeField("prior_nrmse", &ChannelScore::prior_nrmse),
                      MakeField("sigma", &ChannelScore::sigma),
                      MakeField("noise_share", &ChannelScore::noise_share),
                      MakeField("band_coverage", &ChannelScore::band_coverage));
};

template <>
struct FieldTable<RecordScore> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("name", &RecordScore::name),
      MakeField("role", &RecordScore::role),
      MakeField("finite", &RecordScore::finite),
      MakeField("first_scored_sample", &RecordScore::first_scored_sample),
      MakeField("nrmse", &RecordScore::nrmse),
      MakeField("prior_nrmse", &RecordScore::prior_nrmse),
      MakeField("channels", &RecordScore::channels),
      MakeField("start", &RecordScore::start),
      MakeField("prediction", &RecordScore::prediction),
      MakeField("states", &RecordScore::states),
      MakeField("state_mean_squares", &RecordScore::state_mean_squares),
      MakeField("deviations", &RecordScore::deviations));
};

template <>
struct FieldTable<MotionLevel> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("channel", &MotionLevel::channel),
                      MakeField("dof", &MotionLevel::dof),
                      MakeField("quantity", &MotionLevel::quantity),
                      MakeField("unit", &MotionLevel::unit),
                      MakeField("lowest", &MotionLevel::lowest),
                      MakeField("mean", &MotionLevel::mean),
                      MakeField("highest", &MotionLevel::highest));
};

template <>
struct FieldTable<ParameterEstimate> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("name", &ParameterEstimate::name),
      MakeField("unit", &ParameterEstimate::unit),
      MakeField("initial", &ParameterEstimate::initial),
      MakeField("value", &ParameterEstimate::value),
      MakeField("sigma", &ParameterEstimate::sigma),
      MakeField("lower95", &ParameterEstimate::lower95),
      MakeField("upper95", &ParameterEstimate::upper95),
      MakeField("half_width95", &ParameterEstimate::half_width95),
      MakeField("free", &ParameterEstimate::free),
      MakeField("at_bound", &ParameterEstimate::at_bound),
      MakeField("tie", &ParameterEstimate::tie),
      MakeField("tie_factor", &ParameterEstimate::tie_factor));
};

template <>
struct FieldTable<ModeMatch> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("mode", &ModeMatch::mode),
                      MakeField("frequency", &ModeMatch::frequency),
                      MakeField("mac", &ModeMatch::mac));
};

template <>
struct FieldTable<ModeScore> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("name", &ModeScore::name),
                      MakeField("frequency", &ModeScore::frequency),
                      MakeField("initial", &ModeScore::initial),
                      MakeField("updated", &ModeScore::updated));
};

template <>
struct FieldTable<LoadEvidence> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("log_likelihood", &LoadEvidence::log_likelihood),
      MakeField("price", &LoadEvidence::price),
      MakeField("finer_knots", &LoadEvidence::finer_knots),
      MakeField("finer_gain", &LoadEvidence::finer_gain),
      MakeField("finer_price", &LoadEvidence::finer_price));
};

template <>
struct FieldTable<AmbientScore> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("name", &AmbientScore::name),
      MakeField("lowest_frequency", &AmbientScore::lowest_frequency),
      MakeField("highest_frequency", &AmbientScore::highest_frequency),
      MakeField("num_lines", &AmbientScore::num_lines),
      MakeField("num_knots", &AmbientScore::num_knots),
      MakeField("evidence", &AmbientScore::evidence),
      MakeField("chi_square", &AmbientScore::chi_square),
      MakeField("degrees_of_freedom", &AmbientScore::degrees_of_freedom),
      MakeField("probability", &AmbientScore::probability),
      MakeField("coherence_probability", &AmbientScore::coherence_probability),
      MakeField("worst_from", &AmbientScore::worst_from),
      MakeField("worst_to", &AmbientScore::worst_to),
      MakeField("worst_deviation", &AmbientScore::worst_deviation),
      MakeField("channels", &AmbientScore::channels),
      MakeField("explained", &AmbientScore::explained),
      MakeField("by_measured_loads", &AmbientScore::by_measured_loads),
      MakeField("noise_sigma", &AmbientScore::noise_sigma),
      MakeField("groups", &AmbientScore::groups),
      MakeField("information_left", &AmbientScore::information_left),
      MakeField("most_information_left", &AmbientScore::most_information_left),
      MakeField("frequencies", &AmbientScore::frequencies),
      MakeField("measured", &AmbientScore::measured),
      MakeField("modelled", &AmbientScore::modelled),
      MakeField("lines", &AmbientScore::lines));
};

template <>
struct FieldTable<FrfScore> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("name", &FrfScore::name),
      MakeField("lowest_frequency", &FrfScore::lowest_frequency),
      MakeField("highest_frequency", &FrfScore::highest_frequency),
      MakeField("num_lines", &FrfScore::num_lines),
      MakeField("pairs", &FrfScore::pairs),
      MakeField("errors", &FrfScore::errors),
      MakeField("prior_errors", &FrfScore::prior_errors),
      MakeField("unexplained", &FrfScore::unexplained),
      MakeField("sigma", &FrfScore::sigma),
      MakeField("noise_ratios", &FrfScore::noise_ratios),
      MakeField("probability", &FrfScore::probability),
      MakeField("log_likelihood", &FrfScore::log_likelihood),
      MakeField("memory", &FrfScore::memory),
      MakeField("frequencies", &FrfScore::frequencies),
      MakeField("measured_real", &FrfScore::measured_real),
      MakeField("measured_imaginary", &FrfScore::measured_imaginary),
      MakeField("modelled_real", &FrfScore::modelled_real),
      MakeField("modelled_imaginary", &FrfScore::modelled_imaginary));
};

template <>
struct FieldTable<ForceEstimate> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("name", &ForceEstimate::name),
                      MakeField("record", &ForceEstimate::record),
                      MakeField("times", &ForceEstimate::times),
                      MakeField("value", &ForceEstimate::value),
                      MakeField("sigma", &ForceEstimate::sigma),
                      MakeField("lower95", &ForceEstimate::lower95),
                      MakeField("upper95", &ForceEstimate::upper95));
};

template <>
struct FieldTable<IterationRecord> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("stage", &IterationRecord::stage),
      MakeField("segment_samples", &IterationRecord::segment_samples),
      MakeField("iteration", &IterationRecord::iteration),
      MakeField("cost", &IterationRecord::cost),
      MakeField("gradient_norm", &IterationRecord::gradient_norm),
      MakeField("step_norm", &IterationRecord::step_norm),
      MakeField("trust_region_radius", &IterationRecord::trust_region_radius),
      MakeField("largest_gap", &IterationRecord::largest_gap),
      MakeField("accepted", &IterationRecord::accepted),
      MakeField("seconds", &IterationRecord::seconds));
};

template <>
struct FieldTable<StageRecord> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("segment_samples", &StageRecord::segment_samples),
      MakeField("num_segments", &StageRecord::num_segments),
      MakeField("iterations", &StageRecord::iterations),
      MakeField("free_run_error", &StageRecord::free_run_error),
      MakeField("largest_gap", &StageRecord::largest_gap),
      MakeField("rolled_back", &StageRecord::rolled_back));
};

template <>
struct FieldTable<ExplainedValue> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("name", &ExplainedValue::name),
                      MakeField("value", &ExplainedValue::value),
                      MakeField("lower95", &ExplainedValue::lower95),
                      MakeField("upper95", &ExplainedValue::upper95));
};

template <>
struct FieldTable<Explanation> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("what", &Explanation::what),
                      MakeField("kind", &Explanation::kind),
                      MakeField("place", &Explanation::place),
                      MakeField("log_odds", &Explanation::log_odds),
                      MakeField("probability", &Explanation::probability),
                      MakeField("value", &Explanation::value),
                      MakeField("lower95", &Explanation::lower95),
                      MakeField("upper95", &Explanation::upper95),
                      MakeField("removes", &Explanation::removes),
                      MakeField("leaves", &Explanation::leaves),
                      MakeField("moved", &Explanation::moved),
                      MakeField("shift", &Explanation::shift),
                      MakeField("values", &Explanation::values));
};

template <>
struct FieldTable<Finding> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("check", &Finding::check), MakeField("what", &Finding::what),
      MakeField("number", &Finding::number),
      MakeField("limit", &Finding::limit),
      MakeField("advice", &Finding::advice),
      MakeField("grade", &Finding::grade));
};

template <>
struct FieldTable<ParameterProfile::Point> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("value", &ParameterProfile::Point::value),
                      MakeField("ratio", &ParameterProfile::Point::ratio));
};

template <>
struct FieldTable<ParameterProfile> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("name", &ParameterProfile::name),
      MakeField("unit", &ParameterProfile::unit),
      MakeField("estimate", &ParameterProfile::estimate),
      MakeField("points", &ParameterProfile::points),
      MakeField("lower95", &ParameterProfile::lower95),
      MakeField("upper95", &ParameterProfile::upper95),
      MakeField("lower99", &ParameterProfile::lower99),
      MakeField("upper99", &ParameterProfile::upper99),
      MakeField("threshold95", &ParameterProfile::threshold95),
      MakeField("threshold99", &ParameterProfile::threshold99),
      MakeField("linear_lower95", &ParameterProfile::linear_lower95),
      MakeField("linear_upper95", &ParameterProfile::linear_upper95),
      MakeField("determination", &ParameterProfile::determination),
      MakeField("combinations", &ParameterProfile::combinations),
      MakeField("found_lower", &ParameterProfile::found_lower),
      MakeField("unsettled", &ParameterProfile::unsettled),
      MakeField("linearizations", &ParameterProfile::linearizations));
};

template <>
struct FieldTable<ModelChoice::Step> {
  static constexpr bool kExists = true;
  static constexpr auto kFields =
      std::make_tuple(MakeField("left_out", &ModelChoice::Step::left_out),
                      MakeField("taken_in", &ModelChoice::Step::taken_in),
                      MakeField("fitted", &ModelChoice::Step::fitted),
                      MakeField("accepted", &ModelChoice::Step::accepted),
                      MakeField("deviance", &ModelChoice::Step::deviance),
                      MakeField("price", &ModelChoice::Step::price));
};

template <>
struct FieldTable<ModelChoice> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("candidates", &ModelChoice::candidates),
      MakeField("left_out", &ModelChoice::left_out),
      MakeField("left_out_parameters", &ModelChoice::left_out_parameters),
      MakeField("memory", &ModelChoice::memory),
      MakeField("steps", &ModelChoice::steps),
      MakeField("complete", &ModelChoice::complete));
};

template <>
struct FieldTable<IdentifiedModel> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("parameters", &IdentifiedModel::parameters),
      MakeField("sigmas", &IdentifiedModel::sigmas),
      MakeField("starts", &IdentifiedModel::starts),
      MakeField("decays", &IdentifiedModel::decays),
      MakeField("resume_stage", &IdentifiedModel::resume_stage));
};

template <>
struct FieldTable<FitSummary> {
  static constexpr bool kExists = true;
  static constexpr auto kFields = std::make_tuple(
      MakeField("termination", &FitSummary::termination),
      MakeField("message", &FitSummary::message),
      MakeField("records", &FitSummary::records),
      MakeField("parameters", &FitSummary::parameters),
      MakeField("modes", &FitSummary::modes),
      MakeField("num_model_modes", &FitSummary::num_model_modes),
      MakeField("ambient", &FitSummary::ambient),
      MakeField("frfs", &FitSummary::frfs),
      MakeField("initial_modal_cost", &FitSummary::initial_modal_cost),
      MakeField("final_modal_cost", &FitSummary::final_modal_cost),
      MakeField("num_starts", &FitSummary::num_starts),
      MakeField("num_starts_at_best", &FitSummary::num_starts_at_best),
      MakeField("other_solution", &FitSummary::other_solution),
      MakeField("forces", &FitSummary::forces),
      MakeField("covariance_names", &FitSummary::covariance_names),
      MakeField("covariance", &FitSummary::covariance),
      MakeField("covariance_method", &FitSummary::covariance_method),
      MakeField("undetermined", &FitSummary::undetermined),
      MakeField("stages", &FitSummary::stages),
      MakeField("iterations", &FitSummary::iterations),
      MakeField("initial_cost", &FitSummary::initial_cost),
      MakeField("final_cost", &FitSummary::final_cost),
      MakeField("gradient_cosine", &FitSummary::gradient_cosine),
      MakeField("promised_share", &FitSummary::promised_share),
      MakeField("stalled", &FitSummary::stalled),
      MakeField("initial_damping", &FitSummary::initial_damping),
      MakeField("final_damping", &FitSummary::final_damping),
      MakeField("negative_damping_allowed",
                &FitSummary::negative_damping_allowed),
      MakeField("learns_force", &FitSummary::learns_force),
      MakeField("way", &FitSummary::way),
      MakeField("linear_error", &FitSummary::linear_error),
      MakeField("largest_gap", &FitSummary::largest_gap),
      MakeField("single_shooting", &FitSummary::single_shooting),
      MakeField("num_iterations", &FitSummary::num_iterations),
      MakeField("rejected_steps", &FitSummary::rejected_steps),
      MakeField("failed_evaluations", &FitSummary::failed_evaluations),
      MakeField("effective_parameters", &FitSummary::effective_parameters),
      MakeField("decays", &FitSummary::decays),
      MakeField("followed_record", &FitSummary::followed_record),
      MakeField("followed_channel", &FitSummary::followed_channel),
      MakeField("remarks", &FitSummary::remarks),
      MakeField("growing_motion", &FitSummary::growing_motion),
      MakeField("growing_motion_advice", &FitSummary::growing_motion_advice),
      MakeField("seconds", &FitSummary::seconds),
      MakeField("jacobian_seconds", &FitSummary::jacobian_seconds),
      MakeField("linear_solver_seconds", &FitSummary::linear_solver_seconds));
};

// Calls visit(name, value) for each field of `result`, in order.
template <typename Struct, typename Visit>
void VisitFields(Struct&& result, const Visit& visit) {
  std::apply(
      [&](const auto&... field) {
        (visit(field.name, result.*(field.member)), ...);
      },
      FieldTable<std::decay_t<Struct>>::kFields);
}

template <typename Struct>
constexpr size_t NumTabulatedFields() {
  return std::tuple_size_v<
      std::remove_const_t<decltype(FieldTable<Struct>::kFields)>>;
}

}  // namespace pinode

#endif  // PINODE_PROBLEM_RESULT_FIELDS_H_
