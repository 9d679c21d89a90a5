// Identification from measured modes, alone and beside a record.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/structure/model/modal_analysis.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

ModalProperties ModesAt(const StructuralDynamics& dynamics,
                        const Vector& theta) {
  const StructuralModel model = dynamics.CorrectedModel(theta);
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  return modes;
}

// The first `count` modes of the dynamics at `theta`, at these DOFs, if any.
std::vector<MeasuredMode> Measure(const StructuralDynamics& dynamics,
                                  const Vector& theta, int count,
                                  const std::vector<int>& dofs) {
  const ModalProperties modes = ModesAt(dynamics, theta);
  std::vector<MeasuredMode> measured;
  for (int j = 0; j < count; ++j) {
    MeasuredMode mode;
    mode.name = std::to_string(j + 1);
    mode.frequency = modes.frequency_hz[j];
    if (!dofs.empty()) {
      mode.dofs = dofs;
      mode.shape = modes.mode_shapes(dofs, j);
      mode.shape /= mode.shape.cwiseAbs().maxCoeff();
    }
    measured.push_back(mode);
  }
  return measured;
}

struct ModalFit {
  void Run(const IdentificationOptions& options = {}) {
    testing::FitAndJudge(problem, options, nullptr, &summary, &model);
  }
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
};

class ModalForms : public ::testing::TestWithParam<ModalForm> {};

TEST_P(ModalForms, FindTheChainThatTheModesBelongTo) {
  ModalFit fit;
  const auto dynamics = testing::MakeGroupedChain(5, 40.0, 0.1);
  Vector truth(5);
  truth << -0.3, 0.2, 0.1, -0.15, 0.25;
  fit.problem.dynamics = dynamics;
  fit.problem.modal.form = GetParam();
  fit.problem.modal.modes = Measure(*dynamics, truth, 5, {0, 1, 3, 4});
  fit.Run();
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  EXPECT_LT((fit.model.parameters - truth).cwiseAbs().maxCoeff(), 1e-8);
  ASSERT_EQ(fit.summary.modes.size(), 5u);
  const ModalProperties before = ModesAt(*dynamics, Vector::Zero(5));
  for (int j = 0; j < 5; ++j) {
    const ModeScore& mode = fit.summary.modes[static_cast<size_t>(j)];
    EXPECT_NEAR(mode.updated.frequency, mode.frequency, 1e-8);
    EXPECT_NEAR(mode.updated.mac, 1.0, 1e-12);
    EXPECT_EQ(mode.initial.mode, j);
    EXPECT_EQ(mode.initial.frequency, before.frequency_hz[j]);
    EXPECT_LT(mode.initial.mac, 1.0 - 1e-4);
  }
  EXPECT_LT(fit.summary.final_modal_cost, 1e-16);
  EXPECT_GT(fit.summary.initial_modal_cost, 1e-3);
  // MACs have no sign.
  if (GetParam() == ModalForm::kMac) {
    EXPECT_EQ(fit.summary.covariance.size(), 0);
    ASSERT_EQ(fit.summary.remarks.size(), 1u);
    EXPECT_THAT(fit.summary.remarks[0], HasSubstr("no intervals"));
  } else {
    EXPECT_GT(fit.summary.covariance.size(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ModalForms,
                         ::testing::Values(ModalForm::kMac,
                                           ModalForm::kEigenvectorDifference,
                                           ModalForm::kDynamicResidual),
                         [](const auto& form) {
                           return std::string(ModalFormName(form.param));
                         });

// Two modes of a chain whose truth lies beyond its bounds: from wherever a fit
// begins it comes to the same corner.
TEST(ModalIdentify, DoesNotStallAtBounds) {
  constexpr int kStoreys = 10;
  const auto free = testing::MakeGroupedChain(kStoreys, 40.0, 0.0);
  const auto dynamics =
      std::make_shared<StructuralDynamics>(free->model(), free->inputs());
  std::string error;
  for (GroupTerm term : free->groups()) {
    term.alpha.lower = -0.3;
    term.alpha.upper = 0.3;
    ASSERT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  Vector truth(kStoreys);
  for (int j = 0; j < kStoreys; ++j) truth[j] = 0.7 * std::sin(2.0 * j + 1.0);
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  fit.problem.modal.form = ModalForm::kEigenvectorDifference;
  fit.problem.modal.modes = Measure(*free, truth, 2, {2, 5, 9});
  IdentificationOptions options;
  options.num_starts = 40;
  fit.Run(options);
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  EXPECT_GE(fit.summary.num_starts_at_best, 38);
  EXPECT_LT(fit.summary.promised_share, 1e-6);
  EXPECT_GE(std::count_if(
                fit.summary.parameters.begin(), fit.summary.parameters.end(),
                [](const ParameterEstimate& p) { return p.at_bound; }),
            4);
}

// Errors of known size: the intervals are those of the estimates' scatter.
TEST(ModalIdentify, HasIntervalsThatCover) {
  const auto dynamics = testing::MakeGroupedChain(3, 40.0, 0.1);
  Vector truth(3);
  truth << -0.1, 0.2, 0.05;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  const auto exact = Measure(*dynamics, truth, 2, {0, 1, 2});
  const int trials = 300;
  double squares = 0.0;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    testing::Gaussian random(static_cast<uint64_t>(t) + 1);
    fit.problem.modal.modes = exact;
    for (MeasuredMode& mode : fit.problem.modal.modes) {
      mode.frequency_sigma = 0.002 * mode.frequency;
      mode.frequency += mode.frequency_sigma * random.Next();
      mode.shape_sigma = 0.01;
      mode.shape += mode.shape_sigma * random.Draw(3);
    }
    fit.Run();
    ASSERT_EQ(fit.summary.covariance_method, "plain");
    const Vector error = fit.model.parameters - truth;
    squares += error.dot(fit.summary.covariance.ldlt().solve(error));
    for (size_t j = 0; j < 3; ++j) {
      const ParameterEstimate& p = fit.summary.parameters[j];
      covered += p.lower95 < truth[static_cast<int>(j)] &&
                 truth[static_cast<int>(j)] < p.upper95;
    }
  }
  // Chi squared of 3 a trial; four of its standard deviations.
  EXPECT_NEAR(squares / trials, 3.0, 4.0 * std::sqrt(6.0 / trials));
  EXPECT_NEAR(covered / (3.0 * trials), 0.95, 0.03);
}

// A pole of the wind that looks like the first mode, far below it: held against
// that, it would move the mode that is there to the second one, and so on.
TEST(ModalIdentify, LeavesOutWhatTheModelHasNoModeFor) {
  const auto dynamics = testing::MakeGroupedChain(5, 40.0, 0.1);
  Vector truth(5);
  truth << -0.1, 0.1, 0.05, -0.15, 0.1;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  auto& modes = fit.problem.modal.modes;
  modes = Measure(*dynamics, truth, 4, {0, 1, 3, 4});
  modes.insert(modes.begin(), modes.front());
  modes[0].name = "wind";
  modes[0].frequency *= 0.3;
  modes[0].shape[1] += 0.2;
  for (MeasuredMode& mode : modes) {
    mode.frequency_sigma = 0.001 * mode.frequency;
    mode.shape_sigma = 0.01;
  }
  fit.Run();
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  EXPECT_LT((fit.model.parameters - truth).cwiseAbs().maxCoeff(), 1e-6);
  ASSERT_EQ(fit.summary.modes.size(), 5u);
  EXPECT_FALSE(fit.summary.modes[0].InUse());
  EXPECT_TRUE(std::isnan(fit.summary.modes[0].updated.frequency));
  for (int j = 1; j < 5; ++j) {
    EXPECT_EQ(fit.summary.modes[static_cast<size_t>(j)].updated.mode, j - 1);
  }
  ASSERT_EQ(fit.summary.remarks.size(), 1u);
  EXPECT_THAT(fit.summary.remarks[0], HasSubstr("does not use 'wind'"));
}

// As many frequencies as storeys fit several structures.
TEST(ModalIdentify, NamesAnotherStructureOfTheSameFrequencies) {
  const auto dynamics = testing::MakeGroupedChain(4, 40.0, 0.1);
  Vector truth(4);
  truth << -0.29, -0.19, -0.09, 0.48;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  fit.problem.modal.modes = Measure(*dynamics, truth, 4, {});
  for (MeasuredMode& mode : fit.problem.modal.modes) {
    mode.frequency_sigma = 0.002 * mode.frequency;
  }
  IdentificationOptions options;
  options.num_starts = 20;
  fit.Run(options);
  EXPECT_LT(fit.summary.final_modal_cost, 1e-9);
  const std::vector<Finding> doubts = CheckDoubts(fit.summary);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(doubts[0].check, "other_solution");
  EXPECT_EQ(doubts[0].grade, Grade::kWithCare);
  EXPECT_THAT(doubts[0].what, HasSubstr("another solution describes"));
  // Shapes tell which it is.
  fit.problem.modal.modes = Measure(*dynamics, truth, 4, {0, 1, 2, 3});
  for (MeasuredMode& mode : fit.problem.modal.modes) {
    mode.frequency_sigma = 0.002 * mode.frequency;
    mode.shape_sigma = 0.01;
  }
  fit.Run(options);
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  EXPECT_TRUE(CheckDoubts(fit.summary).empty());
}

// Deviations of a fifth of what the modes are off by: what is left over says
// so, and the intervals cover.
TEST(ModalIdentify, WidensIntervalsWhereModesAreNotMet) {
  const auto dynamics = testing::MakeGroupedChain(3, 40.0, 0.1);
  Vector truth(3);
  truth << -0.1, 0.2, 0.05;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  const auto exact = Measure(*dynamics, truth, 3, {0, 1, 2});
  const int trials = 300;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    testing::Gaussian random(static_cast<uint64_t>(t) + 1);
    fit.problem.modal.modes = exact;
    for (MeasuredMode& mode : fit.problem.modal.modes) {
      mode.frequency_sigma = 0.0004 * mode.frequency;
      mode.frequency += 5.0 * mode.frequency_sigma * random.Next();
      mode.shape_sigma = 0.002;
      mode.shape += 5.0 * mode.shape_sigma * random.Draw(3);
    }
    fit.Run();
    ASSERT_EQ(fit.summary.remarks.size(), 1u);
    EXPECT_THAT(fit.summary.remarks[0], HasSubstr("are larger than their"));
    for (size_t j = 0; j < 3; ++j) {
      const ParameterEstimate& p = fit.summary.parameters[j];
      covered += p.lower95 < truth[static_cast<int>(j)] &&
                 truth[static_cast<int>(j)] < p.upper95;
    }
  }
  EXPECT_NEAR(covered / (3.0 * trials), 0.95, 0.03);
}

// Residuals of the modes do not change a prior.
TEST(ModalIdentify, LeavesPriorsAsTheyAre) {
  const auto chain = testing::MakeGroupedChain(3, 40.0, 0.1);
  auto dynamics =
      std::make_shared<StructuralDynamics>(chain->model(), chain->inputs());
  std::string error;
  for (size_t j = 0; j < 2; ++j) {
    ASSERT_TRUE(dynamics->AddGroup(chain->groups()[j], &error)) << error;
  }
  // Modes are undamped: none sees it.
  GroupTerm unseen = chain->groups()[2];
  unseen.group.target = MatrixGroup::Target::kDamping;
  unseen.alpha.prior_sigma = 0.05;
  ASSERT_TRUE(dynamics->AddGroup(unseen, &error)) << error;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  fit.problem.modal.modes = Measure(*chain, Vector::Zero(3), 3, {0, 1, 2});
  testing::Gaussian random(4);
  for (MeasuredMode& mode : fit.problem.modal.modes) {
    mode.frequency_sigma = 0.0001 * mode.frequency;
    mode.frequency *= 1.0 + 0.01 * random.Next();
    mode.shape_sigma = 0.001;
    mode.shape += 0.05 * random.Draw(3);
  }
  fit.Run();
  ASSERT_EQ(fit.summary.remarks.size(), 1u);
  EXPECT_THAT(fit.summary.remarks[0], HasSubstr("are larger than their"));
  EXPECT_NEAR(fit.summary.parameters[2].sigma, 0.05, 1e-6);
  EXPECT_GT(fit.summary.parameters[0].sigma, 0.003);
}

// With weights alone the residuals say how large the errors are: Student's
// intervals, which cover as well.
TEST(ModalIdentify, EstimatesTheErrorsOfWeightedModes) {
  const auto dynamics = testing::MakeGroupedChain(3, 40.0, 0.1);
  const Vector truth = Vector::Constant(3, 0.1);
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  std::vector<MeasuredMode> exact = Measure(*dynamics, truth, 3, {});
  const int trials = 400;
  // One unknown, three frequencies.
  auto one = std::make_shared<StructuralDynamics>(dynamics->model(),
                                                  dynamics->inputs());
  GroupTerm all = dynamics->groups()[0];
  all.group.matrix = dynamics->model().stiffness;
  std::string error;
  ASSERT_TRUE(one->AddGroup(all, &error)) << error;
  fit.problem.dynamics = one;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    testing::Gaussian random(static_cast<uint64_t>(t) + 1);
    fit.problem.modal.modes = exact;
    for (MeasuredMode& mode : fit.problem.modal.modes) {
      mode.frequency *= 1.0 + 0.003 * random.Next();
    }
    fit.Run();
    const ParameterEstimate& p = fit.summary.parameters[0];
    covered += p.lower95 < 0.1 && 0.1 < p.upper95;
    // alpha = mean of l / l0 - 1 weighed by 1 / l^2; two degrees of freedom.
    EXPECT_NEAR(p.upper95 - p.value, StudentQuantile(2.0) * p.sigma,
                1e-12 * p.sigma);
  }
  EXPECT_NEAR(covered / static_cast<double>(trials), 0.95, 0.04);

  // As many residuals as unknowns leave nothing to tell it by.
  fit.problem.modal.modes.resize(1);
  fit.Run();
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  EXPECT_TRUE(std::isinf(fit.summary.parameters[0].sigma));
}

TEST(ModalIdentify, KeepsTheBestOfManyStartsAndCountsThem) {
  const auto chain = testing::MakeGroupedChain(3, 40.0, 0.1);
  auto dynamics =
      std::make_shared<StructuralDynamics>(chain->model(), chain->inputs());
  std::string error;
  for (GroupTerm group : chain->groups()) {
    group.alpha.lower = -0.8;
    group.alpha.upper = 2.0;
    ASSERT_TRUE(dynamics->AddGroup(group, &error)) << error;
  }
  Vector truth(3);
  truth << -0.1, 0.2, 0.05;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  // Three frequencies alone: several chains have them.
  fit.problem.modal.modes = Measure(*dynamics, truth, 3, {0, 1, 2});
  for (MeasuredMode& mode : fit.problem.modal.modes) {
    mode.shape_weight = 1e-3;
    mode.shape[1] += 0.01;
  }
  IdentificationOptions options;
  options.num_starts = 12;
  fit.Run(options);
  EXPECT_EQ(fit.summary.num_starts, 12);
  EXPECT_GT(fit.summary.num_starts_at_best, 1);
  EXPECT_LT(fit.summary.num_starts_at_best, 12);
  EXPECT_LT((fit.model.parameters - truth).cwiseAbs().maxCoeff(), 0.05);
}

// Two springs in a row of which the record's sensor sees one combination: the
// modes and the record add up.
TEST(ModalIdentify, AddsToARecord) {
  const auto dynamics = testing::MakeGroupedChain(3, 40.0, 0.4);
  Vector truth(3);
  truth << 0.1, -0.1, 0.05;
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 300, 0.02);
  record.channels.push_back(
      testing::MakeChannel("a3", Quantity::kAbsoluteAcceleration, 3, 2));
  testing::Simulate(*dynamics, truth, Vector::Zero(6), 0.05, 1, &record);
  const double sigma =
      0.05 * std::sqrt(record.channels[0].values.squaredNorm() / 300.0);
  record.channels[0].sigma = sigma;
  record.start = IdentificationRecord::Start::kRest;
  fit.problem.records.push_back(record);
  IdentificationOptions options;
  options.num_starts = 1;  // a sensor alone has other solutions
  options.covariance = IdentificationOptions::Covariance::kPlain;
  fit.Run(options);
  ASSERT_TRUE(fit.summary.usable()) << fit.summary.message;
  const Matrix of_record = fit.summary.covariance.inverse();
  const Vector by_record = fit.model.parameters;

  ModalFit joint = fit;
  joint.problem.modal.modes = Measure(*dynamics, truth, 2, {0, 2});
  for (MeasuredMode& mode : joint.problem.modal.modes) {
    mode.frequency_sigma = 0.001 * mode.frequency;
    mode.shape_sigma = 0.005;
  }
  ModalFit modes = joint;
  modes.problem.records.clear();
  modes.Run();
  const Matrix of_modes = modes.summary.covariance.inverse();
  joint.Run(options);
  ASSERT_TRUE(joint.summary.usable()) << joint.summary.message;
  const Matrix sum = of_record + of_modes;
  const Matrix found = joint.summary.covariance.inverse();
  EXPECT_LT((found - sum).norm(), 0.1 * sum.norm());
  // Nearly linear: the estimate is the weighed mean.
  const Vector mean = sum.ldlt().solve(of_record * by_record +
                                       of_modes * modes.model.parameters);
  const Vector difference = joint.model.parameters - mean;
  EXPECT_LT(std::sqrt(difference.dot(sum * difference)), 0.1);
  // And neither alone would do.
  const Vector alone = by_record - mean;
  EXPECT_GT(std::sqrt(alone.dot(sum * alone)), 0.2);
}

TEST(ModalIdentify, IsPartOfTheCondensedSystem) {
  testing::SmallFit fit(IdentificationRecord::Start::kFree);
  const MultipleShooting::Options options;
  CondensedSystem without, with;
  ASSERT_TRUE(fit.Shoot(10, options)->Linearize(fit.free, &without));
  fit.problem.modal.modes = Measure(
      *fit.problem.dynamics, fit.problem.dynamics->Parameters(), 2, {0, 1});
  for (MeasuredMode& mode : fit.problem.modal.modes) {
    mode.frequency *= 1.1;
    mode.frequency_weight = 30.0;
    mode.shape[0] += 0.2;
  }
  const auto objective = fit.Shoot(10, options);
  ASSERT_TRUE(objective->Linearize(fit.free, &with));
  Vector all = fit.layout->InitialValues();
  fit.layout->SetFree(fit.free, &all);
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(fit.problem.dynamics->Prepare(
      all.head(fit.problem.dynamics->num_parameters()), &prepared, &error));
  Vector residuals;
  Matrix jacobian;
  ASSERT_TRUE(ModalCost(fit.problem.modal, *fit.problem.dynamics, *fit.layout)
                  .Evaluate(prepared, &residuals, &jacobian, &error))
      << error;
  const double cost = 0.5 * residuals.squaredNorm();
  EXPECT_GT(cost, 1.0);
  double modes = 0.0;
  ASSERT_TRUE(objective->modes()->Evaluate(fit.free, &modes));
  EXPECT_EQ(modes, cost);
  EXPECT_NEAR(with.cost - without.cost, cost, 1e-9 * with.cost);
  const Vector gradient = jacobian.transpose() * residuals;
  EXPECT_LT((with.gradient - without.gradient - gradient).norm(),
            1e-6 * gradient.norm());
  const Matrix information = jacobian.transpose() * jacobian;
  EXPECT_LT((with.hessian - without.hessian - information).norm(),
            1e-6 * information.norm());
}

// Rounding alone decides there if the cost falls.
TEST(ModalIdentify, AModelThatHasTheModesIsUsable) {
  const auto dynamics = testing::MakeGroupedChain(2, 40.0, 0.1);
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  fit.problem.modal.modes = Measure(*dynamics, Vector::Zero(2), 2, {0, 1});
  fit.Run();
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
}

TEST(ModalIdentify, SaysWhatIsWrong) {
  const auto dynamics = testing::MakeGroupedChain(2, 40.0, 0.1);
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  fit.Run();
  EXPECT_THAT(fit.summary.message, HasSubstr("no mode was measured"));

  fit.problem.modal.modes = Measure(*dynamics, Vector::Zero(2), 2, {0, 1});
  // Equal frequencies that the unknown spring mixes.
  auto equal = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                          Matrix::Identity(2, 2)),
      std::vector<InputSpec>{});
  GroupTerm spring;
  spring.group.name = "k";
  spring.group.matrix = SpringMatrix(2, 0, 1);
  std::string error;
  ASSERT_TRUE(equal->AddGroup(spring, &error));
  fit.problem.dynamics = equal;
  fit.Run();
  EXPECT_EQ(fit.summary.termination, Termination::kFailure);
  EXPECT_THAT(fit.summary.message, HasSubstr("same frequency"));
  ProblemAssessment assessment;
  EXPECT_FALSE(
      AssessProblem(fit.problem, IdentificationOptions(), &assessment, &error));
  EXPECT_THAT(error, HasSubstr("same frequency"));

  // A law, which modes cannot determine.
  ASSERT_TRUE(equal->AddLaw(
      testing::MakeElement("hardening", "cubic", 2, 0, 1, {1.0}), &error));
  EXPECT_FALSE(fit.problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("'hardening' cannot be free"));
}

TEST(ModalIdentify, IsAssessedBeforeTheFit) {
  const auto dynamics = testing::MakeGroupedChain(3, 40.0, 0.1);
  ModalFit fit;
  fit.problem.dynamics = dynamics;
  fit.problem.modal.modes =
      Measure(*dynamics, Vector::Constant(3, 0.1), 1, {0, 1, 2});
  fit.problem.modal.modes[0].frequency_sigma = 0.001;
  fit.problem.modal.modes[0].shape_sigma = 0.01;
  ProblemAssessment assessment;
  std::string error;
  ASSERT_TRUE(
      AssessProblem(fit.problem, IdentificationOptions(), &assessment, &error))
      << error;
  EXPECT_EQ(assessment.num_residuals, 3);
  EXPECT_TRUE(assessment.undetermined.empty());
  fit.Run();
  ASSERT_EQ(assessment.expected.size(), 3u);
  for (size_t j = 0; j < 3; ++j) {
    const double sigma = fit.summary.parameters[j].sigma;
    EXPECT_NEAR(assessment.expected[j].sigma, sigma, 0.3 * sigma);
  }

  // A frequency alone cannot tell the springs apart.
  fit.problem.modal.modes[0].dofs.clear();
  fit.problem.modal.modes[0].shape.resize(0);
  ASSERT_TRUE(
      AssessProblem(fit.problem, IdentificationOptions(), &assessment, &error));
  EXPECT_EQ(assessment.undetermined.size(), 2u);
}

}  // namespace
}  // namespace pinode
