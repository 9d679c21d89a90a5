#include "pinode/estimate/usable.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Damping ratios down to this are rounding.
constexpr double kLeastDamping = 1e-6;

// Empty: every record is predicted well enough.
std::string WhyNotPredicted(const IdentificationSummary& summary) {
  std::ostringstream reason;
  for (const RecordScore& score : summary.records) {
    const bool train = score.role == IdentificationRecord::Role::kTrain;
    if (!score.finite) {
      reason << "the free run of record '" << score.name << "' is not finite";
    } else if (score.nrmse >= 1.0) {
      reason << "record '" << score.name << "' is predicted no better (nrmse "
             << score.nrmse << ") than by no motion at all (1)";
    } else if (train ? score.nrmse >= score.prior_nrmse
                     : score.nrmse > score.prior_nrmse) {
      reason << "record '" << score.name << "' is not predicted better (nrmse "
             << score.nrmse << ") than by the model before ("
             << score.prior_nrmse << ")";
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

// Of a fit to ambient records alone: empty where one of them tells something of
// the structure that the loads could not have done as well.
std::string WhyLoadsExplainAll(const IdentificationSummary& summary) {
  if (summary.ambient.empty() || HasTrainRecord(summary) ||
      !summary.modes.empty()) {
    return "";
  }
  std::ostringstream reason;
  for (const AmbientScore& score : summary.ambient) {
    if (score.most_information_left >= kLeastInformationLeft) return "";
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

// Empty: it is.
std::string WhyNotUsable(const GapTuning& tuning,
                         const IdentificationSummary& summary) {
  const std::string not_predicted = WhyNotPredicted(summary);
  if (!not_predicted.empty()) return not_predicted;
  if (TrainingError(summary) > 1.001 * summary.linear_error) {
    return "the training records are predicted worse than by the linear terms "
           "alone";
  }
  const std::string explained = WhyLoadsExplainAll(summary);
  if (!explained.empty()) return explained;
  std::ostringstream reason;
  for (const AmbientScore& score : summary.ambient) {
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
