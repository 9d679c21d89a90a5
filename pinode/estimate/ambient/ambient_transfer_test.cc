#include "pinode/estimate/ambient/ambient_transfer.h"

#include <vector>

#include "gtest/gtest.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "tests/support/ambient_testing.h"

namespace pinode {
namespace {

// H P H^H of a line, whose loads have the covariance P, summed over the nodes.
ComplexMatrix ResponseSpectrum(const AmbientTransfer& transfer,
                               Eigen::Index line, const Matrix& covariance) {
  const ComplexMatrix& h = transfer.at(line);
  const Eigen::Index areas = covariance.rows();
  ComplexMatrix sum = ComplexMatrix::Zero(h.rows(), h.rows());
  for (int node = 0; node < transfer.num_nodes(); ++node) {
    const auto part = h.middleCols(node * areas, areas);
    sum += part * covariance * part.adjoint();
  }
  return sum;
}

// Derivatives by groups of stiffness and damping, of one and of two nodes, are
// those of differences.
TEST(AmbientTransferTest, DerivativesAreThoseOfDifferences) {
  const TestChain chain = RayleighChain(3);
  for (const int areas : {3, 2}) {
    AmbientRecord record = RecordOfChain(chain, 60.0, 1, 0.5, {2, 1, 0});
    record.loads = Matrix::Identity(3, areas);
    record.areas.assign(static_cast<size_t>(areas), "u");
    const IdentificationProblem problem =
        ProblemOfChain(chain, kChainSpring, 0.02, record);
    const ParameterLayout layout(problem);
    AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 1);
    const AmbientTransfer& transfer = cost.transfer();
    EXPECT_EQ(transfer.num_nodes(), areas < 3 ? 2 : 1);
    ASSERT_EQ(transfer.num_groups(), 5);
    const Matrix covariance =
        Matrix::Identity(areas, areas) + Matrix::Ones(areas, areas);
    const Vector free = layout.Free(layout.InitialValues());
    const Eigen::Index line = cost.lines().size() / 2;
    ASSERT_TRUE(cost.SetPoint(free)) << cost.Failure();
    const ComplexFactor factor(ResponseSpectrum(transfer, line, covariance) +
                               ComplexMatrix::Identity(3, 3));
    const auto lower = factor.matrixL();
    ComplexMatrix whitened = transfer.at(line);
    lower.solveInPlace(whitened);
    std::vector<ComplexMatrix> halves(5, ComplexMatrix::Zero(3, 3));
    transfer.AddDerivatives(line, covariance, whitened, factor, &halves);
    constexpr double kStep = 1e-5;
    for (size_t g = 0; g < halves.size(); ++g) {
      ComplexMatrix difference = ComplexMatrix::Zero(3, 3);
      for (const double side : {1.0, -1.0}) {
        Vector moved = free;
        moved[transfer.groups()[g].free] += side * kStep;
        ASSERT_TRUE(cost.SetPoint(moved)) << cost.Failure();
        difference +=
            side / (2.0 * kStep) * ResponseSpectrum(transfer, line, covariance);
      }
      difference = lower.solve(difference).eval();
      difference = lower.solve(difference.adjoint().eval()).adjoint().eval();
      const ComplexMatrix derivative = halves[g] + halves[g].adjoint();
      EXPECT_LT((derivative - difference).norm(), 1e-5 * difference.norm())
          << transfer.groups()[g].name << ", " << areas << " areas";
    }
  }
}

}  // namespace
}  // namespace pinode
