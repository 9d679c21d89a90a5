#include "pinode/case/results/case_check.h"

#include <cstddef>

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/study/explanations/confusions.h"

namespace pinode {
namespace {

void FindModelModes(const StructuralDynamics& dynamics, CaseCheck* check) {
  check->model = dynamics.HeldModel(dynamics.Parameters());
  const StructuralModel& model = check->model;
  if (model.num_dofs() == 0) {
    check->no_modes = "the motion of every DOF is prescribed";
    return;
  }
  std::string error;
  if (!ComputeModes(model.mass, model.damping, model.stiffness, &check->modes,
                    &error)) {
    check->no_modes = error;
  }
}

void MatchMeasuredModes(const ModalData& measured,
                        const StructuralDynamics& dynamics, CaseCheck* check) {
  if (measured.empty()) return;
  const StructuralDynamics then = AveragedDynamics(measured, dynamics);
  const std::vector<bool> in_use = ModesInUse(measured, dynamics);
  std::vector<ModeMatch> matches;
  std::string no_modes;
  if (!MatchModes(OnlyModes(measured, in_use),
                  then.CorrectedModel(then.Parameters()), &matches,
                  &no_modes)) {
    return;
  }
  check->mode_in_use = in_use;
  check->mode_match.resize(in_use.size());
  size_t next = 0;
  for (size_t i = 0; i < in_use.size(); ++i) {
    if (in_use[i]) check->mode_match[i] = matches[next++];
  }
}

}  // namespace

CaseCheck CheckCase(const Case& c) {
  CaseCheck check;
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  FindModelModes(dynamics, &check);
  MatchMeasuredModes(c.problem.modal, dynamics, &check);
  check.record_peaks = FindRecordPeaks(c);
  check.questions = FindQuestions(c, check.modes, check.record_peaks);
  check.has_measurements = !c.problem.records.empty() ||
                           !c.problem.modal.empty() || c.problem.HasSpectra();
  std::string error;
  if (check.has_measurements &&
      !AssessProblem(c.problem, c.options, &check.assessment, &error)) {
    check.not_assessed = error;
  }
  if (check.has_measurements && check.ok() &&
      check.assessment.undetermined.empty()) {
    check.confusions = ConfusionsBeforeFit(c.problem, c.options);
  }
  return check;
}

}  // namespace pinode
