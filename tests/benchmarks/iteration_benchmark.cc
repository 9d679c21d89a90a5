// One Levenberg-Marquardt iteration of a fit with estimated segment starts,
// split into its parts, beside the plain way.
//
// Records of 240, 400 and 4000 samples, the whole state of 8 or 24 states
// measured, segments of 20 samples. An iteration is what lies between two of
// Ceres' iteration callbacks: the linear solve, the cost at the trial point (in
// pinode with the search for the best starts) and the Jacobian there.
// Iterations that Ceres rejects are not counted: they lack the Jacobian.
//
//   starts     cost at the trial point
//   linearize  tangents of all segments; in pinode, which forms them on the
//              way, the normal equations as well, starts eliminated, and their
//              square root
//   solve      the rest: Ceres' solve; for the plain way normal equations, too
//
// Beside both: the rank update alone, J'J by Eigen, of a dense J with as many
// rows as there are measured values and as many columns as an iteration has
// tangents (unknowns of the fit and of a segment's start).

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/solver/condensed_cost.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/benchmarks/chain_problem.h"
#include "tests/benchmarks/measure.h"
#include "tests/benchmarks/plain_chain.h"
#include "tests/benchmarks/plain_fit.h"

namespace pinode {
namespace benchmarks {
namespace {

constexpr int kSegmentSamples = 20;
constexpr double kDecay = 0.1;
constexpr int kRepetitions = 5;
// Accepted iterations of a run, and the most that may be tried for them.
constexpr int kIterations = 5;
constexpr int kPlainIterations = 2;
constexpr int kMaxTrials = 30;
// The plain way is not run where an iteration would take longer.
constexpr double kPlainLimitSeconds = 30.0;
constexpr double kRequiredGrowth = 12.0;
constexpr double kRequiredOfRankUpdate = 0.7;

struct IterationTimes {
  double starts = 0.0;
  double linearize = 0.0;
  double solve = 0.0;
  double Total() const { return starts + linearize + solve; }
};

// Reads the clock after each iteration, until `num_wanted` were accepted.
class Clock final : public ceres::IterationCallback {
 public:
  Clock(int num_wanted, const EvaluationTimes* times)
      : num_wanted_(num_wanted), times_(times) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    const double now = CpuSeconds();
    if (iteration.iteration > 0 && iteration.step_is_successful) {
      IterationTimes times;
      times.starts = times_->cost_seconds - before_.cost_seconds;
      times.linearize = times_->jacobian_seconds - before_.jacobian_seconds;
      times.solve = now - last_ - times.starts - times.linearize;
      iterations_.push_back(times);
    }
    before_ = *times_;
    last_ = CpuSeconds();
    return static_cast<int>(iterations_.size()) < num_wanted_
               ? ceres::SOLVER_CONTINUE
               : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

  const std::vector<IterationTimes>& iterations() const { return iterations_; }

 private:
  int num_wanted_;
  const EvaluationTimes* times_;
  EvaluationTimes before_;
  double last_ = 0.0;
  std::vector<IterationTimes> iterations_;
};

std::vector<IterationTimes> RunIterations(int num_iterations,
                                          const EvaluationTimes& times,
                                          ceres::Problem* problem) {
  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kMaxTrials;
  options.function_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 0.0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  Clock clock(num_iterations, &times);
  options.callbacks.push_back(&clock);
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem, &summary);
  CHECK(!clock.iterations().empty()) << summary.FullReport();
  return clock.iterations();
}

template <typename Member>
double MedianOf(const std::vector<IterationTimes>& iterations, Member member) {
  std::vector<double> values;
  for (const IterationTimes& times : iterations) {
    values.push_back(times.*member);
  }
  return Median(values);
}

IterationTimes MedianTimes(const std::vector<IterationTimes>& iterations) {
  IterationTimes median;
  median.starts = MedianOf(iterations, &IterationTimes::starts);
  median.linearize = MedianOf(iterations, &IterationTimes::linearize);
  median.solve = MedianOf(iterations, &IterationTimes::solve);
  return median;
}

// The fit of one chain in both ways.
template <int kDofs, bool kGroups>
class Fit {
 public:
  using Chain = PlainChain<kDofs, kGroups, false>;

  explicit Fit(int num_samples)
      : problem_(MakeChainProblem(kDofs, kGroups, num_samples)),
        layout_(problem_),
        objective_(problem_, layout_, MultipleShooting::Options()),
        shooting_(objective_.shooting()),
        boundaries_(CutSegments(num_samples, kSegmentSamples)),
        grid_(*record().excitation, record().substeps),
        chain_(kStiffness, kDamping, NetworkArchitecture(), &grid_) {
    CHECK_EQ(layout_.num_free(), Chain::kParameters);
    initial_ = layout_.Free(layout_.InitialValues());
    sigma_.resize(Chain::kStates);
    for (int c = 0; c < Chain::kStates; ++c) {
      sigma_[c] = record().channels[static_cast<size_t>(c)].sigma;
    }
    shooting_.SetSigmas({sigma_});
    objective_.priors().SetDecays(
        Vector::Constant(layout_.num_decay_groups(), kDecay));
    TrajectoryOutlines outlines;
    CHECK(InitialTrajectories(problem_, kSegmentSamples, initial_,
                              StageTuning(), &shooting_, &outlines));
    CHECK(RunTrajectories(shooting_, outlines, &trajectories_));
    scales_ = StateScales(problem_, trajectories_[0]);
    Restart();
    CHECK_EQ(shooting_.record(0).num_segments(), num_segments());
    CondensedSystem system;
    CHECK(shooting_.Linearize(initial_, &system));
    // As at the beginning of a stage of Identify.
    shooting_.SetGapPenalty(
        std::max(1.0, 0.1 * shooting_.state().data_curvature()));
    Restart();
    CheckSameCost();
  }

  // Iterations of pinode from the same beginning.
  std::vector<IterationTimes> RunPinode() {
    Restart();
    Vector x = initial_;
    EvaluationTimes times;
    ceres::Problem ceres_problem;
    ceres_problem.AddResidualBlock(
        new TimedCost(
            std::make_unique<CondensedCost>(&objective_, layout_.num_free()),
            &times),
        nullptr, x.data());
    return RunIterations(kIterations, times, &ceres_problem);
  }

  std::vector<IterationTimes> RunPlain() {
    Restart();
    Vector x = initial_;
    Matrix starts = shooting_.starts()[0];
    EvaluationTimes times;
    ceres::Problem ceres_problem;
    AddPlain(&starts, &x, &times, &ceres_problem);
    return RunIterations(kPlainIterations, times, &ceres_problem);
  }

  // Of one J'J, seconds.
  double RunRankUpdate() const {
    const Eigen::Index columns = layout_.num_free() + Chain::kStates;
    const Eigen::Index rows =
        Eigen::Index{Chain::kStates} * record().num_samples();
    const Matrix jacobian = Matrix::Random(rows, columns);
    Matrix product = Matrix::Zero(columns, columns);
    const double begin = CpuSeconds();
    product.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
    const double seconds = CpuSeconds() - begin;
    CHECK(product(0, 0) > 0.0);
    return seconds;
  }

  int num_segments() const { return static_cast<int>(boundaries_.size()) - 1; }
  // Of the plain way.
  double num_residuals() const {
    return static_cast<double>(Chain::kStates) *
               static_cast<double>(record().num_samples() + num_segments() -
                                   1) +
           Chain::kParameters;
  }
  double num_unknowns() const {
    return static_cast<double>(Chain::kStates) * num_segments() +
           Chain::kParameters;
  }

 private:
  const IdentificationRecord& record() const { return problem_.records[0]; }

  void Restart() {
    SetSegments(kSegmentSamples, trajectories_, &shooting_);
    shooting_.SetStateScales({scales_});
  }

  void AddPlain(Matrix* starts, Vector* x, EvaluationTimes* times,
                ceres::Problem* ceres_problem) {
    AddPlainSegments(chain_, record(), boundaries_, sigma_,
                     scales_ / std::sqrt(shooting_.gap_penalty()), starts,
                     x->data(), times, ceres_problem);
    ceres_problem->AddResidualBlock(
        new WeightedZeroPrior(DecayWeights(layout_, kDecay)), nullptr,
        x->data());
  }

  // Both ways pose the same problem: at the starts that pinode finds, their
  // costs agree but for pinode's faint prior on the first start.
  void CheckSameCost() {
    double cost = 0.0;
    CHECK(objective_.Evaluate(initial_, &cost));
    Vector x = initial_;
    Matrix starts = shooting_.starts()[0];
    EvaluationTimes times;
    ceres::Problem ceres_problem;
    AddPlain(&starts, &x, &times, &ceres_problem);
    double plain_cost = 0.0;
    CHECK(ceres_problem.Evaluate(ceres::Problem::EvaluateOptions(), &plain_cost,
                                 nullptr, nullptr, nullptr));
    CHECK_LE(std::abs(cost - plain_cost), 1e-5 * cost)
        << cost << " against " << plain_cost;
  }

  IdentificationProblem problem_;
  ParameterLayout layout_;
  Objective objective_;
  MultipleShooting& shooting_;
  std::vector<int> boundaries_;
  IntegrationGrid grid_;
  Chain chain_;
  Vector initial_;
  Vector sigma_;
  Vector scales_;
  std::vector<Matrix> trajectories_;
};

void SetCounters(const std::string& prefix, const IterationTimes& times,
                 benchmark::State* state) {
  state->counters[prefix + "starts_ms"] = 1e3 * times.starts;
  state->counters[prefix + "linearize_ms"] = 1e3 * times.linearize;
  state->counters[prefix + "solve_ms"] = 1e3 * times.solve;
}

std::string SizeName(int states, int64_t samples) {
  return std::to_string(states) + " states, " + std::to_string(samples) +
         " samples";
}

template <int kDofs, bool kGroups>
void BM_Iteration(benchmark::State& state) {
  const int num_samples = static_cast<int>(state.range(0));
  Fit<kDofs, kGroups> fit(num_samples);

  // What the plain way's parts cost per residual, segment and so on, from the
  // shortest record: where it would take too long, it is extrapolated.
  static IterationTimes short_plain;
  static double short_products = 0.0;
  static int short_segments = 0;
  const double products =
      fit.num_residuals() * fit.num_unknowns() * fit.num_unknowns();
  IterationTimes extrapolated;
  if (short_segments > 0) {
    const double more_segments =
        static_cast<double>(fit.num_segments()) / short_segments;
    extrapolated.starts = short_plain.starts * more_segments;
    extrapolated.linearize = short_plain.linearize * more_segments;
    extrapolated.solve = short_plain.solve * products / short_products;
  }
  const bool run_plain = extrapolated.Total() <= kPlainLimitSeconds;

  std::vector<IterationTimes> pinode_iterations, plain_iterations;
  std::vector<double> rank_updates;
  for (auto _ : state) {
    rank_updates.push_back(fit.RunRankUpdate());
    const std::vector<IterationTimes> iterations = fit.RunPinode();
    pinode_iterations.insert(pinode_iterations.end(), iterations.begin(),
                             iterations.end());
    state.SetIterationTime(MedianTimes(iterations).Total());
    // One run of the plain way is enough where it takes seconds.
    if (!run_plain ||
        (!plain_iterations.empty() && extrapolated.Total() > 3.0)) {
      continue;
    }
    const std::vector<IterationTimes> plain = fit.RunPlain();
    plain_iterations.insert(plain_iterations.end(), plain.begin(), plain.end());
  }
  const IterationTimes pinode = MedianTimes(pinode_iterations);
  const IterationTimes plain =
      run_plain ? MedianTimes(plain_iterations) : extrapolated;
  if (short_segments == 0) {
    short_plain = plain;
    short_products = products;
    short_segments = fit.num_segments();
  }

  SetCounters("", pinode, &state);
  SetCounters("plain_", plain, &state);
  const std::string size =
      SizeName(Fit<kDofs, kGroups>::Chain::kStates, num_samples);
  if (!run_plain) {
    state.SetLabel("plain way over " +
                   std::to_string(static_cast<int>(kPlainLimitSeconds)) +
                   " s an iteration: extrapolated, not run");
  }
  Comparison comparison;
  comparison.name = "iteration, " + size + " / plain";
  comparison.reference_seconds = plain.Total();
  comparison.pinode_seconds = pinode.Total();
  if (!run_plain) {
    comparison.reference = Comparison::Reference::kExtrapolated;
  }
  AddComparison(comparison);
  Comparison products_alone;
  products_alone.name = "iteration, " + size + " / rank update alone";
  products_alone.reference_seconds = Median(rank_updates);
  products_alone.pinode_seconds = pinode.Total();
  if (!kGroups && num_samples == 4000) {
    products_alone.requirement = Comparison::Requirement::kAtLeast;
    products_alone.limit = kRequiredOfRankUpdate;
  }
  AddComparison(products_alone);
}
BENCHMARK_TEMPLATE(BM_Iteration, 4, false)
    ->Arg(240)
    ->Arg(4000)
    ->Iterations(kRepetitions)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(BM_Iteration, 12, true)
    ->Arg(240)
    ->Arg(4000)
    ->Iterations(kRepetitions)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// An iteration on a record ten times as long, both in turns.
void BM_IterationGrowth(benchmark::State& state) {
  Fit<4, false> short_fit(400);
  Fit<4, false> long_fit(4000);
  std::vector<double> short_seconds, long_seconds;
  for (auto _ : state) {
    for (const IterationTimes& times : short_fit.RunPinode()) {
      short_seconds.push_back(times.Total());
    }
    const std::vector<IterationTimes> iterations = long_fit.RunPinode();
    for (const IterationTimes& times : iterations) {
      long_seconds.push_back(times.Total());
    }
    state.SetIterationTime(MedianTimes(iterations).Total());
  }
  Comparison comparison;
  comparison.name = "iteration, 8 states, 400 -> 4000 samples";
  comparison.reference_seconds = Median(long_seconds);
  comparison.pinode_seconds = Median(short_seconds);
  comparison.requirement = Comparison::Requirement::kAtMost;
  comparison.limit = kRequiredGrowth;
  AddComparison(comparison);
  state.counters["short_ms"] = 1e3 * comparison.pinode_seconds;
  state.counters["long_ms"] = 1e3 * comparison.reference_seconds;
  state.counters["growth"] = comparison.Ratio();
}
BENCHMARK(BM_IterationGrowth)
    ->Iterations(kRepetitions)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace benchmarks
}  // namespace pinode
