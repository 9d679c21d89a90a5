// What a case says before anything is fitted: what pinode_check tells.

#ifndef PINODE_CASE_RESULTS_CASE_CHECK_H_
#define PINODE_CASE_RESULTS_CASE_CHECK_H_

#include <string>
#include <vector>

#include "pinode/case/sections/case_file.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

struct CaseCheck {
  // With the groups that follow nothing at their initial values and the DOFs of
  // prescribed motion held; of a finite-element model, its coordinates.
  StructuralModel model;
  // Its modes in model units; `no_modes` says why there are none.
  ModalProperties modes;
  std::string no_modes;

  // Of each measured mode, whether a fit uses it, and if so the mode of the
  // model that it is held against. Empty where nothing was measured, or where
  // the model has no modes to compare.
  std::vector<bool> mode_in_use;
  std::vector<ModeMatch> mode_match;

  // What the measurements can tell; `not_assessed` says why that is not known.
  // Without measurements there is neither.
  bool has_measurements = false;
  ProblemAssessment assessment;
  std::string not_assessed;

  // Whether nothing stands against a fit that could be known before.
  bool ok() const { return not_assessed.empty(); }
};

// Of a case that ReadCaseForCheck has read.
CaseCheck CheckCase(const Case& c);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_CHECK_H_
