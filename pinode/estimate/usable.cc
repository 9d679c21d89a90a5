#include "pinode/estimate/usable.h"

#include <algorithm>
#include <sstream>
#include <string>

namespace pinode {
namespace {

// Empty: every record is predicted well enough.
std::string WhyNotPredicted(const IdentificationSummary& summary) {
  std::ostringstream reason;
  for (const RecordScore& score : summary.records) {
    const bool train = score.role == IdentificationRecord::Role::kTrain;
    if (!score.finite) {
      reason << "the free run of record '" << score.name << "' is not finite";
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

// Empty: it is.
std::string WhyNotUsable(const GapTuning& tuning,
                         const IdentificationSummary& summary) {
  const std::string not_predicted = WhyNotPredicted(summary);
  if (!not_predicted.empty()) return not_predicted;
  std::ostringstream reason;
  if (!summary.modes.empty() && !HasTrainRecord(summary) &&
      summary.final_modal_cost >= summary.initial_modal_cost) {
    reason << "the measured modes are not met better (cost "
           << summary.final_modal_cost << ") than by the model before ("
           << summary.initial_modal_cost << ")";
  } else if (summary.largest_gap > tuning.closed) {
    reason << "gaps between segments stayed open (" << summary.largest_gap
           << " of the state's RMS)";
  } else if (summary.termination == Termination::kNoConvergence) {
    reason << "not converged after " << summary.num_iterations
           << " iterations; raise options.max_iterations";
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
