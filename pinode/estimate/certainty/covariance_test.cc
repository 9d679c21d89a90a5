#include "pinode/estimate/certainty/covariance.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/integrate/free_run.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// A two-DOF chain with two stiffness groups from a free start.
class CovarianceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 80, 0.05);
    record.channels = {
        testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0),
        testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1)};
    start_ = Vector::LinSpaced(4, -0.1, 0.2);
    states_ = testing::Simulate(*dynamics, Eigen::Vector2d(0.1, -0.05), start_,
                                0.05, 3, &record);
    record.start = IdentificationRecord::Start::kFree;
    problem_.records.push_back(record);
    problem_.dynamics = dynamics;
    sigma_ = Eigen::Vector2d(0.01, 0.1);
    free_ = Eigen::Vector2d(0.1, -0.05);
  }

  CovarianceEstimate Estimate(IdentificationOptions::Covariance choice) {
    const ParameterLayout layout(problem_);
    Objective objective(problem_, layout, MultipleShooting::Options());
    MultipleShooting& shooting = objective.shooting();
    SetSegments(0, {states_}, &shooting);
    shooting.SetSigmas({sigma_});
    shooting.SetStateScales({Vector::Constant(states_.rows(), 0.2)});
    CovarianceEstimate estimate;
    EXPECT_TRUE(EstimateCovariance(problem_, layout, choice, free_, {sigma_},
                                   &objective, &estimate));
    start_ = shooting.starts()[0].col(0);
    return estimate;
  }

  IdentificationProblem problem_;
  Vector start_, sigma_, free_;
  Matrix states_;
};

// All residuals of a free run in the open, for differences by Ceres.
struct FreeRunResiduals {
  bool operator()(double const* const* parameters, double* residuals) const {
    const StructuralDynamics& dynamics = *problem->dynamics;
    const IdentificationRecord& record = problem->records[0];
    StructuralDynamics::Prepared prepared;
    std::string error;
    const Vector theta = Eigen::Map<const Vector>(parameters[0], 2);
    const Vector start = Eigen::Map<const Vector>(parameters[1], 4);
    if (!dynamics.Prepare(theta, &prepared, &error)) return false;
    const ObservationMap observation(
        dynamics,
        {record.channels[0].observation, record.channels[1].observation});
    Trajectory trajectory;
    if (!FreeRun(dynamics, prepared, observation,
                 IntegrationGrid(*record.excitation, record.substeps), start, 0,
                 record.num_samples() - 1, &trajectory)) {
      return false;
    }
    int row = 0;
    for (int i = 0; i < record.num_samples(); ++i) {
      for (int c = 0; c < 2; ++c) {
        residuals[row++] = (trajectory.channels(c, i) -
                            record.channels[static_cast<size_t>(c)].values[i]) /
                           (*sigma)[c];
      }
    }
    // The weak prior on a free start.
    for (int k = 0; k < 4; ++k) residuals[row++] = 1e-2 * start[k] / 0.2;
    return true;
  }
  const IdentificationProblem* problem;
  const Vector* sigma;
};

TEST_F(CovarianceTest, PlainEqualsThatOfCeres) {
  const CovarianceEstimate estimate =
      Estimate(IdentificationOptions::Covariance::kPlain);
  EXPECT_EQ(estimate.method, "plain");
  EXPECT_EQ(estimate.null_space.cols(), 0);

  auto* cost = new ceres::DynamicNumericDiffCostFunction<FreeRunResiduals,
                                                         ceres::RIDDERS>(
      new FreeRunResiduals{&problem_, &sigma_});
  cost->AddParameterBlock(2);
  cost->AddParameterBlock(4);
  cost->SetNumResiduals(2 * 80 + 4);
  Vector theta = free_;
  Vector start = start_;
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(cost, nullptr, theta.data(), start.data());
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  ASSERT_TRUE(covariance.Compute(
      std::vector<std::pair<const double*, const double*>>{
          {theta.data(), theta.data()}},
      &ceres_problem));
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> expected;
  ASSERT_TRUE(covariance.GetCovarianceBlock(theta.data(), theta.data(),
                                            expected.data()));
  EXPECT_LT((estimate.covariance - expected).norm(), 1e-6 * expected.norm());
}

TEST_F(CovarianceTest, PriorsCount) {
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  const Matrix without =
      Estimate(IdentificationOptions::Covariance::kPlain).covariance;
  // A prior of the size of the data's own deviation halves the variance along
  // its axis; the correlation is what the formula of a product of normals says.
  IdentificationProblem& problem = problem_;
  auto changed = std::make_shared<StructuralDynamics>(
      testing::MakeChain(2, 30.0, 0.3), dynamics->inputs());
  std::string error;
  for (GroupTerm group : dynamics->groups()) {
    if (group.group.name == "k1") {
      group.alpha.prior_mean = 0.1;
      group.alpha.prior_sigma = std::sqrt(without(0, 0));
    }
    ASSERT_TRUE(changed->AddGroup(group, &error)) << error;
  }
  problem.dynamics = changed;
  const Matrix with =
      Estimate(IdentificationOptions::Covariance::kPlain).covariance;
  Matrix precision = without.inverse();
  precision(0, 0) += 1.0 / without(0, 0);
  const Matrix expected = precision.inverse();
  EXPECT_LT((with - expected).norm(), 1e-8 * expected.norm());
  EXPECT_NEAR(with(0, 0), 0.5 * without(0, 0), 1e-8 * without(0, 0));
}

// White residuals: both estimators mean the same; noise with a memory of ten
// samples makes the plain one too small by about that much.
TEST_F(CovarianceTest, SandwichSeesAutocorrelation) {
  IdentificationRecord& record = problem_.records[0];
  for (double memory : {0.0, 0.9}) {
    const int samples = 4000;
    IdentificationRecord longer =
        testing::MakeExcitedRecord(*problem_.dynamics, samples, 0.05);
    longer.channels = record.channels;
    states_ = testing::Simulate(*problem_.dynamics, free_, Vector::Zero(4), 0.0,
                                3, &longer);
    testing::Gaussian random(11);
    for (int c = 0; c < 2; ++c) {
      double noise = 0.0;
      for (int i = 0; i < samples; ++i) {
        noise =
            memory * noise + std::sqrt(1.0 - memory * memory) * random.Next();
        longer.channels[static_cast<size_t>(c)].values[i] += sigma_[c] * noise;
      }
    }
    record = longer;
    const Matrix plain =
        Estimate(IdentificationOptions::Covariance::kPlain).covariance;
    const CovarianceEstimate sandwich =
        Estimate(IdentificationOptions::Covariance::kSandwich);
    EXPECT_EQ(sandwich.method, "sandwich");
    EXPECT_GT(sandwich.quantile, 1.96);
    EXPECT_LT(sandwich.quantile, 2.25);
    const CovarianceEstimate automatic =
        Estimate(IdentificationOptions::Covariance::kAuto);
    const double ratio = sandwich.covariance.trace() / plain.trace();
    if (memory == 0.0) {
      EXPECT_GT(ratio, 0.6);
      EXPECT_LT(ratio, 1.6);
      EXPECT_EQ(automatic.method, "plain");
    } else {
      EXPECT_GT(ratio, 1.8);
      EXPECT_EQ(automatic.method, "sandwich");
    }
  }
}

// The free decay of one mass knows stiffness over mass to 1e-4. Priors alone
// know a common factor: it moves both along d = 1 + alpha, with the covariance
// d d' / d'd. A sandwich that is not symmetric loses its positive definiteness.
TEST_F(CovarianceTest, SandwichOfWhatPriorsAloneTellApart) {
  const Matrix one = Matrix::Identity(1, 1);
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(one, 0.0 * one, 30.0 * one),
      std::vector<InputSpec>());
  for (const bool is_mass : {false, true}) {
    GroupTerm term;
    term.group.name = is_mass ? "m" : "k";
    if (is_mass) term.group.target = MatrixGroup::Target::kMass;
    term.group.matrix = is_mass ? one : Matrix(30.0 * one);
    term.alpha.name = term.group.name;
    term.alpha.free = true;
    term.alpha.prior_sigma = 1.0;
    std::string error;
    ASSERT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  problem_.dynamics = dynamics;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 200, 0.05);
  record.channels = {
      testing::MakeChannel("a", Quantity::kAbsoluteAcceleration, 1, 0)};
  record.start = IdentificationRecord::Start::kFree;
  start_ = Eigen::Vector2d(0.1, 0.2);
  free_ = Eigen::Vector2d(0.1, -0.05);
  sigma_ = Vector::Constant(1, 0.05);
  states_ = testing::Simulate(*dynamics, free_, start_, 0.0, 3, &record);
  testing::Gaussian random(11);
  double noise = 0.0;
  for (double& value : record.channels[0].values) {
    noise = 0.9 * noise + std::sqrt(1.0 - 0.81) * random.Next();
    value += sigma_[0] * noise;
  }
  problem_.records = {record};
  const Matrix covariance =
      Estimate(IdentificationOptions::Covariance::kSandwich).covariance;
  EXPECT_EQ(covariance, covariance.transpose());
  EXPECT_EQ(covariance.llt().info(), Eigen::Success);
  const Vector d = free_ + Vector::Ones(2);
  EXPECT_LT((covariance - d * d.transpose() / d.squaredNorm()).norm(), 1e-4);
  // Stiffness over mass.
  const Vector ratio = Eigen::Vector2d(1.0 / d[0], -1.0 / d[1]);
  const double variance = ratio.dot(covariance * ratio);
  EXPECT_GT(variance, 1e-10);
  EXPECT_LT(variance, 1e-6);
}

TEST_F(CovarianceTest, NoisyInputsAreRecognised) {
  problem_.records[0].input_sigma = Vector::Constant(1, 0.05);
  const Matrix plain =
      Estimate(IdentificationOptions::Covariance::kPlain).covariance;
  const CovarianceEstimate automatic =
      Estimate(IdentificationOptions::Covariance::kAuto);
  EXPECT_EQ(automatic.method, "input noise");
  problem_.records[0].input_sigma *= 3.0;
  const CovarianceEstimate noisier =
      Estimate(IdentificationOptions::Covariance::kAuto);
  EXPECT_GT(noisier.covariance.trace(), automatic.covariance.trace());
  EXPECT_GT(noisier.covariance.trace(), plain.trace());
}

// The same spring twice: only the sum of the two changes is determined.
TEST_F(CovarianceTest, FindsTheNullSpace) {
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  GroupTerm twin = dynamics->groups()[0];
  twin.group.name = twin.alpha.name = "twin";
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(twin, &error)) << error;
  problem_.dynamics = dynamics;
  free_ = Eigen::Vector3d(0.1, -0.05, 0.0);
  const CovarianceEstimate estimate =
      Estimate(IdentificationOptions::Covariance::kPlain);
  ASSERT_EQ(estimate.null_space.cols(), 1);
  const Vector direction = estimate.null_space.col(0);
  EXPECT_NEAR(std::abs(direction[0]), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(direction[0], -direction[2], 1e-6);
  EXPECT_NEAR(direction[1], 0.0, 1e-6);
  EXPECT_GT(estimate.covariance(0, 0), 1e6 * estimate.covariance(1, 1));
}

// The eigenvalues are 2 and `least`, with vectors (1, 1) and (1, -1).
Matrix PairWith(double least) {
  Matrix pair(2, 2);
  pair << 1.0, 1.0 - least, 1.0 - least, 1.0;
  return pair;
}

TEST(FactorizeInformation, LeavesOpenWhatRoundingLeavesOfADirection) {
  const Eigen::Vector2d along(1.0, 1.0);
  const Eigen::Vector2d across(1.0, -1.0);
  for (const double least : {1e-3, 1e-14, 0.0, -1e-12, -1e-7}) {
    Matrix lower;
    ASSERT_TRUE(FactorizeInformation(PairWith(least), &lower)) << least;
    const auto solver = lower.triangularView<Eigen::Lower>();
    EXPECT_NEAR(solver.solve(along).norm(), 1.0, 1e-3) << least;
    const double deviation = std::sqrt(2.0 / std::max(least, 1e-10));
    if (least > 0.0) {
      EXPECT_NEAR(solver.solve(across).norm(), deviation, 1e-3 * deviation);
    } else {
      EXPECT_GT(solver.solve(across).norm(), 1e3) << least;
    }
  }
}

TEST(FactorizeInformation, RefusesWhatIsNoInformation) {
  Matrix lower = Matrix::Ones(1, 1);
  EXPECT_FALSE(FactorizeInformation(PairWith(-2.0), &lower));
  EXPECT_FALSE(FactorizeInformation(PairWith(std::nan("")), &lower));
  EXPECT_EQ(lower.size(), 1);
}

}  // namespace
}  // namespace pinode
