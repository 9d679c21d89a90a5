#include "pinode/discover/equation_values.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// g = 2 x - 3 x v over three samples; nothing depends on t.
DiscoveredEquation Bilinear() {
  DiscoveredEquation equation;
  equation.output = "u";
  equation.feature_names = {"x[u]", "v[u]", "t"};
  equation.sample_features.resize(3, 3);
  equation.sample_features << 1.0, 2.0, 0.0, -1.0, 0.5, 0.1, 0.5, -2.0, 0.2;
  equation.terms.resize(2);
  equation.terms[0].basis = "x[u]";
  equation.terms[0].coefficient = 2.0;
  equation.terms[1].basis = "x[u]*v[u]";
  equation.terms[1].coefficient = -3.0;
  return equation;
}

TEST(EquationValuesTest, SumsTermsAndTheirPartsByFeature) {
  EquationValues values;
  std::string error;
  ASSERT_TRUE(EvaluateAtSamples(Bilinear(), &values, &error)) << error;
  EXPECT_TRUE(values.sum.isApprox(Eigen::Vector3d(-4.0, -0.5, 4.0)));
  ASSERT_EQ(values.parts.size(), 3u);
  EXPECT_TRUE(values.parts[0].isApprox(values.sum));
  EXPECT_TRUE(values.parts[1].isApprox(Eigen::Vector3d(-6.0, 1.5, 3.0)));
  EXPECT_EQ(values.parts[2].size(), 0);
}

TEST(EquationValuesTest, RefusesWhatIsNoEquation) {
  EquationValues values;
  std::string error;
  DiscoveredEquation equation = Bilinear();
  equation.terms[1].basis = "x[w]";
  EXPECT_FALSE(EvaluateAtSamples(equation, &values, &error));
  EXPECT_THAT(error, HasSubstr("x[w]"));
  equation = Bilinear();
  equation.feature_names.pop_back();
  EXPECT_FALSE(EvaluateAtSamples(equation, &values, &error));
  EXPECT_THAT(error, HasSubstr("equation of 'u'"));
}

}  // namespace
}  // namespace pinode
