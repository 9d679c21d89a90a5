#include "pinode/structure/sparse/reduction.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A chain of n masses, u1 to un, with unit springs, fixed at its first mass or
// free. Masses grow a little, so that nothing is symmetric by chance.
FiniteElementModel Chain(int n, bool held) {
  FiniteElementModel model;
  model.dof_names = DefaultDofNames(n);
  Matrix stiffness = Matrix::Zero(n, n);
  if (held) stiffness(0, 0) = 1.0;
  for (int i = 1; i < n; ++i) {
    stiffness(i - 1, i - 1) += 1.0;
    stiffness(i, i) += 1.0;
    stiffness(i, i - 1) = stiffness(i - 1, i) = -1.0;
  }
  model.stiffness = stiffness.sparseView();
  model.mass = Matrix(Vector::LinSpaced(n, 1.0, 1.3).asDiagonal()).sparseView();
  return model;
}

ReductionOptions Options(ReductionMethod method,
                         std::vector<std::string> kept_dofs, int num_modes) {
  ReductionOptions options;
  options.method = method;
  options.kept_dofs = std::move(kept_dofs);
  options.num_modes = num_modes;
  return options;
}

ReducedModel ReduceOrFail(const FiniteElementModel& model,
                          const ReductionOptions& options) {
  ReducedModel reduced;
  std::string error;
  EXPECT_TRUE(ReduceModel(model, options, &reduced, &error)) << error;
  return reduced;
}

std::string ErrorOf(const FiniteElementModel& model,
                    const ReductionOptions& options) {
  ReducedModel reduced;
  std::string error;
  EXPECT_FALSE(ReduceModel(model, options, &reduced, &error));
  EXPECT_EQ(reduced.mass.size(), 0) << "a partial result";
  return error;
}

TEST(ReduceModel, ModalTruncationKeepsItsModes) {
  const FiniteElementModel model = Chain(40, true);
  const ReducedModel reduced =
      ReduceOrFail(model, Options(ReductionMethod::kModal, {}, 6));
  EXPECT_THAT(reduced.coordinate_names,
              ElementsAre("q1", "q2", "q3", "q4", "q5", "q6"));
  EXPECT_EQ(reduced.mass, Matrix::Identity(6, 6));
  EXPECT_LT((ReduceMatrix(model.mass, reduced.basis) - reduced.mass).norm(),
            1e-12);
  EXPECT_LT(
      (ReduceMatrix(model.stiffness, reduced.basis) - reduced.stiffness).norm(),
      1e-10);
  EXPECT_EQ(reduced.damping, Matrix::Zero(6, 6));
  ASSERT_EQ(reduced.frequency_error.size(), 6);
  EXPECT_LT(reduced.frequency_error.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_GT(reduced.mac.minCoeff(), 1.0 - 1e-10);
}

// The same modes, with sensors for coordinates.
TEST(ReduceModel, ModalTruncationKeepsDofsToo) {
  const FiniteElementModel model = Chain(40, true);
  const std::vector<std::string> kept = {"u40", "u13", "u26", "u5"};
  for (const int num_modes : {4, 6}) {
    ReductionOptions options =
        Options(ReductionMethod::kModal, kept, num_modes);
    options.num_compared_modes = num_modes;
    const ReducedModel reduced = ReduceOrFail(model, options);
    ASSERT_EQ(reduced.coordinate_names.size(), num_modes);
    for (int i = 0; i < 4; ++i) {
      const std::string& name = kept[static_cast<size_t>(i)];
      EXPECT_EQ(reduced.coordinate_names[static_cast<size_t>(i)], name);
      EXPECT_LT((reduced.basis.row(model.DofIndex(name)) -
                 RowVector::Unit(num_modes, i))
                    .norm(),
                1e-10);
    }
    if (num_modes == 6) {
      EXPECT_EQ(reduced.coordinate_names[5], "q2");
      // Modes without kept DOFs, the lower one first.
      EXPECT_NEAR(reduced.stiffness(4, 5), 0.0, 1e-10);
      EXPECT_LT(reduced.stiffness(4, 4), reduced.stiffness(5, 5));
    }
    EXPECT_LT((ReduceMatrix(model.mass, reduced.basis) - reduced.mass).norm(),
              1e-10 * reduced.mass.norm());
    EXPECT_LT((ReduceMatrix(model.stiffness, reduced.basis) - reduced.stiffness)
                  .norm(),
              1e-10 * reduced.stiffness.norm());
    ASSERT_EQ(reduced.frequency_error.size(), num_modes);
    EXPECT_LT(reduced.frequency_error.cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_GT(reduced.mac.minCoeff(), 1.0 - 1e-9);
  }
  const ReducedModel serep =
      ReduceOrFail(model, Options(ReductionMethod::kSerep, kept, 0));
  const ReducedModel modal =
      ReduceOrFail(model, Options(ReductionMethod::kModal, kept, 4));
  EXPECT_LT((serep.basis - modal.basis).norm(), 1e-9 * serep.basis.norm());
}

TEST(ReduceModel, SerepKeepsAsManyModesAsDofs) {
  const FiniteElementModel model = Chain(40, true);
  ReductionOptions options =
      Options(ReductionMethod::kSerep, {"u40", "u13", "u26", "u5"}, 0);
  const ReducedModel reduced = ReduceOrFail(model, options);
  EXPECT_EQ(reduced.coordinate_names, options.kept_dofs);
  ASSERT_EQ(reduced.frequency_error.size(), 4);
  EXPECT_LT(reduced.frequency_error.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT(reduced.mac.minCoeff(), 1.0 - 1e-9);
  // Coordinates are the kept DOFs themselves, in the order asked for.
  for (int i = 0; i < 4; ++i) {
    const int dof = model.DofIndex(options.kept_dofs[static_cast<size_t>(i)]);
    EXPECT_LT((reduced.basis.row(dof) - RowVector::Unit(4, i)).norm(), 1e-9);
  }
}

// If every other mass is missing, the reduction is exact.
// NumPy: the smallest singular value of the three modes at neighbouring DOFs
// is 8.7e-5 of the largest, at distant ones 0.89.
TEST(ReduceModel, SaysWhereKeptDofsHardlyMoveIndependently) {
  const FiniteElementModel model = Chain(30, true);
  const ReducedModel near = ReduceOrFail(
      model, Options(ReductionMethod::kSerep, {"u28", "u29", "u30"}, 0));
  ASSERT_EQ(near.notes.size(), 1u);
  EXPECT_THAT(near.notes[0],
              HasSubstr("hardly move independently in 3 modes (8.7e-05 of"));
  EXPECT_TRUE(ReduceOrFail(model, Options(ReductionMethod::kSerep,
                                          {"u10", "u20", "u30"}, 0))
                  .notes.empty());
}

TEST(ReduceModel, GuyanIsExactForMasslessDofs) {
  FiniteElementModel model = Chain(20, true);
  std::vector<std::string> kept;
  for (int i = 0; i < 20; ++i) {
    if (i % 2 == 1) {
      kept.push_back(model.dof_names[static_cast<size_t>(i)]);
    } else {
      model.mass.coeffRef(i, i) = 0.0;
    }
  }
  ReductionOptions options = Options(ReductionMethod::kGuyan, kept, 0);
  options.num_compared_modes = 10;
  const ReducedModel reduced = ReduceOrFail(model, options);
  ASSERT_EQ(reduced.frequency_error.size(), 10);
  EXPECT_LT(reduced.frequency_error.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_GT(reduced.mac.minCoeff(), 1.0 - 1e-8);
  EXPECT_THAT(reduced.notes, ElementsAre());
}

// Static responses to forces at kept DOFs are exact. Frequencies are too high,
// and more so for higher modes.
TEST(ReduceModel, GuyanIsStaticallyExactAndTooStiff) {
  const FiniteElementModel model = Chain(30, true);
  ReductionOptions options =
      Options(ReductionMethod::kGuyan, {"u10", "u20", "u30"}, 0);
  options.num_compared_modes = 3;
  const ReducedModel reduced = ReduceOrFail(model, options);
  const Vector force = Vector::LinSpaced(3, 1.0, 2.0);
  Vector whole_force = Vector::Zero(30);
  for (int i = 0; i < 3; ++i) whole_force[10 * i + 9] = force[i];
  const Vector whole = Matrix(model.stiffness).ldlt().solve(whole_force);
  const Vector expanded =
      reduced.basis * Vector(reduced.stiffness.ldlt().solve(force));
  EXPECT_LT((whole - expanded).norm(), 1e-10 * whole.norm());
  ASSERT_EQ(reduced.frequency_error.size(), 3);
  EXPECT_GT(reduced.frequency_error[0], 1e-4);
  EXPECT_LT(reduced.frequency_error[0], 0.02);
  EXPECT_GT(reduced.frequency_error[1], reduced.frequency_error[0]);
  EXPECT_GT(reduced.frequency_error[2], reduced.frequency_error[1]);
  EXPECT_LT(reduced.mac[2], reduced.mac[0]);
}

// Against dense matrices in SciPy (tests/generators/reduction.py).
TEST(ReduceModel, AgreesWithAnIndependentReduction) {
  struct Reference {
    ReductionMethod method;
    int num_modes;
    Vector frequency_error, mac_loss;
    Matrix mass;
  };
  Matrix constraint_mass(3, 3);
  constraint_mass << 7.3237931034483, 1.8889655172414, 0.0, 1.8889655172414,
      8.0168965517241, 2.0596551724138, 0.0, 2.0596551724138, 4.9196551724138;
  Matrix serep_mass(3, 3);
  serep_mass << 10.6145668915275, 0.4935979944962, -0.3653002668341,
      0.4935979944962, 11.0674375603801, 0.8281225376354, -0.3653002668341,
      0.8281225376354, 6.2895429953444;
  for (const Reference& reference : std::vector<Reference>{
           {ReductionMethod::kGuyan, 0,
            Eigen::Vector3d(0.0105293961788, 0.0910132488552, 0.1481600941274),
            Eigen::Vector3d(0.00012615209, 0.014960316000, 0.14701159917),
            constraint_mass},
           {ReductionMethod::kCraigBampton, 2,
            Eigen::Vector3d(0.0004893828546, 0.0230924326911, 0.1284603163313),
            Eigen::Vector3d(1.8774818e-05, 0.01071906926, 0.09432487396),
            constraint_mass},
           {ReductionMethod::kSerep, 0, Vector::Zero(3), Vector::Zero(3),
            serep_mass}}) {
    ReductionOptions options =
        Options(reference.method, {"u10", "u20", "u30"}, reference.num_modes);
    options.num_compared_modes = 3;
    const ReducedModel reduced = ReduceOrFail(Chain(30, true), options);
    ASSERT_EQ(reduced.frequency_error.size(), 3);
    EXPECT_LT((reduced.frequency_error - reference.frequency_error).norm(),
              1e-9);
    EXPECT_LT((Vector::Ones(3) - reduced.mac - reference.mac_loss).norm(),
              1e-9);
    EXPECT_LT((reduced.mass.topLeftCorner(3, 3) - reference.mass).norm(), 1e-9);
  }
}

// Two identical chains side by side: every frequency occurs twice, and the
// combinations of the two motions that form its modes are arbitrary.
TEST(ReduceModel, SharedFrequenciesAreComparedAsSpaces) {
  const FiniteElementModel one = Chain(10, true);
  FiniteElementModel two;
  two.dof_names = DefaultDofNames(20);
  Matrix mass = Matrix::Zero(20, 20);
  Matrix stiffness = Matrix::Zero(20, 20);
  for (const int at : {0, 10}) {
    mass.block(at, at, 10, 10) = Matrix(one.mass);
    stiffness.block(at, at, 10, 10) = Matrix(one.stiffness);
  }
  two.mass = mass.sparseView();
  two.stiffness = stiffness.sparseView();
  ReductionOptions options =
      Options(ReductionMethod::kGuyan, {"u5", "u10", "u15", "u20"}, 0);
  options.num_compared_modes = 4;
  const ReducedModel reduced = ReduceOrFail(two, options);
  ASSERT_EQ(reduced.mac.size(), 4);
  ReductionOptions of_one = Options(ReductionMethod::kGuyan, {"u5", "u10"}, 0);
  of_one.num_compared_modes = 2;
  const ReducedModel single = ReduceOrFail(one, of_one);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(reduced.mac[i], single.mac[i / 2], 1e-9);
    EXPECT_NEAR(reduced.frequency_error[i], single.frequency_error[i / 2],
                1e-9);
  }
}

// If only the kept DOFs support the others, these follow the ground as a rigid
// body and the coupling is zero. If the ground supports one of the others, the
// coupling accounts for it.
TEST(ReduceInfluence, ForceOnTheCoordinatesIsThatOfTheWholeModel) {
  const Matrix influence = Matrix::Ones(12, 1);
  for (const bool held : {false, true}) {
    const FiniteElementModel model = Chain(12, held);
    const ReducedModel reduced = ReduceOrFail(
        model,
        Options(ReductionMethod::kCraigBampton, {"u12", "u4"}, held ? 2 : 0));
    const ReducedInfluence ground = ReduceInfluence(model, reduced, influence);
    const ReducedModel modal =
        ReduceOrFail(model, Options(ReductionMethod::kModal, {"u12", "u4"}, 4));
    const ReducedInfluence of_modes = ReduceInfluence(model, modal, influence);
    EXPECT_EQ(of_modes.influence.col(0), (Vector(4) << 1, 1, 0, 0).finished());
    const Vector on_modes =
        modal.basis.transpose() * (Matrix(model.mass) * influence);
    EXPECT_LT((modal.mass * of_modes.influence +
               of_modes.support_mass_coupling - on_modes)
                  .norm(),
              1e-10 * on_modes.norm());
    EXPECT_EQ(ground.influence(0, 0), 1.0);
    EXPECT_EQ(ground.influence(1, 0), 1.0);
    const Vector force =
        reduced.mass * ground.influence + ground.support_mass_coupling;
    const Vector whole =
        reduced.basis.transpose() * (Matrix(model.mass) * influence);
    EXPECT_LT((force - whole).norm(), 1e-12 * whole.norm());
    if (held) {
      EXPECT_GT(ground.support_mass_coupling.norm(), 0.1);
    } else {
      EXPECT_LT(ground.support_mass_coupling.norm(), 1e-12);
    }
  }
}

TEST(ReduceModel, CraigBamptonConvergesWithItsModes) {
  FiniteElementModel model = Chain(30, true);
  model.damping = 0.01 * model.stiffness;
  double last = 1.0;
  for (const int num_modes : {0, 3, 6, 12}) {
    ReductionOptions options = Options(ReductionMethod::kCraigBampton,
                                       {"u10", "u20", "u30"}, num_modes);
    options.num_compared_modes = 3;
    const ReducedModel reduced = ReduceOrFail(model, options);
    EXPECT_EQ(reduced.mass.rows(), 3 + num_modes);
    const double worst = reduced.frequency_error.maxCoeff();
    EXPECT_LT(worst, 0.5 * last);
    last = worst;
    EXPECT_LT((reduced.damping - 0.01 * reduced.stiffness).norm(), 1e-12);
  }
  // With all of them, it is the whole model.
  ReductionOptions options =
      Options(ReductionMethod::kCraigBampton, {"u10", "u20", "u30"}, 27);
  options.num_compared_modes = 30;
  const ReducedModel all = ReduceOrFail(model, options);
  ASSERT_EQ(all.frequency_error.size(), 30);
  EXPECT_LT(all.frequency_error.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(all.coordinate_names[3], "q1");
  EXPECT_EQ(all.mass, all.mass.transpose());
  EXPECT_EQ(all.stiffness, all.stiffness.transpose());
}

// The chain of the next test in the basis of Craig and Bampton, in closed form:
// between kept DOFs the static shapes are straight, and the modes are sines.
// Kept are `a`, a + 1 and the last DOF.
Matrix ClosedFormBasis(int n, int a, int num_modes) {
  struct Mode {
    double eigenvalue;
    int first, masses, number;
  };
  std::vector<Mode> modes;
  const auto add = [&](int first, int masses) {
    for (int i = 1; i <= num_modes; ++i) {
      const double s = std::sin(i * kPi / (2.0 * (masses + 1)));
      modes.push_back({4.0 * s * s, first, masses, i});
    }
  };
  add(0, a);
  add(a + 2, n - a - 3);
  std::sort(modes.begin(), modes.end(), [](const Mode& x, const Mode& y) {
    return x.eigenvalue < y.eigenvalue;
  });
  Matrix basis = Matrix::Zero(n, 3 + num_modes);
  for (int i = 0; i <= a; ++i) basis(i, 0) = (i + 1.0) / (a + 1.0);
  for (int i = a + 1; i < n; ++i) {
    basis(i, 2) = (i - a - 1.0) / (n - a - 2.0);
    basis(i, 1) = 1.0 - basis(i, 2);
  }
  for (int k = 0; k < num_modes; ++k) {
    const Mode& mode = modes[static_cast<size_t>(k)];
    for (int i = 0; i < mode.masses; ++i) {
      basis(mode.first + i, 3 + k) =
          std::sin(mode.number * kPi * (i + 1) / (mode.masses + 1));
    }
  }
  return basis;
}

// Enough DOFs for the factors of the whole, with a stiff link between two kept
// DOFs.
TEST(ReduceModel, CraigBamptonByFactorsOfTheWhole) {
  const int n = 320;
  const Matrix basis = ClosedFormBasis(n, 99, 5);
  for (const double link : {1.0, 1e2, 1e4}) {
    SCOPED_TRACE(link);
    FiniteElementModel model = Chain(n, true);
    model.mass.setIdentity();
    model.stiffness.coeffRef(99, 99) += link;
    model.stiffness.coeffRef(100, 100) += link;
    model.stiffness.coeffRef(99, 100) -= link;
    model.stiffness.coeffRef(100, 99) -= link;
    const ReducedModel reduced = ReduceOrFail(
        model,
        Options(ReductionMethod::kCraigBampton, {"u100", "u101", "u320"}, 5));
    ASSERT_EQ(reduced.mass.rows(), 8);
    const auto eigenvalues = [](const Matrix& k, const Matrix& m) {
      return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(
                 k, m, Eigen::EigenvaluesOnly)
          .eigenvalues()
          .eval();
    };
    const Vector found = eigenvalues(reduced.stiffness, reduced.mass);
    const Vector expected =
        eigenvalues(basis.transpose() * (model.stiffness * basis),
                    basis.transpose() * (model.mass * basis));
    // The highest is that of the link.
    for (Eigen::Index i = 0; i < 7; ++i) {
      EXPECT_NEAR(found[i], expected[i], 1e-8 * expected[i] + 1e-15 * link);
    }
  }
}

TEST(ReduceModel, RigidBodyModesStayAtZero) {
  const FiniteElementModel model = Chain(30, false);
  for (const ReductionMethod method :
       {ReductionMethod::kGuyan, ReductionMethod::kSerep,
        ReductionMethod::kCraigBampton, ReductionMethod::kModal}) {
    ReductionOptions options =
        Options(method, {"u1", "u10", "u20", "u30"},
                method == ReductionMethod::kModal          ? 5
                : method == ReductionMethod::kCraigBampton ? 4
                                                           : 0);
    options.num_compared_modes = 3;
    const ReducedModel reduced = ReduceOrFail(model, options);
    ASSERT_EQ(reduced.frequency_error.size(), 3);
    EXPECT_EQ(reduced.whole_modes.frequency_hz[0], 0.0);
    EXPECT_EQ(reduced.frequency_error[0], 0.0);
    EXPECT_GT(reduced.mac[0], 1.0 - 1e-9);
    // Three linear elements for half a wave: (pi / 3)^2 / 24 without modes.
    EXPECT_LT(reduced.frequency_error[1],
              method == ReductionMethod::kGuyan ? 0.046 : 0.01);
  }
}

// Links of 1e7 times a spring: the modes of the reduced model, most of which
// are asked for, span 3500 times in frequency.
TEST(ReduceModel, ComparesAllModesBesideStiffLinks) {
  FiniteElementModel model = Chain(40, true);
  for (int i = 1; i < 40; i += 3) {
    const double more = 1e7 - 1.0;
    model.stiffness.coeffRef(i - 1, i - 1) += more;
    model.stiffness.coeffRef(i, i) += more;
    model.stiffness.coeffRef(i - 1, i) -= more;
    model.stiffness.coeffRef(i, i - 1) -= more;
  }
  ReductionOptions options =
      Options(ReductionMethod::kCraigBampton, {"u1", "u20", "u40"}, 36);
  options.num_compared_modes = 36;
  const ReducedModel reduced = ReduceOrFail(model, options);
  ASSERT_EQ(reduced.frequency_error.size(), 36);
  // All modes below the links are in the basis, and the last ones nearly.
  EXPECT_LT(reduced.frequency_error.head(26).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT(reduced.mac.head(26).minCoeff(), 1.0 - 1e-6);
}

// Adding a group to the whole model and reducing it gives the reduced model
// with the reduced group.
TEST(ReduceMatrix, GroupsAreReducedAlong) {
  FiniteElementModel model = Chain(12, true);
  const ReducedModel reduced = ReduceOrFail(
      model, Options(ReductionMethod::kCraigBampton, {"u4", "u12"}, 3));
  Matrix spring = Matrix::Zero(12, 12);
  spring(5, 5) = spring(6, 6) = 1.0;
  spring(5, 6) = spring(6, 5) = -1.0;
  const SparseMatrix group = spring.sparseView();
  const Matrix together =
      ReduceMatrix(SparseMatrix(model.stiffness + 0.3 * group), reduced.basis);
  const Matrix apart =
      reduced.stiffness + 0.3 * ReduceMatrix(group, reduced.basis);
  EXPECT_LT((together - apart).norm(), 1e-14 * together.norm());
}

TEST(ReduceModel, NotesASingularMass) {
  FiniteElementModel model = Chain(6, true);
  // Two neighbours without mass, one of them kept.
  model.mass.coeffRef(2, 2) = 0.0;
  const ReducedModel reduced =
      ReduceOrFail(model, Options(ReductionMethod::kGuyan,
                                  {"u1", "u2", "u3", "u4", "u5", "u6"}, 0));
  EXPECT_THAT(reduced.notes, Contains(HasSubstr("mass matrix is singular")));
  EXPECT_LT(reduced.frequency_error.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ReduceModel, ModesAreNotNamedLikeDofs) {
  FiniteElementModel model = Chain(6, true);
  model.dof_names[2] = "q1";
  const ReducedModel reduced =
      ReduceOrFail(model, Options(ReductionMethod::kCraigBampton, {"q1"}, 2));
  EXPECT_THAT(reduced.coordinate_names, ElementsAre("q1", "qq1", "qq2"));
}

TEST(ReduceModel, RefusesWhatCannotBe) {
  const FiniteElementModel model = Chain(10, true);
  EXPECT_THAT(ErrorOf(model, Options(ReductionMethod::kGuyan, {"u11"}, 0)),
              HasSubstr("'u11' does not exist"));
  EXPECT_THAT(ErrorOf(model, Options(ReductionMethod::kGuyan, {"u1", "u1"}, 0)),
              HasSubstr("named twice"));
  EXPECT_THAT(ErrorOf(model, Options(ReductionMethod::kGuyan, {}, 0)),
              HasSubstr("at least one"));
  EXPECT_THAT(ErrorOf(model, Options(ReductionMethod::kGuyan, {"u1"}, 2)),
              HasSubstr("expected none"));
  EXPECT_THAT(
      ErrorOf(model, Options(ReductionMethod::kModal, {"u1", "u2", "u3"}, 2)),
      HasSubstr("more DOFs are kept (3) than modes are taken (2)"));
  // Two ends of a bar without mass of its own.
  FiniteElementModel stiff = Chain(10, true);
  for (const int i : {5, 6}) stiff.stiffness.coeffRef(i, i) += 1e9;
  stiff.stiffness.coeffRef(5, 6) = stiff.stiffness.coeffRef(6, 5) = -1e9;
  EXPECT_THAT(ErrorOf(stiff, Options(ReductionMethod::kModal, {"u6", "u7"}, 3)),
              HasSubstr("do not move the kept DOFs independently"));
  EXPECT_THAT(ErrorOf(model, Options(ReductionMethod::kModal, {}, 0)),
              HasSubstr("at least 1"));
  EXPECT_THAT(ErrorOf(model, Options(ReductionMethod::kModal, {}, 11)),
              HasSubstr("10 DOFs"));
  EXPECT_THAT(
      ErrorOf(model, Options(ReductionMethod::kCraigBampton, {"u1"}, 10)),
      HasSubstr("there are 9"));
  // A last mass without support, and one with negative stiffness.
  FiniteElementModel loose = Chain(10, true);
  loose.stiffness.coeffRef(9, 9) = 0.0;
  loose.stiffness.coeffRef(8, 8) = 1.0;
  loose.stiffness.coeffRef(8, 9) = loose.stiffness.coeffRef(9, 8) = 0.0;
  EXPECT_THAT(ErrorOf(loose, Options(ReductionMethod::kGuyan, {"u1"}, 0)),
              HasSubstr("keep DOFs that hold all, such as u10 beside"));
  loose.stiffness.coeffRef(9, 9) = -1e-3;
  EXPECT_THAT(ErrorOf(loose, Options(ReductionMethod::kGuyan, {"u1"}, 0)),
              AllOf(HasSubstr("can still move"), HasSubstr("u10")));
  // Two equal chains: seen from one of them, the modes are equal.
  FiniteElementModel twins = Chain(4, true);
  Matrix stiffness = Matrix::Zero(8, 8);
  stiffness.topLeftCorner(4, 4) = Matrix(twins.stiffness);
  stiffness.bottomRightCorner(4, 4) = 1.5 * Matrix(twins.stiffness);
  twins.stiffness = stiffness.sparseView();
  twins.mass = Matrix(Matrix::Identity(8, 8)).sparseView();
  twins.dof_names = DefaultDofNames(8);
  EXPECT_THAT(ErrorOf(twins, Options(ReductionMethod::kSerep, {"u1", "u2"}, 0)),
              HasSubstr("do not move the kept DOFs independently"));
}

}  // namespace
}  // namespace pinode
