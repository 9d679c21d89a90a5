#include "pinode/report/restoring_force.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/network/network.h"
#include "tests/support/report_testing.h"

namespace pinode {
namespace {

// Computed by hand, from the states of the simulation.
TEST(RestoringForce, FollowsTheLawsAlongTheStates) {
  const auto example = testing::MakeReportExample();
  const auto loops = ComputeRestoringForceLoops(example->input);
  ASSERT_EQ(loops.size(), 3u);
  const StructuralDynamics& dynamics = *example->problem.dynamics;
  const Vector& theta = example->model.parameters;

  const RestoringForceLoop& cubic = loops[0];
  EXPECT_EQ(cubic.term, "spring1");
  EXPECT_EQ(cubic.type, "cubic");
  EXPECT_EQ(cubic.force_unit, "N");
  EXPECT_EQ(cubic.deformation_name, "d[ground,u1]");
  EXPECT_EQ(cubic.deformation_unit, "m");
  const Matrix& states =
      example->summary.records[static_cast<size_t>(cubic.record)].states;
  ASSERT_EQ(cubic.force.size(), states.cols());
  const double k3 = theta(4);
  for (int i = 0; i < states.cols(); i += 7) {
    const double d = states(0, i);
    EXPECT_EQ(cubic.deformation(i), d);
    EXPECT_EQ(cubic.rate(i), states(3, i));
    EXPECT_NEAR(cubic.force(i), k3 * d * d * d,
                1e-9 * std::abs(k3 * d * d * d));
    EXPECT_NEAR(cubic.time(i), 0.01 * i, 1e-12);
  }

  // k z with the internal state behind the displacements and velocities.
  const RestoringForceLoop& slip = loops[1];
  EXPECT_EQ(slip.type, "bouc_wen");
  const Matrix& slip_states =
      example->summary.records[static_cast<size_t>(slip.record)].states;
  ASSERT_EQ(slip_states.rows(), 7);
  for (int i = 0; i < slip_states.cols(); i += 7) {
    EXPECT_NEAR(slip.force(i), theta(5) * slip_states(6, i), 1e-6);
    EXPECT_EQ(slip.deformation(i), slip_states(1, i) - slip_states(0, i));
  }

  const RestoringForceLoop& network = loops[2];
  EXPECT_TRUE(network.is_acceleration);
  EXPECT_EQ(network.force_unit, "m/s^2");
  EXPECT_EQ(network.output, "u3");
  const NetworkTerm& term = dynamics.networks()[0];
  const Matrix& network_states =
      example->summary.records[static_cast<size_t>(network.record)].states;
  NetworkWorkspace workspace(*term.network);
  double largest = 0.0;
  for (int i = 0; i < network_states.cols(); i += 7) {
    const double q[] = {network_states(2, i), network_states(5, i)};
    double y;
    term.network->Evaluate(q, theta.data() + 11, &y, &workspace);
    EXPECT_NEAR(network.force(i), y, 1e-15);
    largest = std::max(largest, std::abs(y));
  }
  EXPECT_GT(largest, 1e-4);  // the comparison was not one of zeros
}

TEST(RestoringForce, IsAForceBesideAKnownCurve) {
  const auto example = testing::MakeReportExample();
  const auto before = ComputeRestoringForceLoops(example->input);
  ASSERT_EQ(before.size(), 3u);
  ASSERT_TRUE(before[2].is_acceleration);
  std::vector<ReferenceCurve>& curves =
      example->problem.description.reference_curves;
  curves.push_back({before[2].term, "data sheet",
                    Vector::LinSpaced(2, -1.0, 1.0),
                    Vector::LinSpaced(2, -2.0, 2.0)});
  const auto loops = ComputeRestoringForceLoops(example->input);
  EXPECT_EQ(loops[0].known, nullptr);
  EXPECT_EQ(loops[0].force, before[0].force);
  EXPECT_EQ(loops[2].known, &curves[0]);
  EXPECT_FALSE(loops[2].is_acceleration);
  EXPECT_EQ(loops[2].force_unit, "N");
  const double mass = example->problem.dynamics->model().mass(2, 2);
  const Vector force = -mass * before[2].force;
  EXPECT_GT(force.norm(), 0.0);
  EXPECT_LT((loops[2].force - force).norm(), 1e-12 * force.norm());
}

TEST(RestoringForce, TakesTheRecordWithTheWidestMotion) {
  const auto example = testing::MakeReportExample();
  auto& records = example->summary.records;
  records[0].states *= 100.0;
  EXPECT_EQ(ComputeRestoringForceLoops(example->input)[0].record, 0);
  records[0].finite = false;
  EXPECT_EQ(ComputeRestoringForceLoops(example->input)[0].record, 1);
  records[1].states.resize(0, 0);
  EXPECT_TRUE(ComputeRestoringForceLoops(example->input).empty());
  example->input.model = nullptr;
  EXPECT_TRUE(ComputeRestoringForceLoops(example->input).empty());
}

}  // namespace
}  // namespace pinode
