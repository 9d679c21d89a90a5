#include "pinode/dynamics/elements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

struct WorkedForce {
  std::string type;
  std::vector<double> parameters;
  double deformation;
  double rate;
  double force;
};

// Forces computed by hand from the table in pinode/case/README.md.
class ElementForce : public ::testing::TestWithParam<WorkedForce> {};

TEST_P(ElementForce, MatchesTheTable) {
  std::string error;
  const auto law = CreateElement(GetParam().type, &error);
  ASSERT_NE(law, nullptr) << error;
  ASSERT_EQ(law->num_parameters(), GetParam().parameters.size());
  const double features[] = {GetParam().deformation, GetParam().rate};
  double force = 0.0;
  law->Evaluate(features, nullptr, GetParam().parameters.data(), &force);
  EXPECT_NEAR(force, GetParam().force, 1e-14 * std::abs(GetParam().force));
}

INSTANTIATE_TEST_SUITE_P(
    Table, ElementForce,
    ::testing::ValuesIn(std::vector<WorkedForce>{
        WorkedForce{"linear", {10.0, 0.5}, 0.3, -2.0, 2.0},
        WorkedForce{"cubic", {2.0}, -0.5, 0.0, -0.25},
        WorkedForce{"quadratic_stiffness", {3.0}, -0.5, 0.0, -0.75},
        WorkedForce{"amplitude_damping", {3.0}, -0.5, 2.0, 3.0},
        WorkedForce{"bilinear", {-5.95, 0.2}, 1.15, 0.0, -5.6525},
        WorkedForce{"bilinear", {-5.95, 0.2}, -1.15, 0.0, 5.6525},
        WorkedForce{"bilinear", {-5.95, 0.2}, 0.1, 0.0, 0.0},
        WorkedForce{"coulomb", {4.0, 0.01}, 0.0, 0.005, 4.0 * std::tanh(0.5)},
        WorkedForce{"power_damper", {2.0, 2.0}, 0.0, -3.0, -18.0}}));

TEST(Elements, BoucWenFollowsItsEvolutionLaw) {
  std::string error;
  const auto law = CreateElement("bouc_wen", &error);
  ASSERT_NE(law, nullptr) << error;
  const double features[] = {0.0, -2.0};
  const double internal[] = {0.5};
  const double parameters[] = {10.0, 1.0, 0.6, 0.4, 2.0, 3.0};
  double result[2];
  law->Evaluate(features, internal, parameters, result);
  EXPECT_NEAR(result[0], 5.0, 1e-14);
  // a w - beta (b |w| |z|^(n-1) z + g w |z|^n)
  // = -2 - 3 (0.6*2*0.25 - 0.4*2*0.25)
  EXPECT_NEAR(result[1], -2.3, 1e-14);
}

TEST(Elements, BacklashFrictionFollowsItsEvolutionLaw) {
  std::string error;
  const auto law = CreateElement("backlash_friction", &error);
  ASSERT_NE(law, nullptr) << error;
  const double parameters[] = {10.0, 5.0, 0.2, 2.0};
  const double internal[] = {0.5};
  double result[2];
  const double outwards[] = {0.0, 2.0};
  law->Evaluate(outwards, internal, parameters, result);
  EXPECT_NEAR(result[0], 3.0, 1e-14);
  // It slips at 0.2 + 5 / 10.
  EXPECT_NEAR(result[1], 2.0 * (1.0 - (0.5 / 0.7) * (0.5 / 0.7)), 1e-14);
  const double back[] = {0.0, -2.0};
  law->Evaluate(back, internal, parameters, result);
  EXPECT_EQ(result[1], -2.0);
}

// With sharp slip it is a spring and a slider behind a play. Its state after a
// step is known: as far as the slider allows.
TEST(Elements, SharpBacklashFrictionIsASliderBehindAPlay) {
  std::string error;
  const auto law = CreateElement("backlash_friction", &error);
  ASSERT_NE(law, nullptr) << error;
  const double k = 10.0, f = 5.0, gap = 0.2;
  const double parameters[] = {k, f, gap, 50.0};
  const double slip = gap + f / k;
  constexpr int kSteps = 40000;
  double z = 0.0, exact = 0.0, largest = 0.0, work = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    // Two cycles.
    const double step = 4.0 * std::acos(-1.0) / kSteps;
    const double features[] = {0.0, 2.0 * std::cos(step * i)};
    double result[2];
    law->Evaluate(features, &z, parameters, result);
    const double move = features[1] * step;
    largest = std::max(
        largest,
        std::abs(result[0] - k * (exact - std::clamp(exact, -gap, gap))));
    if (i >= kSteps / 2) work += result[0] * move;
    z += result[1] * step;
    exact = std::clamp(exact + move, -slip, slip);
  }
  EXPECT_LT(largest, 0.1 * f);
  // The second cycle's travel at full force is 2 (2 d - 2 slip), and the spring
  // returns its energy.
  EXPECT_NEAR(work, f * 2.0 * (4.0 - 2.0 * slip), 0.05 * work);
}

TEST(Elements, JacobiansMatchRiddersStyleDifferences) {
  for (const std::string& type : ElementTypes()) {
    std::string error;
    const auto law = CreateElement(type, &error);
    ASSERT_NE(law, nullptr) << error;
    std::vector<double> arguments = {0.37, -0.81};
    for (int z = 0; z < law->num_internal(); ++z) {
      arguments.push_back(0.23 + 0.1 * z);
    }
    const std::vector<ElementParameterInfo> infos = ElementParameters(type);
    for (int p = 0; p < law->num_parameters(); ++p) {
      const double value = 1.3 - 0.17 * p - (type == "bilinear" ? 0.9 * p : 0);
      const bool inside =
          value > infos[p].lower + 0.01 && value < infos[p].upper - 0.01;
      arguments.push_back(inside ? value : infos[p].lower + 0.31);
    }
    const int na = law->num_arguments();
    const int nr = law->num_results();
    std::vector<double> result(nr), jacobian(nr * na), plus(nr), minus(nr);
    const double* x = arguments.data();
    law->Linearize(x, x + 2, x + 2 + law->num_internal(), result.data(),
                   jacobian.data());
    for (int i = 0; i < na; ++i) {
      // Fourth-order differences; truncation about 1e-12.
      const auto at = [&](double step, std::vector<double>* out) {
        std::vector<double> moved = arguments;
        moved[i] += step;
        law->Evaluate(moved.data(), moved.data() + 2,
                      moved.data() + 2 + law->num_internal(), out->data());
      };
      const double h = 1e-3;
      std::vector<double> plus2(nr), minus2(nr);
      at(h, &plus);
      at(-h, &minus);
      at(2 * h, &plus2);
      at(-2 * h, &minus2);
      for (int r = 0; r < nr; ++r) {
        const double difference =
            (8 * (plus[r] - minus[r]) - (plus2[r] - minus2[r])) / (12 * h);
        EXPECT_NEAR(jacobian[r * na + i], difference, 1e-8)
            << type << " result " << r << " argument " << i;
      }
    }
  }
}

TEST(Elements, DerivativesAtRestAreFinite) {
  for (const std::string& type : ElementTypes()) {
    std::string error;
    const auto law = CreateElement(type, &error);
    std::vector<double> arguments(law->num_arguments(), 0.0);
    for (int p = 0; p < law->num_parameters(); ++p) {
      arguments[arguments.size() - 1 - p] = 1.0;
    }
    std::vector<double> result(law->num_results());
    std::vector<double> jacobian(law->num_results() * law->num_arguments());
    law->Linearize(arguments.data(), arguments.data() + 2,
                   arguments.data() + 2 + law->num_internal(), result.data(),
                   jacobian.data());
    for (double value : jacobian) EXPECT_TRUE(std::isfinite(value)) << type;
  }
}

TEST(Elements, UnknownTypeNamesTheNearest) {
  std::string error;
  EXPECT_EQ(CreateElement("cubik", &error), nullptr);
  EXPECT_THAT(error, ::testing::HasSubstr("'cubic'"));
}

TEST(MakeElement, ResistsAtBothEndsAndRefusesWhatIsNone) {
  LawTerm spring;
  std::string error;
  ASSERT_TRUE(MakeElement("between", "cubic", 2, 0, 1, {5.0}, &spring, &error))
      << error;
  EXPECT_EQ(spring.outputs, Matrix(Eigen::Vector2d(-1.0, 1.0)));
  EXPECT_TRUE(spring.parameters.parameters[0].free);

  const auto refused = [&](const std::string& type, int from, int to,
                           const std::vector<double>& values) {
    EXPECT_FALSE(
        MakeElement("bad", type, 2, from, to, values, &spring, &error));
    EXPECT_EQ(spring.name, "between");
    return error;
  };
  EXPECT_THAT(refused("cubik", 0, 1, {5.0}), HasSubstr("cubic"));
  EXPECT_THAT(refused("cubic", 0, 2, {5.0}), HasSubstr("0 and 2"));
  EXPECT_THAT(refused("cubic", 1, 1, {5.0}), HasSubstr("1 and 1"));
  EXPECT_THAT(refused("cubic", -2, 1, {5.0}), HasSubstr("-2 and 1"));
  EXPECT_THAT(refused("cubic", 0, 1, {}), HasSubstr("0 values, expected 1"));
  EXPECT_THAT(refused("bouc_wen", 0, 1, {1.0, 1.0, 1.0, 1.0, -1.0}),
              HasSubstr("bad."));
  EXPECT_THAT(refused("bouc_wen", 0, 1, {1.0, 1.0, 1.0}),
              HasSubstr("3 values, expected 4 to 6"));

  LawTerm slip;
  ASSERT_TRUE(MakeElement("slip", "bouc_wen", 2, 0, 1, {1.0, 1.0, 2.0, 3.0},
                          &slip, &error))
      << error;
  ASSERT_EQ(slip.parameters.parameters.size(), 6u);
  EXPECT_TRUE(slip.parameters.parameters[3].free);
  EXPECT_FALSE(slip.parameters.parameters[4].free);
  EXPECT_FALSE(slip.parameters.parameters[5].free);
  EXPECT_EQ(slip.parameters.parameters[5].value, 1.0);
}

}  // namespace
}  // namespace pinode
