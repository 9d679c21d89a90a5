#include "pinode/modal/resolve_dofs.h"

#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using Complex = std::complex<double>;

MergedModes OneMode(const std::vector<PlaceOfShape>& places,
                    const Eigen::VectorXcd& shape) {
  MergedModes merged;
  for (const PlaceOfShape& place : places) merged.places.push_back(place.place);
  MergedMode mode;
  mode.mode.shape = shape;
  const Eigen::Index size = 2 + 2 * shape.size();
  mode.mode.covariance = 1e-4 * Matrix::Identity(size, size);
  merged.modes = {mode};
  return merged;
}

// A mode that moves node 5 by u and is measured along three oblique beams.
TEST(ResolveDofsTest, ThreeObliqueBeamsAreANode) {
  const Eigen::Vector3cd u(Complex(0.5, 0.1), Complex(-2.0, 0.3),
                           Complex(0.25, 0.0));
  Matrix beams(3, 3);
  beams << 0.8654, 0.4778, -0.1513, 0.1552, 0.9797, -0.1271, 0.4889, 0.7221,
      0.4894;
  std::vector<PlaceOfShape> places;
  Eigen::VectorXcd shape(4);
  for (int i = 0; i < 3; ++i) {
    places.push_back(
        {"beam " + std::to_string(i),
         "b" + std::to_string(i),
         {{"5.1", beams(i, 0)}, {"5.2", beams(i, 1)}, {"5.3", beams(i, 2)}}});
    shape[i] = (beams.row(i).cast<Complex>() * u).value();
  }
  places.push_back({"24.1", "c", {{"24.1", 1.0}}});
  shape[3] = 0.7;
  MergedModes merged = OneMode(places, shape);
  ResolveDofs(&places, &merged);
  EXPECT_THAT(merged.places, ElementsAre("5.1", "5.2", "5.3", "24.1"));
  ASSERT_EQ(places.size(), 4u);
  EXPECT_EQ(places[3].channel, "c");
  const IdentifiedMode& mode = merged.modes[0].mode;
  EXPECT_EQ(mode.shape[1], 1.0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(mode.shape[i] - u[i] / u[1]), 1e-12);
  }
  EXPECT_LT(std::abs(mode.shape[3] - 0.7 / u[1]), 1e-12);
  EXPECT_EQ(mode.shape_sigma_real[1], 0.0);

  // Standard deviations by differences of one entry of the beams.
  const Matrix inverse = beams.inverse();
  double variance = 0.0;
  for (int part = 0; part < 2; ++part) {
    for (int j = 0; j < 3; ++j) {
      constexpr double kStep = 1e-6;
      const Complex move = part == 0 ? Complex(kStep) : Complex(0.0, kStep);
      const Eigen::Vector3cd next = u + inverse.col(j).cast<Complex>() * move;
      const double slope = (next[0] / next[1] - u[0] / u[1]).real() / kStep;
      variance += 1e-4 * slope * slope;
    }
  }
  EXPECT_NEAR(mode.shape_sigma_real[0], std::sqrt(variance),
              1e-5 * std::sqrt(variance));
}

// One sensor along z and one oblique sensor in x and y: z is determined, and of
// x and y only their sum.
TEST(ResolveDofsTest, WhatIsOpenStaysAsItIs) {
  std::vector<PlaceOfShape> places = {
      {"oblique", "o", {{"1.1", 0.866}, {"1.2", 0.5}}},
      {"1.3", "z", {{"1.3", 1.0}}},
      {"strain", "s", {}}};
  MergedModes merged = OneMode(places, Eigen::Vector3cd(1.0, 0.5, 0.25));
  ResolveDofs(&places, &merged);
  EXPECT_THAT(merged.places, ElementsAre("oblique", "1.3", "strain"));
  EXPECT_EQ(merged.modes[0].mode.shape[1], 0.5);
}

// Two sums that share z determine it together with a sensor along x.
TEST(ResolveDofsTest, SumsBesideASensorOfOneDof) {
  std::vector<PlaceOfShape> places = {
      {"x", "x", {{"1.1", 1.0}}},
      {"xy", "xy", {{"1.1", 0.6}, {"1.2", 0.8}}},
      {"zw", "zw", {{"1.3", 1.0}, {"1.4", 1.0}}}};
  // x = 0.5, y = 1.
  MergedModes merged = OneMode(places, Eigen::Vector3cd(0.5, 1.1, 0.4));
  ResolveDofs(&places, &merged);
  EXPECT_THAT(merged.places, ElementsAre("1.1", "1.2", "zw"));
  const Eigen::VectorXcd& shape = merged.modes[0].mode.shape;
  EXPECT_LT(std::abs(shape[0] - 0.5), 1e-12);
  EXPECT_EQ(shape[1], 1.0);
  EXPECT_LT(std::abs(shape[2] - 0.4), 1e-12);
}

// If a set-up does not see a mode, the DOFs that it alone measures stay
// undetermined.
TEST(ResolveDofsTest, PlacesThatWereNotSeen) {
  std::vector<PlaceOfShape> places = {{"a", "a", {{"1.1", 0.6}, {"1.2", 0.8}}},
                                      {"b", "b", {{"1.1", 0.8}, {"1.2", -0.6}}},
                                      {"2.1", "c", {{"2.1", 1.0}}}};
  MergedModes merged = OneMode(places, Eigen::Vector3cd(NAN, 0.5, 1.0));
  ResolveDofs(&places, &merged);
  EXPECT_THAT(merged.places, ElementsAre("1.1", "1.2", "2.1"));
  const IdentifiedMode& mode = merged.modes[0].mode;
  EXPECT_TRUE(std::isnan(mode.shape[0].real()));
  EXPECT_TRUE(std::isnan(mode.shape[1].real()));
  EXPECT_EQ(mode.shape[2], 1.0);
  EXPECT_EQ(mode.shape_sigma_real[2], 0.0);
  EXPECT_TRUE(std::isnan(mode.shape_sigma_real[0]));
}

}  // namespace
}  // namespace pinode
