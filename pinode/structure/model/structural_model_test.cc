#include "pinode/structure/model/structural_model.h"

#include <functional>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Three masses in a row, the first one on the ground.
StructuralModel Chain() {
  const Matrix stiffness =
      SpringMatrix(3, -1, 0) + SpringMatrix(3, 0, 1) + SpringMatrix(3, 1, 2);
  return MakeStructuralModel(2.0 * Matrix::Identity(3, 3), 0.1 * stiffness,
                             10.0 * stiffness);
}

MatrixGroup Group(const std::string& name, const Matrix& matrix) {
  return {name, MatrixGroup::Target::kStiffness, matrix};
}

TEST(StructuralModel, DefaultsMakeAValidModel) {
  const StructuralModel model = Chain();
  std::string error;
  EXPECT_TRUE(model.IsValid(&error)) << error;
  EXPECT_THAT(model.dof_names, ::testing::ElementsAre("u1", "u2", "u3"));
  EXPECT_EQ(model.num_dofs(), 3);
  EXPECT_EQ(model.num_directions(), 1);
  EXPECT_EQ(model.influence, Matrix::Ones(3, 1));
  EXPECT_EQ(model.support_mass_coupling, Matrix::Zero(3, 1));
}

TEST(StructuralModel, FindsNames) {
  const StructuralModel model = Chain();
  EXPECT_EQ(model.DofIndex("u3"), 2);
  EXPECT_EQ(model.DofIndex("u4"), -1);
  EXPECT_EQ(model.DofIndex(""), -1);
  EXPECT_EQ(model.DirectionIndex("x"), 0);
  EXPECT_EQ(model.DirectionIndex("y"), -1);
}

TEST(StructuralModel, AcceptsWhatIsUnusualButSound) {
  std::string error;
  StructuralModel free = Chain();
  free.stiffness -= 10.0 * SpringMatrix(3, -1, 0);  // a rigid-body mode
  EXPECT_TRUE(free.IsValid(&error)) << error;

  StructuralModel buckled = Chain();
  buckled.stiffness -= 15.0 * SpringMatrix(3, -1, 0);
  EXPECT_TRUE(buckled.IsValid(&error)) << error;

  StructuralModel rounded = Chain();
  rounded.stiffness(0, 1) *= 1.0 + 1e-13;
  EXPECT_TRUE(rounded.IsValid(&error)) << error;

  StructuralModel without_ground = Chain();
  without_ground.directions.clear();
  without_ground.influence.resize(3, 0);
  without_ground.support_mass_coupling.resize(3, 0);
  EXPECT_TRUE(without_ground.IsValid(&error)) << error;

  // A tonne together with a small rotational inertia is not refused.
  StructuralModel badly_scaled = Chain();
  badly_scaled.mass.diagonal() << 1e6, 1e-12, 1.0;
  EXPECT_TRUE(badly_scaled.IsValid(&error)) << error;
}

struct BadModel {
  const char* name;
  std::function<void(StructuralModel*)> spoil;
  std::vector<const char*> message_parts;
};

void PrintTo(const BadModel& bad, std::ostream* stream) { *stream << bad.name; }

class BadModelTest : public ::testing::TestWithParam<BadModel> {};

TEST_P(BadModelTest, IsRefusedWithAMessage) {
  StructuralModel model = Chain();
  GetParam().spoil(&model);
  std::string error;
  EXPECT_FALSE(model.IsValid(&error));
  for (const char* part : GetParam().message_parts) {
    EXPECT_THAT(error, HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    StructuralModel, BadModelTest,
    ::testing::ValuesIn(std::
                            vector<BadModel>{
                                BadModel{"NoDofs",
                                         [](StructuralModel* m) {
                                           *m = StructuralModel();
                                         },
                                         {"no DOFs"}},
                                BadModel{"EmptyName",
                                         [](StructuralModel* m) {
                                           m->dof_names[1] = "";
                                         },
                                         {"DOF 2", "empty name"}},
                                BadModel{"NameTwice",
                                         [](StructuralModel* m) {
                                           m->dof_names[2] = "u1";
                                         },
                                         {"'u1'", "DOF 1", "DOF 3", "unique"}},
                                BadModel{"DirectionTwice",
                                         [](StructuralModel* m) {
                                           m->directions = {"x", "x"};
                                         },
                                         {"'x'", "direction 2"}},
                                BadModel{"MassSize",
                                         [](StructuralModel* m) {
                                           m->mass = Matrix::Identity(2, 2);
                                         },
                                         {"mass matrix", "2 x 2", "3 x 3"}},
                                BadModel{"DampingSize",
                                         [](StructuralModel* m) {
                                           m->damping.resize(0, 0);
                                         },
                                         {"damping matrix", "0 x 0", "3 x 3"}},
                                BadModel{"StiffnessNotSquare",
                                         [](StructuralModel* m) {
                                           m->stiffness = Matrix::Ones(3, 2);
                                         },
                                         {"stiffness matrix", "3 x 2"}},
                                BadModel{"StiffnessNaN",
                                         [](StructuralModel* m) {
                                           m->stiffness(1, 2) = kNaN;
                                         },
                                         {"stiffness matrix",
                                          "('u2', 'u3')", "nan", "finite"}},
                                BadModel{"MassInfinite",
                                         [](StructuralModel* m) {
                                           m->mass(0, 0) = kInfinity;
                                         },
                                         {"mass matrix",
                                          "('u1', 'u1')", "inf"}},
                                BadModel{"StiffnessUnsymmetric",
                                         [](StructuralModel* m) {
                                           m->stiffness(0, 1) = -10.1;
                                         },
                                         {"stiffness matrix is not symmetric",
                                          "('u2', 'u1') = -10",
                                          "('u1', 'u2') = -10.1"}},
                                BadModel{"DampingUnsymmetric",
                                         [](StructuralModel* m) {
                                           m->damping(2, 0) = 1e-8;
                                         },
                                         {"damping matrix is not symmetric",
                                          "('u3', 'u1')"}},
                                BadModel{"MassUnsymmetric",
                                         [](StructuralModel* m) {
                                           m->mass(2, 1) = 0.5;
                                         },
                                         {"mass matrix is not symmetric",
                                          "('u3', 'u2') = 0.5"}},
                                BadModel{"MassZero",
                                         [](StructuralModel*
                                                m) { m->mass(1, 1) = 0.0; },
                                         {"positive definite",
                                          "'u2'", "condense"}},
                                BadModel{"MassNegative",
                                         [](StructuralModel* m) {
                                           m->mass(2, 2) = -1.0;
                                         },
                                         {"positive definite", "'u3'", "-1"}},
                                BadModel{"MassIndefinite",
                                         [](StructuralModel* m) {
                                           m->mass(1, 2) = 2.5;
                                           m->mass(2, 1) = 2.5;
                                         },
                                         {"positive definite", "-0.25"}},
                                BadModel{"MassSingular",
                                         [](StructuralModel* m) {
                                           m->mass(1, 2) = 2.0;
                                           m->mass(2, 1) = 2.0;
                                         },
                                         {"positive definite"}},
                                BadModel{"InfluenceSize",
                                         [](StructuralModel* m) {
                                           m->influence.resize(3, 2);
                                         },
                                         {"influence", "3 x 2", "3 x 1",
                                          "direction"}},
                                BadModel{"InfluenceNaN",
                                         [](StructuralModel* m) {
                                           m->influence(2, 0) = kNaN;
                                         },
                                         {"influence", "('u3', 'x')"}},
                                BadModel{"CouplingSize",
                                         [](StructuralModel* m) {
                                           m->support_mass_coupling.resize(0,
                                                                           0);
                                         },
                                         {"support mass coupling", "0 x 0",
                                          "3 x 1"}}}),
    [](const auto& test) { return test.param.name; });

TEST(MatrixGroup, AcceptsSoundGroups) {
  const StructuralModel model = Chain();
  std::string error;
  EXPECT_TRUE(AreGroupsValid(model, {}, &error)) << error;
  EXPECT_TRUE(AreGroupsValid(
      model,
      {Group("k1", SpringMatrix(3, -1, 0)), Group("k2", SpringMatrix(3, 0, 1))},
      &error))
      << error;
}

struct BadGroup {
  const char* name;
  MatrixGroup group;
  std::vector<const char*> message_parts;
};

void PrintTo(const BadGroup& bad, std::ostream* stream) { *stream << bad.name; }

class BadGroupTest : public ::testing::TestWithParam<BadGroup> {};

TEST_P(BadGroupTest, IsRefusedWithAMessage) {
  std::string error;
  EXPECT_FALSE(AreGroupsValid(
      Chain(), {Group("k1", SpringMatrix(3, -1, 0)), GetParam().group},
      &error));
  for (const char* part : GetParam().message_parts) {
    EXPECT_THAT(error, HasSubstr(part));
  }
}

Matrix WithEntry(int row, int column, double value) {
  Matrix matrix = Matrix::Identity(3, 3);
  matrix(row, column) = value;
  return matrix;
}

INSTANTIATE_TEST_SUITE_P(MatrixGroup, BadGroupTest,
                         ::testing::ValuesIn(std::vector<BadGroup>{
                             BadGroup{"EmptyName",
                                      Group("", Matrix::Identity(3, 3)),
                                      {"group", "empty name"}},
                             BadGroup{"NameTwice",
                                      Group("k1", Matrix::Identity(3, 3)),
                                      {"'k1'", "group 1", "group 2"}},
                             BadGroup{"Size",
                                      Group("k2", Matrix::Identity(2, 2)),
                                      {"group 'k2'", "2 x 2", "3 x 3"}},
                             BadGroup{"Unsymmetric",
                                      Group("k2", WithEntry(0, 2, 0.5)),
                                      {"group 'k2'", "not symmetric",
                                       "('u1', 'u3') = 0.5"}},
                             BadGroup{"NaN",
                                      Group("k2", WithEntry(1, 1, kNaN)),
                                      {"group 'k2'", "('u2', 'u2')", "nan"}},
                             BadGroup{"Zero",
                                      Group("k2", Matrix::Zero(3, 3)),
                                      {"group 'k2'", "zero", "stiffness"}}}),
                         [](const auto& test) { return test.param.name; });

TEST(ApplyGroups, AddsToEachTarget) {
  const StructuralModel model = Chain();
  const Matrix one = SpringMatrix(3, 0, 1);
  const Matrix two = SpringMatrix(3, -1, 2);
  const Matrix three = Matrix::Identity(3, 3);
  const std::vector<MatrixGroup> groups = {
      {"k", MatrixGroup::Target::kStiffness, one},
      {"c", MatrixGroup::Target::kDamping, two},
      {"m", MatrixGroup::Target::kMass, three},
      {"k again", MatrixGroup::Target::kStiffness, two}};
  Vector alphas(4);
  alphas << 2.0, 3.0, 4.0, -1.0;
  const StructuralModel updated = ApplyGroups(model, groups, alphas);
  EXPECT_EQ(updated.stiffness, model.stiffness + 2.0 * one - two);
  EXPECT_EQ(updated.damping, model.damping + 3.0 * two);
  EXPECT_EQ(updated.mass, model.mass + 4.0 * three);
  EXPECT_EQ(updated.dof_names, model.dof_names);
}

TEST(SpringMatrix, GivesTheSquaredDeformation) {
  Vector x(4);
  x << 0.3, -1.2, 0.7, 2.0;
  for (int a = -1; a < 4; ++a) {
    for (int b = -1; b < 4; ++b) {
      if (a == b) continue;
      const Matrix spring = SpringMatrix(4, a, b);
      const double deformation = (a < 0 ? 0.0 : x[a]) - (b < 0 ? 0.0 : x[b]);
      EXPECT_NEAR(x.dot(spring * x), deformation * deformation, 1e-14);
      EXPECT_EQ(spring, spring.transpose());
    }
  }
}

TEST(SpringMatrixDeathTest, RefusesImpossibleEnds) {
  EXPECT_DEATH(SpringMatrix(3, 0, 3), "-1 is the ground");
  EXPECT_DEATH(SpringMatrix(3, -2, 0), "-1 is the ground");
  EXPECT_DEATH(SpringMatrix(3, 1, 1), "two different ends");
}

TEST(ApplyGroupsDeathTest, NeedsOneAlphaPerGroup) {
  EXPECT_DEATH(ApplyGroups(Chain(), {}, Vector::Ones(1)),
               "one alpha per group");
}

}  // namespace
}  // namespace pinode
