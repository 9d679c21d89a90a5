#include "pinode/structure/model/damping.h"

#include <cmath>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/structural_model.h"
#include "tests/support/structure_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

struct MassAndStiffness {
  Matrix mass;
  Matrix stiffness;
};

// Unequal masses and springs, with a spring across two storeys.
MassAndStiffness Frame() {
  MassAndStiffness frame;
  frame.mass = Vector::LinSpaced(4, 1.0, 2.5).asDiagonal();
  frame.mass(0, 1) = frame.mass(1, 0) = 0.2;
  frame.stiffness =
      400.0 * SpringMatrix(4, -1, 0) + 300.0 * SpringMatrix(4, 0, 1) +
      200.0 * SpringMatrix(4, 1, 2) + 100.0 * SpringMatrix(4, 2, 3) +
      50.0 * SpringMatrix(4, 0, 3);
  return frame;
}

TEST(RayleighDamping, GivesTheClosedFormRatioInEveryMode) {
  const MassAndStiffness frame = Frame();
  const RayleighCoefficients coefficients{0.3, 0.002};
  const Matrix damping =
      RayleighDamping(frame.mass, frame.stiffness, coefficients);
  const ModalProperties modes = Modes(frame.mass, damping, frame.stiffness);
  for (int i = 0; i < 4; ++i) {
    const double w = 2.0 * kPi * modes.frequency_hz[i];
    const double ratio = 0.3 / (2.0 * w) + 0.002 * w / 2.0;
    EXPECT_NEAR(modes.damping_ratio[i], ratio, 1e-12);
    EXPECT_NEAR(modes.damped_frequency_hz[i],
                modes.frequency_hz[i] * std::sqrt(1.0 - ratio * ratio), 1e-12);
  }
}

TEST(RayleighFromRatios, MeetsBothRatios) {
  const MassAndStiffness frame = Frame();
  const ModalProperties undamped =
      Modes(frame.mass, Matrix::Zero(4, 4), frame.stiffness);
  RayleighCoefficients coefficients;
  std::string error;
  // The order of the two does not matter.
  ASSERT_TRUE(RayleighFromRatios(undamped.frequency_hz[2], 0.05,
                                 undamped.frequency_hz[0], 0.02, &coefficients,
                                 &error))
      << error;
  const ModalProperties damped = Modes(
      frame.mass, RayleighDamping(frame.mass, frame.stiffness, coefficients),
      frame.stiffness);
  EXPECT_NEAR(damped.damping_ratio[0], 0.02, 1e-13);
  EXPECT_NEAR(damped.damping_ratio[2], 0.05, 1e-13);
}

TEST(RayleighFromRatios, AgreesWithTheFormulaForEqualRatios) {
  RayleighCoefficients coefficients;
  std::string error;
  ASSERT_TRUE(RayleighFromRatios(2.0, 0.03, 5.0, 0.03, &coefficients, &error));
  // a0 = 2 zeta w1 w2 / (w1 + w2), a1 = 2 zeta / (w1 + w2).
  const double sum = 2.0 * kPi * 7.0;
  EXPECT_NEAR(coefficients.mass, 2.0 * 0.03 * 4.0 * kPi * 10.0 * kPi / sum,
              1e-14);
  EXPECT_NEAR(coefficients.stiffness, 2.0 * 0.03 / sum, 1e-17);
}

TEST(RayleighFromRatios, AcceptsPurelyProportionalDamping) {
  RayleighCoefficients coefficients;
  std::string error;
  // zeta proportional to f: stiffness alone; to 1/f: mass alone.
  ASSERT_TRUE(RayleighFromRatios(1.1, 0.011, 3.3, 0.033, &coefficients, &error))
      << error;
  EXPECT_NEAR(coefficients.mass, 0.0, 1e-14);
  EXPECT_NEAR(coefficients.stiffness, 0.01 / kPi, 1e-15);
  ASSERT_TRUE(RayleighFromRatios(1.1, 0.033, 3.3, 0.011, &coefficients, &error))
      << error;
  EXPECT_NEAR(coefficients.stiffness, 0.0, 1e-15);
  EXPECT_GE(coefficients.stiffness, 0.0);
}

struct BadPairs {
  const char* name;
  double frequency_a;
  double ratio_a;
  double frequency_b;
  double ratio_b;
  const char* message_part;
};

void PrintTo(const BadPairs& bad, std::ostream* stream) { *stream << bad.name; }

class BadPairsTest : public ::testing::TestWithParam<BadPairs> {};

TEST_P(BadPairsTest, IsRefused) {
  const BadPairs& bad = GetParam();
  RayleighCoefficients coefficients{7.0, 8.0};
  std::string error;
  EXPECT_FALSE(RayleighFromRatios(bad.frequency_a, bad.ratio_a, bad.frequency_b,
                                  bad.ratio_b, &coefficients, &error));
  EXPECT_THAT(error, HasSubstr(bad.message_part));
  EXPECT_EQ(coefficients.mass, 7.0);
  EXPECT_EQ(coefficients.stiffness, 8.0);
}

INSTANTIATE_TEST_SUITE_P(
    RayleighFromRatios, BadPairsTest,
    ::testing::ValuesIn(std::vector<BadPairs>{
        BadPairs{"ZeroFrequency", 0.0, 0.02, 2.0, 0.02, "positive"},
        BadPairs{"NegativeFrequency", 1.0, 0.02, -2.0, 0.02, "-2 Hz"},
        BadPairs{"FrequencyNaN", kNaN, 0.02, 2.0, 0.02, "positive"},
        BadPairs{"NegativeRatio", 1.0, -0.02, 2.0, 0.02, "-0.02"},
        BadPairs{"RatioNaN", 1.0, 0.02, 2.0, kNaN, "damping ratio"},
        BadPairs{"EqualFrequencies", 2.0, 0.02, 2.0, 0.03, "different"},
        BadPairs{"NegativeMassCoefficient", 1.0, 0.01, 2.0, 0.1,
                 "mass coefficient comes out negative"},
        BadPairs{"NegativeStiffnessCoefficient", 1.0, 0.1, 2.0, 0.01,
                 "stiffness coefficient comes out negative"}}),
    [](const auto& test) { return test.param.name; });

TEST(ModalDamping, GivesEachModeItsRatio) {
  const MassAndStiffness frame = Frame();
  Vector ratios(2);
  ratios << 0.01, 0.04;
  Matrix damping;
  std::string error;
  ASSERT_TRUE(
      ModalDamping(frame.mass, frame.stiffness, ratios, &damping, &error))
      << error;
  EXPECT_EQ(damping, damping.transpose());
  const ModalProperties modes = Modes(frame.mass, damping, frame.stiffness);
  EXPECT_NEAR(modes.damping_ratio[0], 0.01, 1e-13);
  for (int i = 1; i < 4; ++i) {
    EXPECT_NEAR(modes.damping_ratio[i], 0.04, 1e-13) << "the last is repeated";
  }
}

TEST(ModalDamping, LeavesRigidBodiesUndamped) {
  const Matrix mass = Matrix::Identity(3, 3);
  const Matrix stiffness = SpringMatrix(3, 0, 1) + SpringMatrix(3, 1, 2);
  Matrix damping;
  std::string error;
  ASSERT_TRUE(
      ModalDamping(mass, stiffness, Vector::Constant(1, 0.1), &damping, &error))
      << error;
  EXPECT_LT((damping * Vector::Ones(3)).norm(), 1e-14);
  EXPECT_GT(damping.norm(), 0.1);
}

TEST(DampingOfModes, IsThePartOfSomeModes) {
  const MassAndStiffness frame = Frame();
  Matrix some;
  std::string error;
  ASSERT_TRUE(
      DampingOfModes(frame.mass, frame.stiffness, 2, 3, 0.05, &some, &error))
      << error;
  const ModalProperties modes = Modes(frame.mass, some, frame.stiffness);
  const double expected[] = {0.0, 0.05, 0.05, 0.0};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(modes.damping_ratio[i], expected[i], 1e-13) << i;
  }
  // Up to the highest; the parts are the whole.
  Matrix first, rest, whole;
  ASSERT_TRUE(
      DampingOfModes(frame.mass, frame.stiffness, 1, 1, 0.05, &first, &error));
  ASSERT_TRUE(
      DampingOfModes(frame.mass, frame.stiffness, 2, 0, 0.05, &rest, &error));
  ASSERT_TRUE(ModalDamping(frame.mass, frame.stiffness,
                           Vector::Constant(1, 0.05), &whole, &error));
  EXPECT_LT((first + rest - whole).norm(), 1e-13 * whole.norm());
  for (const auto& [from, to] : {std::pair{0, 1}, {5, 0}, {3, 2}, {1, 5}}) {
    EXPECT_FALSE(DampingOfModes(frame.mass, frame.stiffness, from, to, 0.05,
                                &some, &error));
    EXPECT_THAT(error, HasSubstr("expected 1 to 4")) << from << " " << to;
  }
}

TEST(ModalDamping, RefusesBadInput) {
  const MassAndStiffness frame = Frame();
  const auto message = [](const Matrix& mass, const Matrix& stiffness,
                          const Vector& ratios) {
    Matrix damping = Matrix::Constant(1, 1, 42.0);
    std::string error;
    EXPECT_FALSE(ModalDamping(mass, stiffness, ratios, &damping, &error));
    EXPECT_EQ(damping, Matrix::Constant(1, 1, 42.0));
    return error;
  };
  const Vector one = Vector::Constant(1, 0.02);
  EXPECT_THAT(message(frame.mass, frame.stiffness, Vector()),
              HasSubstr("0 damping ratios"));
  EXPECT_THAT(message(frame.mass, frame.stiffness, Vector::Ones(5)),
              HasSubstr("1 to 4"));
  EXPECT_THAT(message(frame.mass, frame.stiffness, -one),
              HasSubstr("ratio 1 is -0.02"));
  EXPECT_THAT(message(frame.mass, frame.stiffness, kNaN * one),
              HasSubstr("ratio 1 is nan"));
  EXPECT_THAT(message(frame.mass, -frame.stiffness, one),
              HasSubstr("the stiffness matrix is not positive semidefinite: "
                        "mode 1 has a negative stiffness"));
  EXPECT_THAT(message(-frame.mass, frame.stiffness, one),
              HasSubstr("positive definite"));
}

}  // namespace
}  // namespace pinode
