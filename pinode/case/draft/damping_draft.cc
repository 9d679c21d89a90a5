#include "pinode/case/draft/damping_draft.h"

#include <algorithm>
#include <string>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/case/draft/case_draft_text.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/estimate/certainty/assessment.h"

namespace pinode {
namespace {

// Modes with a ratio of their own. Records seldom show more one by one.
constexpr int kOwnRatios = 5;
// Largest expected standard deviation of a change, as a share of the ratio.
constexpr double kLargestSigma = 0.5;

// Reads the draft as a case and finds what its records tell. Sets *is_read if
// it can be read, and returns true if it can be assessed too.
bool Assess(const CaseDraft& draft, bool* is_read,
            ProblemAssessment* assessment) {
  Case c;
  std::string unused;
  *is_read = ReadCaseDraft(CaseDraftText(draft, ""), draft.path, &c, &unused);
  return *is_read && AssessProblem(c.problem, c.options, assessment, &unused);
}

// Returns true if the records show too little of the parameter.
bool IsHidden(const ProblemAssessment& assessment, const std::string& name) {
  for (const ExpectedDeviation& expected : assessment.expected) {
    if (expected.name == name) return !(expected.sigma <= kLargestSigma);
  }
  return false;
}

bool IsLoadMeasured(const CaseDraft& draft) {
  return std::all_of(draft.records.begin(), draft.records.end(),
                     [](const DraftRecord& record) {
                       return !record.base.empty() || !record.forces.empty();
                     });
}

}  // namespace

bool IsDampingKind(const std::string& kind, bool is_deck, std::string* error) {
  if (kind.empty() || kind == "rayleigh" || kind == "modes") return true;
  if (kind == "storeys") {
    if (!is_deck) return true;
    *error =
        "--damping is 'storeys', but a deck has no storeys. Give rayleigh "
        "or modes";
    return false;
  }
  *error =
      "--damping is " + Quote(kind) + ", expected storeys, rayleigh or modes";
  return false;
}

bool DraftStoreyDamping(bool is_asked_for, CaseDraft* draft,
                        std::string* error) {
  // Vibration under unknown loads tells too little of the damping.
  if (!is_asked_for && !IsLoadMeasured(*draft)) return true;
  draft->storeys_are_damped = true;
  ProblemAssessment assessment;
  bool is_read = false;
  const bool is_assessed = Assess(*draft, &is_read, &assessment);
  bool is_hidden = is_assessed && IsHidden(assessment, kDraftedMassDamping);
  for (int storey = 1; is_assessed && storey <= draft->num_storeys();
       ++storey) {
    is_hidden = is_hidden || IsHidden(assessment, DraftedDamperName(storey));
  }
  draft->storeys_are_damped = is_assessed && !is_hidden;
  draft->some_damping_is_hidden = is_hidden;
  if (draft->storeys_are_damped || !is_asked_for) return true;
  *error = is_hidden
               ? "the records do not show the damping of each storey. Give "
                 "--damping=rayleigh or --damping=modes"
               : "the damping of each storey could not be assessed. Give "
                 "--damping=rayleigh, and look at what pinode_check says";
  return false;
}

void DraftDamping(CaseDraft* draft) {
  // The reduction of a deck keeps more modes than these.
  const int num_modes =
      draft->deck == nullptr ? draft->num_storeys() : kOwnRatios + 1;
  draft->damped_modes.clear();
  for (int mode = 1; mode <= std::min(num_modes, kOwnRatios); ++mode) {
    draft->damped_modes.push_back(mode);
  }
  draft->damped_from = num_modes > kOwnRatios ? kOwnRatios + 1 : 0;
  ProblemAssessment assessment;
  bool is_read = false;
  const bool is_assessed = Assess(*draft, &is_read, &assessment);
  if (!is_read) {
    draft->damped_modes.clear();
    draft->damped_from = 0;
  }
  if (!is_assessed) return;
  const auto is_hidden = [&](int mode) {
    return IsHidden(assessment, DraftedRatioName(*draft, mode));
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
