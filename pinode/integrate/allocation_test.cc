// One step with its derivatives allocates nothing once its workspace exists.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "pinode/integrate/tangent_step.h"
#include "tests/support/allocation_testing.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace {

const char kWhat[] = "memory allocations in the inner loop";

class AllocationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::kCountsAllocations) {
      testing::ReportSkipped(kWhat);
      GTEST_SKIP() << "Allocations are counted with glibc, without sanitizers.";
    }
    dynamics_ = testing::MakeEverything();
    std::string error;
    ASSERT_TRUE(
        dynamics_->Prepare(dynamics_->Parameters(), &prepared_, &error));
    grid_ = IntegrationGrid(
        Excitation(0.0, 0.05, Matrix::Random(3, 12), Interpolation::kLinear),
        2);
    state_ = Vector::LinSpaced(dynamics_->num_states(), -0.5, 0.6);
  }

  std::unique_ptr<StructuralDynamics> dynamics_;
  StructuralDynamics::Prepared prepared_;
  IntegrationGrid grid_;
  Vector state_;
};

TEST_F(AllocationTest, IsCounted) {
  const std::size_t before = testing::allocation_count;
  const Matrix matrix = Matrix::Random(20, 20);
  EXPECT_GT(testing::allocation_count, before);
  EXPECT_TRUE(matrix.allFinite());
}

TEST_F(AllocationTest, StepAllocatesNothing) {
  const int ns = dynamics_->num_states();
  std::size_t worst = 0;
  for (bool with_parameters : {false, true}) {
    TangentStep step(*dynamics_);
    Vector state = state_;
    Matrix sensitivity = Matrix::Zero(
        ns, ns + (with_parameters ? dynamics_->num_tangent_columns() : 0));
    sensitivity.leftCols(ns).setIdentity();
    // The first step may still size its workspace.
    step.Step(prepared_, grid_, 0, 0, false, with_parameters, &state,
              &sensitivity);
    const std::size_t before = testing::allocation_count;
    for (int i = 0; i < 11; ++i) {
      for (int s = 0; s < 2; ++s) {
        step.Step(prepared_, grid_, i, s, false, with_parameters, &state,
                  &sensitivity);
      }
    }
    const std::size_t after = testing::allocation_count;
    EXPECT_EQ(after, before) << "with parameters: " << with_parameters;
    worst = std::max(worst, after - before);
    EXPECT_TRUE(state.allFinite() && sensitivity.allFinite());
    EXPECT_GT(sensitivity.norm(), 0.0);
  }
  testing::ReportFigure(std::string(kWhat) + ": 22 steps", testing::AtMost(0),
                        static_cast<double>(worst));
}

TEST_F(AllocationTest, LinearizationAtASampleAllocatesNothing) {
  TangentStep step(*dynamics_);
  const int ns = dynamics_->num_states();
  const Matrix left = Matrix::Random(2, ns);
  Matrix result = Matrix::Zero(2, dynamics_->num_tangent_columns());
  step.LinearizeAt(prepared_, 0.0, grid_.AtSample(0), state_.data());
  step.AddParameterTangents(prepared_, left, &result);
  const std::size_t before = testing::allocation_count;
  for (int i = 0; i < 12; ++i) {
    step.LinearizeAt(prepared_, grid_.time(i), grid_.AtSample(i),
                     state_.data());
    step.AddParameterTangents(prepared_, left, &result);
  }
  const std::size_t after = testing::allocation_count;
  testing::ReportFigure(std::string(kWhat) + ": 12 linearizations",
                        testing::AtMost(0),
                        static_cast<double>(after - before));
  EXPECT_EQ(after, before);
  EXPECT_GT(result.norm(), 0.0);
}

}  // namespace
}  // namespace pinode
