#include "pinode/estimate/levenberg_marquardt.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/dynamics/testing.h"
#include "pinode/estimate/condensed_cost.h"
#include "pinode/estimate/testing.h"

namespace pinode {
namespace {

using Iteration = LevenbergMarquardt::Iteration;
using End = LevenbergMarquardt::End;

// Rosenbrock's valley, steep (10 in his own) and bent: 0.5 at (1, 1), the rest
// of a residual that nothing changes. There is no cost where x < `edge`.
class Valley final : public CostPart {
 public:
  explicit Valley(double steep, double edge = -kInfinity)
      : steep_(steep), edge_(edge) {}

  bool Evaluate(const Vector& free, double* cost) override {
    const double a = steep_ * (free[1] - free[0] * free[0]);
    const double b = 1.0 - free[0];
    *cost = 0.5 * (a * a + b * b + 1.0);
    return free[0] >= edge_;
  }
  bool Linearize(const Vector& free, CondensedSystem* system) override {
    Eigen::Matrix2d jacobian;
    jacobian << -2.0 * steep_ * free[0], steep_, -1.0, 0.0;
    const Eigen::Vector2d r(steep_ * (free[1] - free[0] * free[0]),
                            1.0 - free[0]);
    *system = {0.5 * (r.squaredNorm() + 1.0), jacobian.transpose() * r,
               jacobian.transpose() * jacobian};
    return free[0] >= edge_;
  }
  std::string Failure() const override { return ""; }

 private:
  double steep_, edge_;
};

IdentificationProblem TwoUnknowns(double upper = kInfinity) {
  IdentificationProblem problem;
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(2, 40.0, 0.1), std::vector<InputSpec>{});
  std::string error;
  for (int i = 0; i < 2; ++i) {
    GroupTerm term;
    term.group.name = "k" + std::to_string(i + 1);
    term.group.target = MatrixGroup::Target::kStiffness;
    term.group.matrix = Matrix::Identity(2, 2);
    term.alpha.name = term.group.name;
    if (i == 0) term.alpha.upper = upper;
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  problem.dynamics = dynamics;
  return problem;
}

struct Path {
  LevenbergMarquardt::Outcome outcome;
  std::vector<Iteration> iterations;
  Vector end;
};

Path Descend(const IdentificationProblem& problem,
             const LevenbergMarquardt::Options& options, Valley valley,
             int stop_at = -1) {
  const ParameterLayout layout(problem);
  LevenbergMarquardt minimizer(layout, options, &valley);
  Path path;
  path.end = Eigen::Vector2d(-1.2, 1.0);
  path.outcome = minimizer.Run(
      [&](const Iteration& iteration, const CondensedSystem& system,
          const Vector& free) {
        double cost = 0.0;
        EXPECT_TRUE(valley.Evaluate(free, &cost));
        EXPECT_DOUBLE_EQ(iteration.cost, cost);
        EXPECT_DOUBLE_EQ(system.cost, cost);
        path.iterations.push_back(iteration);
        return iteration.number != stop_at;
      },
      &path.end);
  return path;
}

class Recorder final : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    iterations.push_back({iteration.iteration, iteration.cost,
                          iteration.gradient_norm, iteration.step_norm,
                          iteration.trust_region_radius,
                          iteration.step_is_successful});
    return ceres::SOLVER_CONTINUE;
  }
  std::vector<Iteration> iterations;
};

class BesideCeres : public ::testing::TestWithParam<int> {};

TEST_P(BesideCeres, TakesTheSameSteps) {
  Valley valley(30.0);
  CondensedCost cost(&valley, 2);
  Vector x = Eigen::Vector2d(-1.2, 1.0);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, x.data());
  ceres::Solver::Options theirs;
  theirs.linear_solver_type = ceres::DENSE_QR;
  theirs.initial_trust_region_radius = 50.0;
  theirs.function_tolerance = 1e-9;
  theirs.gradient_tolerance = 0.0;
  theirs.parameter_tolerance = 1e-14;
  theirs.max_num_iterations = 200;
  theirs.logging_type = ceres::SILENT;
  theirs.update_state_every_iteration = true;
  theirs.use_nonmonotonic_steps = GetParam() > 0;
  theirs.max_consecutive_nonmonotonic_steps = GetParam();
  Recorder recorder;
  theirs.callbacks.push_back(&recorder);
  ceres::Solver::Summary summary;
  ceres::Solve(theirs, &problem, &summary);

  LevenbergMarquardt::Options options;
  options.radius = 50.0;
  options.function_tolerance = 1e-9;
  options.max_iterations = 200;
  options.uphill_steps = GetParam();
  const Path path = Descend(TwoUnknowns(), options, Valley(30.0));
  EXPECT_EQ(path.outcome.end, End::kConverged);
  EXPECT_LT((path.end - Vector::Ones(2)).norm(), 1e-3);
  ASSERT_GT(recorder.iterations.size(), 10u);
  int rejected = 0;
  int uphill = 0;
  ASSERT_GE(path.iterations.size() + 1, recorder.iterations.size());
  for (size_t i = 0; i < path.iterations.size(); ++i) {
    ASSERT_LT(i, recorder.iterations.size());
    const Iteration& own = path.iterations[i];
    const Iteration& other = recorder.iterations[i];
    EXPECT_EQ(own.number, other.number);
    EXPECT_EQ(own.accepted, other.accepted) << i;
    // Ceres shows what a rejected step would have cost.
    // A factor of 1e6 for what 50 steps of a valley make of rounding.
    if (own.accepted) {
      EXPECT_NEAR(own.cost, other.cost, 1e-6 * other.cost) << i;
    }
    EXPECT_NEAR(own.radius, other.radius, 1e-5 * other.radius) << i;
    rejected += own.accepted ? 0 : 1;
    uphill += i > 0 && own.cost > path.iterations[i - 1].cost;
  }
  EXPECT_GT(rejected, 0);
  EXPECT_EQ(uphill > 0, GetParam() > 0);
}

INSTANTIATE_TEST_SUITE_P(Uphill, BesideCeres, ::testing::Values(0, 5));

TEST(LevenbergMarquardt, StopsWhereItIsTold) {
  LevenbergMarquardt::Options options;
  options.max_iterations = 4;
  Path path = Descend(TwoUnknowns(), options, Valley(30.0));
  EXPECT_EQ(path.outcome.end, End::kIterations);
  EXPECT_EQ(path.outcome.iterations, 4);
  EXPECT_EQ(path.iterations.size(), 5u);
  path = Descend(TwoUnknowns(), options, Valley(30.0), 2);
  EXPECT_EQ(path.outcome.end, End::kStopped);
  EXPECT_EQ(path.outcome.iterations, 2);
}

TEST(LevenbergMarquardt, KeepsWithinBounds) {
  LevenbergMarquardt::Options options;
  options.function_tolerance = 1e-12;
  options.max_iterations = 200;
  const Path path = Descend(TwoUnknowns(0.5), options, Valley(10.0));
  EXPECT_EQ(path.outcome.end, End::kConverged);
  EXPECT_EQ(path.end[0], 0.5);
  EXPECT_NEAR(path.end[1], 0.25, 1e-6);
}

TEST(LevenbergMarquardt, GoesRoundWhereThereIsNoCost) {
  LevenbergMarquardt::Options options;
  options.max_iterations = 300;
  options.function_tolerance = 1e-9;
  Path path = Descend(TwoUnknowns(), options, Valley(30.0, 2.0));
  EXPECT_EQ(path.outcome.end, End::kNoCost) << "none at the start";
  EXPECT_EQ(path.end[0], -1.2);
  // The first step, undamped, would go to x = 1.
  options.radius = 1e8;
  Valley valley(30.0, -1.3);
  path = Descend(TwoUnknowns(), options, valley);
  EXPECT_EQ(path.outcome.end, End::kConverged);
  EXPECT_NEAR(path.end[0], 1.0, 1e-3);
}

}  // namespace
}  // namespace pinode
