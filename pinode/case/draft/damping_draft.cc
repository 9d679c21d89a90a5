#include "pinode/case/draft/damping_draft.h"

#include <algorithm>
#include <string>
#include <vector>

#include "pinode/case/draft/case_draft_text.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/estimate/certainty/assessment.h"

namespace pinode {
namespace {

// Modes with a ratio of their own. Records seldom show more one by one.
constexpr int kOwnRatios = 5;
// Largest expected standard deviation of a change, as a share of the ratio.
constexpr double kLargestSigma = 0.5;

}  // namespace

void DraftDamping(CaseDraft* draft) {
  // The reduction of a deck keeps more modes than these.
  const int num_modes =
      draft->deck == nullptr ? draft->num_storeys() : kOwnRatios + 1;
  draft->damped_modes.clear();
  for (int mode = 1; mode <= std::min(num_modes, kOwnRatios); ++mode) {
    draft->damped_modes.push_back(mode);
  }
  draft->damped_from = num_modes > kOwnRatios ? kOwnRatios + 1 : 0;
  Case c;
  ProblemAssessment assessment;
  std::string unused;
  if (!ReadCaseDraft(CaseDraftText(*draft, ""), draft->path, &c, &unused)) {
    draft->damped_modes.clear();
    draft->damped_from = 0;
    return;
  }
  if (!AssessProblem(c.problem, c.options, &assessment, &unused)) return;
  const auto is_hidden = [&](int mode) {
    for (const ExpectedDeviation& expected : assessment.expected) {
      if (expected.name != DraftedRatioName(*draft, mode)) continue;
      return !(expected.sigma <= kLargestSigma);
    }
    return false;
  };
  if (draft->damped_from > 0 && is_hidden(draft->damped_from)) {
    draft->damped_from = 0;
    draft->some_damping_is_hidden = true;
  }
  std::vector<int> seen;
  for (const int mode : draft->damped_modes) {
    if (!is_hidden(mode)) seen.push_back(mode);
  }
  draft->some_damping_is_hidden |= seen.size() < draft->damped_modes.size();
  draft->damped_modes = std::move(seen);
}

}  // namespace pinode
