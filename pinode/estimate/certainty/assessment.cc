#include "pinode/estimate/certainty/assessment.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/input_noise_fit.h"
#include "pinode/estimate/certainty/null_space.h"
#include "pinode/estimate/objective/evidence.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/estimate/start/signs.h"
#include "pinode/estimate/start/stage_schedule.h"
#include "pinode/estimate/start/time_scale.h"
#include "pinode/problem/assumed_noise.h"

namespace pinode {

namespace {

// Counts the unknowns, and the residuals that determine them.
void Count(const IdentificationProblem& problem, const ParameterLayout& layout,
           const Objective& objective, ProblemAssessment* assessment) {
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (const MeasuredChannel& channel : record.channels) {
      if (channel.fit) {
        assessment->num_residuals += CountPresent(channel.values);
      }
    }
    if (record.start == IdentificationRecord::Start::kFree) {
      assessment->num_starts +=
          problem.dynamics->num_states() -
          2 * static_cast<int>(problem.dynamics->prescribed().size());
    }
  }
  assessment->num_free = layout.num_free();
  if (objective.modes() != nullptr) {
    assessment->num_residuals += objective.modes()->num_residuals();
  }
  for (const auto& frfs : objective.frfs()) {
    assessment->num_residuals += frfs->num_residuals();
  }
}

// True if the model stays at rest in all records: they begin at rest, without
// any load. Such records say nothing.
bool StaysAtRest(const IdentificationProblem& problem) {
  if (problem.num_train_records() == 0 || problem.HasSpectra() ||
      !problem.modal.modes.empty() ||
      !problem.dynamics->unknown_forces().empty() ||
      !problem.dynamics->networks().empty()) {
    return false;
  }
  return std::all_of(
      problem.records.begin(), problem.records.end(),
      [](const IdentificationRecord& record) {
        return record.role != IdentificationRecord::Role::kTrain ||
               ((record.start == IdentificationRecord::Start::kRest ||
                 record.known_start.isZero(0.0)) &&
                record.start != IdentificationRecord::Start::kFree &&
                record.excitation->samples().isZero(0.0));
      });
}

// No unknown has an interval.
void SeeNothing(const ParameterLayout& layout, ProblemAssessment* assessment) {
  for (const int index : layout.free()) {
    if (!layout.IsNamed(index)) continue;
    const Parameter& parameter = layout.parameter(index);
    assessment->expected.push_back(
        {parameter.name, parameter.unit, parameter.value, kInfinity});
    assessment->undetermined.push_back(parameter.name);
  }
  assessment->remarks.push_back(
      "No training record has a load and all begin at rest, so nothing moves. "
      "Give a load or an initial state.");
}

}  // namespace

Vector SmoothnessPrecisions(const ParameterLayout& layout,
                            const EvidenceTuning& tuning) {
  Vector precisions = FirstDecays(layout, tuning, nullptr);
  for (int g = 0; g < layout.num_decay_groups(); ++g) {
    if (layout.decay_groups()[static_cast<size_t>(g)].network >= 0) {
      precisions[g] = 0.0;
    }
  }
  return precisions;
}

std::vector<ExpectedDeviation> ExpectedDeviations(const ParameterLayout& layout,
                                                  const Matrix& covariance,
                                                  const Matrix& null_space) {
  std::vector<ExpectedDeviation> expected;
  for (int j = 0; j < layout.num_free(); ++j) {
    const int index = layout.free()[static_cast<size_t>(j)];
    if (!layout.IsNamed(index)) continue;
    const bool determined =
        null_space.cols() == 0 || null_space.row(j).cwiseAbs().maxCoeff() < 0.1;
    const Parameter& parameter = layout.parameter(index);
    expected.push_back({parameter.name, parameter.unit, parameter.value,
                        determined ? std::sqrt(std::max(0.0, covariance(j, j)))
                                   : std::numeric_limits<double>::infinity()});
  }
  return expected;
}

namespace {

// Gives FRFs without one the noise that channels without one have.
IdentificationProblem WithFrfNoise(IdentificationProblem problem,
                                   double share) {
  for (FrfRecord& record : problem.frfs) {
    if (record.sigma.size() > 0) continue;
    record.sigma.resize(record.num_pairs());
    for (Eigen::Index p = 0; p < record.num_pairs(); ++p) {
      double squares = 0.0;
      double count = 0.0;
      for (Eigen::Index k = 0; k < record.num_lines(); ++k) {
        const double square = std::norm(record.values(k, p));
        if (!std::isfinite(square)) continue;
        squares += square /
                   (record.variances.size() > 0 ? record.variances(k, p) : 1.0);
        count += 2.0;
      }
      record.sigma[p] = share * std::sqrt(squares / count);
    }
  }
  return problem;
}

}  // namespace

bool AssessProblem(const IdentificationProblem& problem,
                   const IdentificationOptions& options,
                   ProblemAssessment* assessment, std::string* error) {
  const auto estimates_noise = [](const FrfRecord& record) {
    return record.sigma.size() == 0;
  };
  if (std::any_of(problem.frfs.begin(), problem.frfs.end(), estimates_noise) &&
      problem.IsValid(error)) {
    return AssessProblem(
        WithFrfNoise(problem, options.tuning.noise.first_share), options,
        assessment, error);
  }
  constexpr double kFirmness = 1e4;  // of gaps, against the data's own hold
  *assessment = ProblemAssessment();
  if (!problem.IsValid(error) || !options.IsValid(error) ||
      !IsTimeScalePossible(problem, error)) {
    return false;
  }
  const ParameterLayout layout(problem);
  MultipleShooting::Options shooting_options;
  shooting_options.derivatives = options.derivatives;
  shooting_options.num_threads = options.num_threads;
  Objective objective(problem, layout, shooting_options);
  MultipleShooting& shooting = objective.shooting();

  const std::vector<Vector> sigmas =
      AssumedNoise(problem, options.tuning.noise);
  Count(problem, layout, objective, assessment);
  if (StaysAtRest(problem)) {
    SeeNothing(layout, assessment);
    return true;
  }
  shooting.SetSigmas(sigmas);
  const Vector precisions =
      SmoothnessPrecisions(layout, options.tuning.evidence);
  objective.priors().SetDecays(precisions);

  const auto fail = [&objective, error]() {
    const bool modes =
        objective.modes() != nullptr && !objective.modes()->Failure().empty();
    *error = modes ? objective.modes()->Failure()
                   : "no finite trajectory at the initial values";
    return false;
  };
  InputNoiseFit point;
  point.free = layout.Free(layout.InitialValues());
  point.sigmas = sigmas;
  const Eigen::Index segment_samples =
      FirstSegmentSamples(problem, options.tuning.stages);
  TrajectoryOutlines trajectories;
  const auto find_trajectories = [&](Eigen::Index samples) {
    return InitialTrajectories(problem, samples, point.free,
                               options.tuning.stages, &shooting, &trajectories);
  };
  // Linear dynamics need no segments to stay near the record, and are solved in
  // one piece at once.
  if (!(problem.dynamics->IsLinear() && find_trajectories(0)) &&
      !find_trajectories(segment_samples)) {
    return fail();
  }
  const auto plain = [&]() {
    return EstimateCovariance(
        problem, layout, IdentificationOptions::Covariance::kPlain, point.free,
        sigmas, &objective, &point.covariance);
  };
  // Information in a trajectory in one piece. If the record does not run so
  // before the fit, segments are held together nearly as firmly.
  if (!SetSegmentsAlong(0, trajectories, &shooting)) return fail();
  if (!plain()) {
    if (!SetSegmentsAlong(segment_samples, trajectories, &shooting))
      return fail();
    shooting.SetGapPenalty(kFirmness *
                           std::max(1.0, shooting.state().data_curvature()));
    if (!plain()) {
      return fail();
    }
  } else if (CanFitWithInputNoise(problem, options.loss) &&
             (!RunTrajectories(shooting, trajectories, &point.trajectories) ||
              !InputNoiseCovariance(problem, layout, shooting_options,
                                    precisions, &point))) {
    return fail();
  }
  CovarianceEstimate& covariance = point.covariance;
  covariance.null_space =
      WithUnseenGroups(problem, layout, point.free, covariance.covariance,
                       covariance.null_space);
  const bool sizes_known = !shooting.train_records().empty() ||
                           problem.HasSpectra() || problem.modal.HasSigmas();
  if (sizes_known) {
    assessment->expected = ExpectedDeviations(layout, covariance.covariance,
                                              covariance.null_space);
  }
  Vector first_values = layout.InitialValues();
  FindSigns(problem, &first_values);
  assessment->remarks = TimeScaleRemarks(problem);
  for (std::string& remark : SignRemarks(problem, first_values)) {
    assessment->remarks.push_back(std::move(remark));
  }
  assessment->undetermined = DescribeNullSpace(layout, covariance.null_space);
  return true;
}

}  // namespace pinode
