#include "pinode/structure/model/modal_analysis.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/model/damping.h"
#include "pinode/structure/model/structural_model.h"
#include "tests/support/measured_data_testing.h"
#include "tests/support/structure_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Matrix Scalar(double value) { return Matrix::Constant(1, 1, value); }

TEST(ComputeModes, TwoDofsInClosedForm) {
  // Equal masses and springs: w^2 = k/m (3 -+ sqrt 5) / 2, shapes (1, golden
  // ratio) and (golden ratio, -1).
  const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
  const Matrix stiffness = SpringMatrix(2, -1, 0) + SpringMatrix(2, 0, 1);
  const ModalProperties modes = Modes(4.0 * Matrix::Identity(2, 2),
                                      Matrix::Zero(2, 2), 100.0 * stiffness);
  const double w1 = std::sqrt(25.0 * (3.0 - std::sqrt(5.0)) / 2.0);
  const double w2 = std::sqrt(25.0 * (3.0 + std::sqrt(5.0)) / 2.0);
  EXPECT_NEAR(modes.frequency_hz[0], w1 / (2.0 * kPi), 1e-14);
  EXPECT_NEAR(modes.frequency_hz[1], w2 / (2.0 * kPi), 1e-14);
  // Without damping the damped frequencies are the undamped ones.
  EXPECT_NEAR(modes.damped_frequency_hz[0], w1 / (2.0 * kPi), 1e-14);
  EXPECT_NEAR(modes.damped_frequency_hz[1], w2 / (2.0 * kPi), 1e-14);
  EXPECT_NEAR(modes.damping_ratio[0], 0.0, 1e-14);
  EXPECT_NEAR(modes.damping_ratio[1], 0.0, 1e-14);
  const double scale = 1.0 / std::sqrt(4.0 * (1.0 + golden * golden));
  Matrix shapes(2, 2);
  shapes << scale, scale * golden, scale * golden, -scale;
  EXPECT_LT((modes.mode_shapes - shapes).norm(), 1e-14);
}

TEST(ComputeModes, ShapesAreMassNormalisedAndSolveTheEigenproblem) {
  Matrix mass = Vector::LinSpaced(5, 1.0, 3.0).asDiagonal();
  mass(1, 2) = mass(2, 1) = 0.4;
  Matrix stiffness = 9.0 * SpringMatrix(5, -1, 0);
  for (int i = 0; i < 4; ++i)
    stiffness += (9.0 - i) * SpringMatrix(5, i, i + 1);
  const ModalProperties modes = Modes(mass, Matrix::Zero(5, 5), stiffness);
  const Matrix& shapes = modes.mode_shapes;
  const Vector squares = (2.0 * kPi * modes.frequency_hz).cwiseAbs2();
  EXPECT_LT(
      (shapes.transpose() * mass * shapes - Matrix::Identity(5, 5)).norm(),
      1e-13);
  EXPECT_LT((stiffness * shapes - mass * shapes * squares.asDiagonal()).norm(),
            1e-12);
  EXPECT_TRUE(std::is_sorted(squares.data(), squares.data() + 5));
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(shapes.col(i).maxCoeff(), shapes.col(i).cwiseAbs().maxCoeff());
  }
}

TEST(ComputeModes, DoesNotDependOnUnits) {
  // A rotation of small inertia beside a translation, in two unit systems.
  Matrix mass(2, 2);
  mass << 2.0, 0.1, 0.1, 0.5;
  Matrix stiffness(2, 2);
  stiffness << 300.0, -40.0, -40.0, 80.0;
  const ModalProperties modes = Modes(mass, 0.01 * stiffness, stiffness);
  const Matrix scale = Eigen::Vector2d(1e6, 1e-5).asDiagonal();
  const ModalProperties scaled =
      Modes(scale * mass * scale, 0.01 * scale * stiffness * scale,
            scale * stiffness * scale);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(scaled.frequency_hz[i], modes.frequency_hz[i], 1e-13);
    EXPECT_NEAR(scaled.damping_ratio[i], modes.damping_ratio[i], 1e-13);
  }
}

TEST(ComputeModes, OneDofFromUndampedToUnstable) {
  // w = 2, c = 2 zeta w.
  for (const double ratio : {-1.5, -0.2, 0.0, 0.05, 0.7, 0.999, 1.3, 50.0}) {
    const ModalProperties modes =
        Modes(Scalar(1.0), Scalar(4.0 * ratio), Scalar(4.0));
    EXPECT_NEAR(modes.frequency_hz[0], 1.0 / kPi, 1e-15);
    EXPECT_NEAR(modes.damping_ratio[0], ratio, 1e-12 * std::max(1.0, ratio));
    const double damped =
        std::abs(ratio) < 1.0 ? std::sqrt(1.0 - ratio * ratio) / kPi : 0.0;
    EXPECT_NEAR(modes.damped_frequency_hz[0], damped, 1e-12);
  }
  // At critical damping the two eigenvalues coincide, and rounding has the
  // effect of its square root.
  EXPECT_NEAR(Modes(Scalar(1.0), Scalar(4.0), Scalar(4.0)).damping_ratio[0],
              1.0, 1e-7);
}

TEST(ComputeModes, ReportsRigidBodies) {
  // Two free masses: one rigid-body mode, one at w^2 = k (1/m1 + 1/m2).
  const Matrix mass = Eigen::Vector2d(1.0, 3.0).asDiagonal();
  const Matrix spring = SpringMatrix(2, 0, 1);
  for (const double damper : {0.0, 0.2}) {
    const ModalProperties modes = Modes(mass, damper * spring, 6.0 * spring);
    const double w = std::sqrt(6.0 * 4.0 / 3.0);
    EXPECT_EQ(modes.frequency_hz[0], 0.0);
    EXPECT_EQ(modes.damped_frequency_hz[0], 0.0);
    EXPECT_TRUE(std::isnan(modes.damping_ratio[0]));
    EXPECT_NEAR(modes.frequency_hz[1], w / (2.0 * kPi), 1e-14);
    EXPECT_NEAR(modes.damping_ratio[1], damper * 4.0 / 3.0 / (2.0 * w), 1e-14);
    EXPECT_NEAR(modes.mode_shapes(0, 0), 0.5, 1e-14);
    EXPECT_NEAR(modes.mode_shapes(1, 0), 0.5, 1e-14);
  }
  // With a damper to the ground its two real eigenvalues are 0 and about -c/m.
  const ModalProperties grounded =
      Modes(mass, 0.1 * SpringMatrix(2, -1, 0), 6.0 * spring);
  EXPECT_EQ(grounded.frequency_hz[0], 0.0);
  EXPECT_EQ(grounded.damped_frequency_hz[0], 0.0);
  EXPECT_TRUE(std::isnan(grounded.damping_ratio[0]));
  EXPECT_GT(grounded.damping_ratio[1], 0.0);
}

TEST(ComputeModes, ReportsSeveralRigidBodiesAndNoStiffnessAtAll) {
  const ModalProperties modes =
      Modes(Matrix::Identity(3, 3), Matrix::Zero(3, 3), Matrix::Zero(3, 3));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(modes.frequency_hz[i], 0.0);
    EXPECT_EQ(modes.damped_frequency_hz[i], 0.0);
    EXPECT_TRUE(std::isnan(modes.damping_ratio[i]));
  }
}

TEST(ComputeModes, ReportsNegativeStiffness) {
  const Matrix stiffness = Eigen::Vector2d(9.0, -1.0).asDiagonal();
  const ModalProperties modes =
      Modes(Matrix::Identity(2, 2), 0.6 * Matrix::Identity(2, 2), stiffness);
  EXPECT_TRUE(std::isnan(modes.frequency_hz[0]));
  EXPECT_EQ(modes.damped_frequency_hz[0], 0.0);
  EXPECT_TRUE(std::isnan(modes.damping_ratio[0]));
  EXPECT_NEAR(modes.frequency_hz[1], 1.5 / kPi, 1e-15);
  EXPECT_NEAR(modes.damping_ratio[1], 0.1, 1e-14);
}

TEST(ComputeModes, PairsByShapeWhereDampingReversesTheOrder) {
  // Uncoupled modes at w = 10 and 11; the second, heavily damped, oscillates
  // more slowly than the first, and a third is overdamped.
  const Matrix stiffness = Eigen::Vector3d(100.0, 121.0, 144.0).asDiagonal();
  const Matrix damping =
      Eigen::Vector3d(2.0 * 0.01 * 10.0, 2.0 * 0.8 * 11.0, 2.0 * 3.0 * 12.0)
          .asDiagonal();
  const ModalProperties modes =
      Modes(Matrix::Identity(3, 3), damping, stiffness);
  EXPECT_NEAR(modes.damping_ratio[0], 0.01, 1e-13);
  EXPECT_NEAR(modes.damping_ratio[1], 0.8, 1e-13);
  EXPECT_NEAR(modes.damping_ratio[2], 3.0, 1e-12);
  EXPECT_LT(modes.damped_frequency_hz[1], modes.damped_frequency_hz[0]);
  EXPECT_EQ(modes.damped_frequency_hz[2], 0.0);
}

TEST(ComputeModes, SortsTheEigenvaluesOfTwoOverdampedModes) {
  // Real eigenvalues of the two interleave: -0.51, -19.5 and -1.4, -27.6 or so.
  const Matrix stiffness = Eigen::Vector2d(10.0, 40.0).asDiagonal();
  const Matrix damping = Eigen::Vector2d(20.0, 29.0).asDiagonal();
  const ModalProperties modes =
      Modes(Matrix::Identity(2, 2), damping, stiffness);
  EXPECT_NEAR(modes.damping_ratio[0], 20.0 / (2.0 * std::sqrt(10.0)), 1e-12);
  EXPECT_NEAR(modes.damping_ratio[1], 29.0 / (2.0 * std::sqrt(40.0)), 1e-12);
}

TEST(ComputeModes, SmallNonProportionalDampingIsThatOfFirstOrderTheory) {
  // To first order in C: zeta_i = phi_i' C phi_i / (2 w_i).
  const Matrix mass = Eigen::Vector3d(2.0, 1.5, 1.0).asDiagonal();
  const Matrix stiffness = 50.0 * SpringMatrix(3, -1, 0) +
                           40.0 * SpringMatrix(3, 0, 1) +
                           30.0 * SpringMatrix(3, 1, 2);
  const Matrix damping = 0.01 * SpringMatrix(3, 1, 2);
  const ModalProperties modes = Modes(mass, damping, stiffness);
  for (int i = 0; i < 3; ++i) {
    const Vector shape = modes.mode_shapes.col(i);
    const double ratio =
        shape.dot(damping * shape) / (4.0 * kPi * modes.frequency_hz[i]);
    EXPECT_NEAR(modes.damping_ratio[i], ratio, 1e-3 * ratio);
  }
}

TEST(ComputeModes, UsesEveryEigenvalueOnceUnderStrongLocalDamping) {
  // One strong damper, swept until it locks its storey: eigenvalues become
  // real and oscillating ones move far, yet the set must stay complete.
  const Matrix mass = Matrix::Identity(4, 4);
  Matrix stiffness = 100.0 * SpringMatrix(4, -1, 0);
  for (int i = 0; i < 3; ++i) stiffness += 100.0 * SpringMatrix(4, i, i + 1);
  for (const double damper : {1.0, 5.0, 10.0, 20.0, 50.0, 200.0, 1e4}) {
    const Matrix damping = damper * SpringMatrix(4, 1, 2);
    const ModalProperties modes = Modes(mass, damping, stiffness);
    const Eigen::VectorXcd eigenvalues =
        StateEigenvalues(mass, damping, stiffness);
    std::vector<double> expected;
    for (const std::complex<double>& value : eigenvalues) {
      if (value.imag() > 1e-9) {
        expected.push_back(value.imag() / (2.0 * kPi));
      }
    }
    std::sort(expected.begin(), expected.end());
    std::vector<double> found;
    for (const double frequency : modes.damped_frequency_hz) {
      if (frequency > 0.0) found.push_back(frequency);
    }
    std::sort(found.begin(), found.end());
    EXPECT_THAT(found,
                ::testing::Pointwise(::testing::DoubleNear(1e-9), expected))
        << "damper " << damper;
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(modes.damping_ratio[i], 0.0) << "damper " << damper;
      if (modes.damped_frequency_hz[i] == 0.0) {
        EXPECT_GE(modes.damping_ratio[i], 1.0) << "damper " << damper;
      }
    }
  }
}

struct BadMatrices {
  const char* name;
  Matrix mass;
  Matrix damping;
  Matrix stiffness;
  const char* message_part;
};

void PrintTo(const BadMatrices& bad, std::ostream* stream) {
  *stream << bad.name;
}

class BadMatricesTest : public ::testing::TestWithParam<BadMatrices> {};

TEST_P(BadMatricesTest, IsRefusedWithAMessage) {
  const BadMatrices& bad = GetParam();
  ModalProperties modes;
  std::string error;
  EXPECT_FALSE(
      ComputeModes(bad.mass, bad.damping, bad.stiffness, &modes, &error));
  EXPECT_THAT(error, HasSubstr(bad.message_part));
  EXPECT_EQ(modes.frequency_hz.size(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    ComputeModes, BadMatricesTest,
    ::testing::Values(
        BadMatrices{"MassZero", Scalar(0.0), Scalar(0.0), Scalar(1.0),
                    "positive definite"},
        BadMatrices{
            "MassIndefinite", (Matrix(2, 2) << 1.0, 2.0, 2.0, 1.0).finished(),
            Matrix::Zero(2, 2), Matrix::Identity(2, 2), "positive definite"},
        BadMatrices{"MassNaN", Scalar(std::numeric_limits<double>::quiet_NaN()),
                    Scalar(0.0), Scalar(1.0), "not finite"},
        BadMatrices{"DampingNaN", Scalar(1.0),
                    Scalar(std::numeric_limits<double>::quiet_NaN()),
                    Scalar(1.0), "not finite"},
        BadMatrices{"StiffnessInfinite", Scalar(1.0), Scalar(0.0),
                    Scalar(std::numeric_limits<double>::infinity()),
                    "not finite"}),
    [](const auto& test) { return test.param.name; });

TEST(ComputeModesDeathTest, ChecksSizes) {
  ModalProperties modes;
  std::string error;
  EXPECT_DEATH((void)ComputeModes(Matrix::Identity(2, 2), Scalar(0.0),
                                  Matrix::Identity(2, 2), &modes, &error),
               "C 1 x 1");
  EXPECT_DEATH(StateEigenvalues(Scalar(-1.0), Scalar(0.0), Scalar(1.0)),
               "positive definite");
}

TEST(StateEigenvalues, AreThoseOfOneDof) {
  // s^2 + 0.4 s + 4.
  const Eigen::VectorXcd eigenvalues =
      StateEigenvalues(Scalar(2.0), Scalar(0.8), Scalar(8.0));
  ASSERT_EQ(eigenvalues.size(), 2);
  for (const std::complex<double>& value : eigenvalues) {
    EXPECT_NEAR(value.real(), -0.2, 1e-14);
    EXPECT_NEAR(std::abs(value.imag()), std::sqrt(3.96), 1e-14);
  }
  EXPECT_NEAR(LargestStateEigenvalue(Scalar(2.0), Scalar(0.8), Scalar(8.0)),
              2.0, 1e-14);
}

TEST(StateEigenvalues, HeavyDampingDeterminesTheLargest) {
  // c = 100: s = -50 -+ sqrt(2499).
  EXPECT_NEAR(LargestStateEigenvalue(Scalar(1.0), Scalar(100.0), Scalar(1.0)),
              50.0 + std::sqrt(2499.0), 1e-11);
  // No spring at all.
  EXPECT_NEAR(LargestStateEigenvalue(Scalar(2.0), Scalar(6.0), Scalar(0.0)),
              3.0, 1e-14);
}

TEST(StateEigenvalues, SolveTheQuadraticEigenproblemOfUnsymmetricMatrices) {
  const Matrix mass = (Matrix(2, 2) << 2.0, 0.3, 0.3, 1.0).finished();
  const Matrix damping = (Matrix(2, 2) << 0.5, 0.4, -0.2, 0.3).finished();
  const Matrix stiffness = (Matrix(2, 2) << 30.0, -4.0, -9.0, 20.0).finished();
  for (const std::complex<double>& s :
       StateEigenvalues(mass, damping, stiffness)) {
    const Eigen::Matrix2cd pencil = s * s * mass.cast<std::complex<double>>() +
                                    s * damping.cast<std::complex<double>>() +
                                    stiffness.cast<std::complex<double>>();
    const std::complex<double> determinant =
        pencil(0, 0) * pencil(1, 1) - pencil(0, 1) * pencil(1, 0);
    EXPECT_LT(std::abs(determinant), 1e-10);
  }
}

TEST(Mac, IgnoresScaleAndSign) {
  const Vector a = (Vector(3) << 1.0, 2.0, -1.0).finished();
  EXPECT_NEAR(Mac(a, -7e200 * a), 1.0, 1e-15);
  EXPECT_LE(Mac(a, a), 1.0);
  EXPECT_NEAR(Mac(a, (Vector(3) << 1.0, 0.0, 1.0).finished()), 0.0, 1e-15);
  // (1 + 2)^2 / (6 * 2)
  EXPECT_NEAR(Mac(a, (Vector(3) << 1.0, 1.0, 0.0).finished()), 0.75, 1e-15);
  EXPECT_EQ(Mac(a, Vector::Zero(3)), 0.0);
}

TEST(MacMatrix, HasARowPerShapeOfA) {
  const Matrix a = Matrix::Identity(3, 2);
  const Matrix b = Matrix::Ones(3, 3);
  const Matrix mac = MacMatrix(a, b);
  ASSERT_EQ(mac.rows(), 2);
  ASSERT_EQ(mac.cols(), 3);
  EXPECT_LT((mac - Matrix::Constant(2, 3, 1.0 / 3.0)).norm(), 1e-15);
}

TEST(PairModes, FindsAPermutation) {
  const Matrix a = Matrix::Identity(4, 4);
  Matrix b(4, 4);
  b << a.col(2), -a.col(0), 5.0 * a.col(3), a.col(1);
  EXPECT_THAT(PairModes(a, b), ElementsAre(1, 3, 0, 2));
}

TEST(PairModes, MaximisesTheTotalInsteadOfTheFirst) {
  // Shape 0 of A is nearest to shape 0 of B, but shape 1 of A has no other.
  const Matrix a = (Matrix(3, 2) << 1.0, 1.0, 0.0, 0.0, 0.9, 0.0).finished();
  const Matrix b = (Matrix(3, 2) << 1.0, 0.0, 0.0, 0.0, 0.5, 1.0).finished();
  const Matrix mac = MacMatrix(a, b);
  ASSERT_GT(mac(0, 0), mac(0, 1));
  ASSERT_GT(mac(0, 0), mac(1, 0));
  EXPECT_THAT(PairModes(a, b), ElementsAre(1, 0));
}

TEST(PairModes, LeavesSomeWithoutPartner) {
  const Matrix a = Matrix::Identity(3, 3);
  EXPECT_THAT(PairModes(a, a.rightCols(2)), ElementsAre(-1, 0, 1));
  EXPECT_THAT(PairModes(a.rightCols(2), a), ElementsAre(1, 2));
}

// Pairs of matrices from public collections, with eigenvalues computed by
// another program.
class MeasuredMatricesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    PINODE_FIND_MEASURED_DATA(folder, "matrices");
    folder_ = folder;
    std::ifstream(folder_ / "reference_eigenvalues.json") >> reference_;
  }

  Matrix Read(const std::string& name) const {
    Matrix matrix;
    std::string error;
    EXPECT_TRUE(ReadMatrix((folder_ / name).string(), &matrix, &error))
        << error;
    return matrix;
  }

  std::filesystem::path folder_;
  nlohmann::json reference_;
};

TEST_F(MeasuredMatricesTest, LowestEigenvaluesAgreeWithTheReference) {
  for (const auto& [stiffness_name, mass_name] :
       {std::pair("bcsstk02", "bcsstm02"), std::pair("lunda", "lundb")}) {
    const std::string key =
        std::string(stiffness_name) + "/" + std::string(mass_name);
    SCOPED_TRACE(key);
    const Matrix stiffness = Read(std::string(stiffness_name) + ".mtx");
    const Matrix mass = Read(std::string(mass_name) + ".mtx");
    const StructuralModel model =
        MakeStructuralModel(mass, 0.0 * mass, stiffness);
    std::string error;
    ASSERT_TRUE(model.IsValid(&error)) << error;
    const nlohmann::json& reference = reference_.at(key);
    ASSERT_EQ(model.num_dofs(), reference.at("n").get<int>());
    const ModalProperties modes =
        Modes(model.mass, model.damping, model.stiffness);
    const auto expected =
        reference.at("lowest_eigenvalues").get<std::vector<double>>();
    ASSERT_EQ(expected.size(), 10u);
    for (size_t i = 0; i < expected.size(); ++i) {
      const double w = 2.0 * kPi * modes.frequency_hz[i];
      EXPECT_NEAR(w * w, expected[i], 1e-6 * expected[i]);
      const double damped = 2.0 * kPi * modes.damped_frequency_hz[i];
      EXPECT_NEAR(damped * damped, expected[i], 1e-6 * expected[i]);
    }
  }
}

TEST_F(MeasuredMatricesTest, ModalDampingOfManyDofsIsFoundAgain) {
  const Matrix stiffness = Read("bcsstk02.mtx");
  const Matrix mass = Read("bcsstm02.mtx");
  Matrix damping;
  std::string error;
  const Vector ratios = Vector::LinSpaced(66, 0.01, 1.5);
  ASSERT_TRUE(ModalDamping(mass, stiffness, ratios, &damping, &error)) << error;
  const ModalProperties modes = Modes(mass, damping, stiffness);
  for (int i = 0; i < 66; ++i) {
    EXPECT_NEAR(modes.damping_ratio[i], ratios[i], 1e-8) << "mode " << i + 1;
  }
}

TEST_F(MeasuredMatricesTest, MasslessDofsAreRefusedByName) {
  const Matrix stiffness = Read("bcsstk01.mtx");
  const Matrix mass = Read("bcsstm01.mtx");
  const StructuralModel model =
      MakeStructuralModel(mass, 0.0 * mass, stiffness);
  std::string error;
  EXPECT_FALSE(model.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("has the mass 0"));
  int massless = 0;
  mass.diagonal().minCoeff(&massless);
  EXPECT_THAT(error, HasSubstr("'" + model.dof_names[massless] + "'"));
  ModalProperties modes;
  EXPECT_FALSE(ComputeModes(mass, 0.0 * mass, stiffness, &modes, &error));
}

}  // namespace
}  // namespace pinode
