#include "pinode/problem/close_modes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

MeasuredMode ModeAt(double frequency, double sigma,
                    const std::vector<double>& shape) {
  MeasuredMode mode;
  mode.frequency = frequency;
  mode.frequency_sigma = sigma;
  for (size_t i = 0; i < shape.size(); ++i) {
    mode.dofs.push_back(static_cast<int>(i));
  }
  mode.shape =
      Eigen::Map<const Vector>(shape.data(), static_cast<int>(shape.size()));
  return mode;
}

TEST(CloseModes, AreWithinThreeDeviationsOfTheirDifference) {
  ModalData data;
  // The deviation of the difference is 0.005.
  data.modes = {ModeAt(2.0, 0.003, {1.0, 0.1, 0.0}),
                ModeAt(7.0, 0.003, {1.0, -1.0, 0.4}),
                ModeAt(2.0149, 0.004, {0.0, 0.2, 1.0})};
  EXPECT_THAT(CloseModes(data), ElementsAre(ElementsAre(0, 2)));
  data.modes[2].frequency = 2.0151;
  EXPECT_THAT(CloseModes(data), IsEmpty());
  // Without deviations 0.1 % of the frequency count.
  for (MeasuredMode& mode : data.modes) mode.frequency_sigma = 0.0;
  EXPECT_THAT(CloseModes(data), IsEmpty());
  data.modes[2].frequency = 2.0019;
  EXPECT_THAT(CloseModes(data), ElementsAre(ElementsAre(0, 2)));
}

TEST(CloseModes, NeedIndependentShapesAtTheSameDofs) {
  ModalData data;
  data.modes = {ModeAt(2.0, 0.1, {1.0, 0.1, 0.0}),
                ModeAt(2.0, 0.1, {1.0, 0.2, 0.1})};
  EXPECT_THAT(CloseModes(data), IsEmpty());  // one shape, measured twice
  data.modes[1] = ModeAt(2.0, 0.1, {0.1, 1.0, 0.1});
  EXPECT_EQ(CloseModes(data).size(), 1u);
  data.form = ModalForm::kDynamicResidual;
  EXPECT_THAT(CloseModes(data), IsEmpty());
  data.form = ModalForm::kMac;
  EXPECT_EQ(CloseModes(data).size(), 1u);
  data.modes[1].dofs = {0, 1, 3};
  EXPECT_THAT(CloseModes(data), IsEmpty());
  data.modes[1] = ModeAt(2.0, 0.1, {});
  EXPECT_THAT(CloseModes(data), IsEmpty());
  // Two shapes at two DOFs span everything.
  data.modes = {ModeAt(2.0, 0.1, {1.0, 0.0}), ModeAt(2.0, 0.1, {0.0, 1.0})};
  EXPECT_THAT(CloseModes(data), IsEmpty());
}

TEST(CloseModes, MacWithASpanIsThatOfItsNearestVector) {
  Matrix basis(3, 2);
  basis << 1.0, 1.0, 0.0, 1.0, 0.0, 0.0;
  Vector vector(3);
  vector << 3.0, -4.0, 5.0;
  EXPECT_NEAR(MacWithSpan(basis, vector), 25.0 / 50.0, 1e-14);
  EXPECT_NEAR(MacWithSpan(basis, basis.col(1)), 1.0, 1e-14);
  EXPECT_EQ(MacWithSpan(basis, Vector::Zero(3)), 0.0);
}

// The partners of two turned shapes are the two modes of their plane, although
// neither is like one of them.
TEST(CloseModes, PartnersAreThoseOfTheSpan) {
  ModalData data;
  const double c = std::cos(0.8), s = std::sin(0.8);
  data.modes = {ModeAt(1.0, 0.1, {c, s, 0.0, 0.0}),
                ModeAt(1.0, 0.1, {-s, c, 0.0, 0.0})};
  Vector eigenvalues(4);
  eigenvalues << 30.0, 38.0, 39.0, 40.0;
  Matrix shapes(4, 4);
  shapes << 0, 1, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0;
  const std::vector<ModeMatch> matches = MatchModes(data, eigenvalues, shapes);
  EXPECT_EQ(matches[0].mode + matches[1].mode, 1 + 3);
  EXPECT_NEAR(matches[0].mac, 1.0, 1e-12);
  EXPECT_NEAR(matches[1].mac, 1.0, 1e-12);
  EXPECT_THAT(HavePartners(data, eigenvalues, shapes), ElementsAre(true, true));
}

}  // namespace
}  // namespace pinode
