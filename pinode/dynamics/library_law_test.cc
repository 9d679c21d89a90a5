#include "pinode/dynamics/library_law.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

std::vector<LibraryFunction> Parse(const std::vector<std::string>& terms,
                                   const std::vector<std::string>& features) {
  std::vector<LibraryFunction> functions(terms.size());
  std::string error;
  for (size_t k = 0; k < terms.size(); ++k) {
    EXPECT_TRUE(
        LibraryFunction::Parse(terms[k], features, &functions[k], &error))
        << error;
  }
  return functions;
}

TEST(LibraryLaw, ValueAndDerivativesByHand) {
  // g = a x^3 + b x v + c |v| v at x = 2, v = -3.
  const LibraryLaw law(2, Parse({"x[u1]^3", "x[u1]*v[u1]", "abs(v[u1])*v[u1]"},
                                {"x[u1]", "v[u1]"}));
  ASSERT_EQ(law.num_parameters(), 3);
  ASSERT_EQ(law.num_arguments(), 5);
  const double q[] = {2.0, -3.0};
  const double xi[] = {-2.0, 0.5, 10.0};
  double value;
  double jacobian[5];
  law.Linearize(q, nullptr, xi, &value, jacobian);
  EXPECT_DOUBLE_EQ(value, -16.0 - 3.0 - 90.0);
  EXPECT_DOUBLE_EQ(jacobian[0], -2.0 * 12.0 + 0.5 * -3.0);  // by x
  EXPECT_DOUBLE_EQ(jacobian[1], 0.5 * 2.0 + 10.0 * 6.0);    // by v: 2 |v|
  EXPECT_DOUBLE_EQ(jacobian[2], 8.0);
  EXPECT_DOUBLE_EQ(jacobian[3], -6.0);
  EXPECT_DOUBLE_EQ(jacobian[4], -9.0);

  double alone;
  law.Evaluate(q, nullptr, xi, &alone);
  EXPECT_DOUBLE_EQ(alone, value);

  WideJet jets[5];
  for (int i = 0; i < 5; ++i) {
    jets[i] = WideJet(i < 2 ? q[i] : xi[i - 2], i);
  }
  WideJet result;
  law.Evaluate(jets, nullptr, jets + 2, &result);
  EXPECT_DOUBLE_EQ(result.a, value);
  for (int i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(result.v[i], jacobian[i]);
}

// sqrt has an infinite slope at 0, where a structure may be at rest.
TEST(LibraryLaw, ACoefficientOfZeroKeepsAnInfiniteSlopeOut) {
  const LibraryLaw law(1, Parse({"x[u1]", "sqrt(x[u1])"}, {"x[u1]"}));
  const double q = 0.0;
  const double xi[] = {3.0, 0.0};
  double value;
  double jacobian[3];
  law.Linearize(&q, nullptr, xi, &value, jacobian);
  EXPECT_EQ(value, 0.0);
  EXPECT_EQ(jacobian[0], 3.0);
}

// Accelerations are added unchanged; forces resist and act through M.
TEST(LibraryLaw, ActsAsAccelerationOrForce) {
  for (const ActsAs acts_as : {ActsAs::kAcceleration, ActsAs::kForce}) {
    StructuralModel model = testing::MakeChain(2, 0.0, 0.0);
    model.mass.diagonal() << 4.0, 5.0;
    StructuralDynamics dynamics(model, {});
    LawTerm term;
    term.name = "nl";
    term.type = "library";
    term.law = std::make_shared<LibraryLaw>(1, Parse({"x[u1]^3"}, {"x[u1]"}));
    term.features = {Feature::Displacement(0)};
    term.outputs = Matrix::Zero(2, 1);
    term.outputs(0, 0) = 1.0;
    term.outputs(1, 0) = -1.0;
    term.acts_as = acts_as;
    term.parameters.name = "nl";
    Parameter xi;
    xi.name = "nl.x[u1]^3";
    xi.value = 10.0;
    term.parameters.parameters = {xi};
    std::string error;
    ASSERT_TRUE(dynamics.AddLaw(std::move(term), &error)) << error;
    StructuralDynamics::Prepared prepared;
    ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
    const double state[] = {2.0, 1.0, 0.0, 0.0};
    auto stage = dynamics.MakeLinearization();
    dynamics.Linearize(prepared, 0.0, nullptr, state, &stage);
    const bool force = acts_as == ActsAs::kForce;
    EXPECT_DOUBLE_EQ(stage.rate[2], force ? -80.0 / 4.0 : 80.0);
    EXPECT_DOUBLE_EQ(stage.rate[3], force ? 80.0 / 5.0 : -80.0);
    EXPECT_DOUBLE_EQ(stage.jacobian(2, 0), force ? -120.0 / 4.0 : 120.0);
    EXPECT_DOUBLE_EQ(stage.force_acceleration[0], force ? -20.0 : 0.0);
  }
}

TEST(LibraryLaw, FunctionsThatDoNotFitAreRefused) {
  std::vector<LibraryFunction> functions(1);
  std::string error;
  ASSERT_TRUE(LibraryFunction::Parse("a*b", {"a", "b"}, &functions[0], &error));
  EXPECT_TRUE(LibraryLaw::AreValid(2, functions, &error)) << error;
  EXPECT_FALSE(LibraryLaw::AreValid(1, functions, &error));
  EXPECT_EQ(error, "'a*b' is of other features than its term");
  EXPECT_FALSE(LibraryLaw::AreValid(0, functions, &error));
  EXPECT_FALSE(LibraryLaw::AreValid(2, {}, &error));
}

}  // namespace
}  // namespace pinode
