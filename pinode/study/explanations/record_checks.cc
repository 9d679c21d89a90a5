#include "pinode/study/explanations/record_checks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/close_modes.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

using Findings = std::vector<Finding>;

bool IsTraining(const IdentificationRecord& record) {
  return record.role == IdentificationRecord::Role::kTrain;
}

// Correlation of samples that both channels have.
double Correlation(const Vector& a, const Vector& b) {
  const auto present = a.array().isFinite() && b.array().isFinite();
  const Vector x = present.select(a.array() - MeanOfPresent(a), 0.0);
  const Vector y = present.select(b.array() - MeanOfPresent(b), 0.0);
  const double size = x.norm() * y.norm();
  return size > 0.0 ? x.dot(y) / size : 0.0;
}

void CheckCopies(const IdentificationRecord& record, Findings* findings) {
  for (size_t c = 0; c < record.channels.size(); ++c) {
    const MeasuredChannel& one = record.channels[c];
    for (size_t d = 0; one.fit && d < c; ++d) {
      const MeasuredChannel& two = record.channels[d];
      if (!two.fit || one.observation.quantity != two.observation.quantity ||
          one.observation.weights.isApprox(two.observation.weights) ||
          one.values.size() != two.values.size()) {
        continue;
      }
      const double unlike = 1.0 - std::abs(Correlation(one.values, two.values));
      if (unlike > limits::kCopy) continue;
      findings->push_back(
          {"copied_channel",
           "channels '" + two.observation.name + "' and '" +
               one.observation.name + "' of record '" + record.name +
               "' hold the same values, but their places move differently",
           unlike, limits::kCopy,
           "one of them is a copy: leave it out, or name the right column"});
    }
  }
}

void CheckGivenNoise(const IdentificationRecord& record,
                     const RecordScore& score, Findings* findings) {
  double worst = 0.0;
  std::string name;
  for (size_t c = 0; c < record.channels.size(); ++c) {
    const MeasuredChannel& channel = record.channels[c];
    if (!channel.fit || !(channel.sigma > 0.0)) continue;
    const double ratio = score.channels[c].rmse / channel.sigma;
    if (ratio > worst) {
      worst = ratio;
      name = channel.observation.name;
    }
  }
  if (!(worst > limits::kGivenNoise)) return;
  // Missed motion is above the noise too, and is a finding of its own.
  const bool misses_motion =
      StructuredError(score) > limits::kLittleUnexplained;
  findings->push_back(
      {"given_noise_contradicted",
       "the residuals of channel '" + name + "' of record '" + record.name +
           "' are " + FormatNumber(worst, 3) + " times its given noise",
       worst, limits::kGivenNoise,
       "the intervals are too narrow by this factor: correct `sigma`, or leave "
       "it out to have it estimated",
       worst > limits::kGivenNoiseFar && !misses_motion ? Grade::kNotUsable
                                                        : Grade::kWithCare});
}

void CheckPriors(const IdentificationProblem& problem, const FitSummary& fit,
                 Findings* findings) {
  const ParameterLayout layout(problem);
  for (const ParameterEstimate& estimate : fit.parameters) {
    const int j = layout.FreeIndex(estimate.name);
    if (j < 0) continue;
    const Parameter& parameter = layout.free_parameter(j);
    if (!parameter.HasPrior() || !(parameter.prior_sigma > 0.0)) continue;
    const double away =
        std::abs(estimate.value - parameter.prior_mean) / parameter.prior_sigma;
    if (!(away > limits::kPriorContradicted)) continue;
    findings->push_back(
        {"prior_contradicted",
         "'" + estimate.name + "' is " + FormatNumber(away, 2) +
             " standard deviations of its prior away from the prior",
         away, limits::kPriorContradicted,
         "widen the prior if it was a guess, or look for what the model lacks",
         Grade::kWithCare});
  }
}

void CheckSizes(const IdentificationProblem& problem, const FitSummary& fit,
                Findings* findings) {
  for (const GroupTerm& term : problem.dynamics->groups()) {
    if (!term.alpha.free || term.follows != GroupTerm::Follows::kNothing ||
        term.group.target == MatrixGroup::Target::kDamping) {
      continue;
    }
    for (const ParameterEstimate& estimate : fit.parameters) {
      if (estimate.name != term.alpha.name) continue;
      const double size = term.present + estimate.value;
      if (!(size > limits::kGroupSize)) continue;
      findings->push_back({"group_out_of_size",
                           "'" + estimate.name + "' has become " +
                               FormatNumber(size, 3) +
                               " times its value in the initial model",
                           size, limits::kGroupSize,
                           "check units and sensors; correct the model if it "
                           "is really so far off",
                           size > limits::kGroupSizeFar ? Grade::kNotUsable
                                                        : Grade::kWithCare});
    }
  }
}

// A mode that has become strongly damped stands for something else, such as a
// resonance that the model does not have.
void CheckModeDampings(const StructuralModel& before,
                       const StructuralModel& after, double highest_hz,
                       Findings* findings) {
  ModalProperties initial, updated;
  std::string unused;
  if (!ComputeModes(before.mass, before.damping, before.stiffness, &initial,
                    &unused) ||
      !ComputeModes(after.mass, after.damping, after.stiffness, &updated,
                    &unused)) {
    return;
  }
  for (Eigen::Index i = 0; i < updated.damping_ratio.size(); ++i) {
    const double ratio = updated.damping_ratio[i];
    if (!(updated.frequency_hz[i] < highest_hz) ||
        !(ratio > limits::kModeDamping) ||
        !(initial.damping_ratio[i] < 0.5 * ratio)) {
      continue;
    }
    findings->push_back(
        {"mode_damping",
         "the updated model has a mode at " +
             FormatNumber(updated.frequency_hz[i], 4) + " Hz with " +
             FormatNumber(100.0 * ratio, 3) +
             " % of critical damping, the initial model has " +
             FormatNumber(100.0 * initial.damping_ratio[i], 3) + " %",
         ratio, limits::kModeDamping,
         "only a structure with dampers has so much: find what the model "
         "lacks",
         ratio > limits::kModeDampingFar ? Grade::kNotUsable
                                         : Grade::kWithCare});
    return;
  }
}

// Free dampers may become negative where something else is missing.
void CheckDampers(const StructuralModel& before, const StructuralModel& after,
                  Findings* findings) {
  const auto least = [](const Matrix& damping) {
    const Eigen::SelfAdjointEigenSolver<Matrix> values(damping,
                                                       Eigen::EigenvaluesOnly);
    const double size = values.eigenvalues().cwiseAbs().maxCoeff();
    return size > 0.0 ? values.eigenvalues().minCoeff() / size : 0.0;
  };
  const double now = least(after.damping);
  if (!(now < -limits::kNegativeDamper) ||
      least(before.damping) < -limits::kNegativeDamper) {
    return;
  }
  findings->push_back(
      {"negative_damper",
       "the updated damping matrix feeds a motion: its smallest eigenvalue "
       "is " +
           FormatNumber(100.0 * now, 2) + " % of its largest",
       -now, limits::kNegativeDamper,
       "give damping groups a `lower` bound, or look for what the model lacks",
       Grade::kWithCare});
}

void CheckDamping(const IdentificationProblem& problem,
                  const IdentifiedModel& model, Findings* findings) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  // Modes of larger models are not worth their time here.
  constexpr int kMostDofs = 200;
  if (dynamics.model().num_dofs() > kMostDofs || !dynamics.networks().empty() ||
      HasMemoryNetwork(dynamics)) {
    return;
  }
  double highest_hz = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (!IsTraining(record)) continue;
    highest_hz = std::max(highest_hz, 0.4 / record.sampling_step());
  }
  const StructuralModel before = dynamics.CorrectedModel(dynamics.Parameters());
  const StructuralModel after =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  CheckModeDampings(before, after, highest_hz, findings);
  CheckDampers(before, after, findings);
}

// Returns the largest MAC of each measured shape with any mode of the model.
std::vector<double> LargestMacs(const ModalData& data,
                                const UndampedModes& modes) {
  std::vector<double> best(data.modes.size(), 0.0);
  for (size_t i = 0; i < best.size(); ++i) {
    const MeasuredMode& mode = data.modes[i];
    if (!mode.HasShape()) continue;
    for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
      best[i] = std::max(best[i], Mac(mode.shape, modes.shapes(mode.dofs, j)));
    }
  }
  // Close modes may point in any direction of the span of as many modes of the
  // model: those that are most like their own span.
  for (const std::vector<int>& set : CloseModes(data)) {
    const Matrix span = UnitShapes(data, set);
    const std::vector<int>& dofs =
        data.modes[static_cast<size_t>(set.front())].dofs;
    std::vector<std::pair<double, Eigen::Index>> alike;
    for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
      alike.emplace_back(MacWithSpan(span, modes.shapes(dofs, j)), j);
    }
    if (alike.size() < set.size()) continue;
    std::sort(alike.rbegin(), alike.rend());
    Matrix partners(static_cast<Eigen::Index>(dofs.size()),
                    static_cast<Eigen::Index>(set.size()));
    for (size_t k = 0; k < set.size(); ++k) {
      partners.col(static_cast<Eigen::Index>(k)) =
          modes.shapes(dofs, alike[k].second).normalized();
    }
    for (const int i : set) {
      double& own = best[static_cast<size_t>(i)];
      own = std::max(
          own, MacWithSpan(partners, data.modes[static_cast<size_t>(i)].shape));
    }
  }
  return best;
}

int NumUsed(const FitSummary& fit) {
  return static_cast<int>(
      std::count_if(fit.modes.begin(), fit.modes.end(),
                    [](const ModeScore& mode) { return mode.InUse(); }));
}

// True if the fit left a mode out although the model has modes left for it.
bool IsLeftOut(const FitSummary& fit, size_t i) {
  return i < fit.modes.size() && !fit.modes[i].InUse() &&
         NumUsed(fit) < fit.num_model_modes;
}

// MAC that a shape reaches with the right mode in spite of its known noise. The
// noise alone costs about (n - 1) sigma^2 / |shape|^2.
double LeastMac(const MeasuredMode& mode) {
  constexpr double kTimesMean = 3.0;
  double variance = mode.shape_sigma * mode.shape_sigma;
  if (mode.shape_covariance.size() > 0) {
    variance = mode.shape_covariance.diagonal().mean();
  }
  const double others = static_cast<double>(mode.shape.size() - 1);
  return limits::kShapeMet -
         kTimesMean * others * variance / mode.shape.squaredNorm();
}

// Measured modes that share a finding, and the one with the smallest MAC.
struct OddShapes {
  std::vector<std::string> names;
  double least = 1.0;
  double limit = kLeastPairProfit;

  void Add(const std::string& name, double mac, double limit_of_mode) {
    names.push_back(name);
    if (mac > least) return;
    least = mac;
    limit = limit_of_mode;
  }
  bool AreSeveral() const { return names.size() > 1; }
  std::string Text() const {
    return (AreSeveral() ? "measured modes '" : "measured mode '") +
           Join(names, "', '") + "'";
  }
};

std::string NameOf(const std::string& name, size_t i) {
  return name.empty() ? std::to_string(i + 1) : name;
}

// Measured shapes that the fitted model does not have. Below kLeastPairProfit
// a fit that used one would have moved parameters to meet noise.
void CheckShapes(const IdentificationProblem& problem, const FitSummary& fit,
                 const IdentifiedModel& model, Findings* findings) {
  const StructuralDynamics dynamics =
      AveragedDynamics(problem.modal, *problem.dynamics);
  const StructuralModel after =
      dynamics.CorrectedModel(model.parameters.head(dynamics.num_parameters()));
  UndampedModes modes;
  std::string unused;
  if (problem.modal.empty() ||
      !ComputeUndampedModes(after.mass, after.stiffness, &modes, &unused)) {
    return;
  }
  const std::vector<double> best = LargestMacs(problem.modal, modes);
  OddShapes foreign, unlike;
  for (size_t i = 0; i < best.size(); ++i) {
    const MeasuredMode& mode = problem.modal.modes[i];
    // CheckUnusedModes names modes that were left out.
    if (!mode.HasShape() || IsLeftOut(fit, i)) continue;
    if (best[i] < kLeastPairProfit) {
      foreign.Add(NameOf(mode.name, i), best[i], kLeastPairProfit);
    } else if (best[i] < LeastMac(mode)) {
      unlike.Add(NameOf(mode.name, i), best[i], LeastMac(mode));
    }
  }
  if (!foreign.names.empty()) {
    findings->push_back(
        {"shape_like_no_mode",
         (foreign.AreSeveral() ? "the shapes of " : "the shape of ") +
             foreign.Text() + (foreign.AreSeveral() ? " are" : " is") +
             " like no mode of the updated model (largest MAC " +
             FormatNumber(foreign.least, 2) +
             "): " + (foreign.AreSeveral() ? "they" : "it") + " may be noise",
         foreign.least, foreign.limit,
         foreign.AreSeveral()
             ? "leave the modes out, or check the places and signs of their "
               "sensors"
             : "leave the mode out, or check the places and signs of its "
               "sensors",
         Grade::kWithCare});
  }
  if (!unlike.names.empty()) {
    findings->push_back(
        {"shape_not_met",
         std::string("no mode of the updated model has the shape of ") +
             (unlike.AreSeveral() ? "any of the " : "") + unlike.Text() + " (" +
             (unlike.AreSeveral() ? "smallest" : "largest") + " MAC " +
             FormatNumber(unlike.least, 2) + ")",
         unlike.least, unlike.limit,
         std::string("check the signs and places of ") +
             (unlike.AreSeveral() ? "their" : "its") +
             " sensors, or free what the model lacks",
         Grade::kWithCare});
  }
}

// Modes that a fit had to leave out although the model has modes for them.
void CheckUnusedModes(const FitSummary& fit, Findings* findings) {
  OddShapes left_out;
  for (size_t i = 0; i < fit.modes.size(); ++i) {
    if (IsLeftOut(fit, i)) {
      left_out.Add(NameOf(fit.modes[i].name, i), 1.0, 1.0);
    }
  }
  if (left_out.names.empty()) return;
  const bool several = left_out.AreSeveral();
  findings->push_back(
      {"mode_not_used",
       "the fit does not use " + left_out.Text() +
           ": each mode of the initial model is unlike " +
           (several ? "them" : "it") +
           ", or is the partner of another measured mode",
       static_cast<double>(NumUsed(fit)), static_cast<double>(fit.modes.size()),
       several ? "check the sign and place of each entry of their shapes, and "
                 "their frequencies; or leave the modes out"
               : "check the sign and place of each entry of its shape, and its "
                 "frequency; or leave the mode out",
       Grade::kWithCare});
}

}  // namespace

std::vector<Finding> CheckAgainstProblem(const IdentificationProblem& problem,
                                         const FitSummary& fit,
                                         const IdentifiedModel& model) {
  Findings findings;
  for (size_t r = 0; r < fit.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (!IsTraining(record)) continue;
    CheckCopies(record, &findings);
    CheckGivenNoise(record, fit.records[r], &findings);
  }
  CheckPriors(problem, fit, &findings);
  CheckSizes(problem, fit, &findings);
  CheckDamping(problem, model, &findings);
  CheckShapes(problem, fit, model, &findings);
  CheckUnusedModes(fit, &findings);
  return findings;
}

}  // namespace pinode
