// Discovery on the cases of data/: from records over networks to equations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/study/laws/refit.h"
#include "tests/cases/case_figures.h"
#include "tests/cases/chain_terms.h"
#include "tests/cases/measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

class Discover : public ::testing::TestWithParam<const char*> {};

// The networks of schemes 2 and 3 predict what they have not seen. Table 2 of
// Lai et al. (2021): exactly the true terms, from all polynomials of
// degree 3 in the eight states, and their coefficients.
TEST_P(Discover, FindsExactlyTheTrueTerms) {
  const std::string scheme = GetParam();
  const CaseRun run =
      RunCase(ReadCaseOrFail("data/four_dof_free/" + scheme + ".toml"));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  ExpectFigures("case 1, " + scheme, SchemeFigures(scheme), run);
  std::string error;
  std::vector<DiscoveredEquation> equations;
  ASSERT_TRUE(DiscoverFromNetworks(run.c.problem, run.model, run.c.discover,
                                   &equations, &error))
      << error;
  ASSERT_EQ(equations.size(), 4u);
  for (const DiscoveredEquation& equation : equations) {
    EXPECT_EQ(equation.num_candidates, 164);
  }
  const Terms truth = MissingTerms(scheme);
  const double share = ShareOfChain(scheme);
  TermsFound found =
      Compare(WithoutRefit(run.c.problem, equations), truth, share);
  EXPECT_EQ(found.num_missing + found.num_spurious, 0) << found.wrong;
  ExpectFigure(
      "case 1, " + scheme + ", from the network: worst coefficient, relative",
      1e-2, found.worst);
  // Where the case asks for an ensemble.
  if (run.c.discover.num_bags > 0) {
    double least = 1.0;
    for (const DiscoveredEquation& equation : equations) {
      for (const DiscoveredTerm& term : equation.terms) {
        const double p = term.inclusion_probability;
        if (!(p >= least)) least = p;  // not a number counts
      }
    }
    ReportFigure("case 1, " + scheme + ": least inclusion probability",
                 Nothing(), least);
    EXPECT_GT(least, 0.5);
  }

  Discovery discovery;
  ASSERT_TRUE(RefitEquations(run.c.problem, run.model, equations,
                             run.c.discover, run.c.options, nullptr, nullptr,
                             &discovery, &error))
      << error;
  EXPECT_TRUE(discovery.summary.usable()) << discovery.summary.message;
  EXPECT_THAT(discovery.dropped, ::testing::IsEmpty());
  EXPECT_THAT(discovery.added, ::testing::IsEmpty());
  found = Compare(discovery, truth, share);
  EXPECT_EQ(found.num_missing + found.num_spurious, 0) << found.wrong;
  // The records have twelve digits, which is where the refit ends, whatever the
  // network.
  ExpectFigure("case 1, " + scheme +
                   ", refit through the ODE: worst coefficient, relative",
               1e-6, 1e-9, found.worst);
}

INSTANTIATE_TEST_SUITE_P(FourDofFree, Discover,
                         ::testing::Values("scheme2", "scheme3"));

// Equations from the records' derivatives, refitted to the trajectories.
Discovery FromDerivatives(const Case& c) {
  std::string error;
  std::vector<DiscoveredEquation> equations;
  IdentifiedModel begin;
  Discovery discovery;
  EXPECT_TRUE(DiscoverFromDerivatives(c.problem, c.discover, &equations, &begin,
                                      &error))
      << error;
  EXPECT_TRUE(RefitEquations(c.problem, begin, equations, c.discover, c.options,
                             nullptr, nullptr, &discovery, &error))
      << error;
  EXPECT_TRUE(discovery.summary.usable()) << discovery.summary.message;
  return discovery;
}

// Nine terms between two masses and a road, 1 % noise.
TEST(DiscoverQuarterCar, FindsExactlyTheTrueTerms) {
  const Case c = ReadCaseOrFail("data/quarter_car/quarter_car.toml");
  const Discovery discovery = FromDerivatives(c);
  Terms truth;
  const std::string file = "data/quarter_car/truth.json";
  for (const char* basis : {"x[s]", "x[u]", "v[s]", "v[u]"}) {
    truth[{"s", basis}] = Truth(file, std::string("/sprung/") + basis);
    truth[{"u", basis}] = Truth(file, std::string("/unsprung/") + basis);
  }
  truth[{"u", "input[road]"}] = Truth(file, "/unsprung/input[road]");
  const TermsFound found = Compare(discovery, truth, 1.0);
  ReportFigure("quarter_car: terms missing or wrong", AtMost(0),
               found.num_missing + found.num_spurious);
  EXPECT_EQ(found.num_missing + found.num_spurious, 0) << found.wrong;
  ReportFigure("quarter_car: worst coefficient, relative", AtMost(0.02),
               found.worst);
  EXPECT_LT(found.worst, 0.02);
}

// Three hardening storeys among twenty, and a free run of ten times the record.
TEST(DiscoverChain20, FindsTheStoreysThatHarden) {
  const Case c = ReadCaseOrFail("data/chain20/chain20.toml");
  const Discovery discovery = FromDerivatives(c);
  ASSERT_EQ(discovery.equations.size(), 20u);
  Terms truth;
  for (const int storey : {4, 11, 17}) {
    const std::string here = "u" + std::to_string(storey);
    const std::string below = "u" + std::to_string(storey - 1);
    truth[{here + "-" + below, "d[" + below + "," + here + "]^3"}] =
        Truth("data/chain20/truth.json", "/cubic/" + std::to_string(storey));
  }
  const TermsFound found = Compare(discovery, truth, 1.0);
  ReportFigure("chain20: terms missing or wrong", AtMost(0),
               found.num_missing + found.num_spurious);
  EXPECT_EQ(found.num_missing + found.num_spurious, 0) << found.wrong;
  ReportFigure("chain20: worst coefficient, relative", AtMost(0.02),
               found.worst);
  EXPECT_LT(found.worst, 0.02);
  for (const RecordScore& record : discovery.summary.records) {
    if (record.name != "long") continue;
    EXPECT_TRUE(record.finite);
    ReportFigure("chain20: nrmse of ten times the record", AtMost(0.01),
                 record.nrmse);
    EXPECT_LT(record.nrmse, 0.01);
  }
}

}  // namespace
}  // namespace testing
}  // namespace pinode
