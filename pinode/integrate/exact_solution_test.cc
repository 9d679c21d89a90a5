// Compares the exact solution of linear dynamics with converged Runge-Kutta
// solutions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/integrate/segment.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/figure_testing.h"
#include "tests/support/integrate_testing.h"

namespace pinode {
namespace {

Excitation Wave(int samples, Interpolation interpolation) {
  Matrix values(2, samples);
  for (int i = 0; i < samples; ++i) {
    values.col(i) << std::sin(0.9 * i) + 0.3 * std::sin(0.11 * i),
        std::cos(0.37 * i);
  }
  return Excitation(0.0, 0.05, values, interpolation);
}

std::unique_ptr<StructuralDynamics> WithGroups(const StructuralModel& model) {
  auto dynamics =
      std::make_unique<StructuralDynamics>(model, testing::GroundAndForce());
  testing::AddGroupsOfAllKinds(SpringMatrix(3, 0, 1), dynamics.get());
  return dynamics;
}

// Difficult structures: damping of any kind, modes that do not oscillate, a
// rigid body, equal frequencies.
std::vector<StructuralModel> Structures() {
  std::vector<StructuralModel> models;
  models.push_back(testing::MakeChain(3, 10.0, 0.5));
  models.back().mass(0, 1) = models.back().mass(1, 0) = 0.1;
  models.push_back(testing::MakeChain(3, 10.0, 9.0));
  models.push_back(testing::MakeChain(3, 10.0, 0.0));
  models.back().stiffness(0, 0) = 10.0;
  models.push_back(testing::MakeChain(3, 10.0, 0.0));
  models.back().mass.setIdentity();
  models.back().stiffness = 30.0 * Matrix::Identity(3, 3);
  models.back().damping = 0.1 * Matrix::Identity(3, 3);
  return models;
}

// Values computed on request equal those of a table.
TEST(IntegrationGrid, NodesOfTheExactSolution) {
  for (const Interpolation interpolation :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic}) {
    for (const bool periodic : {false, true}) {
      const Excitation wave(0.0, 0.05, Wave(40, interpolation).samples(),
                            interpolation, periodic);
      const IntegrationGrid grid = IntegrationGrid::Exact(wave);
      const IntegrationGrid table(wave, grid.substeps());
      ASSERT_EQ(grid.num_intervals(), table.num_intervals());
      for (int i = 0; i <= grid.num_intervals(); ++i) {
        for (int j = 0; j < 2; ++j) {
          EXPECT_EQ(grid.AtSample(i)[j], table.AtSample(i)[j]);
        }
      }
      Matrix nodes;
      grid.GetNodes(3, grid.num_intervals() - 3, &nodes);
      ASSERT_EQ(nodes.rows(), 6 * grid.substeps());
      EXPECT_EQ(nodes, Eigen::Map<const Matrix>(table.AtNode(3, 0, 0),
                                                nodes.rows(), nodes.cols()));
    }
  }
}

class ExactSolution : public ::testing::TestWithParam<Interpolation> {};

TEST_P(ExactSolution, IsWhatRungeKuttaComesTo) {
  // A minute, and a run too short for modes.
  for (const int samples : {1201, 60}) {
    const Excitation wave = Wave(samples, GetParam());
    for (const StructuralModel& model : Structures()) {
      const auto dynamics = WithGroups(model);
      const testing::ChannelRunner runner(*dynamics);
      const Vector theta = dynamics->Parameters();
      const Vector start = Vector::LinSpaced(6, -0.5, 0.6);
      const Matrix exact =
          runner.Run(theta, start, IntegrationGrid::Exact(wave));
      const Matrix fine = runner.Run(theta, start, IntegrationGrid(wave, 128));
      const double error = (exact - fine).norm() / fine.norm();
      // The windowed sinc is not a polynomial.
      const double limit =
          GetParam() == Interpolation::kBandLimited ? 1e-6 : 1e-10;
      testing::ReportFigure("exact solution against 128 Runge-Kutta steps",
                            testing::AtMost(limit), error);
      EXPECT_LT(error, limit);
    }
  }
}

TEST_P(ExactSolution, HasItsOwnDerivatives) {
  constexpr int kSamples = 300;
  // Polynomials through many nodes leave fewer digits for differences.
  const double limit = GetParam() == Interpolation::kBandLimited ? 3e-6 : 1e-7;
  const IntegrationGrid grid =
      IntegrationGrid::Exact(Wave(kSamples, GetParam()));
  for (const StructuralModel& model : Structures()) {
    const auto dynamics = WithGroups(model);
    const testing::ChannelRunner runner(*dynamics);
    const Vector theta = dynamics->Parameters();
    const Vector start = Vector::LinSpaced(6, -0.5, 0.6);
    StructuralDynamics::Prepared prepared;
    std::string error;
    ASSERT_TRUE(dynamics->Prepare(theta, &prepared, &error));
    for (const auto method :
         {DerivativeMethod::kTangents, DerivativeMethod::kJets}) {
      SegmentPropagator propagator(*dynamics, method);
      SegmentTangents tangents;
      ASSERT_TRUE(propagator.Propagate(prepared, runner.observation, grid,
                                       start, 0, grid.num_intervals(), true,
                                       SegmentColumns::kAll, &tangents));
      for (int j = 0; j < 6 + theta.size(); ++j) {
        const auto run = [&](double step) {
          Vector moved_start = start;
          Vector moved = theta;
          (j < 6 ? moved_start[j] : moved[j - 6]) += step;
          return runner.Run(moved, moved_start, grid);
        };
        // Central differences, extrapolated once.
        constexpr double kStep = 5e-4;
        const Matrix coarse = (run(kStep) - run(-kStep)) / (2.0 * kStep);
        const Matrix middle = (run(0.5 * kStep) - run(-0.5 * kStep)) / kStep;
        const Matrix fine =
            (run(0.25 * kStep) - run(-0.25 * kStep)) / (0.5 * kStep);
        const Matrix once = (4.0 * middle - coarse) / 3.0;
        const Matrix twice = (4.0 * fine - middle) / 3.0;
        const Matrix slope = (16.0 * twice - once) / 15.0;
        const Vector flat =
            Eigen::Map<const Vector>(slope.data(), slope.size());
        EXPECT_LT((tangents.jacobian().col(j) - flat).norm(),
                  limit * std::max(flat.norm(), 1e-3))
            << j;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Interpolations, ExactSolution,
                         ::testing::Values(Interpolation::kHeld,
                                           Interpolation::kLinear,
                                           Interpolation::kCubic,
                                           Interpolation::kBandLimited));

// A mode at 5 kHz, sampled at 20 Hz: Runge-Kutta needs hundreds of steps per
// sample to stay stable.
TEST(ExactSolutionOfStiffModels, CostsNoSteps) {
  StructuralModel model = testing::MakeChain(3, 10.0, 0.5);
  const double stiff = std::pow(2.0 * 3.14159265358979 * 5000.0, 2);
  model.stiffness(2, 2) += stiff;
  model.damping(2, 2) += 0.02 * std::sqrt(stiff);
  const auto dynamics = WithGroups(model);
  const testing::ChannelRunner runner(*dynamics);
  const Excitation wave = Wave(400, Interpolation::kLinear);
  const IntegrationGrid grid = IntegrationGrid::Exact(wave);
  EXPECT_EQ(grid.substeps(), 1);
  const Vector theta = dynamics->Parameters();
  const Matrix exact = runner.Run(theta, Vector::Zero(6), grid);
  const Matrix fine =
      runner.Run(theta, Vector::Zero(6), IntegrationGrid(wave, 4000));
  EXPECT_LT((exact.topRows(2) - fine.topRows(2)).norm(),
            1e-8 * fine.topRows(2).norm());
}

}  // namespace
}  // namespace pinode
