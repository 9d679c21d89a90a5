// Damping ratios of modes that are free, from a case file to a result.

#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/results/finite_element_result.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/record_grid.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/reduction/renewed_basis.h"
#include "tests/support/case_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/rod_case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Parameters of the rod's case: lower, upper, brace, zeta1, zeta2.
constexpr int kFirstRatio = 3;

constexpr char kRatioGroups[] = R"([[group]]
name = "zeta1"
adds_to = "damping"
mode = 1
ratio = 0.02
lower = -1.0
[[group]]
name = "zeta2"
adds_to = "damping"
modes_from = 2
ratio = 0.02
lower = -1.0
[[record]]
name)";

std::string CaseBy(const std::string& method) {
  return Replaced(Replaced(kRodCase, "[[record]]\nname", kRatioGroups),
                  "method = \"guyan\"", method);
}

Vector RatiosOf(const StructuralDynamics& dynamics, const Vector& parameters) {
  const StructuralModel model = dynamics.CorrectedModel(parameters);
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  return modes.damping_ratio;
}

class ModeDampingTest : public RodCaseTest {
 protected:
  // Returns the case with what its sensors would have measured with these
  // parameters.
  Case Measured(const Vector& hidden, double noise) {
    Case c = ReadOrFail(
        CaseBy("method = \"craig_bampton\"\nmodes = 2\nkeep = [\"4.1\", "
               "\"8.1\"]"));
    IdentificationRecord& record = c.problem.records[0];
    const StructuralDynamics& dynamics = *c.problem.dynamics;
    IdentificationRecord excited =
        testing::MakeExcitedRecord(dynamics, 1500, 0.01);
    excited.start = IdentificationRecord::Start::kRest;
    excited.substeps = record.substeps;
    excited.channels = record.channels;
    excited.name = record.name;
    testing::Simulate(dynamics, hidden, Vector::Zero(dynamics.num_states()),
                      noise, 7, &excited);
    record = std::move(excited);
    return c;
  }
};

TEST_F(ModeDampingTest, EachModeHasItsRatio) {
  for (const char* method :
       {"method = \"guyan\"", "method = \"serep\"",
        "method = \"craig_bampton\"\nmodes = 2",
        "method = \"modal\"\nmodes = 3\nkeep = [\"4.1\", \"8.1\"]"}) {
    const Case c = ReadOrFail(CaseBy(method));
    ASSERT_NE(c.problem.dynamics, nullptr);
    Vector parameters = c.problem.dynamics->Parameters();
    ASSERT_EQ(parameters.size(), 5) << method;
    parameters[kFirstRatio] = 0.5;
    parameters[kFirstRatio + 1] = -0.25;
    const Vector ratios = RatiosOf(*c.problem.dynamics, parameters);
    EXPECT_NEAR(ratios[0], 0.03, 1e-12) << method;
    for (Eigen::Index i = 1; i < ratios.size(); ++i) {
      EXPECT_NEAR(ratios[i], 0.015, 1e-12) << method << ", mode " << i + 1;
    }
  }
}

TEST_F(ModeDampingTest, ModelsWithoutReductionToo) {
  folder_.Write("quake.csv", SmallRecord());
  const Case c =
      ReadOrFail(Replaced(SmallCase(), "[[record]]\nname", kRatioGroups));
  ASSERT_NE(c.problem.dynamics, nullptr);
  const Vector ratios = RatiosOf(*c.problem.dynamics, Vector{{0.0, 1.0, -1.0}});
  EXPECT_NEAR(ratios[0], 0.04, 1e-12);
  EXPECT_NEAR(ratios[1], 0.0, 1e-12);
}

TEST_F(ModeDampingTest, RatiosFollowARenewedBasis) {
  Case c = ReadOrFail(CaseBy("method = \"craig_bampton\"\nmodes = 2"));
  ASSERT_NE(c.finite_element, nullptr);
  const ReducedProblem from{c.problem, *c.finite_element};
  IdentifiedModel found;
  found.parameters = Vector{{-0.5, 0.2, 0.0, 0.5, -0.25}};
  ReducedProblem renewed;
  IdentifiedModel begin;
  std::string error;
  ASSERT_TRUE(RenewBasis(from, found, &renewed, &begin, &error)) << error;
  const Vector ratios = RatiosOf(*renewed.problem.dynamics, begin.parameters);
  EXPECT_NEAR(ratios[0], 0.03, 1e-12);
  EXPECT_NEAR(ratios[1], 0.015, 1e-12);
  // In the basis before they are those of other modes.
  EXPECT_GT(std::abs(RatiosOf(*c.problem.dynamics, found.parameters)[0] - 0.03),
            1e-4);
}

// Derivatives of the channels by the ratios, against Ridders' differences.
TEST_F(ModeDampingTest, DerivativesAreExact) {
  const Vector at{{-0.1, 0.1, 0.2, 0.3, -0.2}};
  Case c = Measured(at, 0.0);
  ASSERT_NE(c.problem.dynamics, nullptr);
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  IdentificationRecord record = c.problem.records[0];
  const int last = 300;
  const Vector start = Vector::Zero(dynamics.num_states());
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(at, &prepared, &error)) << error;
  const ObservationMap observation(dynamics, record.Observations());
  SegmentTangents exact;
  SegmentPropagator propagator(dynamics, DerivativeMethod::kTangents);
  const IntegrationGrid grid = GridOf(dynamics, record, *record.excitation);
  ASSERT_TRUE(propagator.Propagate(prepared, observation, grid, start, 0, last,
                                   true, SegmentColumns::kParameters, &exact));
  ASSERT_EQ(exact.jacobian().cols(), at.size());
  const auto num_channels = static_cast<Eigen::Index>(record.channels.size());
  for (int p = kFirstRatio; p < at.size(); ++p) {
    const auto channels = [&](double change) {
      testing::Simulate(dynamics, at + change * Vector::Unit(at.size(), p),
                        start, 0.0, 7, &record);
      Vector values(num_channels * (last + 1));
      for (Eigen::Index i = 0; i <= last; ++i) {
        for (Eigen::Index k = 0; k < num_channels; ++k) {
          values[i * num_channels + k] =
              record.channels[static_cast<size_t>(k)].values[i];
        }
      }
      return values;
    };
    const Vector difference = testing::Differentiate(channels, 0.05);
    ASSERT_EQ(exact.jacobian().rows(), difference.size());
    EXPECT_GT(difference.norm(), 1e-4);
    EXPECT_LT((exact.jacobian().col(p) - difference).norm(),
              1e-8 * difference.norm());
  }
}

// A fit finds damping of 3.2 % and 1.2 % from 2 % in both, beside the
// stiffness.
TEST_F(ModeDampingTest, HiddenDampingIsFound) {
  const Vector hidden{{-0.2, 0.1, 0.0, 0.6, -0.4}};
  Case c = Measured(hidden, 0.01);
  ASSERT_NE(c.problem.dynamics, nullptr);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(c.problem, c.options, nullptr, &summary, &model);
  ASSERT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 5u);
  for (size_t p = 0; p < 5; ++p) {
    const ParameterEstimate& found = summary.parameters[p];
    std::printf("%-6s %9.5f +- %.5f\n", found.name.c_str(), found.value,
                found.sigma);
    EXPECT_NEAR(found.value, hidden[static_cast<Eigen::Index>(p)],
                4.0 * found.sigma)
        << found.name;
    EXPECT_LT(found.sigma, 0.05) << found.name;
  }
}

// Ratios are no matrix over all DOFs: a model with ratios has none, and one
// with Rayleigh's damping says that the group is missing from it.
TEST_F(ModeDampingTest, RemarksSayWhatIsNotWritten) {
  Case c = ReadOrFail(CaseBy("method = \"guyan\""));
  const auto remarks = [&c] {
    std::string all;
    for (const std::string& remark : c.problem.description.remarks) {
      all += remark + "\n";
    }
    return all;
  };
  EXPECT_THAT(remarks(), ::testing::Not(HasSubstr("'zeta1'")));
  c = ReadOrFail(Replaced(CaseBy("method = \"guyan\""), "{ratios = [0.02]}",
                          "{rayleigh = [0.3, 0.001]}"));
  EXPECT_THAT(remarks(), HasSubstr("'zeta1'"));
}

TEST_F(ModeDampingTest, RefusesWhatCannotBe) {
  const auto refusal = [this](const std::string& keys) {
    return Refusal("[[record]]\nname",
                   "[[group]]\nname = \"z\"\n" + keys + "\n[[record]]\nname");
  };
  const std::string damping = "adds_to = \"damping\"\n";
  EXPECT_THAT(refusal("adds_to = \"mass\"\nmode = 1\nratio = 0.02"),
              HasSubstr("'mode' needs adds_to = \"damping\""));
  EXPECT_THAT(refusal(damping + "mode = 1"), HasSubstr("'ratio'"));
  EXPECT_THAT(refusal(damping + "mode = 3\nratio = 0.02"), HasSubstr("mode"));
  EXPECT_THAT(refusal(damping + "modes_from = 0\nratio = 0.02"),
              HasSubstr("modes_from"));
  EXPECT_THAT(refusal(damping + "mode = 1\nratio = -0.02"), HasSubstr("ratio"));
  EXPECT_THAT(refusal(damping + "mode = 1\nmodes_from = 2\nratio = 0.02"),
              HasSubstr("it has 2 of the keys"));
  EXPECT_THAT(refusal(damping + "proportional_to = \"mass\"\nratio = 0.02"),
              HasSubstr("'ratio' needs 'mode' or 'modes_from'"));
}

}  // namespace
}  // namespace pinode
