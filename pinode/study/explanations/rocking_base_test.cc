#include "pinode/study/explanations/rocking_base.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "pinode/study/identify/identify.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

// Stiffness of the DOFs with a rotation of the base as one more DOF, which a
// spring holds and which has no moment of inertia, condensed by Schur.
Matrix Condensed(const Matrix& stiffness, const Vector& heights,
                 double spring) {
  const Eigen::Index n = stiffness.rows();
  Matrix whole(n + 1, n + 1);
  whole.topLeftCorner(n, n) = stiffness;
  whole.topRightCorner(n, 1) = -stiffness * heights;
  whole.bottomLeftCorner(1, n) = whole.topRightCorner(n, 1).transpose();
  whole(n, n) = spring + heights.dot(stiffness * heights);
  return whole.topLeftCorner(n, n) - whole.topRightCorner(n, 1) *
                                         whole.bottomLeftCorner(1, n) /
                                         whole(n, n);
}

TEST(RockingBase, IsTheCondensedRotation) {
  const auto chain = testing::MakeGroupedChain(4, 100.0, 0.5);
  const Matrix& stiffness = chain->model().stiffness;
  const Vector heights = HeightsOfStoreys(chain->model());
  ASSERT_EQ(heights, Vector::LinSpaced(4, 1.0, 4.0));
  const double own = heights.dot(stiffness * heights);
  for (const double spring : {1e4, 500.0, 20.0}) {
    const Matrix expected = Condensed(stiffness, heights, spring);
    const Matrix found =
        stiffness + own / (spring + own) * RockingPerShare(stiffness, heights);
    EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm()) << spring;
  }
}

TEST(RockingBase, NeedsStoreysAboveEachOther) {
  StructuralModel model = testing::MakeGroupedChain(3, 100.0, 0.5)->model();
  EXPECT_TRUE(MakeRockingBase(model).has_value());
  // The second storey is numbered last, then first.
  model.stiffness.row(1).swap(model.stiffness.row(2));
  model.stiffness.col(1).swap(model.stiffness.col(2));
  EXPECT_EQ(HeightsOfStoreys(model), (Vector{{1.0, 3.0, 2.0}}));
  model.stiffness.row(0).swap(model.stiffness.row(2));
  model.stiffness.col(0).swap(model.stiffness.col(2));
  EXPECT_EQ(HeightsOfStoreys(model), (Vector{{2.0, 3.0, 1.0}}));
  // A tie from the roof to the ground.
  StructuralModel tied = model;
  tied.stiffness(1, 1) += 50.0;
  EXPECT_FALSE(MakeRockingBase(tied).has_value());
  // Two storeys stand on the lowest one.
  StructuralModel fork = testing::MakeGroupedChain(3, 100.0, 0.5)->model();
  fork.stiffness = Matrix{
      {300.0, -100.0, -100.0}, {-100.0, 100.0, 0.0}, {-100.0, 0.0, 100.0}};
  EXPECT_FALSE(MakeRockingBase(fork).has_value());
  // A spring that skips a storey.
  StructuralModel braced = testing::MakeGroupedChain(3, 100.0, 0.5)->model();
  braced.stiffness(0, 0) += 50.0;
  braced.stiffness(2, 2) += 50.0;
  braced.stiffness(0, 2) -= 50.0;
  braced.stiffness(2, 0) -= 50.0;
  EXPECT_FALSE(MakeRockingBase(braced).has_value());
  for (const int storeys : {1, 2}) {
    EXPECT_FALSE(MakeRockingBase(
        testing::MakeGroupedChain(storeys, 100.0, 0.5)->model()));
  }
}

// The storeys of the truth are not those of the initial model, so that the
// matrix of the first refit is not the right one.
TEST(RockingBase, IsNamedWithItsShare) {
  const Vector alpha{{0.15, -0.2, 0.1}};
  const auto chain = ChainAt(alpha);
  StructuralModel model = chain->CorrectedModel(alpha);
  const Vector heights = HeightsOfStoreys(model);
  const double own = heights.dot(model.stiffness * heights);
  const double share = 0.3;
  model.stiffness =
      Condensed(model.stiffness, heights, own * (1.0 / share - 1.0));
  std::string error;
  const auto truth =
      StructuralDynamics::Create(std::move(model), chain->inputs(), &error);
  ASSERT_NE(truth, nullptr) << error;
  const Identification found = Identify(MeasuredChain(3, *truth, 7),
                                        IdentificationOptions(), {}, nullptr);
  ASSERT_FALSE(found.summary.explanations.empty());
  const Explanation& first = found.summary.explanations[0];
  EXPECT_EQ(first.kind, "stiffness") << first.what;
  EXPECT_EQ(first.place, "base") << first.what;
  EXPECT_LT(first.lower95, share);
  EXPECT_GT(first.upper95, share);
  for (const ExplainedValue& value : first.values) {
    const size_t storey = static_cast<size_t>(value.name.back() - '1');
    EXPECT_NEAR(value.value, alpha[static_cast<Eigen::Index>(storey)], 0.03)
        << value.name;
  }
  EXPECT_NE(found.summary.verdict.grade(), Grade::kGood);
}

}  // namespace
}  // namespace pinode
