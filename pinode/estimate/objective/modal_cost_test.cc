#include "pinode/estimate/objective/modal_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/group_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// A problem of modes alone, and its residuals at any value of the free
// parameters.
struct ModalSetup {
  explicit ModalSetup(std::shared_ptr<const StructuralDynamics> dynamics) {
    problem.dynamics = std::move(dynamics);
  }

  bool Evaluate(const Vector& free, Vector* residuals, Matrix* jacobian,
                std::string* error) const {
    const ParameterLayout layout(problem);
    Vector all = layout.InitialValues();
    layout.SetFree(free, &all);
    StructuralDynamics::Prepared prepared;
    return problem.dynamics->Prepare(all, &prepared, error) &&
           ModalCost(problem.modal, *problem.dynamics, layout)
               .Evaluate(prepared, residuals, jacobian, error);
  }

  Vector Residuals(const Vector& free) const {
    Vector residuals;
    std::string error;
    EXPECT_TRUE(Evaluate(free, &residuals, nullptr, &error)) << error;
    return residuals;
  }

  Matrix Jacobian(const Vector& free) const {
    Vector residuals;
    Matrix jacobian;
    std::string error;
    EXPECT_TRUE(Evaluate(free, &residuals, &jacobian, &error)) << error;
    return jacobian;
  }

  Vector InitialFree() const {
    const ParameterLayout layout(problem);
    return layout.Free(layout.InitialValues());
  }

  IdentificationProblem problem;
};

// Six masses on springs; groups of every kind, of which the damping, one that
// follows time and one that is fixed have no effect.
std::shared_ptr<StructuralDynamics> MakeSixDofs() {
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(6, 30.0, 0.1), std::vector<InputSpec>{});
  std::string error;
  const auto add = [&](const GroupTerm& term) {
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  };
  using Target = MatrixGroup::Target;
  add(testing::MakeGroupTerm("c", Target::kDamping, SpringMatrix(6, 0, 1),
                             0.2));
  add(testing::MakeGroupTerm("k1", Target::kStiffness,
                             30.0 * SpringMatrix(6, -1, 0), 0.1));
  GroupTerm fixed = testing::MakeGroupTerm("k2", Target::kStiffness,
                                           30.0 * SpringMatrix(6, 0, 1), -0.2);
  fixed.alpha.free = false;
  add(fixed);
  add(testing::MakeGroupTerm("k3", Target::kStiffness,
                             30.0 * SpringMatrix(6, 1, 2), -0.1));
  Matrix mass = Matrix::Zero(6, 6);
  mass(4, 4) = 1.0;
  mass(4, 5) = mass(5, 4) = 0.1;
  add(testing::MakeGroupTerm("m5", Target::kMass, mass, 0.3));
  GroupTerm following = testing::MakeGroupTerm(
      "drift", Target::kStiffness, 30.0 * SpringMatrix(6, 2, 3), 0.4);
  following.follows = GroupTerm::Follows::kTime;
  add(following);
  add(testing::MakeGroupTerm("k6", Target::kStiffness,
                             30.0 * SpringMatrix(6, 4, 5), 0.2));
  return dynamics;
}

class ModalCostForms : public ::testing::TestWithParam<ModalForm> {};

TEST_P(ModalCostForms, DerivativesMatchRiddersDifferences) {
  constexpr double kLimit = 1e-9;
  double worst = 0.0;
  for (const bool with_sigmas : {false, true}) {
    if (with_sigmas && GetParam() == ModalForm::kDynamicResidual) continue;
    ModalSetup setup(MakeSixDofs());
    setup.problem.modal.form = GetParam();
    setup.problem.modal.modes = {
        testing::MakeMeasuredMode(0.25, {0, 2, 5}, {-2.0, -5.0, -9.0}),
        testing::MakeMeasuredMode(0.61, {5, 1, 3, 4}, {1.0, -0.8, -0.2, 0.7}),
        testing::MakeMeasuredMode(1.5, {0, 1, 2, 3, 4, 5},
                                  {1.0, -1.1, 0.4, 0.9, -1.2, 0.3})};
    setup.problem.modal.modes[1].shape_weight = 3.0;
    setup.problem.modal.modes[1].residual_weight = 0.2;
    if (GetParam() != ModalForm::kDynamicResidual) {
      MeasuredMode frequency_alone = testing::MakeMeasuredMode(1.05, {}, {});
      frequency_alone.frequency_weight = 7.0;
      setup.problem.modal.modes.push_back(frequency_alone);
    }
    if (with_sigmas) {
      setup.problem.modal.modes[0].frequency_sigma = 0.01;
      if (GetParam() == ModalForm::kEigenvectorDifference) {
        setup.problem.modal.modes[2].shape_sigma = 0.05;
        setup.problem.modal.modes[0].shape_covariance =
            1e-4 * Matrix::Identity(3, 3);
        setup.problem.modal.modes[0].frequency_shape_covariance =
            (Vector(3) << 4e-5, -2e-5, 1e-5).finished();
      }
    }
    const Vector free = setup.InitialFree();
    const Matrix jacobian = setup.Jacobian(free);
    ASSERT_EQ(jacobian.cols(), 6);
    EXPECT_TRUE(jacobian.col(0).isZero(0.0));  // the damping
    EXPECT_TRUE(jacobian.col(4).isZero(0.0));  // what follows time
    for (int j = 0; j < free.size(); ++j) {
      const Vector expected = testing::Differentiate(
          [&](double h) {
            Vector moved = free;
            moved[j] += h;
            return setup.Residuals(moved);
          },
          1e-2);
      const double scale = std::max(1e-3, expected.cwiseAbs().maxCoeff());
      worst = std::max(
          worst, (jacobian.col(j) - expected).cwiseAbs().maxCoeff() / scale);
      if (j != 0 && j != 4) {
        EXPECT_GT(expected.norm(), 1e-3);
      }
    }
  }
  EXPECT_LT(worst, kLimit);
}

TEST_P(ModalCostForms, VanishAtTheModelsOwnModes) {
  ModalSetup setup(MakeSixDofs());
  const StructuralModel model = setup.problem.dynamics->CorrectedModel(
      setup.problem.dynamics->Parameters());
  ModalProperties modes;
  std::string error;
  ASSERT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  setup.problem.modal.form = GetParam();
  const std::vector<int> dofs = {4, 0, 1, 3};
  for (int j : {0, 3, 1}) {
    MeasuredMode mode =
        testing::MakeMeasuredMode(modes.frequency_hz[j], {}, {});
    mode.dofs = dofs;
    mode.shape = -3.0 * modes.mode_shapes(dofs, j);
    setup.problem.modal.modes.push_back(mode);
  }
  EXPECT_LT(setup.Residuals(setup.InitialFree()).cwiseAbs().maxCoeff(), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(All, ModalCostForms,
                         ::testing::Values(ModalForm::kMac,
                                           ModalForm::kEigenvectorDifference,
                                           ModalForm::kDynamicResidual),
                         [](const auto& form) {
                           return std::string(ModalFormName(form.param));
                         });

// M = I, K = [2 -1; -1 1] + a [1 0; 0 0]: at a = 0 w^2 = (3 -+ sqrt 5) / 2, the
// lower shape is [1; golden ratio].
struct TwoDofs : ModalSetup {
  TwoDofs()
      : ModalSetup(std::make_shared<StructuralDynamics>(
            testing::MakeChain(2, 1.0, 0.0), std::vector<InputSpec>{})) {
    auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
    std::string error;
    EXPECT_TRUE(dynamics->AddGroup(
        testing::MakeGroupTerm("a", MatrixGroup::Target::kStiffness,
                               SpringMatrix(2, -1, 0)),
        &error))
        << error;
    problem.dynamics = dynamics;
    problem.modal.modes = {testing::MakeMeasuredMode(0.12, {0, 1}, {1.0, 1.0})};
    measured = std::pow(kTwoPi * 0.12, 2);
  }
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  const double eigenvalue = 0.5 * (3.0 - std::sqrt(5.0));
  double measured;
};

TEST(ModalCost, MatchesTheClosedFormOfTwoDofs) {
  TwoDofs setup;
  const double norm = 1.0 + setup.golden * setup.golden;
  const double frequency = 1.0 - setup.eigenvalue / setup.measured;
  const double slope = -1.0 / (norm * setup.measured);
  // From the characteristic polynomial, tan of the shape's angle is
  // 2 + a - w^2.
  const double ratio_slope = 1.0 - 1.0 / norm;

  setup.problem.modal.form = ModalForm::kMac;
  Vector residuals = setup.Residuals(Vector::Zero(1));
  Matrix jacobian = setup.Jacobian(Vector::Zero(1));
  ASSERT_EQ(residuals.size(), 2);
  EXPECT_NEAR(residuals[0], frequency, 1e-14);
  EXPECT_NEAR(jacobian(0, 0), slope, 1e-14);
  const double cosine = (1.0 + setup.golden) / std::sqrt(2.0 * norm);
  EXPECT_NEAR(residuals[1], (1.0 - cosine) / cosine, 1e-14);
  // d(1/c)/dg, c = (1 + g) / sqrt(2 (1 + g^2)).
  const double by_ratio = std::sqrt(2.0) * (setup.golden - 1.0) /
                          (std::sqrt(norm) * std::pow(1.0 + setup.golden, 2));
  EXPECT_NEAR(jacobian(1, 0), by_ratio * ratio_slope, 1e-14);

  // The first of two equal entries scales.
  setup.problem.modal.form = ModalForm::kEigenvectorDifference;
  setup.problem.modal.modes[0].shape_weight = 2.0;
  residuals = setup.Residuals(Vector::Zero(1));
  jacobian = setup.Jacobian(Vector::Zero(1));
  ASSERT_EQ(residuals.size(), 2);
  EXPECT_NEAR(residuals[0], frequency, 1e-14);
  EXPECT_NEAR(residuals[1], 2.0 * (setup.golden - 1.0), 1e-14);
  EXPECT_NEAR(jacobian(1, 0), 2.0 * ratio_slope, 1e-14);
}

TEST(ModalCost, MatchesTheClosedFormOfADynamicResidual) {
  TwoDofs setup;
  setup.problem.modal.form = ModalForm::kDynamicResidual;
  setup.problem.modal.modes[0].residual_weight = 3.0;
  const double l = setup.measured;
  Vector residuals = setup.Residuals(Vector::Zero(1));
  EXPECT_NEAR(residuals[0], 3.0 * (1.0 - l), 1e-14);
  EXPECT_NEAR(residuals[1], 3.0 * -l, 1e-14);

  // With the second DOF not measured: min over u of |a + b u|, a = [2 - l; -1],
  // b = [-1; 1 - l]; what is left is across b.
  setup.problem.modal.modes[0] = testing::MakeMeasuredMode(0.12, {0}, {4.0});
  residuals = setup.Residuals(Vector::Zero(1));
  const double across = std::abs((2.0 - l) * (1.0 - l) - 1.0);
  EXPECT_NEAR(residuals.norm(), across / std::hypot(1.0, 1.0 - l), 1e-14);
}

// With known errors of a shape, the residuals are those of the best scale: they
// do not depend on the entry that scales.
TEST(ModalCost, SigmasMakeAllowanceForTheScale) {
  ModalSetup setup(MakeSixDofs());
  const StructuralModel model = setup.problem.dynamics->CorrectedModel(
      setup.problem.dynamics->Parameters());
  ModalProperties modes;
  std::string error;
  ASSERT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error));
  const std::vector<int> dofs = {0, 1, 3, 5};
  const Vector x = modes.mode_shapes(dofs, 1);
  const double noise = 1e-5;
  MeasuredMode mode = testing::MakeMeasuredMode(modes.frequency_hz[1], {}, {});
  mode.dofs = dofs;
  mode.shape = 2.5 * x;
  mode.shape += noise * testing::Gaussian(4).Draw(4);
  mode.shape_sigma = noise;
  setup.problem.modal.modes = {mode};
  const double found =
      setup.Residuals(setup.InitialFree()).tail(3).squaredNorm();
  const double scale = x.dot(mode.shape) / x.squaredNorm();
  const double expected =
      (mode.shape - scale * x).squaredNorm() / (noise * noise);
  EXPECT_GT(expected, 0.1);
  EXPECT_NEAR(found, expected, 1e-3 * expected);
}

// Frequency and shape whose errors go together: the residuals are worth what
// the inverse of the whole covariance, that of the frequency and all ratios,
// makes of the errors.
TEST(ModalCost, FrequencyAndShapeAreWeighedTogether) {
  ModalSetup setup(MakeSixDofs());
  const StructuralModel model = setup.problem.dynamics->CorrectedModel(
      setup.problem.dynamics->Parameters());
  ModalProperties modes;
  std::string error;
  ASSERT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error));
  // Three entries, the second the largest, and errors so small that those of
  // the eigenvalue are those of the frequency.
  const std::vector<int> dofs = {1, 5, 3};
  constexpr double kSmall = 1e-6;
  const Matrix root = testing::Gaussian(7).Draw(16).reshaped(4, 4);
  const Matrix joint = kSmall * kSmall * (root * root.transpose());
  const Vector errors = kSmall * testing::Gaussian(8).Draw(4);
  const Vector x = modes.mode_shapes(dofs, 0) / modes.mode_shapes(5, 0);
  MeasuredMode mode =
      testing::MakeMeasuredMode(modes.frequency_hz[0] + errors[0], {}, {});
  mode.dofs = dofs;
  mode.shape = x + errors.tail(3);
  mode.frequency_sigma = std::sqrt(joint(0, 0));
  mode.shape_covariance = joint.bottomRightCorner(3, 3);
  mode.frequency_shape_covariance = joint.col(0).tail(3);
  setup.problem.modal.modes = {mode};
  ASSERT_TRUE(setup.problem.modal.IsValid(6, &error)) << error;

  Matrix slopes = Matrix::Zero(3, 4);
  slopes(0, 0) = 1.0;
  slopes.row(1) << 0.0, 1.0, -x[0], 0.0;
  slopes.row(2) << 0.0, 0.0, -x[2], 1.0;
  const Vector off = slopes * errors;
  const Matrix covariance = slopes * joint * slopes.transpose();
  const double expected = off.dot(covariance.inverse() * off);
  const Vector free = setup.InitialFree();
  const double together = setup.Residuals(free).squaredNorm();
  EXPECT_NEAR(together, expected, 1e-4 * expected);

  // Apart, they are worth something else; with nothing in common, exactly that.
  setup.problem.modal.modes[0].frequency_shape_covariance = Vector::Zero(3);
  const Vector uncorrelated = setup.Residuals(free);
  setup.problem.modal.modes[0].frequency_shape_covariance = Vector();
  EXPECT_EQ(setup.Residuals(free), uncorrelated);
  EXPECT_GT(std::abs(uncorrelated.squaredNorm() / expected - 1.0), 0.05);
}

TEST(ModalCost, WeighsFrequenciesByTheirSigma) {
  TwoDofs setup;
  const double frequency = std::sqrt(setup.eigenvalue) / kTwoPi;
  setup.problem.modal.modes = {
      testing::MakeMeasuredMode(frequency * (1.0 + 1e-6), {}, {})};
  setup.problem.modal.modes[0].frequency_sigma = 1e-6 * frequency;
  EXPECT_NEAR(setup.Residuals(Vector::Zero(1))[0], 1.0, 1e-5);
}

// Two masses on springs of their own. The modes change places as the springs
// do, and the residuals take no notice.
TEST(ModalCost, IsSmoothWhereModesCross) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                          Vector::Constant(2, 1.0).asDiagonal()),
      std::vector<InputSpec>{});
  std::string error;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(dynamics->AddGroup(
        testing::MakeGroupTerm("k" + std::to_string(i + 1),
                               MatrixGroup::Target::kStiffness,
                               SpringMatrix(2, -1, i), i == 0 ? -0.05 : 0.05),
        &error));
  }
  ModalSetup setup(dynamics);
  setup.problem.modal.modes = {
      testing::MakeMeasuredMode(0.16, {0, 1}, {1.0, 0.05}),
      testing::MakeMeasuredMode(0.16, {0, 1}, {0.0, 1.0})};
  const double measured = std::pow(kTwoPi * 0.16, 2);
  for (const double a : {-0.05, -1e-3, 1e-3, 0.05}) {
    Vector free(2);
    free << a, -a;
    const Vector residuals = setup.Residuals(free);
    EXPECT_NEAR(residuals[0], 1.0 - (1.0 + a) / measured, 1e-13);
    EXPECT_NEAR(residuals[2], 1.0 - (1.0 - a) / measured, 1e-13);
    EXPECT_NEAR(setup.Jacobian(free)(0, 0), -1.0 / measured, 1e-12);
  }
  // Exactly at the crossing no group mixes the modes.
  EXPECT_NEAR(setup.Jacobian(Vector::Zero(2))(2, 1), -1.0 / measured, 1e-12);
}

// Two storeys that sway alike in x and y (DOFs x1, x2, y1, y2), with groups
// that split the pairs of modes, turn them, and change masses.
ModalSetup MakeSquareTower(double split, double turn, double shape_angle) {
  const StructuralModel chain = testing::MakeChain(2, 40.0, 0.0);
  Matrix mass = Matrix::Zero(4, 4), stiffness = Matrix::Zero(4, 4);
  for (const int first : {0, 2}) {
    mass.block(first, first, 2, 2) = chain.mass;
    stiffness.block(first, first, 2, 2) = chain.stiffness;
  }
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(mass, Matrix::Zero(4, 4), stiffness),
      std::vector<InputSpec>{});
  std::string error;
  using Target = MatrixGroup::Target;
  for (const GroupTerm& term :
       {testing::MakeGroupTerm("kx", Target::kStiffness,
                               40.0 * SpringMatrix(4, -1, 0), split),
        testing::MakeGroupTerm("ky", Target::kStiffness,
                               40.0 * SpringMatrix(4, 2, 3)),
        testing::MakeGroupTerm("kxy", Target::kStiffness,
                               40.0 * SpringMatrix(4, 1, 3), turn),
        testing::MakeGroupTerm("my", Target::kMass,
                               mass.row(3).transpose() * mass.row(3))}) {
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  ModalSetup setup(dynamics);
  UndampedModes modes;
  EXPECT_TRUE(ComputeUndampedModes(chain.mass, chain.stiffness, &modes, &error))
      << error;
  for (const int m : {0, 1}) {
    Matrix pair = Matrix::Zero(4, 2);
    pair.col(0).head(2) = pair.col(1).tail(2) = modes.shapes.col(m);
    Matrix rotation(2, 2);
    rotation << std::cos(shape_angle), -std::sin(shape_angle),
        std::sin(shape_angle), std::cos(shape_angle);
    const Matrix measured = pair * rotation;
    for (int i = 0; i < 2; ++i) {
      MeasuredMode mode;
      mode.frequency = std::sqrt(modes.eigenvalues[m]) / kTwoPi;
      mode.frequency_sigma = 0.01 * mode.frequency;
      mode.dofs = {0, 1, 2, 3};
      mode.shape = measured.col(i);
      mode.shape_sigma = 0.02;
      setup.problem.modal.modes.push_back(mode);
    }
  }
  return setup;
}

// A pair of one frequency may be measured at any angle.
TEST(ModalCost, CloseModesAreComparedByTheirSpan) {
  const ModalSetup setup = MakeSquareTower(0.0, 0.0, 0.6);
  const Vector zero = Vector::Zero(4);
  const Vector residuals = setup.Residuals(zero);
  ASSERT_EQ(residuals.size(), 4 * 4 + 2);
  EXPECT_LT(residuals.cwiseAbs().maxCoeff(), 1e-6);
  // A split of the first pair by x -> (1 + s) x, seen at the angle a: G has
  // l (1 + s cos^2 a), l (1 + s sin^2 a) and l s sin a cos a.
  Vector free = zero;
  free[0] = 1e-4;
  const Vector moved = setup.Residuals(free);
  const double x = moved[0] / (50.0 * std::pow(std::cos(0.6), 2));
  EXPECT_NEAR(moved[4] / (50.0 * std::pow(std::sin(0.6), 2)), x, 1e-3 * -x);
  EXPECT_NEAR(moved[16],
              std::sqrt(2.0) * 50.0 * x * std::sin(0.6) * std::cos(0.6),
              1e-3 * -x * 50.0);
}

TEST(ModalCost, DerivativesOfCloseModesMatchRiddersDifferences) {
  for (const ModalForm form :
       {ModalForm::kMac, ModalForm::kEigenvectorDifference}) {
    // Exactly equal, almost equal, and turned modes of the model.
    for (const double split : {0.0, 1e-7, 0.01}) {
      for (const bool with_covariance : {false, true}) {
        ModalSetup setup = MakeSquareTower(split, 0.3 * split, 0.4);
        setup.problem.modal.form = form;
        for (MeasuredMode& mode : setup.problem.modal.modes) {
          mode.shape[1] += 0.1 * mode.shape.norm();
          if (form == ModalForm::kMac || with_covariance) {
            mode.shape_sigma = 0.0;
          }
          if (form == ModalForm::kMac || !with_covariance) continue;
          mode.shape_covariance =
              1e-3 * Vector::LinSpaced(4, 1.0, 4.0).asDiagonal();
        }
        const Vector free = setup.InitialFree();
        const Matrix jacobian = setup.Jacobian(free);
        for (int j = 0; j < free.size(); ++j) {
          const Vector expected = testing::Differentiate(
              [&](double h) {
                Vector moved = free;
                moved[j] += h;
                return setup.Residuals(moved);
              },
              1e-2);
          EXPECT_LT((jacobian.col(j) - expected).cwiseAbs().maxCoeff(),
                    1e-6 * std::max(1.0, expected.cwiseAbs().maxCoeff()))
              << ModalFormName(form) << " " << split << " " << j;
        }
      }
    }
  }
}

TEST(ModalCost, RefusesModesOfOneFrequencyThatAGroupMixes) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                          Matrix::Identity(2, 2)),
      std::vector<InputSpec>{});
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(
      testing::MakeGroupTerm("k", MatrixGroup::Target::kStiffness,
                             SpringMatrix(2, 0, 1)),
      &error));
  ModalSetup setup(dynamics);
  setup.problem.modal.modes = {
      testing::MakeMeasuredMode(0.16, {0, 1}, {1.0, 0.3})};
  Vector residuals;
  Matrix jacobian;
  EXPECT_FALSE(setup.Evaluate(Vector::Zero(1), &residuals, &jacobian, &error));
  EXPECT_THAT(error, HasSubstr("modes 1 and 2 of the model have the same"));
  EXPECT_TRUE(
      setup.Evaluate(Vector::Constant(1, 1e-3), &residuals, &jacobian, &error))
      << error;
}

TEST(ModalCost, SaysWhyThereIsNone) {
  TwoDofs setup;
  Vector residuals;
  std::string error;
  // The model's only candidate does not move where the measured one is largest.
  setup.problem.modal.form = ModalForm::kEigenvectorDifference;
  setup.problem.modal.modes = {
      testing::MakeMeasuredMode(0.16, {0, 1}, {1.0, 0.9})};
  auto alone = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                          (Vector(2) << 100.0, 1.0).finished().asDiagonal()),
      std::vector<InputSpec>{});
  ASSERT_TRUE(alone->AddGroup(
      testing::MakeGroupTerm("k", MatrixGroup::Target::kStiffness,
                             SpringMatrix(2, -1, 1)),
      &error));
  setup.problem.dynamics = alone;
  EXPECT_FALSE(setup.Evaluate(Vector::Zero(1), &residuals, nullptr, &error));
  EXPECT_THAT(error, HasSubstr("orthogonal"));

  // The column of an unmeasured DOF is zero at the measured frequency.
  setup.problem.modal.form = ModalForm::kDynamicResidual;
  setup.problem.modal.modes = {
      testing::MakeMeasuredMode(1.0 / kTwoPi, {0}, {1.0})};
  EXPECT_FALSE(setup.Evaluate(Vector::Zero(1), &residuals, nullptr, &error));
  EXPECT_THAT(error, HasSubstr("singular"));
}

}  // namespace
}  // namespace pinode
