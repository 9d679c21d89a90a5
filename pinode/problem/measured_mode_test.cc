#include "pinode/problem/measured_mode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Vector Eigenvalues(const std::vector<double>& frequencies) {
  Vector values(static_cast<int>(frequencies.size()));
  for (size_t i = 0; i < frequencies.size(); ++i) {
    values[static_cast<int>(i)] = std::pow(kTwoPi * frequencies[i], 2);
  }
  return values;
}

std::vector<int> Partners(const ModalData& data, const Vector& eigenvalues,
                          const Matrix& shapes) {
  std::vector<int> partners;
  for (const ModeMatch& match : MatchModes(data, eigenvalues, shapes)) {
    partners.push_back(match.mode);
  }
  return partners;
}

TEST(MatchModes, FollowsShapesWhereFrequenciesHaveCrossed) {
  ModalData data;
  data.modes = {testing::MakeMeasuredMode(1.0, {0, 1}, {1.0, 0.1}),
                testing::MakeMeasuredMode(1.2, {0, 1}, {0.0, 2.0})};
  const Matrix shapes = Matrix::Identity(2, 2);
  EXPECT_EQ(Partners(data, Eigenvalues({1.1, 1.2}), shapes),
            (std::vector<int>{0, 1}));
  // The mode of the second DOF is now the lower one.
  EXPECT_EQ(Partners(data, Eigenvalues({0.9, 1.3}),
                     Matrix(shapes.rowwise().reverse())),
            (std::vector<int>{1, 0}));
}

TEST(MatchModes, FrequenciesDecideBetweenShapesThatLookAlike) {
  // At the two measured DOFs modes 1 and 3 are the same.
  Matrix shapes(3, 3);
  shapes << 1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 0.5, 0.1, -2.0;
  ModalData data;
  data.modes = {testing::MakeMeasuredMode(3.1, {0, 1}, {1.0, 0.95})};
  const Vector eigenvalues = Eigenvalues({1.0, 2.0, 3.0});
  EXPECT_EQ(Partners(data, eigenvalues, shapes), std::vector<int>{2});
  data.modes[0].frequency = 1.3;
  EXPECT_EQ(Partners(data, eigenvalues, shapes), std::vector<int>{0});
}

TEST(MatchModes, KeepsTheOrderOfModesWithoutShapes) {
  // Nearest neighbours would pair 3 Hz with the model's second mode.
  ModalData data;
  data.modes = {testing::MakeMeasuredMode(1.0), testing::MakeMeasuredMode(2.0),
                testing::MakeMeasuredMode(3.0)};
  EXPECT_EQ(
      Partners(data, Eigenvalues({1.5, 3.0, 4.5, 9.0}), Matrix::Identity(4, 4)),
      (std::vector<int>{0, 1, 2}));
}

TEST(MatchModes, LeavesModesWithoutFrequencyToTheLast) {
  Vector eigenvalues = Eigenvalues({0.0, 0.0, 2.0});
  eigenvalues[0] = -10.0;
  ModalData data;
  data.modes = {testing::MakeMeasuredMode(1.0)};
  EXPECT_EQ(Partners(data, eigenvalues, Matrix::Identity(3, 3)),
            std::vector<int>{2});
  data.modes = {testing::MakeMeasuredMode(1.0), testing::MakeMeasuredMode(2.0),
                testing::MakeMeasuredMode(3.0)};
  const std::vector<ModeMatch> matches =
      MatchModes(data, eigenvalues, Matrix::Identity(3, 3));
  EXPECT_EQ(matches[1].mode, 2);
  EXPECT_TRUE(std::isnan(matches[0].mac));
  EXPECT_TRUE(std::isnan(matches[0].frequency) ||
              std::isnan(matches[2].frequency));
}

TEST(MatchModes, GivesFrequencyAndMacOfAModel) {
  // M = I, K = [2 -1; -1 1]: w^2 = (3 -+ sqrt 5) / 2, shapes [1; golden ratio]
  // and [golden ratio; -1].
  const StructuralModel model = testing::MakeChain(2, 1.0, 0.0);
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  ModalData data;
  data.modes = {testing::MakeMeasuredMode(0.3, {0, 1}, {1.0, -1.0}),
                testing::MakeMeasuredMode(0.1, {1, 0}, {1.0, 1.0})};
  std::vector<ModeMatch> matches;
  std::string error;
  ASSERT_TRUE(MatchModes(data, model, &matches, &error)) << error;
  EXPECT_EQ(matches[0].mode, 1);
  EXPECT_NEAR(matches[0].frequency, golden / kTwoPi, 1e-14);
  const double norm = 1.0 + golden * golden;
  EXPECT_NEAR(matches[1].mac, std::pow(1.0 + golden, 2) / (2.0 * norm), 1e-14);
  EXPECT_NEAR(matches[0].mac, std::pow(1.0 + golden, 2) / (2.0 * norm), 1e-14);

  StructuralModel massless = model;
  massless.mass(0, 0) = 0.0;
  EXPECT_FALSE(MatchModes(data, massless, &matches, &error));
  EXPECT_THAT(error, HasSubstr("mass"));
}

// A mode that is not the structure's, with the shape of its first one.
TEST(HavePartners, NotWhatTheModelLacks) {
  const Vector eigenvalues = Eigenvalues({1.0, 2.0, 3.0});
  const Matrix shapes = Matrix::Identity(3, 3);
  ModalData data;
  data.modes = {testing::MakeMeasuredMode(0.3, {0, 1, 2}, {1.0, 0.3, 0.0}),
                testing::MakeMeasuredMode(1.1, {0, 1, 2}, {1.0, 0.1, 0.0}),
                testing::MakeMeasuredMode(2.1, {0, 1, 2}, {0.0, 1.0, 0.1})};
  EXPECT_EQ(HavePartners(data, eigenvalues, shapes),
            (std::vector<bool>{false, true, true}));
  EXPECT_EQ(OnlyModes(data, {false, true, false}).modes.front().frequency, 1.1);
  // Without it the mode is the structure's first.
  data.modes.erase(data.modes.begin() + 1);
  data.modes[0].frequency = 0.5;
  EXPECT_EQ(HavePartners(data, eigenvalues, shapes),
            (std::vector<bool>{true, true}));
  // Without any similarity no mode is left out.
  data.modes[0].frequency = data.modes[1].frequency = 1e3;
  EXPECT_EQ(HavePartners(data, eigenvalues, shapes),
            (std::vector<bool>{true, true}));
}

// A model that is 6.25 times too stiff; a stranger stands where its first mode
// is.
TEST(HavePartners, UpToACommonFactor) {
  const Vector eigenvalues = Eigenvalues({2.5, 5.0, 7.5, 10.0});
  const Matrix shapes = Matrix::Identity(4, 4);
  ModalData data;
  for (int j = 0; j < 4; ++j) {
    Vector shape = Vector::Unit(4, j);
    data.modes.push_back(testing::MakeMeasuredMode(
        1.0 + j, {0, 1, 2, 3}, {shape[0], shape[1], shape[2], shape[3]}));
  }
  data.modes.push_back(
      testing::MakeMeasuredMode(2.5, {0, 1, 2, 3}, {1.0, 0.1, 0.0, 0.0}));
  EXPECT_EQ(HavePartners(data, eigenvalues, shapes),
            (std::vector<bool>{true, true, true, true, false}));
}

// Without shapes, frequencies decide; of nothing alike the nearest are kept, as
// many as the model has modes.
TEST(HavePartners, OfMoreModesThanTheModelHas) {
  const Vector eigenvalues = Eigenvalues({1.0, 2.0});
  const Matrix shapes = Matrix::Identity(2, 2);
  ModalData data;
  for (const double frequency : {0.4, 1.02, 1.97, 3.3}) {
    data.modes.push_back(testing::MakeMeasuredMode(frequency));
  }
  EXPECT_EQ(HavePartners(data, eigenvalues, shapes),
            (std::vector<bool>{false, true, true, false}));
  for (MeasuredMode& mode : data.modes) mode.frequency *= 1e4;
  const std::vector<bool> kept = HavePartners(data, eigenvalues, shapes);
  EXPECT_EQ(std::count(kept.begin(), kept.end(), true), 2);
  EXPECT_EQ(MatchModes(OnlyModes(data, kept), eigenvalues, shapes).size(), 2u);

  StructuralModel massless = testing::MakeChain(2, 1.0, 0.0);
  massless.mass(0, 0) = 0.0;
  EXPECT_EQ(HavePartners(data, massless),
            (std::vector<bool>{true, true, false, false}));
}

TEST(ModalData, RefusesWhatMakesNoSense) {
  struct Bad {
    std::function<void(ModalData*)> spoil;
    const char* message;
  };
  const std::vector<Bad> cases = {
      {[](ModalData* d) { d->modes[0].frequency = 0.0; }, "frequency"},
      {[](ModalData* d) { d->modes[0].frequency = kNaN; }, "frequency"},
      {[](ModalData* d) { d->modes[0].frequency_weight = 0.0; }, "weights"},
      {[](ModalData* d) { d->modes[0].shape_weight = -1.0; }, "weights"},
      {[](ModalData* d) { d->modes[0].frequency_sigma = -1.0; }, "deviations"},
      {[](ModalData* d) { d->modes[0].shape = Vector::Ones(3); }, "per DOF"},
      {[](ModalData* d) { d->modes[0].shape[0] = kNaN; }, "finite"},
      {[](ModalData* d) {
         d->modes[0].dofs = {0, 3};
       },
       "does not have"},
      {[](ModalData* d) {
         d->modes[0].dofs = {1, 1};
       },
       "twice"},
      {[](ModalData* d) { d->modes[0].shape.setZero(); }, "zero"},
      {[](ModalData* d) {
         d->modes[0] = testing::MakeMeasuredMode(1.0, {0}, {1.0});
       },
       "at least two DOFs"},
      {[](ModalData* d) {
         d->form = ModalForm::kMac;
         d->modes[0].shape_sigma = 0.1;
       },
       "eigenvector difference"},
      {[](ModalData* d) {
         d->form = ModalForm::kDynamicResidual;
         d->modes[0].frequency_sigma = 0.1;
       },
       "no sigma"},
      {[](ModalData* d) {
         d->form = ModalForm::kDynamicResidual;
         d->modes[0] = testing::MakeMeasuredMode(1.0);
       },
       "needs its shape"},
      {[](ModalData* d) {
         d->modes[0].frequency_shape_covariance = Vector::Zero(2);
         d->modes[0].shape_covariance = Matrix::Identity(2, 2);
       },
       "needs the sigma of the frequency"},
      {[](ModalData* d) {
         d->modes[0].frequency_shape_covariance = Vector::Zero(3);
         d->modes[0].shape_covariance = Matrix::Identity(2, 2);
         d->modes[0].frequency_sigma = 1.0;
       },
       "one finite value per entry"},
      {[](ModalData* d) {
         d->modes[0].frequency_shape_covariance = Vector::Constant(2, 0.8);
         d->modes[0].shape_covariance = Matrix::Identity(2, 2);
         d->modes[0].frequency_sigma = 1.0;
       },
       "too large: with their own"},
  };
  ModalData good;
  good.modes = {testing::MakeMeasuredMode(1.0, {0, 2}, {1.0, 0.5})};
  std::string error;
  ASSERT_TRUE(good.IsValid(3, &error)) << error;
  EXPECT_FALSE(good.HasSigmas());
  for (const Bad& bad : cases) {
    ModalData data = good;
    bad.spoil(&data);
    EXPECT_FALSE(data.IsValid(3, &error)) << bad.message;
    EXPECT_THAT(error, HasSubstr(bad.message));
  }
  good.modes[0].shape_sigma = 0.01;
  EXPECT_TRUE(good.HasSigmas());
}

}  // namespace
}  // namespace pinode
