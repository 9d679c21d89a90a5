#include "pinode/report/fit_text.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Correlation from which two estimates count as one: a change of one is
// compensated by the other nearly without effect on the records.
constexpr double kStrongCorrelation = 0.95;
constexpr size_t kMaxCorrelations = 12;

const char* TerminationSentence(Termination termination) {
  switch (termination) {
    case Termination::kFailure:
      return "failed";
    case Termination::kConverged:
      return "converged";
    case Termination::kNoConvergence:
      return "not converged";
    case Termination::kInterrupted:
      return "interrupted; this is the best result so far";
  }
  return "";
}

// Returns pairs of parameters that the data hardly distinguish.
std::vector<std::string> StrongCorrelations(
    const IdentificationSummary& summary) {
  const Matrix& covariance = summary.covariance;
  const Eigen::Index size = covariance.rows();
  std::vector<std::pair<double, std::string>> found;
  if (covariance.cols() != size ||
      static_cast<size_t>(size) != summary.covariance_names.size()) {
    return {};
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double correlation =
          covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
      if (!(std::abs(correlation) >= kStrongCorrelation)) continue;
      found.emplace_back(
          -std::abs(correlation),
          summary.covariance_names[static_cast<size_t>(j)] + " and " +
              summary.covariance_names[static_cast<size_t>(i)] +
              " can hardly be told apart: only their combination is known well "
              "(correlation " +
              ReadableNumber(correlation, 3) + ").");
    }
  }
  std::sort(found.begin(), found.end());
  if (found.size() > kMaxCorrelations) found.resize(kMaxCorrelations);
  std::vector<std::string> sentences;
  for (const auto& entry : found) sentences.push_back(entry.second);
  return sentences;
}

std::string IterationsText(const IdentificationSummary& summary) {
  std::string text = Count(summary.num_iterations, "iteration");
  if (summary.rejected_steps > 0) {
    text += ", " + Count(summary.rejected_steps, "rejected step");
  }
  if (summary.failed_evaluations > 0) {
    text += ", " + Count(summary.failed_evaluations, "trajectory") +
            " discarded because it was not finite";
  }
  return text;
}

}  // namespace

std::string CovarianceSentence(const std::string& method) {
  if (method == "plain") {
    return "plain: inverse of the Gauss-Newton Hessian. It assumes that the "
           "residuals of different samples are independent.";
  }
  if (method == "sandwich") {
    return "block sandwich: the intervals allow for the correlation of "
           "residuals that are close in time.";
  }
  if (method == "inflated") {
    return "inflated: residuals close in time are correlated. The intervals "
           "count one sample per autocorrelation time.";
  }
  if (method == "input noise") {
    return "input noise: the intervals allow for the noise of the measured "
           "excitation and of the sensors.";
  }
  if (method == "errors in variables") {
    return "errors in variables: the errors of the measured excitation are "
           "unknowns of the fit. The case gives their size.";
  }
  return method;
}

std::vector<std::pair<std::string, std::string>> SolutionFacts(
    const IdentificationSummary& summary) {
  std::vector<std::pair<std::string, std::string>> facts = {
      {"Result", std::string(TerminationSentence(summary.termination)) +
                     (summary.message.empty() || summary.message == "converged"
                          ? ""
                          : " (" + summary.message + ")")},
      {"Levenberg-Marquardt", IterationsText(summary)},
      {"Cost", ReadableNumber(summary.initial_cost, 5) + " \u2192 " +
                   ReadableNumber(summary.final_cost, 5)}};
  if (!summary.way.empty()) facts.emplace_back("Way", summary.way);
  if (summary.num_starts > 1) {
    facts.emplace_back("Starts", std::to_string(summary.num_starts_at_best) +
                                     " of " +
                                     std::to_string(summary.num_starts) +
                                     " reached the lowest cost");
  }
  facts.emplace_back("Time", Duration(summary.seconds) + " (derivatives " +
                                 Duration(summary.jacobian_seconds) +
                                 ", linear solver " +
                                 Duration(summary.linear_solver_seconds) + ")");
  if (!summary.stages.empty()) {
    facts.emplace_back(
        "Shooting",
        summary.records.empty() ? "no records of measured loads"
        : summary.single_shooting
            ? "the last stage was a simulation of each whole record"
            : "the records stay cut into segments: the simulation of the "
              "whole record was not stable or not better");
    if (summary.largest_gap > 0.0) {
      facts.emplace_back("Largest gap between segments",
                         ReadableNumber(summary.largest_gap, 2) +
                             " times the state's root mean square");
    }
  }
  if (!summary.covariance_method.empty()) {
    facts.emplace_back("Covariance",
                       CovarianceSentence(summary.covariance_method));
  }
  return facts;
}

std::vector<std::string> Limits(const IdentificationSummary& summary) {
  std::vector<std::string> limits;
  for (const std::string& direction : summary.undetermined) {
    limits.push_back("Not determined by these records: " + direction + ".");
  }
  for (const ParameterEstimate& parameter : summary.parameters) {
    if (parameter.free && parameter.at_bound) {
      limits.push_back(parameter.name +
                       " stopped at its bound, so its interval means nothing. "
                       "Check the bound and the model.");
    }
  }
  for (const std::string& sentence : StrongCorrelations(summary)) {
    limits.push_back(sentence);
  }
  for (const ParameterProfile& profile : summary.profiles) {
    if (profile.DiffersFromLinear()) {
      limits.push_back(
          profile.name +
          ": the linear interval is wrong by more than a fifth. Use the "
          "interval of the profile.");
    }
  }
  return limits;
}

std::string NoLimitsSentence(const IdentificationSummary& summary) {
  if (summary.covariance_method.empty()) {
    return "There is no covariance. It is unknown what the data determine.";
  }
  if (!Limits(summary).empty()) return "";
  return "The records determine every free named parameter, and no two of "
         "them are correlated by " +
         ReadableNumber(kStrongCorrelation, 2) + " or more.";
}

}  // namespace pinode
