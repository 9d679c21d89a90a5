#include "pinode/study/picture/structure_picture.h"

#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/damage/change.h"
#include "pinode/dynamics/unknown_force.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/resolve_dofs.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/picture/dof_places.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Three floors of two corners each; DOFs u1, u2, u3 move floors along x.
PlacedGeometry Frame() {
  PlacedGeometry placed;
  StructureGeometry& geometry = placed.geometry;
  geometry.positions.resize(8, 3);
  for (int floor = 0; floor < 4; ++floor) {
    for (int side = 0; side < 2; ++side) {
      geometry.node_names.push_back(std::string(side == 0 ? "w" : "e") +
                                    std::to_string(floor));
      geometry.positions.row(2 * floor + side) << 4.0 * side, 0.0, 3.0 * floor;
    }
  }
  for (int floor = 1; floor < 4; ++floor) {
    StructureGeometry::Set columns;
    columns.name = "columns_" + std::to_string(floor);
    for (int side = 0; side < 2; ++side) {
      columns.elements.push_back(static_cast<int>(geometry.elements.size()));
      geometry.elements.push_back(
          {ElementShape::kLine, {2 * floor - 2 + side, 2 * floor + side}});
    }
    geometry.elements.push_back(
        {ElementShape::kLine, {2 * floor, 2 * floor + 1}});
    geometry.sets.push_back(columns);
    const std::string name = std::to_string(floor);
    placed.dofs["u" + name] = {{"w" + name, 1, 1.0}, {"e" + name, 1, 1.0}};
    placed.groups["k" + name] = {columns.name};
  }
  return placed;
}

TEST(StructurePictureTest, GroupsArrowsAndModes) {
  const IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  DamageResult damage;
  damage.options.threshold = 0.05;
  damage.subjects.resize(3);
  damage.estimate.groups.resize(3);
  for (size_t i = 0; i < 3; ++i) {
    damage.subjects[i].name = "k" + std::to_string(3 - i);
  }
  GroupChange& change = damage.estimate.groups[1];  // of k2
  change.change = -0.1;
  change.lower95 = -0.12;
  change.upper95 = -0.08;
  change.probability = 0.99;
  change.changed = true;
  const StructurePicture picture = MakeStructurePicture(
      Frame(), problem, nullptr, nullptr, nullptr, &damage, 2);
  ASSERT_EQ(picture.groups.size(), 3u);
  EXPECT_TRUE(picture.since_baseline);
  EXPECT_EQ(picture.groups[1].name, "k2");
  EXPECT_THAT(picture.groups[1].elements, ElementsAre(3, 4));
  EXPECT_EQ(picture.groups[1].change, -0.1);
  EXPECT_EQ(picture.groups[1].probability, 0.99);
  EXPECT_TRUE(picture.groups[1].changed);
  EXPECT_FALSE(picture.groups[0].changed);
  // A sensor a floor, at the first of its nodes.
  ASSERT_EQ(picture.sensors.size(), 3u);
  EXPECT_EQ(picture.sensors[1].name, "a2");
  EXPECT_EQ(
      picture.geometry.node_names[static_cast<size_t>(picture.sensors[1].node)],
      "w2");
  EXPECT_EQ(picture.sensors[1].direction, Eigen::Vector3d::UnitX());
  // A uniform chain has sin(i pi / 7) for the lowest mode.
  ASSERT_EQ(picture.modes.size(), 2u);
  const Matrix& shape = picture.modes[0].shape;
  for (int floor = 1; floor <= 3; ++floor) {
    const double expected =
        std::sin(floor * M_PI / 7.0) / std::sin(3.0 * M_PI / 7.0);
    EXPECT_NEAR(std::abs(shape(2 * floor, 0)), expected, 1e-6);
    EXPECT_NEAR(shape(2 * floor + 1, 0), shape(2 * floor, 0), 1e-12);
  }
  EXPECT_EQ(shape.rightCols(2).norm(), 0.0);
  EXPECT_EQ(shape.topRows(2).norm(), 0.0);
}

// A sensor of several DOFs of a node is one arrow between them, one that
// measures between nodes an arrow at each.
TEST(StructurePictureTest, SensorsAlongAnyDirection) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  PlacedGeometry placed = Frame();
  placed.dofs["u2"] = {{"w1", 3, -1.0}};
  auto& channels = problem.records[0].channels;
  channels.resize(2);
  channels[0].observation.weights = Eigen::Vector3d(0.6, 0.8, 0.0);
  channels[1].observation.weights = Eigen::Vector3d(-1.0, 0.0, 1.0);
  const StructurePicture picture = MakeStructurePicture(
      placed, problem, nullptr, nullptr, nullptr, nullptr, 0);
  ASSERT_EQ(picture.sensors.size(), 3u);
  EXPECT_TRUE(
      picture.sensors[0].direction.isApprox(Eigen::Vector3d(0.6, 0.0, -0.8)));
  EXPECT_EQ(picture.sensors[1].direction, -Eigen::Vector3d::UnitX());
  EXPECT_EQ(picture.sensors[2].direction, Eigen::Vector3d::UnitX());
  EXPECT_EQ(picture.sensors[2].name, picture.sensors[1].name);
  EXPECT_TRUE(picture.modes.empty());
}

// A node may have directions of its own, and such that nobody says.
TEST(StructurePictureTest, DirectionsOfNodes) {
  PlacedGeometry placed = Frame();
  placed.dofs["u2"] = {{"w1", 3, -1.0}};
  Eigen::Matrix3d axes;
  axes << 0.0, 0.6, 0.8, 1.0, 0.0, 0.0, 0.0, 0.8, -0.6;
  placed.geometry.axes[2] = axes;
  placed.geometry.axes[3] = Eigen::Matrix3d::Zero();
  const DofPlaces places(placed);
  ASSERT_EQ(places.Of("u2").size(), 1u);
  EXPECT_EQ(places.Of("u2")[0].direction, Eigen::Vector3d(0.0, -0.8, 0.6));
  ASSERT_EQ(places.Of("w1.1").size(), 1u);
  EXPECT_EQ(places.Of("w1.1")[0].direction, Eigen::Vector3d(0.0, 0.6, 0.8));
  EXPECT_EQ(places.Of("w2.1")[0].direction, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(places.Of("e1.1").empty());
  // Shapes there are turned into the global system: 2 along the first of the
  // directions, 1 along the second.
  MergedModes merged;
  merged.modes.resize(1);
  merged.modes[0].mode.shape = Eigen::Vector2cd(2.0, 1.0);
  const std::vector<Eigen::MatrixXcd> motions = MotionsOfNodes(
      placed, {{"w1.1", "a", {{"w1.1", 1.0}}}, {"w1.2", "b", {{"w1.2", 1.0}}}},
      merged);
  ASSERT_EQ(motions.size(), 1u);
  const Eigen::Vector3d turned =
      motions[0].row(2).real().transpose() / motions[0].row(2).real()[0];
  EXPECT_TRUE(turned.isApprox(Eigen::Vector3d(1.0, 1.2, 1.6)));
}

// A force is drawn at its place, in the direction of its factor. A floor's
// force is drawn at the first of its nodes, as a sensor is.
TEST(StructurePictureTest, UnmeasuredForces) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  auto dynamics = ChainAt(Vector::Zero(3));
  UnknownForceTerm gust;
  gust.name = "gust";
  gust.history = std::make_shared<HalfSinePulse>();
  gust.outputs = -2.0 * Vector::Unit(3, 1);
  gust.parameters.name = gust.name;
  for (const char* name : {"gust.start", "gust.duration", "gust.amplitude"}) {
    Parameter parameter;
    parameter.name = name;
    parameter.value = 1.0;
    gust.parameters.parameters.push_back(parameter);
  }
  std::string error;
  ASSERT_TRUE(dynamics->AddUnknownForce(std::move(gust), &error)) << error;
  problem.dynamics = dynamics;
  const StructurePicture picture = MakeStructurePicture(
      Frame(), problem, nullptr, nullptr, nullptr, nullptr, 0);
  EXPECT_TRUE(picture.forces.empty());
  ASSERT_EQ(picture.unknown_forces.size(), 1u);
  const StructurePicture::Arrow& arrow = picture.unknown_forces[0];
  EXPECT_EQ(arrow.name, "gust");
  EXPECT_EQ(picture.geometry.node_names[static_cast<size_t>(arrow.node)], "w2");
  EXPECT_EQ(arrow.direction, -Eigen::Vector3d::UnitX());
  EXPECT_TRUE(picture.notes.empty());
}

TEST(StructurePictureTest, AgainstTheModelAndWithoutPlaces) {
  const IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  IdentificationSummary summary;
  summary.parameters.push_back(
      {"k1", "1", 0.0, 0.2, 0.01, 0.18, 0.22, 0.02, true, false});
  summary.parameters.push_back(
      {"k2", "1", 0.0, 0.01, 0.01, -0.01, 0.03, 0.02, true, false});
  PlacedGeometry placed = Frame();
  placed.dofs.erase("u3");
  placed.groups["k3"] = {"nothing"};
  const StructurePicture picture = MakeStructurePicture(
      placed, problem, nullptr, &summary, nullptr, nullptr, 5);
  ASSERT_EQ(picture.groups.size(), 2u);
  EXPECT_TRUE(picture.groups[0].changed);
  EXPECT_FALSE(picture.groups[1].changed);
  EXPECT_TRUE(std::isnan(picture.groups[0].probability));
  EXPECT_EQ(picture.sensors.size(), 2u);
  ASSERT_EQ(picture.notes.size(), 2u);
  EXPECT_THAT(picture.notes[0], HasSubstr("k3"));
  EXPECT_THAT(picture.notes[1], HasSubstr("a3"));
}

// Node w1 is seen along two oblique directions, w2 along one, e1 not at all;
// floor 3 moves as one.
TEST(StructurePictureTest, ModesOfRecordsAlone) {
  PlacedGeometry placed = Frame();
  placed.dofs.erase("u1");
  const std::vector<PlaceOfShape> sensors = {
      {"p", "a", {{"w1.1", 0.8}, {"w1.3", 0.6}}},
      {"q", "b", {{"w1.1", -0.6}, {"w1.3", 0.8}}},
      {"r", "c", {{"w2.1", 0.6}, {"w2.3", 0.8}}},
      {"u3", "d", {{"u3", 1.0}}},
      {"s", "strain", {}}};
  // w1 moves by (1, 0, 2), w2 by 0.5 along what is seen, the floor by -4.
  MergedModes merged;
  MergedMode mode;
  mode.mode.frequency_hz = 2.5;
  mode.mode.shape.resize(5);
  mode.mode.shape << 2.0, 1.0, 0.5, -4.0, 7.0;
  mode.mode.shape *= std::polar(2.0, 0.7);
  merged.modes = {mode, mode};
  for (const PlaceOfShape& place : sensors)
    merged.places.push_back(place.place);
  merged.modes[1].mode.shape.head(2).setConstant(kNaN);
  const StructurePicture picture =
      MakeModesPicture(placed, sensors, sensors, merged);
  ASSERT_EQ(picture.sensors.size(), 4u);
  EXPECT_TRUE(
      picture.sensors[1].direction.isApprox(Eigen::Vector3d(-0.6, 0.0, 0.8)));
  ASSERT_EQ(picture.modes.size(), 2u);
  EXPECT_EQ(picture.modes[0].frequency_hz, 2.5);
  // The sign of a mode is free.
  const auto expect = [&](size_t m, int node, double x, double z) {
    const Matrix& shape = picture.modes[m].shape;
    const double scale = -4.0 / shape(6, 0);
    EXPECT_NEAR(scale * shape(node, 0), x, 1e-12) << node;
    EXPECT_NEAR(shape(node, 1), 0.0, 1e-12) << node;
    EXPECT_NEAR(scale * shape(node, 2), z, 1e-12) << node;
  };
  expect(0, 2, 1.0, 2.0);
  expect(0, 4, 0.3, 0.4);
  expect(0, 6, -4.0, 0.0);
  expect(0, 7, -4.0, 0.0);
  expect(0, 3, 0.0, 0.0);
  EXPECT_EQ(picture.modes[0].shape.cwiseAbs().maxCoeff(), 1.0);
  // A place that no sensor observed.
  expect(1, 2, 0.0, 0.0);
  expect(1, 4, 0.3, 0.4);
  ASSERT_EQ(picture.notes.size(), 2u);
  EXPECT_THAT(picture.notes[0], HasSubstr("strain"));
  EXPECT_THAT(picture.notes[1], HasSubstr("4 of 8 nodes"));
}

TEST(VtuTest, CellsAndPoints) {
  const IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  IdentificationSummary summary;
  summary.parameters.push_back(
      {"k1", "1", 0.0, 0.2, 0.01, 0.18, 0.22, 0.02, true, false});
  StructurePicture picture = MakeStructurePicture(
      Frame(), problem, nullptr, &summary, nullptr, nullptr, 1);
  const std::string vtu = FormatVtu(picture);
  EXPECT_THAT(vtu, HasSubstr("NumberOfPoints=\"8\" NumberOfCells=\"9\""));
  EXPECT_THAT(vtu, HasSubstr("<!-- groups: 0 k1 1 k2 2 k3 -->"));
  EXPECT_THAT(vtu, HasSubstr("Name=\"types\" NumberOfComponents=\"1\" "
                             "format=\"ascii\">\n3 3 3 3 3 3 3 3 3"));
  EXPECT_THAT(vtu, HasSubstr("Name=\"change\" NumberOfComponents=\"1\" "
                             "format=\"ascii\">\n0.2 0.2 0 0"));
  EXPECT_THAT(vtu, HasSubstr("Name=\"known\" NumberOfComponents=\"1\" "
                             "format=\"ascii\">\n1 1 0 0"));
  EXPECT_THAT(vtu, HasSubstr("Name=\"mode_1\" NumberOfComponents=\"3\""));
  EXPECT_EQ(vtu.find("nan"), std::string::npos);
  EXPECT_THAT(vtu, Not(HasSubstr("\"change_")));
  // Two hyphens end a comment of XML.
  for (const char* name : {"a--b", "a---b", "a----", "-----"}) {
    picture.groups[0].name = name;
    const std::string named = FormatVtu(picture);
    const size_t begin = named.find("<!--") + 4;
    EXPECT_EQ(named.find("--", begin), named.find("-->", begin)) << name;
  }
}

// A set with a change of mass but not of stiffness shows its mass. If both have
// changed, the other one has arrays of its own.
TEST(VtuTest, ShowsWhatHasChanged) {
  StructurePicture picture;
  picture.geometry = Frame().geometry;
  for (const bool is_mass : {false, true}) {
    StructurePicture::Group group;
    group.name = is_mass ? "mass" : "stiffness";
    group.is_mass = is_mass;
    group.elements = is_mass ? std::vector<int>{1, 2} : std::vector<int>{0, 1};
    group.change = is_mass ? 0.3 : -0.25;
    group.changed = is_mass;
    picture.groups.push_back(group);
  }
  EXPECT_THAT(ShownGroups(picture),
              ElementsAre(0, 1, 1, -1, -1, -1, -1, -1, -1));
  std::string vtu = FormatVtu(picture);
  EXPECT_THAT(vtu, HasSubstr("format=\"ascii\">\n-0.25 0.3 0.3 0 "));
  EXPECT_THAT(vtu, HasSubstr("Name=\"change_0\" NumberOfComponents=\"1\" "
                             "format=\"ascii\">\n-0.25 -0.25 0 0"));
  EXPECT_THAT(vtu, Not(HasSubstr("\"change_1")));
  picture.groups[0].changed = true;
  EXPECT_THAT(ShownGroups(picture),
              ElementsAre(0, 0, 1, -1, -1, -1, -1, -1, -1));
  vtu = FormatVtu(picture);
  EXPECT_THAT(vtu, HasSubstr("Name=\"change_1\" NumberOfComponents=\"1\" "
                             "format=\"ascii\">\n0 0.3 0.3 0"));
}

}  // namespace
}  // namespace pinode
