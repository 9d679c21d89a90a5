// Discovery on the cases of data/: from records over networks to equations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/figure_testing.h"
#include "pinode/case/discovered_case.h"
#include "pinode/discover/discovery.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {
namespace {

// The right-hand side's terms that a scheme leaves to the network, by output:
// accelerations, of unit masses.
using Terms = std::map<std::pair<std::string, std::string>, double>;

Terms MissingTerms(double share_of_chain) {
  Terms truth;
  const int n = 4;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double unit = i == j                 ? (i + 1 < n ? -2.0 : -1.0)
                          : std::abs(i - j) == 1 ? 1.0
                                                 : 0.0;
      if (unit == 0.0 || share_of_chain == 0.0) continue;
      const std::string output = "x" + std::to_string(i + 1);
      const std::string input = "x" + std::to_string(j + 1);
      truth[{output, "x[" + input + "]"}] = 10.0 * share_of_chain * unit;
      truth[{output, "v[" + input + "]"}] = 0.5 * share_of_chain * unit;
    }
  }
  truth[{"x1", "x[x1]^3"}] = -2.0;
  return truth;
}

class Discover : public ::testing::TestWithParam<const char*> {};

// Table 2 of Lai et al. (2021): exactly the true terms, from all polynomials of
// degree 3 in the eight states, and their coefficients.
TEST_P(Discover, FindsExactlyTheTrueTerms) {
  const std::string scheme = GetParam();
  const CaseRun run =
      RunCase(ReadCaseOrFail("data/four_dof_free/" + scheme + ".toml"));
  ASSERT_TRUE(run.summary.usable) << run.summary.message;
  std::string error;
  std::vector<DiscoveredEquation> equations;
  ASSERT_TRUE(DiscoverFromNetworks(run.c.problem, run.model, run.c.discover,
                                   &equations, &error))
      << error;
  ASSERT_EQ(equations.size(), 4u);
  const Terms truth = MissingTerms(scheme == "scheme2" ? 0.3 : 0.0);
  Terms selected;
  double worst = 0.0;
  for (const DiscoveredEquation& equation : equations) {
    EXPECT_EQ(equation.num_candidates, 164);
    for (const DiscoveredTerm& term : equation.terms) {
      const auto found = truth.find({equation.output, term.basis});
      if (found == truth.end()) {
        ADD_FAILURE() << equation.output << ": " << term.basis
                      << " is not a term of the chain";
        continue;
      }
      selected[found->first] = term.coefficient;
      worst = Worse(worst, std::abs(term.coefficient / found->second - 1.0));
    }
  }
  EXPECT_EQ(selected.size(), truth.size());
  ReportFigure(
      "case 1, " + scheme + ", from the network: worst coefficient, relative",
      AtMost(1e-2), worst);
  EXPECT_LT(worst, 1e-2);

  Discovery discovery;
  ASSERT_TRUE(RefitEquations(run.c, run.model, equations, nullptr, &discovery, &error))
      << error;
  EXPECT_TRUE(discovery.summary.usable) << discovery.summary.message;
  EXPECT_THAT(discovery.dropped, ::testing::IsEmpty());
  worst = 0.0;
  int count = 0;
  for (size_t e = 0; e < discovery.equations.size(); ++e) {
    for (const EquationTerm& term : discovery.terms[e]) {
      const auto found =
          truth.find({discovery.equations[e].output, term.basis});
      ASSERT_TRUE(found != truth.end()) << term.basis;
      worst = Worse(worst, std::abs(term.coefficient / found->second - 1.0));
      ++count;
    }
  }
  EXPECT_EQ(count, static_cast<int>(truth.size()));
  ReportFigure("case 1, " + scheme +
                   ", refit through the ODE: worst coefficient, relative",
               AtMost(1e-6), worst);
  EXPECT_LT(worst, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(FourDofFree, Discover,
                         ::testing::Values("scheme2", "scheme3"));

}  // namespace
}  // namespace testing
}  // namespace pinode
