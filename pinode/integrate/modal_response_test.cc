#include "pinode/integrate/modal_response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/integrate/segment.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/figure_testing.h"
#include "tests/support/integrate_testing.h"

namespace pinode {
namespace {

constexpr int kModalSamples = 90;

// Displacement, velocity and both accelerations under two inputs.
class ModalResponseTest : public ::testing::Test {
 protected:
  void Use(const StructuralDynamics& dynamics) {
    dynamics_ = &dynamics;
    std::string error;
    ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared_, &error))
        << error;
    const int n = dynamics.num_dofs();
    observation_ = ObservationMap(
        dynamics,
        {{"x", Quantity::kDisplacement, Vector::Unit(n, 0)},
         {"v", Quantity::kVelocity, Vector::Unit(n, n - 1)},
         {"a", Quantity::kAbsoluteAcceleration, Vector::Unit(n, n - 1)},
         {"r", Quantity::kRelativeAcceleration, Vector::Unit(n, 0)}});
    Matrix values(dynamics.num_inputs(), kModalSamples);
    for (int i = 0; i < kModalSamples; ++i) {
      for (int k = 0; k < values.rows(); ++k) {
        values(k, i) = std::sin(1.3 * i + k) + 0.5 * std::cos(0.37 * i);
      }
    }
    const Excitation excitation(0.2, 0.05, values, Interpolation::kCubic);
    grid_ = IntegrationGrid(excitation, 3);
    exact_grid_ = IntegrationGrid::Exact(excitation);
    start_ = Vector::LinSpaced(dynamics.num_states(), -0.5, 0.6);
  }

  // Returns the largest difference from the segment's own result, each column
  // relative to its size.
  double WorstAgainstSegment() {
    return testing::Worse(WorstAgainstSegment(grid_),
                          WorstAgainstSegment(exact_grid_));
  }

  double WorstAgainstSegment(const IntegrationGrid& grid) {
    SegmentPropagator propagator(*dynamics_, DerivativeMethod::kTangents);
    SegmentTangents segment;
    EXPECT_TRUE(propagator.Propagate(prepared_, observation_, grid, start_, 0,
                                     kModalSamples - 1, true,
                                     SegmentColumns::kAll, &segment));
    ModalResponse response;
    if (!response.Prepare(*dynamics_, prepared_, grid, true)) return 1e300;
    const ModalResponse::Contents contents{true, true};
    const Matrix values = response.Values(contents, observation_, start_);
    const std::vector<Matrix> tables =
        response.Derivatives(contents, observation_, start_, true, true);
    const int nc = observation_.num_channels();
    Matrix channels(nc, kModalSamples);
    Matrix jacobian(nc * kModalSamples, tables[0].cols());
    // In pieces of a length that does not divide the whole.
    ModalResponse::State state = response.Begin(contents);
    Matrix histories;
    for (int first = 0; first < kModalSamples; first += 40) {
      const int count = std::min(40, kModalSamples - first);
      response.Advance(contents, grid, first, count, &state, &histories);
      channels.middleCols(first, count) = values.transpose() * histories;
      for (int i = 0; i < count; ++i) {
        for (int c = 0; c < nc; ++c) {
          jacobian.row((first + i) * nc + c) =
              histories.col(i).transpose() * tables[static_cast<size_t>(c)];
        }
      }
    }
    double worst =
        (channels - segment.channels).norm() / segment.channels.norm();
    // A zero column, for example of a state that no channel measures, is
    // compared relative to the others.
    const double least = 1e-6 * segment.jacobian().colwise().norm().maxCoeff();
    for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
      worst = testing::Worse(
          worst, (jacobian.col(j) - segment.jacobian().col(j)).norm() /
                     std::max(least, segment.jacobian().col(j).norm()));
    }
    const Vector end =
        response.States(contents, start_).transpose() * histories.rightCols(1);
    return testing::Worse(
        worst, (end - segment.end_state).norm() / segment.end_state.norm());
  }

  const StructuralDynamics* dynamics_ = nullptr;
  StructuralDynamics::Prepared prepared_;
  ObservationMap observation_;
  IntegrationGrid grid_, exact_grid_;
  Vector start_;
};

TEST_F(ModalResponseTest, EqualsTheSegmentForDampingOfAnyKind) {
  StructuralModel model = testing::MakeChain(4, 10.0, 0.5);
  model.mass(0, 1) = model.mass(1, 0) = 0.1;
  model.support_mass_coupling(0, 0) = 0.2;
  StructuralDynamics dynamics(model, testing::GroundAndForce());
  testing::AddGroupsOfAllKinds(SpringMatrix(4, 0, 1), &dynamics);
  testing::AddGroupsOfAllKinds(SpringMatrix(4, -1, 3), &dynamics);
  Use(dynamics);
  const double worst = WorstAgainstSegment();
  testing::ReportFigure("modal response against the steps, any damping",
                        testing::AtMost(1e-10), worst);
  EXPECT_LT(worst, 1e-10);
}

TEST_F(ModalResponseTest, HoldsWithoutDampingAndWithModesThatDoNotSwing) {
  StructuralDynamics undamped(testing::MakeChain(3, 10.0, 0.0),
                              testing::GroundAndForce());
  testing::AddGroupsOfAllKinds(SpringMatrix(3, 0, 1), &undamped);
  Use(undamped);
  EXPECT_LT(WorstAgainstSegment(), 1e-10);
  StructuralDynamics heavy(testing::MakeChain(3, 10.0, 9.0),
                           testing::GroundAndForce());
  testing::AddGroupsOfAllKinds(SpringMatrix(3, 0, 1), &heavy);
  Use(heavy);
  EXPECT_LT(WorstAgainstSegment(), 1e-10);
}

// Two equal oscillators, and one that is nearly equal to them: the derivatives
// with respect to a spring between them must not divide by a difference.
TEST_F(ModalResponseTest, HoldsWhereFrequenciesAreEqual) {
  for (const double apart : {0.0, 1e-12, 1e-9, 3e-7, 1e-4}) {
    StructuralModel model = testing::MakeChain(3, 10.0, 0.0);
    model.mass.setIdentity();
    model.stiffness =
        Vector(Eigen::Vector3d(40.0, 40.0, 40.0 * (1.0 + apart))).asDiagonal();
    model.damping = 0.02 * model.stiffness;
    StructuralDynamics dynamics(model, testing::GroundAndForce());
    testing::AddGroupsOfAllKinds(SpringMatrix(3, 0, 2), &dynamics);
    for (const double alpha : {0.0, 0.1}) {
      dynamics.SetParameters(Vector::Constant(3, alpha));
      Use(dynamics);
      EXPECT_LT(WorstAgainstSegment(), 1e-8) << apart << " " << alpha;
    }
  }
}

// A rigid body's two eigenvalues 0 have one mode.
TEST_F(ModalResponseTest, SaysWhereModesDoNotSpanTheStates) {
  StructuralModel model = testing::MakeChain(3, 10.0, 0.0);
  model.stiffness(0, 0) = 10.0;
  const StructuralDynamics dynamics(model, testing::GroundAndForce());
  Use(dynamics);
  EXPECT_NEAR(model.stiffness.rowwise().sum().norm(), 0.0, 1e-12);
  ModalResponse response;
  EXPECT_FALSE(response.Prepare(dynamics, prepared_, grid_, false));
  EXPECT_FALSE(response.Prepare(dynamics, prepared_, grid_, false));
}

}  // namespace
}  // namespace pinode
