#include "pinode/estimate/fit/growing_motion.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

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
