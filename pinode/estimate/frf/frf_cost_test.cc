#include "pinode/estimate/frf/frf_cost.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/group_testing.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

using testing::MakeGroupTerm;

// Four masses with dampers that couple the modes, three responses of different
// quantities and two forces; gains, a delay and a loss factor.
struct FrfSetup4 {
  FrfSetup4() {
    auto dynamics = std::make_shared<StructuralDynamics>(
        testing::MakeChain(4, 30.0, 0.1), std::vector<InputSpec>{});
    std::string error;
    using Target = MatrixGroup::Target;
    const Matrix all = dynamics->model().damping;
    for (const GroupTerm& term :
         {MakeGroupTerm("k1", Target::kStiffness, 30.0 * SpringMatrix(4, -1, 0),
                        0.1),
          MakeGroupTerm("k3", Target::kStiffness, 30.0 * SpringMatrix(4, 1, 2),
                        -0.2),
          MakeGroupTerm("m2", Target::kMass,
                        Matrix(Vector::Unit(4, 1).asDiagonal()), 0.3),
          MakeGroupTerm("c", Target::kDamping, all, 0.4),
          MakeGroupTerm("c3", Target::kDamping, SpringMatrix(4, 2, 3), 0.2)}) {
      EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
    }
    problem.dynamics = dynamics;
    for (const auto& [name, value] :
         std::vector<std::pair<std::string, double>>{{"gain.a", 1.2},
                                                     {"gain.b", 0.8},
                                                     {"delay.b", 0.01},
                                                     {"loss_factor", 0.03}}) {
      Parameter parameter;
      parameter.name = name;
      parameter.value = value;
      problem.sensors.parameters.push_back(parameter);
    }
    FrfRecord record;
    record.name = "h";
    record.frequencies = Vector::LinSpaced(60, 0.1, 2.5);
    const Quantity quantities[] = {Quantity::kRelativeAcceleration,
                                   Quantity::kVelocity,
                                   Quantity::kDisplacement};
    for (int o = 0; o < 3; ++o) {
      Observation response;
      response.name = std::string(1, static_cast<char>('a' + o));
      response.quantity = quantities[o];
      response.weights = Vector::Unit(4, o);
      record.responses.push_back(response);
    }
    record.references = Matrix::Zero(4, 2);
    record.references(0, 0) = 1.0;
    record.references(3, 1) = -2.0;
    record.reference_names = {"p", "q"};
    record.gains = {0, 1, -1};
    record.delays = {-1, 2, -1};
    record.loss_factor = 3;
    record.values = ComplexMatrix::Ones(60, 6);
    problem.frfs = {record};
  }

  Vector Free() const {
    const ParameterLayout layout(problem);
    return layout.Free(layout.InitialValues());
  }

  // Replaces the measured values by those of the model, plus a known error.
  void Measure(double size) {
    const ParameterLayout layout(problem);
    FrfCost cost(problem.frfs[0], *problem.dynamics, layout, 1);
    double unused = 0.0;
    ASSERT_TRUE(cost.Evaluate(Free(), &unused)) << cost.Failure();
    ComplexMatrix values = cost.modelled();
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      values.reshaped()[i] += size * std::abs(values.reshaped()[i]) *
                              std::polar(1.0, 1.7 * static_cast<double>(i));
    }
    problem.frfs[0].values = values;
  }

  IdentificationProblem problem;
};

// The direct solution with complex matrices of the DOFs.
TEST(FrfTransferTest, AgreesWithDirectSolution) {
  const FrfSetup4 setup;
  const FrfRecord& record = setup.problem.frfs[0];
  const ParameterLayout layout(setup.problem);
  FrfTransfer transfer(record, *setup.problem.dynamics, layout);
  std::string error;
  ASSERT_TRUE(transfer.SetPoint(setup.Free(), &error)) << error;
  const StructuralModel model = setup.problem.dynamics->CorrectedModel(
      setup.problem.dynamics->Parameters());
  for (const Eigen::Index line : {0, 20, 59}) {
    const double w = kTwoPi * record.frequencies[line];
    const ComplexMatrix z =
        Complex(1.0, 0.03) * model.stiffness.cast<Complex>() +
        Complex(0.0, w) * model.damping.cast<Complex>() -
        w * w * model.mass.cast<Complex>();
    const ComplexMatrix motion =
        z.partialPivLu().solve(record.references.cast<Complex>());
    FrfTransfer::Line result;
    transfer.Compute(line, false, &result);
    const Complex factors[] = {
        1.2 * -w * w, 0.8 * Complex(0.0, w) * std::polar(1.0, -0.01 * w), 1.0};
    for (Eigen::Index p = 0; p < 6; ++p) {
      const Complex expected = factors[p % 3] * motion(p % 3, p / 3);
      EXPECT_LT(std::abs(result.values[p] - expected),
                1e-11 * std::abs(expected));
    }
  }
}

TEST(FrfTransferTest, DerivativesMatchRiddersDifferences) {
  const FrfSetup4 setup;
  const FrfRecord& record = setup.problem.frfs[0];
  const ParameterLayout layout(setup.problem);
  FrfTransfer transfer(record, *setup.problem.dynamics, layout);
  const Vector free = setup.Free();
  ASSERT_EQ(layout.num_free(), 9);
  ASSERT_EQ(transfer.columns().size(), 9u);
  std::string error;
  for (const Eigen::Index line : {5, 33}) {
    ASSERT_TRUE(transfer.SetPoint(free, &error)) << error;
    FrfTransfer::Line exact;
    transfer.Compute(line, true, &exact);
    for (size_t c = 0; c < transfer.columns().size(); ++c) {
      const auto values = [&](double step) {
        Vector moved = free;
        moved[transfer.columns()[c]] += step;
        EXPECT_TRUE(transfer.SetPoint(moved, &error)) << error;
        FrfTransfer::Line result;
        transfer.Compute(line, false, &result);
        Vector parts(12);
        parts << result.values.real(), result.values.imag();
        return parts;
      };
      const Vector differences = testing::Differentiate(values, 1e-3);
      Vector slopes(12);
      slopes << exact.slopes.col(static_cast<Eigen::Index>(c)).real(),
          exact.slopes.col(static_cast<Eigen::Index>(c)).imag();
      EXPECT_LT((slopes - differences).norm(), 1e-8 * slopes.norm())
          << layout.free_parameter(transfer.columns()[c]).name;
    }
  }
}

// Damping that does not couple the modes takes the short way, with the same
// result.
TEST(FrfTransferTest, ReciprocityWithAndWithoutCoupledModes) {
  for (const bool coupled : {false, true}) {
    FrfSetup4 setup;
    auto dynamics =
        std::make_shared<StructuralDynamics>(*setup.problem.dynamics);
    Vector theta = dynamics->Parameters();
    if (!coupled) theta.setZero();
    dynamics->SetParameters(theta);
    setup.problem.dynamics = dynamics;
    setup.problem.sensors.parameters.clear();
    FrfRecord& record = setup.problem.frfs[0];
    record.gains.clear();
    record.delays.clear();
    record.loss_factor = -1;
    for (Observation& response : record.responses) {
      response.quantity = Quantity::kVelocity;
    }
    record.references = Matrix::Identity(4, 2);
    const ParameterLayout layout(setup.problem);
    FrfTransfer transfer(record, *dynamics, layout);
    std::string error;
    ASSERT_TRUE(transfer.SetPoint(layout.Free(layout.InitialValues()), &error));
    FrfTransfer::Line result;
    transfer.Compute(17, true, &result);
    // Pair of response 1 and force 0, and the other way round.
    EXPECT_LT(std::abs(result.values[1] - result.values[3]), 1e-14);
    EXPECT_LT((result.slopes.row(1) - result.slopes.row(3)).norm(), 1e-13);
  }
}

TEST(FrfCostTest, GradientMatchesDifferences) {
  for (const bool known : {false, true}) {
    FrfSetup4 setup;
    setup.Measure(0.05);
    FrfRecord& record = setup.problem.frfs[0];
    record.values(4, 2) = Complex(kNaN, kNaN);
    record.variances = Matrix::Constant(60, 6, 2.0);
    record.variances.row(3).setConstant(0.5);
    if (known) record.sigma = Vector::Constant(6, 0.02);
    const ParameterLayout layout(setup.problem);
    FrfCost cost(record, *setup.problem.dynamics, layout, 2);
    Vector free = setup.Free();
    free.array() += 0.02;
    const auto value = [&](double step, Eigen::Index j) {
      Vector moved = free;
      moved[j] += step;
      double result = 0.0;
      EXPECT_TRUE(cost.Evaluate(moved, &result));
      return Vector::Constant(1, result);
    };
    CondensedSystem system;
    ASSERT_TRUE(cost.Linearize(free, &system));
    EXPECT_EQ(cost.num_residuals(), 2 * 359);
    for (Eigen::Index j = 0; j < free.size(); ++j) {
      const double slope = testing::Differentiate(
          [&](double step) { return value(step, j); }, 1e-3)[0];
      EXPECT_NEAR(system.gradient[j], slope, 1e-7 * system.gradient.norm());
    }
  }
}

TEST(FrfCostTest, ThreadsGiveTheSameBits) {
  FrfSetup4 setup;
  setup.Measure(0.05);
  const ParameterLayout layout(setup.problem);
  Vector free = setup.Free();
  free.array() += 0.02;
  CondensedSystem one, three;
  FrfCost first(setup.problem.frfs[0], *setup.problem.dynamics, layout, 1);
  FrfCost second(setup.problem.frfs[0], *setup.problem.dynamics, layout, 3);
  ASSERT_TRUE(first.Linearize(free, &one));
  ASSERT_TRUE(second.Linearize(free, &three));
  EXPECT_EQ(one.cost, three.cost);
  EXPECT_EQ(one.gradient, three.gradient);
  EXPECT_EQ(one.hessian, three.hessian);
}

}  // namespace
}  // namespace pinode
