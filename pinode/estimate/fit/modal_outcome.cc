#include "pinode/estimate/fit/modal_outcome.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Probability above which the remaining error of the modes may be chance.
constexpr double kLeastModalProbability = 0.01;

// Compares the measured modes with those of the initial and the fitted model.
// `modes`: the modal cost of the fit.
void ScoreModes(const ModalData& measured, const ModalCost& modes,
                const Vector& prior_parameters, const Vector& parameters,
                FitSummary* summary) {
  const StructuralDynamics& dynamics = modes.dynamics();
  const std::vector<bool>& in_use = modes.in_use();
  std::vector<ModeMatch> initial, updated;
  std::string error;
  if (!MatchModes(modes.data(),
                  dynamics.CorrectedModel(
                      prior_parameters.head(dynamics.num_parameters())),
                  &initial, &error) ||
      !MatchModes(
          modes.data(),
          dynamics.CorrectedModel(parameters.head(dynamics.num_parameters())),
          &updated, &error)) {
    return;
  }
  summary->num_model_modes = dynamics.num_dofs();
  size_t next = 0;
  for (size_t i = 0; i < measured.modes.size(); ++i) {
    const MeasuredMode& mode = measured.modes[i];
    ModeScore score{mode.name, mode.frequency, {}, {}};
    if (in_use[i]) {
      score.initial = initial[next];
      score.updated = updated[next++];
    }
    summary->modes.push_back(std::move(score));
  }
}

// Returns a text on unused modes; empty: all are used.
std::string ModesLeftOut(const std::vector<ModeScore>& modes) {
  std::vector<std::string> names;
  for (const ModeScore& mode : modes) {
    if (!mode.InUse()) names.push_back("'" + mode.name + "'");
  }
  if (names.empty()) return "";
  return "Measured modes: the fit does not use " + Join(names, ", ") +
         ". The initial model has no mode of this shape and frequency that is "
         "not paired with another measured mode.";
}

// Returns half the sum of squares of the modal residuals; infinite if they
// cannot be evaluated.
double ModalCostAt(const Vector& free, ModalCost* modes) {
  double cost = 0.0;
  return modes->Evaluate(free, &cost) ? cost : kInfinity;
}

// Returns the number of modal residuals beyond those that a fit to modes alone
// uses up.
double ResidualsLeft(const ModalCost& modal, double effective_parameters,
                     const CovarianceEstimate& covariance) {
  const double determined =
      effective_parameters - static_cast<double>(covariance.null_space.cols());
  return modal.num_residuals() - modal.num_eliminated() - determined;
}

// Scales the covariance to the residuals. As for channels, the remaining error
// gives the size of the modes' errors, as a multiple `left` of their given
// variances. Priors keep their variances. H^-1 (s H_modes + H_priors) H^-1,
// with H the sum of the two.
bool ScaleToResiduals(const Vector& free, double left, ModalCost* modes,
                      CovarianceEstimate* covariance) {
  CondensedSystem system;
  if (!modes->Linearize(free, &system)) return false;
  const double scale = 2.0 * system.cost / left;
  const Matrix inverse = covariance->covariance;
  covariance->covariance += (scale - 1.0) * inverse * system.hessian * inverse;
  covariance->quantile = StudentQuantile(left);
  return covariance->covariance.allFinite();
}

// Judges a fit to modes alone. Without residual degrees of freedom there is no
// covariance unless standard deviations are given.
void JudgeModes(const Vector& free, ModalCost* modes, bool* known,
                CovarianceEstimate* covariance, FitSummary* summary) {
  const double cost = summary->final_modal_cost;
  const double left =
      ResidualsLeft(*modes, summary->effective_parameters, *covariance);
  const std::vector<MeasuredMode>& measured = modes->data().modes;
  if (modes->data().form == ModalForm::kMac &&
      std::any_of(measured.begin(), measured.end(),
                  [](const MeasuredMode& mode) { return mode.HasShape(); })) {
    // One minus a MAC is the square of a shape's error and has no sign.
    // Intervals from the curvature of a sum of such squared held the truth in 0
    // of 48.
    *known = false;
    summary->remarks.push_back(
        "A comparison of modes by their MAC gives no intervals. For intervals "
        "set form = 'eigenvector_difference' and give standard deviations.");
    return;
  }
  if (!modes->data().HasSigmas()) {
    *known = left >= 0.5 && ScaleToResiduals(free, left, modes, covariance);
    return;
  }
  // A weight does not give the size of a residual.
  if (!modes->data().HasSigmasOfAll()) return;
  if (left < 0.5 ||
      ChiSquareProbability(2.0 * cost, left) >= kLeastModalProbability) {
    return;
  }
  *known = ScaleToResiduals(free, left, modes, covariance);
  summary->remarks.push_back(
      "The errors of the measured modes are larger than their standard "
      "deviations say (chi^2 " +
      FormatNumber(2.0 * cost / left, 3) +
      " per degree of freedom). The model lacks something, or the standard "
      "deviations are too small. Those of the parameters follow the errors and "
      "are " +
      FormatNumber(std::sqrt(2.0 * cost / left), 3) + " times as large.");
}

// Returns the least damping ratio of the modes; NaN if no mode has one.
double LeastDampingOf(const StructuralDynamics& dynamics,
                      const Vector& parameters) {
  const StructuralModel model =
      dynamics.HeldModel(parameters.head(dynamics.num_parameters()));
  if (model.num_dofs() == 0) return kNaN;
  ModalProperties modes;
  std::string unused;
  if (!ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                    &unused)) {
    return kNaN;
  }
  double least = kInfinity;
  for (double ratio : modes.damping_ratio) {
    if (std::isfinite(ratio)) least = std::min(least, ratio);
  }
  return std::isfinite(least) ? least : kNaN;
}

// Seconds of the longest record, in the model's unit of time.
double LongestDuration(const IdentificationProblem& problem) {
  double longest = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    longest = std::max(longest, static_cast<double>(record.num_samples() - 1) *
                                    record.sampling_step());
  }
  return longest;
}

bool HasFreeGroupOf(const StructuralDynamics& dynamics,
                    MatrixGroup::Target target) {
  return std::any_of(dynamics.groups().begin(), dynamics.groups().end(),
                     [target](const GroupTerm& term) {
                       return term.group.target == target && term.alpha.free;
                     });
}

}  // namespace

void ReportModes(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const Vector& parameters,
                 ModalCost* modes, bool* known, CovarianceEstimate* covariance,
                 FitSummary* summary) {
  const Vector initial = layout.InitialValues();
  const Vector free = layout.Free(parameters);
  ScoreModes(problem.modal, *modes, initial, parameters, summary);
  summary->initial_modal_cost = ModalCostAt(layout.Free(initial), modes);
  summary->final_modal_cost = ModalCostAt(free, modes);
  const std::string left_out = ModesLeftOut(summary->modes);
  if (!left_out.empty()) summary->remarks.push_back(left_out);
  if (*known && problem.num_train_records() == 0 && !problem.HasSpectra()) {
    JudgeModes(free, modes, known, covariance, summary);
  }
}

double LeastDamping(const IdentificationProblem& problem,
                    const Vector& parameters) {
  if (problem.num_train_records() > 0 || problem.ambient.empty()) {
    return LeastDampingOf(*problem.dynamics, parameters);
  }
  double least = kInfinity;
  for (const AmbientRecord& record : problem.ambient) {
    const double found =
        LeastDampingOf(record.AveragedDynamics(*problem.dynamics), parameters);
    if (std::isfinite(found)) least = std::min(least, found);
  }
  return std::isfinite(least) ? least : kNaN;
}

bool DampingsAreBounded(const StructuralDynamics& dynamics) {
  const auto& groups = dynamics.groups();
  return std::none_of(groups.begin(), groups.end(), [](const GroupTerm& term) {
    return term.group.target == MatrixGroup::Target::kDamping &&
           term.alpha.free && !std::isfinite(term.alpha.lower);
  });
}

void ReportGrowingMotion(const IdentificationProblem& problem,
                         const Vector& parameters, FitSummary* summary) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (parameters.size() < dynamics.num_parameters()) return;
  const StructuralModel model =
      dynamics.HeldModel(parameters.head(dynamics.num_parameters()));
  if (model.num_dofs() == 0) return;
  UndampedModes modes;
  std::string unused;
  if (!ComputeUndampedModes(model.mass, model.stiffness, &modes, &unused)) {
    return;
  }
  const Eigen::VectorXcd values =
      StateEigenvalues(model.mass, model.damping, model.stiffness);
  Eigen::Index fastest = 0;
  const double growth = values.real().maxCoeff(&fastest);
  if (!(growth * LongestDuration(problem) > limits::kGrowth)) return;
  const double frequency = std::abs(values[fastest].imag()) / kTwoPi;
  const bool stiffness = frequency == 0.0 && modes.eigenvalues[0] < 0.0;
  summary->growing_motion =
      "a motion" +
      (frequency > 0.0
           ? " at " +
                 FormatNumber(
                     frequency * problem.description.HzPerModelFrequency(), 4) +
                 " Hz"
           : std::string()) +
      " has negative " + (stiffness ? "stiffness" : "damping") +
      " in the identified matrices";
  if (HasFreeGroupOf(dynamics, stiffness ? MatrixGroup::Target::kStiffness
                                         : MatrixGroup::Target::kDamping)) {
    summary->growing_motion_advice =
        "give the groups of this matrix a 'lower' bound or a 'prior_sigma'";
  }
}

}  // namespace pinode
