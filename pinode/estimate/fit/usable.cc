#include "pinode/estimate/fit/usable.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/estimate/shooting/score.h"

namespace pinode {
namespace {

// Damping ratios down to this are rounding.
constexpr double kLeastDamping = 1e-6;
// Of the motion, what a network may leave that is no noise.
constexpr double kMostLeftByNetwork = 0.1;
// And what any model may. With the wrong load, a load at the wrong place or
// time, sensors exchanged or a third of the damping, fits of a frame's storeys
// ended at 0.47 to 0.87, all better than the model before, with intervals that
// were tens of their widths off.
constexpr double kMostLeft = 0.4;
// Of a record's motion; noise alone is fitted as well as this.
constexpr double kNoMotion = 0.98;
// Where a hold-out record's error is larger than both this and this multiple of
// the training records', it belongs to another structure or the model is wrong.
constexpr double kMostHoldoutError = 0.5;
constexpr double kMostHoldoutGrowth = 3.0;
// Or if it misses this much of the motion that is no noise.
constexpr double kMostLeftOfHoldout = 0.7;

// A group is told where loads leave so much of what ambient records say of it,
// and its interval is no wider to either side than one or its value. Where less
// is left, as in bands beside all modes, so little of the cost is quadratic
// that 95 % intervals, however narrow, held the truth in 50 to 90 of 100
// records.
constexpr double kLeastLeftOfGroup = 0.1;
constexpr double kWidestInterval = 1.0;

// How far a measured mode may be from the one that it is held against: the
// logarithm of the ratio of frequencies, and the MAC.
constexpr double kMostModeDistance = 0.3;
constexpr double kLeastModeMac = 0.5;
// Where the farthest frequency is off by more than this and by more than so
// many times what the model before left, shapes have driven it there.
constexpr double kFrequencyMet = 0.02;
constexpr double kMostFrequencyGrowth = 2.0;
// And more than this is met by no updated model, whatever the one before left:
// sensors in another order ended at 0.16 and 0.20, one upside down at 0.12.
constexpr double kMostFrequencyError = 0.1;
// By how much all measured frequencies may be higher or lower than those of the
// model before. A model is not nine times too soft; radians per second in place
// of cycles are 6.3, and other units of mass or length the root of theirs.
constexpr double kMostFrequencyScale = 3.0;

// Empty: every record is predicted well enough.
std::string WhyNotPredicted(const IdentificationSummary& summary) {
  std::ostringstream reason;
  for (const RecordScore& score : summary.records) {
    const bool train = score.role == IdentificationRecord::Role::kTrain;
    if (!score.finite) {
      reason << "the free run of record '" << score.name << "' is not finite";
    } else if (score.nrmse >= (train ? kNoMotion : 1.0)) {
      reason << "record '" << score.name << "' is predicted no better (nrmse "
             << score.nrmse << ") than by no motion at all (1)";
    } else if (train ? score.nrmse >= score.prior_nrmse
                     : score.nrmse > score.prior_nrmse) {
      reason << "record '" << score.name << "' is not predicted better (nrmse "
             << score.nrmse << ") than by the model before ("
             << score.prior_nrmse << ")";
    } else if (train && StructuredError(score) > kMostLeft) {
      reason << "the model misses " << FormatNumber(100.0 * score.nrmse, 2)
             << " % of the motion of record '" << score.name
             << "'; that is more than noise: a load or a sensor of the "
                "wrong size, sign, place or time, damping that is far off, or "
                "something that the model lacks";
    } else {
      continue;
    }
    return reason.str();
  }
  return "";
}

bool HasTrainRecord(const IdentificationSummary& summary) {
  return std::any_of(summary.records.begin(), summary.records.end(),
                     [](const RecordScore& score) {
                       return score.role == IdentificationRecord::Role::kTrain;
                     });
}

// Empty: each measured mode that was used is still like its partner. A fit that
// holds a mode against another one of the model has moved parameters to no end.
std::string WhyModesAreLost(const IdentificationSummary& summary) {
  const auto used =
      std::count_if(summary.modes.begin(), summary.modes.end(),
                    [](const ModeScore& mode) { return mode.InUse(); });
  const auto measured = static_cast<std::ptrdiff_t>(summary.modes.size());
  // Where more were measured than the model has, all that it has are enough.
  if (2 * used <= measured && used < summary.num_model_modes) {
    return "of " + std::to_string(measured) + " measured modes only " +
           std::to_string(used) +
           " are like any of the model before: wrong units, places or signs of "
           "sensors, or another structure";
  }
  for (const ModeScore& mode : summary.modes) {
    if (!mode.InUse()) continue;
    const double ratio = mode.updated.frequency / mode.frequency;
    // A MAC of NaN is of a mode without a shape.
    if (std::abs(std::log(ratio)) <= kMostModeDistance &&
        !(mode.updated.mac < kLeastModeMac)) {
      continue;
    }
    std::ostringstream reason;
    reason << "no mode of the model that was found is like measured mode '"
           << mode.name << "' (the nearest: "
           << (std::isfinite(ratio)
                   ? FormatNumber(100.0 * (ratio - 1.0), 2) + " % in frequency"
                   : "without a frequency");
    if (std::isfinite(mode.updated.mac)) {
      reason << ", MAC " << FormatNumber(mode.updated.mac, 2);
    }
    reason << "): it may be none of the structure's, or paired wrongly; leave "
              "it out, give its shape at more DOFs, or begin from a better "
              "model";
    return reason.str();
  }
  return "";
}

// Empty: the model before had frequencies of about the size of the measured
// ones.
std::string WhyFrequenciesAreOfAnotherUnit(
    const IdentificationSummary& summary) {
  std::vector<double> ratios;
  for (const ModeScore& mode : summary.modes) {
    if (mode.InUse() && mode.initial.frequency > 0.0) {
      ratios.push_back(mode.frequency / mode.initial.frequency);
    }
  }
  if (ratios.empty()) return "";
  std::nth_element(
      ratios.begin(),
      ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
      ratios.end());
  const double ratio = ratios[ratios.size() / 2];
  if (std::abs(std::log(ratio)) <= std::log(kMostFrequencyScale)) return "";
  return "the measured frequencies are " + FormatNumber(ratio, 2) +
         " times those of the model before: radians per second in place of "
         "cycles, a model whose masses and stiffnesses are in other units than "
         "its time, or another structure";
}

// Empty: frequencies are met, and not much worse than by the model before.
std::string WhyFrequenciesAreWorse(const IdentificationSummary& summary) {
  double before = 0.0;
  double after = 0.0;
  for (const ModeScore& mode : summary.modes) {
    if (!mode.InUse()) continue;
    const auto error = [&mode](const ModeMatch& match) {
      return std::abs(match.frequency / mode.frequency - 1.0);
    };
    before = std::max(before, error(mode.initial));
    after = std::max(after, error(mode.updated));
  }
  if (after > kMostFrequencyError) {
    return "measured frequencies are met within no less than " +
           FormatNumber(100.0 * after, 2) +
           " %: sensors in another order, a sensor's sign, place or direction, "
           "or groups that cannot make the model like the structure";
  }
  if (after <= std::max(kFrequencyMet, kMostFrequencyGrowth * before)) {
    return "";
  }
  return "measured frequencies are met within " +
         FormatNumber(100.0 * after, 2) + " %, by the model before within " +
         FormatNumber(100.0 * before, 2) +
         " %: shapes and frequencies contradict each other; a sensor's sign, "
         "place or direction, or standard deviations that are too small";
}

// Of each group that ambient records see: the largest part of what one of them
// would say of it that unknown loads leave.
std::map<std::string, double> InformationLeft(
    const IdentificationSummary& summary) {
  std::map<std::string, double> left;
  for (const AmbientScore& score : summary.ambient) {
    for (size_t g = 0; g < score.groups.size(); ++g) {
      double& most = left[score.groups[g]];
      most =
          std::max(most, score.information_left[static_cast<Eigen::Index>(g)]);
    }
  }
  return left;
}

// Empty where as many groups are told, one at least, as loads hide: a
// combination that no group follows from may be a mode that a fit has put where
// the loads have a peak.
std::string WhyGroupsAreNotTold(const IdentificationSummary& summary) {
  const std::map<std::string, double> left = InformationLeft(summary);
  // Without a covariance others say why.
  if (left.empty() || summary.covariance.size() == 0) return "";
  size_t told = 0;
  std::vector<std::string> hidden, others;
  for (const ParameterEstimate& estimate : summary.parameters) {
    const auto group = left.find(estimate.name);
    if (group == left.end()) continue;
    const double half_width = (estimate.upper95 - estimate.value) /
                              std::max(1.0, std::abs(estimate.value));
    const std::string name = "'" + estimate.name + "'";
    if (group->second < kLeastLeftOfGroup) {
      hidden.push_back(name);
    } else if (half_width <= kWidestInterval) {
      ++told;
    } else {
      // Known loads would not make it known.
      others.push_back(name);
    }
  }
  if (told > 0 && told >= hidden.size()) return "";
  if (told == 0) hidden.insert(hidden.end(), others.begin(), others.end());
  if (hidden.empty()) return "";
  return (told == 0 ? "none of " + Join(hidden, ", ") + " can be told"
                    : Join(hidden, ", ") + " cannot be told") +
         ": the unmeasured loads explain the ambient records as well as they "
         "do; fewer knots or loads, more sensors, or a band that modes of the "
         "structure are in";
}

// Of a fit to ambient records alone: empty where one of them tells something of
// the structure that the loads could not have done as well.
std::string WhyLoadsExplainAll(const IdentificationSummary& summary) {
  if (summary.ambient.empty() || HasTrainRecord(summary) ||
      !summary.modes.empty()) {
    return "";
  }
  std::ostringstream reason;
  for (const AmbientScore& score : summary.ambient) {
    if (score.most_information_left >= kLeastInformationLeft) {
      return WhyGroupsAreNotTold(summary);
    }
    if (!reason.str().empty()) continue;
    reason << "the unmeasured loads of ambient record '" << score.name
           << "' explain all that it shows: with them unknown at most "
           << FormatNumber(100.0 * score.most_information_left, 2)
           << " % of what it says of the groups is left, so that none of them "
              "can be told; fewer knots or loads, or more sensors";
  }
  return reason.str();
}

// As FreeRunError.
double TrainingError(const IdentificationSummary& summary) {
  double sum = 0.0;
  int count = 0;
  for (const RecordScore& score : summary.records) {
    if (score.role != IdentificationRecord::Role::kTrain) continue;
    sum += score.nrmse * score.nrmse;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

// RMS over the training records.
double StructuredTrainingError(const IdentificationSummary& summary) {
  double sum = 0.0;
  int count = 0;
  for (const RecordScore& score : summary.records) {
    if (score.role != IdentificationRecord::Role::kTrain) continue;
    sum += std::pow(StructuredError(score), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

// Of a network that learns a force: it can be any force, so that what it leaves
// over is a force that it was not given the inputs for, or did not find.
std::string WhyNotLearned(const IdentificationSummary& summary) {
  if (!summary.learns_force) return "";
  const double left = StructuredTrainingError(summary);
  if (left <= kMostLeftByNetwork) return "";
  std::ostringstream reason;
  reason << "the network leaves " << FormatNumber(100.0 * left, 2)
         << " % of the training records, and that is no noise: its force is "
            "not the one that is missing; another 'seed' of the network, more "
            "hidden units, or inputs that it lacks";
  return reason.str();
}

// Empty: hold-out records are predicted about as well as training records, or
// at least not by half wrong, and not wrong as a whole.
std::string WhyNotCarriedOver(const IdentificationSummary& summary) {
  if (!HasTrainRecord(summary)) return "";
  const double training = TrainingError(summary);
  for (const RecordScore& score : summary.records) {
    if (score.role != IdentificationRecord::Role::kHoldout ||
        (score.nrmse <=
             std::max(kMostHoldoutError, kMostHoldoutGrowth * training) &&
         StructuredError(score) <= kMostLeftOfHoldout)) {
      continue;
    }
    std::ostringstream reason;
    reason << "what was found does not carry over: hold-out record '"
           << score.name << "' is predicted with an error of "
           << FormatNumber(100.0 * score.nrmse, 2)
           << " %, the training records with "
           << FormatNumber(100.0 * training, 2) << " %";
    return reason.str();
  }
  return "";
}

// Empty: it is.
std::string WhyNotUsable(const GapTuning& tuning,
                         const IdentificationSummary& summary) {
  std::string not_predicted = WhyNotPredicted(summary);
  if (!not_predicted.empty()) return not_predicted;
  if (TrainingError(summary) > 1.001 * summary.linear_error) {
    return "the training records are predicted worse than by the linear terms "
           "alone";
  }
  for (const std::string& objection :
       {WhyNotLearned(summary), WhyNotCarriedOver(summary),
        WhyFrequenciesAreOfAnotherUnit(summary), WhyModesAreLost(summary),
        WhyFrequenciesAreWorse(summary)}) {
    if (!objection.empty()) return objection;
  }
  std::string explained = WhyLoadsExplainAll(summary);
  if (!explained.empty()) return explained;
  std::ostringstream reason;
  for (const AmbientScore& score : summary.ambient) {
    if (score.coherence_probability < kLeastAmbientProbability) {
      reason << "what the response to the measured loads of record '"
             << score.name << "' leaves still goes with it (probability "
             << score.coherence_probability
             << " that it does by chance): a load or a sensor of the wrong "
                "size, sign, time or place, loads from before the record, or "
                "modes that the model lacks";
      return reason.str();
    }
    if (score.probability >= kLeastAmbientProbability) continue;
    reason << "the model does not describe the spectra of ambient record '"
           << score.name << "' (probability " << score.probability
           << " of such a difference by chance, most between "
           << score.worst_from << " and " << score.worst_to
           << " cycles per unit of time): modes that it lacks, loads "
              "elsewhere, or a spectrum finer than its knots";
    return reason.str();
  }
  if (!summary.modes.empty() && !HasTrainRecord(summary) &&
      summary.final_modal_cost >= summary.initial_modal_cost) {
    reason << "the measured modes are not met better (cost "
           << summary.final_modal_cost << ") than by the model before ("
           << summary.initial_modal_cost << ")";
  } else if (summary.largest_gap > tuning.closed) {
    reason << "gaps between segments stayed open (" << summary.largest_gap
           << " of the state's RMS)";
  } else if (!summary.other_solution.empty()) {
    reason << "another solution describes what was measured nearly as well: "
           << summary.other_solution
           << "; more sensors, bounds or priors have to tell which it is";
  } else if (summary.stalled) {
    reason << "the fit came to a halt short of a minimum (cosine of the "
              "gradient "
           << summary.gradient_cosine << "); try options.multistart";
  } else if (summary.termination == Termination::kNoConvergence) {
    reason << "not converged after " << summary.num_iterations
           << " iterations; raise options.max_iterations";
  } else if (summary.final_damping < -kLeastDamping &&
             !summary.negative_damping_allowed) {
    reason << "a mode has negative damping (" << 100.0 * summary.final_damping
           << " %); give the damping groups a 'lower' bound";
  } else if (!summary.followed_channel.empty()) {
    reason << "an unknown force follows channel '" << summary.followed_channel
           << "' of record '" << summary.followed_record
           << "' nearly sample by sample, so that the channel's noise cannot "
              "be estimated; give its sigma";
  }
  return reason.str();
}

}  // namespace

void JudgeUsable(const GapTuning& tuning, IdentificationSummary* summary) {
  summary->usable = false;
  // Both have said why already.
  if (summary->termination == Termination::kFailure ||
      summary->termination == Termination::kInterrupted) {
    return;
  }
  const std::string reason = WhyNotUsable(tuning, *summary);
  summary->usable = reason.empty();
  if (!reason.empty()) summary->message = reason;
}

}  // namespace pinode
