#include "pinode/structure/sparse/finite_element_model.h"

#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

SparseMatrix Sparse(const Matrix& dense) { return dense.sparseView(); }

// Three DOFs in a chain held at the first; the last has no mass.
FiniteElementModel ThreeDofs() {
  FiniteElementModel model;
  model.dof_names = {"1.1", "2.1", "3.1"};
  Matrix mass = Matrix::Zero(3, 3);
  mass.topLeftCorner(2, 2) << 2.0, 1.0, 1.0, 2.0;
  model.mass = Sparse(mass);
  model.stiffness =
      Sparse((Matrix(3, 3) << 2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 1.0)
                 .finished());
  return model;
}

std::string ErrorOf(const FiniteElementModel& model) {
  std::string error;
  EXPECT_FALSE(model.IsValid(&error));
  return error;
}

TEST(FiniteElementModel, IsValid) {
  FiniteElementModel model = ThreeDofs();
  std::string error;
  EXPECT_TRUE(model.IsValid(&error)) << error;
  model.damping = model.stiffness;
  EXPECT_TRUE(model.IsValid(&error)) << error;
  EXPECT_EQ(model.DofIndex("2.1"), 1);
  EXPECT_EQ(model.DofIndex("2.2"), -1);
}

TEST(FiniteElementModel, RefusesNamesAndSizesThatDoNotMatch) {
  FiniteElementModel model = ThreeDofs();
  model.dof_names[1] = "1.1";
  EXPECT_THAT(ErrorOf(model), HasSubstr("'1.1'"));
  model.dof_names[1] = "";
  EXPECT_THAT(ErrorOf(model), HasSubstr("DOF 2 has no name"));
  model.dof_names = {"a", "b"};
  EXPECT_THAT(ErrorOf(model), HasSubstr("M is 3 x 3, expected 2 x 2"));
  model.dof_names.clear();
  EXPECT_THAT(ErrorOf(model), HasSubstr("no DOFs"));
  model = ThreeDofs();
  model.damping = SparseMatrix(2, 2);
  EXPECT_THAT(ErrorOf(model), HasSubstr("C is 2 x 2"));
}

TEST(FiniteElementModel, RefusesAsymmetryAndNumbersThatAreNone) {
  FiniteElementModel model = ThreeDofs();
  model.stiffness.coeffRef(0, 1) = -1.0 - 1e-9;
  EXPECT_THAT(ErrorOf(model),
              AllOf(HasSubstr("K is not symmetric"), HasSubstr("1.1, 2.1")));
  model.stiffness.coeffRef(0, 1) = -1.0 - 1e-11;
  std::string error;
  EXPECT_TRUE(model.IsValid(&error)) << error;
  // An entry without a mirror image, in either triangle.
  model = ThreeDofs();
  model.stiffness.coeffRef(0, 2) = 0.5;
  EXPECT_THAT(ErrorOf(model), HasSubstr("K is not symmetric"));
  model = ThreeDofs();
  model.stiffness.coeffRef(2, 0) = 0.5;
  EXPECT_THAT(ErrorOf(model), HasSubstr("K is not symmetric"));
  model = ThreeDofs();
  model.stiffness.coeffRef(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(ErrorOf(model), HasSubstr("K(2.1, 2.1)"));
}

TEST(FiniteElementModel, RefusesIndefiniteMass) {
  FiniteElementModel model = ThreeDofs();
  model.mass.coeffRef(1, 1) = -2.0;
  EXPECT_THAT(ErrorOf(model), HasSubstr("M(2.1, 2.1) is -2"));
  model = ThreeDofs();
  model.mass.coeffRef(0, 1) = model.mass.coeffRef(1, 0) = 2.1;
  EXPECT_THAT(ErrorOf(model), HasSubstr("negative kinetic energy"));
  // Semidefinite: two DOFs share one mass.
  model.mass.coeffRef(0, 1) = model.mass.coeffRef(1, 0) = 2.0;
  std::string error;
  EXPECT_TRUE(model.IsValid(&error)) << error;
  model = ThreeDofs();
  model.mass.coeffRef(1, 2) = model.mass.coeffRef(2, 1) = 0.1;
  EXPECT_THAT(ErrorOf(model), HasSubstr("beside a zero diagonal at 3.1"));
}

// The square of a matrix with 1 on its diagonal and 0.3 beside it. Its rows are
// not dominant, and its eigenvalues lie between 0.16 and 2.56.
TEST(FiniteElementModel, LargeMassesThatAreNotDominant) {
  const int n = 3000;
  SparseMatrix root(n, n);
  for (int i = 0; i < n; ++i) {
    root.insert(i, i) = 1.0;
    if (i > 0) root.insert(i, i - 1) = 0.3;
    if (i + 1 < n) root.insert(i, i + 1) = 0.3;
  }
  FiniteElementModel model;
  model.dof_names = DefaultDofNames(n);
  model.mass = root * root;
  model.stiffness = model.mass;
  std::string error;
  EXPECT_TRUE(model.IsValid(&error)) << error;
  SparseMatrix unit(n, n);
  unit.setIdentity();
  model.mass -= 0.17 * unit;
  EXPECT_THAT(ErrorOf(model), HasSubstr("negative kinetic energy"));
  // One motion alone: two masses that share more than they have.
  model.mass = model.stiffness;
  model.mass.coeffRef(1000, 1001) = model.mass.coeffRef(1001, 1000) = 1.3;
  EXPECT_THAT(ErrorOf(model), HasSubstr("negative kinetic energy"));
}

TEST(FiniteElementModel, RefusesDofsThatNothingDetermines) {
  FiniteElementModel model = ThreeDofs();
  model.dof_names.push_back("4.1");
  model.mass.conservativeResize(4, 4);
  model.stiffness.conservativeResize(4, 4);
  EXPECT_THAT(ErrorOf(model),
              HasSubstr("1 DOF without mass and without stiffness (4.1)"));
}

TEST(NumberRepeatedNames, NumbersAndExplains) {
  std::vector<std::string> notes;
  EXPECT_THAT(NumberRepeatedNames({"1.1", "1.2"}, &notes),
              ElementsAre("1.1", "1.2"));
  EXPECT_THAT(notes, ElementsAre());
  EXPECT_THAT(
      NumberRepeatedNames({"7.1", "8.1", "7.1", "7.1#1", "7.1"}, &notes),
      ElementsAre("7.1#1'", "8.1", "7.1#2", "7.1#1", "7.1#3"));
  EXPECT_THAT(notes, ElementsAre(AllOf(HasSubstr("7.1 (3 times)"),
                                       HasSubstr("1 DOF names"))));
}

TEST(SpecialDofs, AreFoundAndDescribed) {
  FiniteElementModel model;
  model.dof_names = {"a", "b", "held", "free"};
  model.mass = Sparse(Vector(Eigen::Vector4d(1.0, 0.0, 1.0, 3.0)).asDiagonal());
  Matrix stiffness = Matrix::Zero(4, 4);
  stiffness.topLeftCorner(2, 2) << 2.0, -1.0, -1.0, 1.0;
  stiffness(2, 2) = 1.0;
  model.stiffness = Sparse(stiffness);
  std::string error;
  ASSERT_TRUE(model.IsValid(&error)) << error;
  const SpecialDofs special = FindSpecialDofs(model);
  EXPECT_THAT(special.massless, ElementsAre(1));
  EXPECT_THAT(special.uncoupled, ElementsAre(2));
  EXPECT_THAT(special.unsupported, ElementsAre(3));
  EXPECT_THAT(
      DescribeSpecialDofs(model),
      ElementsAre(HasSubstr("(b)"), HasSubstr("(held)"), HasSubstr("(free)")));
  const FiniteElementModel rest = RemoveDofs(model, {3, 2});
  EXPECT_THAT(rest.dof_names, ElementsAre("a", "b"));
  EXPECT_EQ(Matrix(rest.stiffness), Matrix(stiffness.topLeftCorner(2, 2)));
  EXPECT_EQ(Matrix(rest.mass)(0, 0), 1.0);
  EXPECT_FALSE(rest.has_damping());
  EXPECT_TRUE(DescribeSpecialDofs(rest).size() == 1);
}

TEST(FiniteElementModelDeathTest, RemoveDofsChecksPositions) {
  EXPECT_DEATH((void)RemoveDofs(ThreeDofs(), {3}), "DOF 3 does not exist");
  EXPECT_DEATH((void)RemoveDofs(ThreeDofs(), {0, 1, 2}), "all DOFs");
}

}  // namespace
}  // namespace pinode
