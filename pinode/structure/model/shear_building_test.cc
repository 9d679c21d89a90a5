#include "pinode/structure/model/shear_building.h"

#include <cmath>
#include <limits>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

ShearBuilding ThreeStoreys() {
  ShearBuilding building;
  building.masses = {30.0, 20.0, 10.0};
  building.stiffnesses = {7.0, 5.0, 3.0};
  building.dampers = {0.7, 0.5, 0.3};
  return building;
}

TEST(BuildShearBuilding, AssemblesFromTheGroundUp) {
  StructuralModel model;
  std::string error;
  ASSERT_TRUE(BuildShearBuilding(ThreeStoreys(), &model, &error)) << error;
  Matrix stiffness(3, 3);
  stiffness << 12.0, -5.0, 0.0, -5.0, 8.0, -3.0, 0.0, -3.0, 3.0;
  EXPECT_EQ(model.stiffness, stiffness);
  EXPECT_TRUE(model.damping.isApprox(0.1 * stiffness, 1e-15));
  EXPECT_EQ(model.mass.diagonal(), Eigen::Vector3d(30.0, 20.0, 10.0));
  EXPECT_EQ(model.mass.sum(), 60.0);
  EXPECT_EQ(model.influence, Matrix::Ones(3, 1));
  EXPECT_EQ(model.DofIndex("u3"), 2);
}

TEST(BuildShearBuilding, TakesNamesAndNoDampers) {
  ShearBuilding building = ThreeStoreys();
  building.dampers.clear();
  building.dof_names = {"first", "second", "roof"};
  StructuralModel model;
  std::string error;
  ASSERT_TRUE(BuildShearBuilding(building, &model, &error)) << error;
  EXPECT_EQ(model.DofIndex("roof"), 2);
  EXPECT_EQ(model.damping, Matrix::Zero(3, 3));
}

// n equal floors: w_j = 2 sqrt(k / m) sin((2 j - 1) pi / (2 (2 n + 1))), and
// the shape at floor i is sin(i (2 j - 1) pi / (2 n + 1)).
TEST(BuildShearBuilding, UniformBuildingHasTheClosedFormModes) {
  for (const int n : {1, 2, 5, 40}) {
    ShearBuilding building;
    building.masses.assign(n, 2e3);
    building.stiffnesses.assign(n, 4e6);
    StructuralModel model;
    ModalProperties modes;
    std::string error;
    ASSERT_TRUE(BuildShearBuilding(building, &model, &error)) << error;
    ASSERT_TRUE(ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                             &error))
        << error;
    for (int j = 1; j <= n; ++j) {
      const double angle = (2.0 * j - 1.0) * kPi / (2.0 * n + 1.0);
      const double frequency =
          std::sqrt(4e6 / 2e3) * std::sin(angle / 2.0) / kPi;
      EXPECT_NEAR(modes.frequency_hz[j - 1], frequency, 1e-10 * frequency);
      Vector shape(n);
      for (int i = 1; i <= n; ++i) shape[i - 1] = std::sin(i * angle);
      EXPECT_NEAR(Mac(shape, modes.mode_shapes.col(j - 1)), 1.0, 1e-12);
    }
  }
}

TEST(StoreyGroups, AddUpToTheWholeMatrix) {
  const ShearBuilding building = ThreeStoreys();
  StructuralModel model;
  std::string error;
  ASSERT_TRUE(BuildShearBuilding(building, &model, &error)) << error;
  using Target = MatrixGroup::Target;
  for (const Target target :
       {Target::kMass, Target::kDamping, Target::kStiffness}) {
    std::vector<MatrixGroup> groups;
    ASSERT_TRUE(StoreyGroups(building, target, &groups, &error)) << error;
    ASSERT_EQ(groups.size(), 3u);
    EXPECT_TRUE(AreGroupsValid(model, groups, &error)) << error;
    const StructuralModel twice = ApplyGroups(model, groups, Vector::Ones(3));
    const bool is_mass = target == Target::kMass;
    const bool is_damping = target == Target::kDamping;
    const bool is_stiffness = target == Target::kStiffness;
    EXPECT_TRUE(twice.mass.isApprox((is_mass ? 2.0 : 1.0) * model.mass));
    EXPECT_TRUE(
        twice.damping.isApprox((is_damping ? 2.0 : 1.0) * model.damping));
    EXPECT_TRUE(
        twice.stiffness.isApprox((is_stiffness ? 2.0 : 1.0) * model.stiffness));
  }
}

TEST(StoreyGroup, IsAStoreysOwnStiffness) {
  MatrixGroup group;
  std::string error;
  ASSERT_TRUE(StoreyGroup(ThreeStoreys(), MatrixGroup::Target::kStiffness, 2,
                          &group, &error))
      << error;
  EXPECT_EQ(group.name, "k2");
  Matrix expected(3, 3);
  expected << 5.0, -5.0, 0.0, -5.0, 5.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_EQ(group.matrix, expected);
}

TEST(StoreyGroup, RefusesWhatIsNotThere) {
  ShearBuilding building = ThreeStoreys();
  MatrixGroup group;
  std::string error;
  for (const int storey : {0, 4, -1}) {
    EXPECT_FALSE(StoreyGroup(building, MatrixGroup::Target::kMass, storey,
                             &group, &error));
    EXPECT_THAT(error, HasSubstr("no storey " + std::to_string(storey)));
  }
  building.dampers[1] = 0.0;
  EXPECT_FALSE(
      StoreyGroup(building, MatrixGroup::Target::kDamping, 2, &group, &error));
  EXPECT_THAT(error, HasSubstr("storey 2 has no damper"));
  building.dampers.clear();
  std::vector<MatrixGroup> groups;
  EXPECT_FALSE(
      StoreyGroups(building, MatrixGroup::Target::kDamping, &groups, &error));
  EXPECT_THAT(error, HasSubstr("storey 1 has no damper"));
  EXPECT_TRUE(groups.empty());
}

struct BadBuilding {
  const char* name;
  void (*spoil)(ShearBuilding*);
  const char* message_part;
};

void PrintTo(const BadBuilding& bad, std::ostream* stream) {
  *stream << bad.name;
}

class BadBuildingTest : public ::testing::TestWithParam<BadBuilding> {};

TEST_P(BadBuildingTest, IsRefused) {
  ShearBuilding building = ThreeStoreys();
  GetParam().spoil(&building);
  StructuralModel model;
  std::string error;
  EXPECT_FALSE(BuildShearBuilding(building, &model, &error));
  EXPECT_THAT(error, HasSubstr(GetParam().message_part));
  EXPECT_EQ(model.num_dofs(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    ShearBuilding, BadBuildingTest,
    ::testing::ValuesIn(std::vector<BadBuilding>{
        BadBuilding{"Empty", [](ShearBuilding* b) { *b = ShearBuilding(); },
                    "no masses"},
        BadBuilding{"FewStiffnesses",
                    [](ShearBuilding* b) { b->stiffnesses.pop_back(); },
                    "2 stiffnesses, expected 3"},
        BadBuilding{"ManyDampers",
                    [](ShearBuilding* b) { b->dampers.push_back(1.0); },
                    "4 dampers, expected 3"},
        BadBuilding{"FewNames", [](ShearBuilding* b) { b->dof_names = {"a"}; },
                    "1 DOF names"},
        BadBuilding{"NameTwice",
                    [](ShearBuilding* b) {
                      b->dof_names = {"a", "b", "a"};
                    },
                    "'a'"},
        BadBuilding{"ZeroMass", [](ShearBuilding* b) { b->masses[1] = 0.0; },
                    "entry 2 of the masses is 0"},
        BadBuilding{"NegativeStiffness",
                    [](ShearBuilding* b) { b->stiffnesses[2] = -3.0; },
                    "entry 3 of the stiffnesses is -3"},
        BadBuilding{"NegativeDamper",
                    [](ShearBuilding* b) { b->dampers[0] = -0.1; },
                    "entry 1 of the dampers is -0.1"},
        BadBuilding{"NaN",
                    [](ShearBuilding* b) {
                      b->masses[0] = std::numeric_limits<double>::quiet_NaN();
                    },
                    "masses is nan"}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace pinode
