#include "pinode/estimate/certainty/profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pinode/estimate/certainty/profile_combinations.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A fit and what is needed to profile it.
struct Profiled {
  IdentificationProblem problem;
  IdentificationOptions options;
  IdentificationSummary summary;
  IdentifiedModel model;
  std::vector<ParameterProfile> profiles;
  std::string error;

  // Problem of `dynamics` from its values, on a record simulated at `truth`.
  Profiled(std::shared_ptr<StructuralDynamics> dynamics, const Vector& truth,
           double noise, double amplitude = 1.0) {
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 400, 0.02);
    const Matrix samples = amplitude * record.excitation->samples();
    record.excitation.emplace(0.0, 0.02, samples, Interpolation::kLinear);
    const int n = dynamics->num_dofs();
    for (int i = 0; i < n; ++i) {
      record.channels.push_back(testing::MakeChannel(
          "x" + std::to_string(i + 1), Quantity::kDisplacement, n, i));
    }
    testing::Simulate(*dynamics, truth, Vector::Zero(dynamics->num_states()),
                      noise, 7, &record);
    record.start = IdentificationRecord::Start::kRest;
    problem.records.push_back(record);
    problem.dynamics = dynamics;
  }

  bool Run(const std::vector<std::string>& names = {}) {
    testing::FitAndJudge(problem, options, nullptr, &summary, &model);
    ProfileOptions profile_options;
    profile_options.parameters = names;
    return ProfileParameters(problem, summary, model, options, profile_options,
                             &profiles, &error);
  }

  const ParameterProfile& Of(const std::string& name) const {
    for (const ParameterProfile& profile : profiles) {
      if (profile.name == name) return profile;
    }
    ADD_FAILURE() << "no profile of " << name;
    return profiles.front();
  }
};

// One mass on a spring of the model, with a law between it and the ground.
std::shared_ptr<StructuralDynamics> OnASpring() {
  return std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 30.0, 0.6),
      std::vector<InputSpec>{{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
}

void AddFree(const std::string& name, const std::string& type,
             const std::vector<double>& values,
             const std::vector<std::string>& free,
             StructuralDynamics* dynamics) {
  LawTerm term =
      testing::MakeElement(name, type, 1, Feature::kGround, 0, values);
  for (Parameter& parameter : term.parameters.parameters) {
    parameter.free = false;
    for (const std::string& each : free) {
      if (parameter.name == name + "." + each) parameter.free = true;
    }
  }
  std::string error;
  ASSERT_TRUE(dynamics->AddLaw(std::move(term), &error)) << error;
}

TEST(ProfileParameters, IsTheLinearIntervalWhereTheCostIsAParabola) {
  auto dynamics = testing::MakeGroupedChain(2, 40.0, 0.4);
  Profiled fit(dynamics, Eigen::Vector2d(0.1, -0.05), 0.02);
  ASSERT_TRUE(fit.Run()) << fit.error;
  ASSERT_EQ(fit.profiles.size(), 2);
  for (const ParameterProfile& profile : fit.profiles) {
    EXPECT_EQ(profile.determination, Determination::kDetermined);
    const double half = 0.5 * (profile.linear_upper95 - profile.linear_lower95);
    EXPECT_NEAR(profile.lower95, profile.linear_lower95, 0.03 * half);
    EXPECT_NEAR(profile.upper95, profile.linear_upper95, 0.03 * half);
    // 99 %: 2.576 deviations to 1.960.
    EXPECT_NEAR(profile.upper99 - profile.estimate, 1.3143 * half, 0.05 * half);
    EXPECT_FALSE(profile.DiffersFromLinear());
    EXPECT_FALSE(profile.found_lower);
    EXPECT_GE(profile.points.size(), 5);
    EXPECT_LT(profile.linearizations, 40);
  }
}

// One spring gains as much as the other one loses.
TEST(ProfileParameters, NamesTheSumThatAloneIsDetermined) {
  auto dynamics = OnASpring();
  AddFree("a", "linear", {5.0, 0.0}, {"k"}, dynamics.get());
  AddFree("b", "linear", {3.0, 0.0}, {"k"}, dynamics.get());
  Profiled fit(dynamics, (Vector(4) << 7.0, 0.0, 3.0, 0.0).finished(), 0.02);
  ASSERT_TRUE(fit.Run()) << fit.error;
  EXPECT_EQ(fit.Of("a.k").determination, Determination::kNotAtAll);
  EXPECT_THAT(fit.Of("a.k").combinations, ElementsAre("b.k + a.k"));
  EXPECT_EQ(fit.Of("b.k").determination, Determination::kNotAtAll);
  EXPECT_TRUE(std::isinf(fit.Of("b.k").upper95));
}

// The scale of a hysteretic state is nobody's business.
TEST(ProfileParameters, NamesTheProductThatAloneIsDetermined) {
  auto dynamics = OnASpring();
  AddFree("d", "bouc_wen", {2.0, 20.0, 8.0, 3.0, 1.0}, {"k", "a"},
          dynamics.get());
  Profiled fit(dynamics,
               (Vector(6) << 2.0, 24.0, 8.0, 3.0, 1.0, 1.0).finished(), 0.01);
  ASSERT_TRUE(fit.Run({"d.k"})) << fit.error;
  ASSERT_EQ(fit.profiles.size(), 1);
  EXPECT_EQ(fit.Of("d.k").determination, Determination::kNotAtAll);
  EXPECT_THAT(fit.Of("d.k").combinations, ElementsAre("d.k * d.a"));
}

// The literature's four parameters of the shape are three; and along the way
// the factor may change its sign with the others'.
TEST(ProfileParameters, NamesTheTwoProductsOfBoucWensShape) {
  auto dynamics = OnASpring();
  AddFree("d", "bouc_wen", {20.0, 1.0, 7.0, 2.5, 1.3, 1.2},
          {"b", "g", "n", "beta"}, dynamics.get());
  Profiled fit(dynamics,
               (Vector(6) << 20.0, 1.0, 8.0, 3.0, 1.5, 1.0).finished(), 0.01);
  ASSERT_TRUE(fit.Run()) << fit.error;
  EXPECT_EQ(fit.Of("d.beta").determination, Determination::kNotAtAll);
  EXPECT_THAT(fit.Of("d.beta").combinations,
              ElementsAre("d.beta * d.b", "d.beta * d.g"));
  EXPECT_EQ(fit.Of("d.n").determination, Determination::kDetermined);
}

// One linearisation says that the valley's floor is level, with the start among
// the unknowns and an exponent at its bound too.
TEST(ProfileParameters, WalksAlongAValleyAtLittleCost) {
  auto dynamics = OnASpring();
  AddFree("d", "bouc_wen", {20.0, 1.0, 7.0, 2.5, 1.1, 1.2},
          {"b", "g", "n", "beta"}, dynamics.get());
  Profiled fit(dynamics,
               (Vector(6) << 20.0, 1.0, 8.0, 3.0, 1.0, 1.0).finished(), 0.01);
  fit.problem.records[0].start = IdentificationRecord::Start::kFree;
  ASSERT_TRUE(fit.Run()) << fit.error;
  for (const char* name : {"d.b", "d.g", "d.beta"}) {
    EXPECT_EQ(fit.Of(name).determination, Determination::kNotAtAll) << name;
    EXPECT_LE(fit.Of(name).linearizations, 16) << name;
  }
  EXPECT_LE(fit.Of("d.n").linearizations, 20);
  EXPECT_TRUE(std::isfinite(fit.Of("d.n").upper95));
}

// A gap that was never closed could be wider, but not narrower.
TEST(ProfileParameters, HasOneEndWhereTheDataSeeOne) {
  auto dynamics = OnASpring();
  AddFree("stop", "bilinear", {40.0, 0.35}, {"gap"}, dynamics.get());
  Profiled fit(dynamics, Eigen::Vector2d(40.0, 0.35), 0.02, 1.3);
  ASSERT_TRUE(fit.Run()) << fit.error;
  const ParameterProfile& gap = fit.Of("stop.gap");
  EXPECT_EQ(gap.determination, Determination::kOneSided);
  const double largest =
      fit.summary.records[0].states.row(0).cwiseAbs().maxCoeff();
  EXPECT_LT(gap.lower95, 1.02 * largest);
  EXPECT_GT(gap.lower95, 0.7 * largest);
  EXPECT_TRUE(std::isinf(gap.upper95));
  EXPECT_TRUE(gap.DiffersFromLinear());
}

TEST(ProfileParameters, StopsWhereItIsToldTo) {
  Profiled fit(testing::MakeGroupedChain(3, 40.0, 0.4),
               Eigen::Vector3d(0.1, -0.05, 0.02), 0.02);
  testing::FitAndJudge(fit.problem, fit.options, nullptr, &fit.summary,
                       &fit.model);
  ProfileOptions options;
  options.callback = [](const std::vector<ParameterProfile>& done, int of) {
    EXPECT_EQ(of, 3);
    return done.size() < 2;
  };
  ASSERT_TRUE(ProfileParameters(fit.problem, fit.summary, fit.model,
                                fit.options, options, &fit.profiles,
                                &fit.error));
  EXPECT_EQ(fit.profiles.size(), 2);
}

TEST(ProfileParameters, GoesOnWhereItWasCutOff) {
  Profiled fit(testing::MakeGroupedChain(3, 40.0, 0.4),
               Eigen::Vector3d(0.1, -0.05, 0.02), 0.02);
  ASSERT_TRUE(fit.Run()) << fit.error;
  ASSERT_EQ(fit.profiles.size(), 3u);
  const std::vector<ParameterProfile> whole = fit.profiles;

  // Known profiles are kept, though no more work is allowed.
  ProfileOptions options;
  options.known = {whole[0], whole[2]};
  options.stop = []() { return true; };
  ASSERT_TRUE(ProfileParameters(fit.problem, fit.summary, fit.model,
                                fit.options, options, &fit.profiles,
                                &fit.error));
  ASSERT_EQ(fit.profiles.size(), 2u);
  EXPECT_EQ(fit.profiles[1].name, whole[2].name);
  EXPECT_EQ(fit.profiles[1].lower95, whole[2].lower95);

  // But not around another fit.
  options.known[0].estimate += 0.1 * (whole[0].upper95 - whole[0].lower95);
  ASSERT_TRUE(ProfileParameters(fit.problem, fit.summary, fit.model,
                                fit.options, options, &fit.profiles,
                                &fit.error));
  ASSERT_EQ(fit.profiles.size(), 1u);
  EXPECT_EQ(fit.profiles[0].name, whole[2].name);
}

TEST(ProfileParameters, SaysWhatItCannotDo) {
  Profiled fit(testing::MakeGroupedChain(2, 40.0, 0.4),
               Eigen::Vector2d(0.1, -0.05), 0.02);
  EXPECT_FALSE(fit.Run({"k3"}));
  EXPECT_THAT(fit.error, HasSubstr("no free parameter 'k3'"));
  fit.summary.covariance_method = "errors in variables";
  EXPECT_FALSE(ProfileParameters(fit.problem, fit.summary, fit.model,
                                 fit.options, {}, &fit.profiles, &fit.error));
  EXPECT_THAT(fit.error, HasSubstr("its errors were unknowns"));
  EXPECT_FALSE(ProfileParameters(fit.problem, IdentificationSummary(),
                                 IdentifiedModel(), fit.options, {},
                                 &fit.profiles, &fit.error));
}

TEST(DescribeCombinations, ProductsPowersAndSums) {
  Matrix values(5, 6);
  for (int p = 0; p < 6; ++p) {
    const double a = 1.0 + 0.4 * p;
    values.col(p) << a, 8.0 / a, -3.0 * a * a, 10.0 - 0.5 * a, 2.0;
  }
  EXPECT_THAT(DescribeCombinations({"a", "b", "c", "d", "e"}, values, 0),
              ElementsAre("a * b", "c / a^2", "d + 0.5 a"));
  // Along b, and of what is neither.
  EXPECT_THAT(DescribeCombinations({"a", "b", "c", "d", "e"}, values, 1),
              Contains("b * a"));
  values.row(1) = values.row(0).array().sin();
  EXPECT_THAT(DescribeCombinations({"a", "b"}, values.topRows(2), 0),
              IsEmpty());
}

}  // namespace
}  // namespace pinode
