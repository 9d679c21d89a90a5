#include "pinode/estimate/fit/fit_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/verdict_limits.h"

namespace pinode {
namespace {

using Findings = std::vector<Finding>;
using Role = IdentificationRecord::Role;

bool IsTraining(const RecordScore& score) { return score.role == Role::kTrain; }

bool HasTrainRecord(const FitSummary& fit) {
  return std::any_of(fit.records.begin(), fit.records.end(), IsTraining);
}

// Free text in which numbers are written as a stream writes them.
template <typename... Parts>
std::string Text(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

std::string PercentText(double fraction) {
  return FormatNumber(100.0 * fraction, 2) + " %";
}

// RMS over the training records of `error`, a function of their scores.
template <typename Error>
double RmsOverTraining(const FitSummary& fit, const Error& error) {
  double sum = 0.0;
  int count = 0;
  for (const RecordScore& score : fit.records) {
    if (!IsTraining(score)) continue;
    sum += std::pow(error(score), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

double TrainingError(const FitSummary& fit) {
  return RmsOverTraining(fit,
                         [](const RecordScore& score) { return score.nrmse; });
}

void CheckPrediction(const RecordScore& score, Findings* findings) {
  const bool train = IsTraining(score);
  const double no_motion =
      train ? limits::kNoMotion : limits::kNoMotionOfHoldout;
  if (!score.finite) {
    findings->push_back(
        {"free_run_not_finite",
         "the simulation of record '" + score.name + "' is not finite", kNaN,
         kNaN,
         "check units, masses and stiffnesses, and give the groups bounds"});
  } else if (score.nrmse >= no_motion) {
    findings->push_back(
        {"no_better_than_no_motion",
         Text("the model predicts record '", score.name, "' no better (nrmse ",
              score.nrmse, ") than no motion at all (nrmse 1)"),
         score.nrmse, no_motion});
  } else if (train ? score.nrmse >= score.prior_nrmse
                   : score.nrmse > score.prior_nrmse) {
    findings->push_back(
        {"no_better_than_initial_model",
         Text("the model does not predict record '", score.name,
              "' better (nrmse ", score.nrmse, ") than the initial model (",
              score.prior_nrmse, ")"),
         score.nrmse, score.prior_nrmse});
  } else if (train && StructuredError(score) > limits::kUnexplained) {
    findings->push_back(
        {kUnexplainedMotion,
         PercentText(score.nrmse) + " of the motion of record '" + score.name +
             "' is unexplained, and noise is not the reason",
         StructuredError(score), limits::kUnexplained,
         "check size, sign, place and time of each load and sensor, and the "
         "damping; or find what the model lacks"});
  }
}

void CheckLinearTerms(const FitSummary& fit, Findings* findings) {
  const double error = TrainingError(fit);
  if (!(error > limits::kLinearTermsTolerance * fit.linear_error)) return;
  findings->push_back({"worse_than_linear_terms",
                       "the model predicts the training records worse than its "
                       "linear terms alone",
                       error, fit.linear_error});
}

void CheckLearnedForce(const FitSummary& fit, Findings* findings) {
  if (!fit.learns_force) return;
  const double left = RmsOverTraining(fit, StructuredError);
  if (left <= limits::kUnexplainedByNetwork) return;
  findings->push_back(
      {"force_not_learned",
       "the network leaves " + PercentText(left) +
           " of the training records unexplained: it has not learned the "
           "missing force",
       left, limits::kUnexplainedByNetwork,
       "try another 'seed' of the network, more hidden units, more inputs, or "
       "a larger 'memory'"});
}

void CheckHoldouts(const FitSummary& fit, Findings* findings) {
  if (!HasTrainRecord(fit)) return;
  const double training = TrainingError(fit);
  const double largest =
      std::max(limits::kHoldoutError, limits::kHoldoutGrowth * training);
  for (const RecordScore& score : fit.records) {
    if (IsTraining(score) || !score.finite) continue;
    const bool much = score.nrmse > largest;
    const double unexplained = StructuredError(score);
    if (!much && !(unexplained > limits::kUnexplainedOfHoldout)) continue;
    findings->push_back(
        {"does_not_carry_over",
         "the result does not carry over to hold-out record '" + score.name +
             "': its error is " + PercentText(score.nrmse) +
             ", that of the training records " + PercentText(training),
         much ? score.nrmse : unexplained,
         much ? largest : limits::kUnexplainedOfHoldout});
  }
}

void CheckFrequencyUnit(const FitSummary& fit, Findings* findings) {
  std::vector<double> ratios;
  for (const ModeScore& mode : fit.modes) {
    if (mode.InUse() && mode.initial.frequency > 0.0) {
      ratios.push_back(mode.frequency / mode.initial.frequency);
    }
  }
  if (ratios.empty()) return;
  std::nth_element(
      ratios.begin(),
      ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
      ratios.end());
  const double ratio = ratios[ratios.size() / 2];
  if (std::abs(std::log(ratio)) <= std::log(limits::kFrequencyScale)) return;
  findings->push_back(
      {"frequencies_of_another_unit",
       "the measured frequencies are " + FormatNumber(ratio, 2) +
           " times those of the initial model",
       ratio, limits::kFrequencyScale,
       "check three things: frequencies in Hz and not in rad/s, masses and "
       "stiffnesses in the units of the model, the right structure"});
}

// A fit that holds a mode against the wrong one of the model has moved
// parameters to no end.
void CheckModePartners(const FitSummary& fit, Findings* findings) {
  const auto used =
      std::count_if(fit.modes.begin(), fit.modes.end(),
                    [](const ModeScore& mode) { return mode.InUse(); });
  const auto measured = static_cast<std::ptrdiff_t>(fit.modes.size());
  // If the model has fewer modes than were measured, all of its are enough.
  if (2 * used <= measured && used < fit.num_model_modes) {
    findings->push_back(
        {"modes_without_partner",
         "only " + std::to_string(used) + " of " + std::to_string(measured) +
             " measured modes are like a mode of the initial model",
         static_cast<double>(used), static_cast<double>(measured) / 2.0,
         "check units, the places and signs of the sensors, and that the model "
         "is of this structure"});
  }
  for (const ModeScore& mode : fit.modes) {
    if (!mode.InUse()) continue;
    const double ratio = mode.updated.frequency / mode.frequency;
    const double distance = std::abs(std::log(ratio));
    // A MAC of NaN is of a mode without a shape.
    const bool unlike = mode.updated.mac < limits::kModeMac;
    if (distance <= limits::kModeDistance && !unlike) continue;
    const std::string nearest = std::isfinite(ratio)
                                    ? PercentText(ratio - 1.0) + " in frequency"
                                    : "without a frequency";
    findings->push_back(
        {"mode_lost",
         "no mode of the updated model is like measured mode '" + mode.name +
             "' (the nearest: " + nearest +
             (std::isfinite(mode.updated.mac)
                  ? ", MAC " + FormatNumber(mode.updated.mac, 2)
                  : "") +
             "); it may be no mode of the structure, or paired wrongly",
         unlike ? mode.updated.mac : distance,
         unlike ? limits::kModeMac : limits::kModeDistance,
         "leave it out, give its shape at more DOFs, or begin from a better "
         "model"});
    return;
  }
}

void CheckFrequencies(const FitSummary& fit, Findings* findings) {
  double before = 0.0;
  double after = 0.0;
  for (const ModeScore& mode : fit.modes) {
    if (!mode.InUse()) continue;
    const auto error = [&mode](const ModeMatch& match) {
      return std::abs(match.frequency / mode.frequency - 1.0);
    };
    before = std::max(before, error(mode.initial));
    after = std::max(after, error(mode.updated));
  }
  const double grown =
      std::max(limits::kFrequencyMet, limits::kFrequencyGrowth * before);
  if (after > limits::kFrequencyError) {
    findings->push_back(
        {"frequencies_not_met",
         "the largest error of a measured frequency is still " +
             PercentText(after),
         after, limits::kFrequencyError,
         "check the order, sign, place and direction of the sensors, and "
         "whether the groups can make the model like the structure"});
  } else if (after > grown) {
    findings->push_back(
        {"frequencies_worse",
         "the updated model meets measured frequencies within " +
             PercentText(after) + ", the initial model within " +
             PercentText(before) + ": shapes and frequencies contradict",
         after, grown,
         "check the sign, place and direction of each sensor, and whether "
         "standard deviations are too small"});
  }
}

// Returns for each group of the ambient records the largest share, over these,
// of the information that the unmeasured loads leave.
std::map<std::string, double> InformationLeft(const FitSummary& fit) {
  std::map<std::string, double> left;
  for (const AmbientScore& score : fit.ambient) {
    for (size_t g = 0; g < score.groups.size(); ++g) {
      double& most = left[score.groups[g]];
      most =
          std::max(most, score.information_left[static_cast<Eigen::Index>(g)]);
    }
  }
  return left;
}

// As many groups must be determined, one at least, as loads hide: a combination
// that no group follows from may be a mode that a fit has put where the loads
// have a peak.
void CheckGroupsOfAmbientRecords(const FitSummary& fit, Findings* findings) {
  const std::map<std::string, double> left = InformationLeft(fit);
  // Without a covariance another finding says why.
  if (left.empty() || fit.covariance.size() == 0) return;
  size_t told = 0;
  std::vector<std::string> hidden, others;
  for (const ParameterEstimate& estimate : fit.parameters) {
    const auto group = left.find(estimate.name);
    if (group == left.end()) continue;
    const double half_width = (estimate.upper95 - estimate.value) /
                              std::max(1.0, std::abs(estimate.value));
    const std::string name = "'" + estimate.name + "'";
    if (group->second < limits::kInformationLeft) {
      hidden.push_back(name);
    } else if (half_width <= limits::kWidestInterval) {
      ++told;
    } else {
      // Known loads would not determine it either.
      others.push_back(name);
    }
  }
  if (told > 0 && told >= hidden.size()) return;
  if (told == 0) hidden.insert(hidden.end(), others.begin(), others.end());
  if (hidden.empty()) return;
  findings->push_back(
      {"groups_not_determined",
       (told == 0 ? "none of " + Join(hidden, ", ") + " is" : "not") +
           " determined by the data" +
           (told == 0 ? "" : ": " + Join(hidden, ", ")) +
           "; the unmeasured loads explain the ambient records as well",
       static_cast<double>(told), static_cast<double>(hidden.size()),
       "use fewer knots or loads, more sensors, or a band with modes of the "
       "structure"});
}

// Ambient records alone must tell something of the structure that their loads
// could not have done as well.
void CheckLoadsDoNotExplainAll(const FitSummary& fit, Findings* findings) {
  if (fit.ambient.empty() || HasTrainRecord(fit) || !fit.modes.empty() ||
      !fit.frfs.empty()) {
    return;
  }
  for (const AmbientScore& score : fit.ambient) {
    if (score.most_information_left >= limits::kAnyInformationLeft) {
      CheckGroupsOfAmbientRecords(fit, findings);
      return;
    }
  }
  const AmbientScore& first = fit.ambient.front();
  findings->push_back({"loads_explain_all",
                       "the unmeasured loads explain all of ambient record '" +
                           first.name +
                           "', so it determines no group: at most " +
                           PercentText(first.most_information_left) +
                           " of its information on the groups is left",
                       first.most_information_left, limits::kAnyInformationLeft,
                       "use fewer knots or loads, or more sensors"});
}

void CheckSpectra(const FitSummary& fit, Findings* findings) {
  for (const AmbientScore& score : fit.ambient) {
    if (score.coherence_probability < limits::kSpectrumProbability) {
      findings->push_back(
          {"measured_loads_not_explained",
           Text("the rest of record '", score.name,
                "', without the response to its measured loads, still follows "
                "these loads (probability of chance ",
                score.coherence_probability, ")"),
           score.coherence_probability, limits::kSpectrumProbability,
           "check size, sign, time and place of each load and sensor; or there "
           "are loads from before the record, or modes that the model lacks"});
    } else if (score.probability < limits::kSpectrumProbability) {
      findings->push_back(
          {"spectra_not_described",
           Text("the model does not describe the spectra of ambient record '",
                score.name, "' (probability of chance ", score.probability,
                ", worst between ", score.worst_from, " and ", score.worst_to,
                " cycles per unit of time)"),
           score.probability, limits::kSpectrumProbability,
           "add modes to the model, move or add loads, or use more knots"});
    }
  }
}

// The pair with the largest entry of `values`, as "pair a/b of 'name'".
std::string WorstPair(const FrfScore& score, const Vector& values) {
  Eigen::Index worst = 0;
  values.maxCoeff(&worst);
  return "pair " + score.pairs[static_cast<size_t>(worst)] + " of '" +
         score.name + "'";
}

void CheckFrfs(const FitSummary& fit, Findings* findings) {
  for (const FrfScore& score : fit.frfs) {
    if (score.pairs.empty()) {
      findings->push_back({"frfs_not_finite",
                           "the model has no finite frequency responses for '" +
                               score.name + "'",
                           kNaN, kNaN, "check units, masses and stiffnesses"});
    } else if (score.errors.norm() >
               limits::kFrfErrorGrowth * score.prior_errors.norm() +
                   limits::kFrfRounding) {
      findings->push_back({"frfs_no_better_than_initial_model",
                           "the model does not describe frequency responses '" +
                               score.name + "' better than the initial model",
                           score.errors.norm(), score.prior_errors.norm(),
                           "check units, and places and directions of hammer "
                           "and sensors"});
    } else if (score.WorstUnexplained() > limits::kFrfUnexplained) {
      findings->push_back(
          {"frfs_not_described",
           PercentText(score.WorstUnexplained()) + " of " +
               WorstPair(score, score.unexplained) +
               " is unexplained, and noise is not the reason",
           score.WorstUnexplained(), limits::kFrfUnexplained,
           "check size, sign and place of hammer and sensor, the damping, and "
           "the band; or find what the model lacks"});
    }
    if (score.noise_ratios.size() > 0 &&
        score.noise_ratios.maxCoeff() > limits::kGivenNoiseFar) {
      findings->push_back(
          {"frf_noise_far_off",
           "the error of " + WorstPair(score, score.noise_ratios) + " is " +
               FormatNumber(score.noise_ratios.maxCoeff(), 3) +
               " times its given noise",
           score.noise_ratios.maxCoeff(), limits::kGivenNoiseFar,
           "correct 'sigma', or find what the model lacks"});
    }
  }
}

// True if the initial model has the measured modes, up to rounding: nothing is
// left to be met better.
bool InitialModelMeetsModes(const FitSummary& fit) {
  constexpr double kRounding = 1e-9;
  return std::all_of(
      fit.modes.begin(), fit.modes.end(), [](const ModeScore& mode) {
        const double error = mode.initial.frequency / mode.frequency - 1.0;
        return !mode.InUse() || (std::abs(error) < kRounding &&
                                 !(mode.initial.mac < 1.0 - kRounding));
      });
}

void CheckModalCost(const FitSummary& fit, Findings* findings) {
  if (fit.modes.empty() || HasTrainRecord(fit) || !fit.frfs.empty() ||
      fit.final_modal_cost < fit.initial_modal_cost ||
      InitialModelMeetsModes(fit)) {
    return;
  }
  findings->push_back(
      {"modes_not_met_better",
       Text("the updated model does not meet the measured modes better (cost ",
            fit.final_modal_cost, ") than the initial model (",
            fit.initial_modal_cost, ")"),
       fit.final_modal_cost, fit.initial_modal_cost});
}

// Frequencies of a symmetric structure always allow its mirror image.
bool IsOfFrequenciesAlone(const FitSummary& fit) {
  return !HasTrainRecord(fit) && fit.ambient.empty() && fit.frfs.empty() &&
         !fit.modes.empty() &&
         std::none_of(fit.modes.begin(), fit.modes.end(),
                      [](const ModeScore& mode) {
                        return std::isfinite(mode.updated.mac);
                      });
}

Finding OtherSolution(const FitSummary& fit) {
  return {"other_solution",
          "another solution describes the data almost as well: " +
              fit.other_solution,
          kNaN, kNaN, "add sensors, bounds or priors to decide between them"};
}

void CheckConvergence(const GapTuning& gaps, const FitSummary& fit,
                      Findings* findings) {
  if (fit.largest_gap > gaps.closed) {
    findings->push_back({"open_gaps",
                         Text("gaps between segments stayed open (",
                              fit.largest_gap, " times the RMS of the state)"),
                         fit.largest_gap, gaps.closed});
  }
  if (!fit.other_solution.empty() && !IsOfFrequenciesAlone(fit)) {
    findings->push_back(OtherSolution(fit));
  }
  if (fit.stalled) {
    findings->push_back(
        {"stalled",
         Text("the fit stopped before a minimum (cosine of the gradient ",
              fit.gradient_cosine, ")"),
         fit.gradient_cosine, kNaN, "try options.multistart"});
  } else if (fit.termination == Termination::kNoConvergence) {
    findings->push_back({"not_converged",
                         Text("the fit has not converged after ",
                              fit.num_iterations, " iterations"),
                         static_cast<double>(fit.num_iterations), kNaN,
                         // Fits of ambient records also end where further
                         // steps gain next to nothing.
                         fit.ambient.empty()
                             ? "raise options.max_iterations"
                             : "raise options.max_iterations if it allows no "
                               "more; else check sign, order and gain of the "
                               "sensors, which the model contradicts"});
  }
}

void CheckDamping(const FitSummary& fit, Findings* findings) {
  if (!(fit.final_damping < -limits::kDamping) ||
      fit.negative_damping_allowed) {
    return;
  }
  findings->push_back(
      {"negative_damping",
       Text("a mode has negative damping (", 100.0 * fit.final_damping, " %)"),
       fit.final_damping, -limits::kDamping,
       "give the damping groups a 'lower' bound"});
}

void CheckFollowedChannel(const FitSummary& fit, Findings* findings) {
  if (fit.followed_channel.empty()) return;
  findings->push_back(
      {"force_follows_channel",
       "an unknown force follows channel '" + fit.followed_channel +
           "' of record '" + fit.followed_record +
           "' sample by sample, so the noise of the channel cannot be "
           "estimated",
       kNaN, kNaN, "give the `sigma` of the channel"});
}

}  // namespace

std::vector<Finding> CheckFit(const GapTuning& gaps, const FitSummary& fit) {
  if (fit.termination == Termination::kFailure) {
    return {{"failed", fit.message}};
  }
  if (fit.termination == Termination::kInterrupted) {
    return {{"interrupted", fit.message}};
  }
  Findings findings;
  for (const RecordScore& score : fit.records) {
    CheckPrediction(score, &findings);
  }
  if (!fit.growing_motion.empty()) {
    findings.push_back({"growing_motion", fit.growing_motion, kNaN,
                        limits::kGrowth, fit.growing_motion_advice});
  }
  CheckLinearTerms(fit, &findings);
  CheckLearnedForce(fit, &findings);
  CheckHoldouts(fit, &findings);
  CheckFrequencyUnit(fit, &findings);
  CheckModePartners(fit, &findings);
  CheckFrequencies(fit, &findings);
  CheckLoadsDoNotExplainAll(fit, &findings);
  CheckSpectra(fit, &findings);
  CheckFrfs(fit, &findings);
  CheckModalCost(fit, &findings);
  CheckConvergence(gaps, fit, &findings);
  CheckDamping(fit, &findings);
  CheckFollowedChannel(fit, &findings);
  return findings;
}

std::vector<Finding> CheckMeasuredFrequencies(
    const IdentificationProblem& problem, const FitSummary& fit) {
  if (problem.num_train_records() > 0 || problem.HasSpectra()) return {};
  double sum = 0.0;
  double worst = 0.0;
  int count = 0;
  for (size_t i = 0; i < fit.modes.size(); ++i) {
    const MeasuredMode& measured = problem.modal.modes[i];
    if (!fit.modes[i].InUse() || !(measured.frequency_sigma > 0.0)) continue;
    const double error = fit.modes[i].updated.frequency - measured.frequency;
    sum += std::pow(error / measured.frequency_sigma, 2);
    worst = std::max(worst, std::abs(error) / measured.frequency);
    ++count;
  }
  const double ratio = count > 0 ? std::sqrt(sum / count) : 0.0;
  if (!(ratio > limits::kFrequencyDeviations) ||
      !(worst > limits::kFrequencyMet)) {
    return {};
  }
  return {
      {"frequencies_far_off",
       "the errors of the measured frequencies are " + FormatNumber(ratio, 3) +
           " times their standard deviations, the worst error is " +
           PercentText(worst),
       ratio, limits::kFrequencyDeviations,
       "start from a better model, set 'multistart', or check modes, groups "
       "and standard deviations"}};
}

std::vector<Finding> CheckDoubts(const FitSummary& fit) {
  Findings findings;
  if (!fit.other_solution.empty() && IsOfFrequenciesAlone(fit)) {
    findings.push_back(OtherSolution(fit));
    findings.back().grade = Grade::kWithCare;
  }
  for (const FrfScore& score : fit.frfs) {
    if (score.pairs.empty()) continue;
    if (score.probability < limits::kFrfProbability) {
      findings.push_back(
          {"frf_residual_no_noise",
           "the error of frequency responses '" + score.name +
               "' is not noise: " + PercentText(score.WorstUnexplained()) +
               " of " + WorstPair(score, score.unexplained) + " is unexplained",
           score.probability, limits::kFrfProbability,
           "find what the model lacks; or, if the noise is a share of each "
           "line, set noise = \"relative\"",
           Grade::kWithCare});
    }
    if (score.num_lines < limits::kFewFrfLines) {
      findings.push_back({"frf_few_lines",
                          "frequency responses '" + score.name + "' have " +
                              std::to_string(score.num_lines) +
                              " lines: a wrong model may look right",
                          static_cast<double>(score.num_lines),
                          static_cast<double>(limits::kFewFrfLines),
                          "widen 'band_hz', lower 'stride', or measure with a "
                          "finer resolution",
                          Grade::kWithCare});
    }
    if (score.noise_ratios.size() > 0 &&
        score.noise_ratios.maxCoeff() > limits::kGivenNoise) {
      findings.push_back(
          {"frf_noise_off",
           "the error of " + WorstPair(score, score.noise_ratios) + " is " +
               FormatNumber(score.noise_ratios.maxCoeff(), 3) +
               " times its given noise",
           score.noise_ratios.maxCoeff(), limits::kGivenNoise,
           "correct 'sigma', or find what the model lacks", Grade::kWithCare});
    }
  }
  for (const RecordScore& score : fit.records) {
    if (!IsTraining(score)) continue;
    const double unexplained = StructuredError(score);
    if (!(unexplained > limits::kLittleUnexplained)) continue;
    findings.push_back(
        {kUnexplainedMotion,
         PercentText(unexplained) + " of the motion of record '" + score.name +
             "' is unexplained and too large to be noise",
         unexplained, limits::kLittleUnexplained,
         "find the cause first: the intervals allow for it only where an "
         "explanation was found",
         Grade::kWithCare});
  }
  return findings;
}

std::string WhyNotSound(const GapTuning& gaps, const FitSummary& fit) {
  const std::vector<Finding> findings = CheckFit(gaps, fit);
  return findings.empty() ? "" : findings.front().Sentence();
}

}  // namespace pinode
