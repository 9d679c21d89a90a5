// Check of a case before it is fitted, as reported by pinode_check.

#ifndef PINODE_CASE_RESULTS_CASE_CHECK_H_
#define PINODE_CASE_RESULTS_CASE_CHECK_H_

#include <string>
#include <vector>

#include "pinode/case/results/case_questions.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

struct CaseCheck {
  // Model with the groups that follow no covariate at their initial values, and
  // the DOFs of prescribed motion held; of a finite-element model, its
  // coordinates.
  StructuralModel model;
  // Modes in model units; `no_modes` is the reason for missing ones.
  ModalProperties modes;
  std::string no_modes;

  // Per measured mode: true if a fit uses it, and the mode of the model with
  // which it is compared. Empty if no mode was measured, or if the model has no
  // modes.
  std::vector<bool> mode_in_use;
  std::vector<ModeMatch> mode_match;

  // Peaks of the records' spectra, and what can hardly be meant as it is
  // written.
  std::vector<RecordPeaks> record_peaks;
  std::vector<std::string> questions;

  // Assessment of the measurements; `not_assessed` is the reason for a missing
  // one. Both are empty without measurements.
  bool has_measurements = false;
  ProblemAssessment assessment;
  std::string not_assessed;
  // Things that the records cannot tell from the unknowns, a sentence each.
  std::vector<std::string> confusions;

  // True if no obstacle to a fit is known.
  bool ok() const { return not_assessed.empty(); }
};

// Checks a case that ReadCaseForCheck has read.
CaseCheck CheckCase(const Case& c);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_CHECK_H_
