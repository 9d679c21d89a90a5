#include "pinode/estimate/fit/ambient_start.h"

#include <gtest/gtest.h>

#include "pinode/base/constants.h"
#include "pinode/estimate/fit/fit_once.h"
#include "tests/support/ambient_testing.h"

namespace pinode {
namespace {

// Largest error of the three springs, after a fit to the record's modes alone.
double LargestErrorOfStart(const IdentificationProblem& problem) {
  IdentificationProblem modes_alone;
  if (!ModesOfAmbientRecord(problem, 1, &modes_alone)) return kInfinity;
  FitSummary summary;
  IdentifiedModel model;
  FitOnce(modes_alone, IdentificationOptions(), nullptr, &summary, &model);
  EXPECT_EQ(summary.termination, Termination::kConverged) << summary.message;
  return model.parameters.head(3).cwiseAbs().maxCoeff();
}

TEST(AmbientStart, BeginsNearTheModesOfTheRecord) {
  const TestChain chain = RayleighChain(3);
  const IdentificationProblem problem = ProblemOfChain(
      chain, kChainSpring, 0.08, RecordOfChain(chain, 300.0, 3, 0.9));
  EXPECT_LT(LargestErrorOfStart(problem), 0.03);
}

// A part of a long record is enough: the part without gaps.
TEST(AmbientStart, TakesThePartOfALongRecordThatIsThere) {
  const TestChain chain = RayleighChain(3);
  AmbientRecord record = RecordOfChain(chain, 300.0, 3, 0.9);
  const Eigen::Index size = record.samples.cols();
  // Its second part alone, over and over the same.
  Matrix samples = Matrix::Constant(3, 140000, kNaN);
  for (Eigen::Index k = 65000; k < 132000; ++k) {
    samples.col(k) = record.samples.col(k % size);
  }
  record.samples = samples;
  const IdentificationProblem problem =
      ProblemOfChain(chain, kChainSpring, 0.08, record);
  EXPECT_LT(LargestErrorOfStart(problem), 0.03);
}

}  // namespace
}  // namespace pinode
