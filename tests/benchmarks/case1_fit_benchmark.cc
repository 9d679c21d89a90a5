// Case 1 (data/four_dof_free) from the start of a fit to a mean squared error
// of the free run over the training records of 1e-6: Identify beside the plain
// way.
//
// Both ways start from the same weights and the same records. After every
// iteration both records are run freely from their first measured state, with
// the parameters at hand; the time for that is not counted. Reading the case is
// not counted either.
//
// The plain way is the multiple shooting problem that one would write down with
// Ceres alone: the segments that Identify begins with, their starts (at first
// the measured states) as parameter blocks, DynamicAutoDiffCostFunction, dense
// normal equations, and fixed weights. See README.md for how they were chosen.

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/estimate/start/stage_schedule.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/benchmarks/measure.h"
#include "tests/benchmarks/plain_chain.h"
#include "tests/benchmarks/plain_fit.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace benchmarks {
namespace {

constexpr double kTargetError = 1e-6;
constexpr double kRequiredRatio = 8.0;
constexpr int kPinodeRepetitions = 3;
constexpr double kPlainLimitSeconds = 600.0;

// Weights of the plain way, as shares of each channel's spread and of each
// state's RMS, and the precision of its weight decay.
struct PlainWeights {
  double sigma = 0.003;
  double gap_sigma = 0.0003;
  double decay = 0.1;
};

using Chain = PlainChain<4, false, true>;

std::vector<int> TrainRecords(const IdentificationProblem& problem) {
  std::vector<int> train;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].role == IdentificationRecord::Role::kTrain) {
      train.push_back(static_cast<int>(r));
    }
  }
  return train;
}

// The measured states of a record, num_states x num_samples.
Matrix MeasuredStates(const IdentificationRecord& record) {
  Matrix states(Chain::kStates, record.num_samples());
  CHECK_EQ(record.channels.size(), static_cast<size_t>(Chain::kStates));
  for (int c = 0; c < Chain::kStates; ++c) {
    states.row(c) = record.channels[static_cast<size_t>(c)].values.transpose();
  }
  return states;
}

// Mean over training records, samples and states.
double FreeRunError(const IdentificationProblem& problem,
                    const Vector& parameters) {
  double sum = 0.0;
  double count = 0.0;
  for (int r : TrainRecords(problem)) {
    const IdentificationRecord& record =
        problem.records[static_cast<size_t>(r)];
    const Matrix measured = MeasuredStates(record);
    RecordScore score;
    ScoreRecord(problem, r, parameters, measured.col(0), 0, &score);
    if (!score.finite) return std::numeric_limits<double>::infinity();
    sum += (score.states - measured).squaredNorm();
    count += static_cast<double>(measured.size());
  }
  return sum / count;
}

// How a fit came along.
struct FitTimes {
  bool reached = false;
  double seconds = 0.0;  // without the free runs
  int iterations = 0;
  double error = std::numeric_limits<double>::infinity();
};

// Stops the watch during free runs.
class Watch {
 public:
  explicit Watch(const IdentificationProblem& problem)
      : problem_(problem), begin_(CpuSeconds()) {}

  // True where the fit may stop.
  bool Check(const Vector& parameters, int iteration) {
    const double now = CpuSeconds();
    times_.seconds = now - begin_ - excluded_;
    times_.iterations = iteration;
    times_.error = std::min(times_.error, FreeRunError(problem_, parameters));
    times_.reached = times_.error <= kTargetError;
    excluded_ += CpuSeconds() - now;
    return times_.reached;
  }

  const FitTimes& times() const { return times_; }

 private:
  const IdentificationProblem& problem_;
  FitTimes times_;
  double begin_;
  double excluded_ = 0.0;
};

FitTimes FitWithPinode(const Case& c) {
  IdentificationOptions options = c.options;
  options.num_threads = 1;
  Watch watch(c.problem);
  options.callback = [&watch](const IdentificationProgress& progress) {
    if (watch.times().reached) return true;
    const bool reached =
        watch.Check(progress.model->parameters, progress.iteration);
    VLOG(1) << "pinode stage " << progress.stage << " iteration "
            << progress.iteration << " gap " << progress.largest_gap
            << " free-run error " << watch.times().error << " after "
            << watch.times().seconds << " s";
    return !reached;
  };
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(c.problem, options, nullptr, &summary, &model);
  return watch.times();
}

class PlainCallback final : public ceres::IterationCallback {
 public:
  PlainCallback(const ParameterLayout& layout, const Vector* free, Watch* watch)
      : layout_(layout), free_(free), watch_(watch) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    Vector parameters = layout_.InitialValues();
    layout_.SetFree(*free_, &parameters);
    const bool reached = watch_->Check(parameters, iteration.iteration);
    VLOG(1) << "plain iteration " << iteration.iteration << " cost "
            << iteration.cost << " free-run error " << watch_->times().error
            << " after " << watch_->times().seconds << " s";
    return reached || watch_->times().seconds > kPlainLimitSeconds
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const ParameterLayout& layout_;
  const Vector* free_;
  Watch* watch_;
};

FitTimes FitPlainly(const IdentificationProblem& problem,
                    const PlainWeights& weights) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const ParameterLayout layout(problem);
  CHECK_EQ(layout.num_free(), Chain::kParameters);
  const StructuralModel& model = dynamics.model();
  const NetworkArchitecture& architecture =
      dynamics.networks()[0].network->architecture();

  Watch watch(problem);
  Vector x = layout.Free(layout.InitialValues());
  const std::vector<int> train = TrainRecords(problem);
  const auto segment_samples =
      static_cast<int>(FirstSegmentSamples(problem, StageTuning()));
  std::vector<IntegrationGrid> grids;
  std::vector<Chain> chains;
  std::vector<Matrix> starts;
  // Residual blocks point into these.
  grids.reserve(train.size());
  chains.reserve(train.size());
  starts.reserve(train.size());
  EvaluationTimes times;
  ceres::Problem ceres_problem;
  for (int r : train) {
    const IdentificationRecord& record =
        problem.records[static_cast<size_t>(r)];
    grids.emplace_back(*record.excitation, record.substeps);
    chains.emplace_back(model.stiffness(3, 3), model.damping(3, 3),
                        architecture, &grids.back());
    const Matrix measured = MeasuredStates(record);
    const std::vector<int> boundaries =
        CutSegments(static_cast<int>(record.num_samples()), segment_samples);
    Matrix& segment_starts = starts.emplace_back(
        Chain::kStates, static_cast<int>(boundaries.size()) - 1);
    for (int k = 0; k < segment_starts.cols(); ++k) {
      segment_starts.col(k) = measured.col(boundaries[static_cast<size_t>(k)]);
    }
    Vector sigma(Chain::kStates);
    for (int i = 0; i < Chain::kStates; ++i) {
      sigma[i] = weights.sigma * StandardDeviationOfPresent(measured.row(i));
    }
    AddPlainSegments(chains.back(), record, boundaries, sigma,
                     weights.gap_sigma * StateScales(problem, measured),
                     &segment_starts, x.data(), &times, &ceres_problem);
  }
  ceres_problem.AddResidualBlock(
      new WeightedZeroPrior(DecayWeights(layout, weights.decay)), nullptr,
      x.data());

  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 100000;
  options.function_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 0.0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  PlainCallback callback(layout, &x, &watch);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  VLOG(1) << summary.BriefReport();
  return watch.times();
}

// The case with the noise levels of the plain way instead of Identify's search
// for them.
Case WithGivenNoise(Case c, double share) {
  for (IdentificationRecord& record : c.problem.records) {
    for (MeasuredChannel& channel : record.channels) {
      channel.sigma = share * StandardDeviationOfPresent(channel.values);
    }
  }
  return c;
}

// Repeated fits in one way.
struct Series {
  FitTimes last;
  std::vector<double> seconds;

  void Add(const FitTimes& times) {
    last = times;
    seconds.push_back(times.seconds);
  }
  double MedianSeconds() const {
    return last.reached ? Median(seconds)
                        : std::numeric_limits<double>::infinity();
  }
};

void BM_Case1Fit(benchmark::State& state) {
  const std::string scheme = "scheme" + std::to_string(state.range(0));
  Case c;
  std::string error;
  CHECK(ReadCase(PINODE_SOURCE_DIR "/data/four_dof_free/" + scheme + ".toml",
                 &c, &error))
      << error;
  const PlainWeights weights;
  const Case given_noise = WithGivenNoise(c, weights.sigma);
  Series pinode, pinode_given_noise;
  FitTimes plain;
  for (auto _ : state) {
    for (int i = 0; i < kPinodeRepetitions; ++i) {
      pinode.Add(FitWithPinode(c));
      pinode_given_noise.Add(FitWithPinode(given_noise));
      if (i == 0) plain = FitPlainly(c.problem, weights);
    }
    state.SetIterationTime(Median(pinode.seconds));
  }
  state.counters["iterations"] = pinode.last.iterations;
  state.counters["mse"] = pinode.last.error;
  state.counters["given_noise_s"] = Median(pinode_given_noise.seconds);
  state.counters["given_noise_iterations"] = pinode_given_noise.last.iterations;
  state.counters["plain_s"] = plain.seconds;
  state.counters["plain_iterations"] = plain.iterations;
  state.counters["plain_mse"] = plain.error;
  if (!pinode.last.reached) {
    state.SkipWithError("the free-run error of 1e-6 was not reached");
  }

  Comparison comparison;
  comparison.reference_seconds = plain.seconds;
  if (!plain.reached) {
    comparison.reference = Comparison::Reference::kLowerBound;
  }
  comparison.name = "case 1, " + scheme + ", noise levels given / plain";
  comparison.pinode_seconds = pinode_given_noise.MedianSeconds();
  AddComparison(comparison);
  comparison.name = "case 1, " + scheme + ", as the case is / plain";
  comparison.pinode_seconds = pinode.MedianSeconds();
  comparison.requirement = Comparison::Requirement::kAtLeast;
  comparison.limit = kRequiredRatio;
  AddComparison(comparison);
}
BENCHMARK(BM_Case1Fit)
    ->Arg(2)
    ->Arg(3)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace benchmarks
}  // namespace pinode
