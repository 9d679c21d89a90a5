#include "pinode/estimate/shooting/linear_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// A chain of four with sensors of every kind that a LinearRecord takes: gain
// and offset free or fixed, one channel that is not fitted, one that misses
// samples.
struct LinearFit {
  LinearFit(IdentificationRecord::Start start, int samples) {
    auto chain = testing::MakeGroupedChain(4, 40.0, 0.4);
    problem.dynamics = chain;
    IdentificationRecord record =
        testing::MakeExcitedRecord(*chain, samples, 0.02);
    record.name = "record";
    record.substeps = 2;
    record.start = start;
    const Quantity quantities[] = {Quantity::kDisplacement, Quantity::kVelocity,
                                   Quantity::kAbsoluteAcceleration,
                                   Quantity::kRelativeAcceleration};
    for (int c = 0; c < 4; ++c) {
      record.channels.push_back(
          testing::MakeChannel("c" + std::to_string(c), quantities[c], 4, c));
    }
    truth = Eigen::Vector4d(0.1, -0.2, 0.15, 0.05);
    Vector first = Vector::Zero(8);
    if (start != IdentificationRecord::Start::kRest) {
      first = Vector::LinSpaced(8, -0.4, 0.5);
      record.known_start = first;
    }
    trajectory = testing::Simulate(*chain, truth, first, 0.05, 7, &record);
    record.channels[0].gain = 0;
    record.channels[1].offset = 1;
    record.channels[3].gain = 2;
    for (int i = 5; i < 40; ++i) record.channels[2].values[i] = kMissing;
    problem.records.push_back(record);
    for (const char* name : {"gain", "offset", "fixed gain"}) {
      Parameter parameter;
      parameter.name = name;
      parameter.value = std::string(name) == "offset" ? 0.1 : 1.2;
      parameter.free = std::string(name) != "fixed gain";
      problem.sensors.parameters.push_back(parameter);
    }
  }

  // The same cost with and without LinearRecord, which a robust loss does not
  // take, however far its outliers begin.
  std::unique_ptr<MultipleShooting> Shoot(bool linear, int threads) {
    if (layout == nullptr) layout = std::make_unique<ParameterLayout>(problem);
    MultipleShooting::Options options;
    options.num_threads = threads;
    if (!linear) {
      options.loss = RobustLoss::kHuber;
      options.loss_scale = 1e9;
    }
    auto shooting =
        std::make_unique<MultipleShooting>(problem, *layout, options);
    shooting->SetStateScales({Vector::Constant(8, 0.3)});
    shooting->SetSigmas({Vector::LinSpaced(
        static_cast<int>(problem.records[0].channels.size()), 0.1, 0.7)});
    SetSegments(0, {trajectory}, shooting.get());
    return shooting;
  }

  IdentificationProblem problem;
  std::unique_ptr<ParameterLayout> layout;
  Vector truth;
  Matrix trajectory;
};

class LinearRecordTest
    : public ::testing::TestWithParam<IdentificationRecord::Start> {};

void ExpectNear(const Matrix& a, const Matrix& b, double limit) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_LE((a - b).norm(), limit * b.norm());
}

TEST_P(LinearRecordTest, EqualsWhatIsPropagatedStepByStep) {
  // Few channels: rows are cheaper than the Gram matrix, and the other way
  // round where channels are many.
  for (const int copies : {0, 40}) {
    LinearFit fit(GetParam(), 300);
    IdentificationRecord& record = fit.problem.records[0];
    record.channels[1].fit = false;
    for (int k = 0; k < copies; ++k) {
      const MeasuredChannel copy = record.channels[static_cast<size_t>(k % 4)];
      record.channels.push_back(copy);
    }
    auto linear = fit.Shoot(true, 1);
    auto stepped = fit.Shoot(false, 1);
    const Vector free = 0.9 * fit.layout->Free(fit.layout->InitialValues()) +
                        Vector::Constant(fit.layout->num_free(), 0.03);
    CondensedSystem a, b;
    ASSERT_TRUE(linear->Linearize(free, &a));
    ASSERT_TRUE(stepped->Linearize(free, &b));
    EXPECT_NEAR(a.cost, b.cost, 1e-11 * b.cost);
    ExpectNear(a.gradient, b.gradient, 1e-10);
    ExpectNear(a.hessian, b.hessian, 1e-10);
    testing::ReportFigure("Gram of modal histories against rows",
                          testing::AtMost(1e-10),
                          (a.hessian - b.hessian).norm() / b.hessian.norm());
    ExpectNear(linear->starts()[0], stepped->starts()[0], 1e-9);

    std::vector<Matrix> residuals, jacobians, other_residuals, other_jacobians;
    ASSERT_TRUE(
        WeightedResiduals(free, true, linear.get(), &residuals, &jacobians));
    ASSERT_TRUE(WeightedResiduals(free, true, stepped.get(), &other_residuals,
                                  &other_jacobians));
    ExpectNear(residuals[0], other_residuals[0], 1e-10);
    ExpectNear(jacobians[0], other_jacobians[0], 1e-9);
    EXPECT_TRUE(residuals[0].row(1).isZero(0.0));
    EXPECT_EQ(residuals[0](2, 10), 0.0);
    ASSERT_TRUE(WeightedResiduals(free, false, linear.get(), &other_residuals,
                                  nullptr));
    ExpectNear(other_residuals[0], residuals[0], 1e-13);
  }
}

// What is found without a look at each sample's derivatives, against these.
TEST_P(LinearRecordTest, EqualsSumsOverTheJacobian) {
  LinearFit fit(GetParam(), 9000);
  fit.problem.records[0].channels[1].fit = false;
  for (const int threads : {1, 3}) {
    auto shooting = fit.Shoot(true, threads);
    const Vector free = fit.layout->Free(fit.layout->InitialValues());
    const int nf = fit.layout->num_free();
    CondensedSystem system;
    ASSERT_TRUE(shooting->Linearize(free, &system));
    ASSERT_TRUE(shooting->sweep().IsByModes());
    const Matrix information = ResidualInformation(*shooting);
    ASSERT_NE(shooting->state().SquaresAt(free), nullptr);
    const Vector squares = (*shooting->state().SquaresAt(free))[0];
    EXPECT_EQ(shooting->state().SquaresAt(1.01 * free), nullptr);
    std::vector<Matrix> residuals, jacobians, moved;
    ASSERT_TRUE(
        WeightedResiduals(free, true, shooting.get(), &residuals, &jacobians));
    const Matrix& rows = jacobians[0];
    ExpectNear(information, rows.transpose() * rows, 1e-10);
    const Vector sigmas = Vector::LinSpaced(4, 0.1, 0.7);
    ExpectNear(
        squares,
        residuals[0].rowwise().squaredNorm().cwiseProduct(sigmas.cwiseAbs2()),
        1e-11);

    const Vector step = Vector::LinSpaced(nf, -0.02, 0.03);
    ASSERT_TRUE(MovedResiduals(*shooting, free, step, &moved));
    const Vector expected = residuals[0].reshaped() + rows * step;
    ExpectNear(moved[0], expected.reshaped(4, 9000), 1e-10);

    // Blocks that end inside pieces, and one that is longer than them.
    for (const int length : {5, 37, 5000}) {
      Matrix products = Matrix::Zero(nf, nf);
      double count = 0.0;
      ASSERT_TRUE(AddScores(*shooting, free, {length}, &products, &count));
      Matrix sum = Matrix::Zero(nf, nf);
      int blocks = 0;
      for (int first = 0; first < 9000; first += length, ++blocks) {
        const int n = std::min(length, 9000 - first);
        const Vector score = rows.middleRows(4 * first, 4 * n).transpose() *
                             residuals[0].middleCols(first, n).reshaped();
        sum += score * score.transpose();
      }
      EXPECT_EQ(count, blocks);
      ExpectNear(Matrix(products.selfadjointView<Eigen::Lower>()), sum, 1e-9);
    }
  }
}

// Records longer than what one thread sums at a time: the same bits.
TEST_P(LinearRecordTest, ThreadsShareOneRecord) {
  LinearFit fit(GetParam(), 20000);
  auto one = fit.Shoot(true, 1);
  auto three = fit.Shoot(true, 3);
  const Vector free = fit.layout->Free(fit.layout->InitialValues());
  CondensedSystem a, b;
  ASSERT_TRUE(one->Linearize(free, &a));
  ASSERT_TRUE(three->Linearize(free, &b));
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.gradient, b.gradient);
  EXPECT_EQ(a.hessian, b.hessian);
}

// At the same point, with other noise: what has been summed serves again.
TEST_P(LinearRecordTest, NewNoiseIsWeighedAnew) {
  LinearFit fit(GetParam(), 300);
  auto again = fit.Shoot(true, 1);
  auto anew = fit.Shoot(true, 1);
  const Vector free = fit.layout->Free(fit.layout->InitialValues());
  CondensedSystem a, b;
  ASSERT_TRUE(again->Linearize(free, &a));
  const std::vector<Vector> sigmas = {Eigen::Vector4d(0.01, 0.3, 0.05, 2.0)};
  again->SetSigmas(sigmas);
  anew->SetSigmas(sigmas);
  ASSERT_TRUE(again->Linearize(free, &a));
  ASSERT_TRUE(anew->Linearize(free, &b));
  EXPECT_NEAR(a.cost, b.cost, 1e-11 * b.cost);
  ExpectNear(a.gradient, b.gradient, 1e-10);
  ExpectNear(a.hessian, b.hessian, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Starts, LinearRecordTest,
                         ::testing::Values(IdentificationRecord::Start::kRest,
                                           IdentificationRecord::Start::kKnown,
                                           IdentificationRecord::Start::kFree));

TEST(LinearRecord, IsNotForEverything) {
  LinearFit fit(IdentificationRecord::Start::kRest, 100);
  const ParameterLayout layout(fit.problem);
  const auto create = [&](RobustLoss loss) {
    const IdentificationRecord& record = fit.problem.records[0];
    const IntegrationGrid grid(*record.excitation, 2);
    const ObservationMap observation(*fit.problem.dynamics,
                                     record.Observations());
    return LinearRecord::Create(fit.problem, layout, record, grid, observation,
                                loss) != nullptr;
  };
  EXPECT_TRUE(create(RobustLoss::kNone));
  EXPECT_FALSE(create(RobustLoss::kHuber));
  fit.problem.records[0].channels[0].delay = 1;
  EXPECT_FALSE(create(RobustLoss::kNone));
}

}  // namespace
}  // namespace pinode
