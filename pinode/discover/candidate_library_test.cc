#include "pinode/discover/candidate_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CandidateLibrary Created(const std::vector<std::string>& features,
                         const CandidateLibraryOptions& options) {
  CandidateLibrary library;
  std::string error;
  EXPECT_TRUE(CandidateLibrary::Create(features, options, &library, &error))
      << error;
  return library;
}

TEST(CandidateLibrary, NamesEveryKindInOrder) {
  CandidateLibraryOptions options;
  options.constant = true;
  options.polynomial_degree = 3;
  options.sine_features = {"x[1]"};
  options.cosine_features = {"v[1]"};
  options.absolute_features = {"v[1]"};
  options.sign_features = {"v[1]"};
  options.signed_square_features = {"x[1]"};
  options.expressions = {"tanh( v[1] / 0.01 )"};
  const CandidateLibrary library = Created({"x[1]", "v[1]"}, options);
  EXPECT_THAT(library.Names(),
              ElementsAre("1", "x[1]", "v[1]", "x[1]^2", "x[1]*v[1]", "v[1]^2",
                          "x[1]^3", "x[1]^2*v[1]", "x[1]*v[1]^2", "v[1]^3",
                          "sin(x[1])", "cos(v[1])", "abs(v[1])", "sign(v[1])",
                          "abs(x[1])*x[1]", "tanh(v[1]/0.01)"));
  EXPECT_EQ(library.degree(0), 0);
  EXPECT_EQ(library.degree(2), 1);
  EXPECT_EQ(library.degree(4), 2);
  EXPECT_EQ(library.degree(9), 3);
  for (int k = 10; k < library.size(); ++k) {
    EXPECT_EQ(library.degree(k), kNotAMonomial);
  }
}

TEST(CandidateLibrary, ProductsAndFeaturesAreChosen) {
  CandidateLibraryOptions options;
  options.polynomial_degree = 2;
  options.products = false;
  options.polynomial_features = {"d[a,b]", "input[road]"};
  EXPECT_THAT(
      Created({"x[a]", "d[a,b]", "input[road]"}, options).Names(),
      ElementsAre("d[a,b]", "input[road]", "d[a,b]^2", "input[road]^2"));
  options.products = true;
  options.polynomial_features.clear();
  // Monomials in 3 features: 3 of degree 1 and 6 of degree 2.
  EXPECT_EQ(Created({"x[a]", "d[a,b]", "input[road]"}, options).size(), 9);
  options.polynomial_degree = 4;
  EXPECT_EQ(Created({"a", "b", "c", "d"}, options).size(), 69);
}

TEST(CandidateLibrary, EvaluatesSamplesByHand) {
  CandidateLibraryOptions options;
  options.polynomial_degree = 2;
  options.signed_square_features = {"x[1]"};
  options.sign_features = {"v[1]"};
  const CandidateLibrary library = Created({"x[1]", "v[1]"}, options);
  Matrix features(2, 2);
  features << 2.0, -3.0, -0.5, 0.25;
  Matrix expected(2, 7);
  expected << 2.0, -3.0, 4.0, -6.0, 9.0, -1.0, 4.0,  //
      -0.5, 0.25, 0.25, -0.125, 0.0625, 1.0, -0.25;
  Matrix theta;
  std::string error;
  ASSERT_TRUE(library.Evaluate(features, &theta, &error)) << error;
  EXPECT_EQ(theta, expected);

  Vector values;
  Matrix jacobian;
  library.Linearize(features.row(0).transpose(), &values, &jacobian);
  EXPECT_EQ(values, expected.row(0).transpose());
  Matrix slopes(7, 2);
  slopes << 1.0, 0.0, 0.0, 1.0, 4.0, 0.0, -3.0, 2.0, 0.0, -6.0, 0.0, 0.0, 4.0,
      0.0;
  EXPECT_EQ(jacobian, slopes);
}

TEST(CandidateLibrary, OutsideADomainItNamesCandidateAndSample) {
  CandidateLibraryOptions options;
  options.expressions = {"ln(x[1])"};
  const CandidateLibrary library = Created({"x[1]"}, options);
  Matrix features(3, 1);
  features << 1.0, 2.0, -1.0;
  Matrix theta;
  std::string error;
  EXPECT_FALSE(library.Evaluate(features, &theta, &error));
  EXPECT_THAT(error, HasSubstr("'ln(x[1])' is not finite at sample 3"));
  EXPECT_EQ(theta.size(), 0);
}

TEST(CandidateLibrary, RefusesBadOptions) {
  const std::vector<std::string> features = {"x[1]", "v[1]"};
  const auto refused = [&](const CandidateLibraryOptions& options) {
    CandidateLibrary library;
    std::string error;
    EXPECT_FALSE(CandidateLibrary::Create(features, options, &library, &error));
    EXPECT_EQ(library.size(), 0);
    return error;
  };
  CandidateLibraryOptions options;
  options.polynomial_features = {"x[2]"};
  EXPECT_THAT(refused(options), HasSubstr("polynomials: unknown feature"));
  options = {};
  options.sine_features = {"x[1]", "x[1]"};
  EXPECT_THAT(refused(options), HasSubstr("sines: feature 'x[1]' twice"));
  options = {};
  options.expressions = {"x[1] ^ 3"};
  EXPECT_THAT(refused(options), HasSubstr("candidate 'x[1]^3' twice"));
  options = {};
  options.expressions = {"2*y[1]"};
  EXPECT_THAT(refused(options), HasSubstr("'2*y[1]', column 3: unknown"));
  options = {};
  options.polynomial_degree = -1;
  EXPECT_THAT(refused(options), HasSubstr("degree -1"));
  options.polynomial_degree = 0;
  EXPECT_THAT(refused(options), HasSubstr("no candidate"));
  options.polynomial_degree = 100;
  EXPECT_THAT(refused(options), HasSubstr("more than 2000 candidates"));
  CandidateLibrary library;
  std::string error;
  EXPECT_FALSE(
      CandidateLibrary::Create({"x[1]", "x[1]"}, {}, &library, &error));
  EXPECT_THAT(error, HasSubstr("feature 'x[1]' twice"));
}

}  // namespace
}  // namespace pinode
