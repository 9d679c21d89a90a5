#include "pinode/structure/sparse/rigid_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/sparse/reduction.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// An unsupported steel strip, 1 m x 40 mm x 5 mm.
constexpr double kLength = 1.0;
constexpr double kBending = 210e9 * 40e-3 * 5e-3 * 5e-3 * 5e-3 / 12.0;  // N m^2
constexpr double kMassPerLength = 7850.0 * 40e-3 * 5e-3;                // kg/m
constexpr double kMass = kMassPerLength * kLength;

// Plane bending in `elements` Euler-Bernoulli elements, with DOFs w and
// rotation at each node, "i.3" and "i.5". K of the elements first .. last - 1,
// M of all.
FiniteElementModel Strip(int elements, int first, int last) {
  const double h = kLength / elements;
  Matrix k(4, 4);
  k << 12, 6 * h, -12, 6 * h,               //
      6 * h, 4 * h * h, -6 * h, 2 * h * h,  //
      -12, -6 * h, 12, -6 * h,              //
      6 * h, 2 * h * h, -6 * h, 4 * h * h;
  k *= kBending / (h * h * h);
  Matrix m(4, 4);
  m << 156, 22 * h, 54, -13 * h,              //
      22 * h, 4 * h * h, 13 * h, -3 * h * h,  //
      54, 13 * h, 156, -22 * h,               //
      -13 * h, -3 * h * h, -22 * h, 4 * h * h;
  m *= kMassPerLength * h / 420.0;
  const int n = 2 * (elements + 1);
  Matrix mass = Matrix::Zero(n, n);
  Matrix stiffness = Matrix::Zero(n, n);
  for (int e = 0; e < elements; ++e) {
    mass.block(2 * e, 2 * e, 4, 4) += m;
    if (e >= first && e < last) stiffness.block(2 * e, 2 * e, 4, 4) += k;
  }
  FiniteElementModel model;
  model.mass = mass.sparseView();
  model.stiffness = stiffness.sparseView();
  for (int i = 1; i <= elements + 1; ++i) {
    model.dof_names.push_back(std::to_string(i) + ".3");
    model.dof_names.push_back(std::to_string(i) + ".5");
  }
  return model;
}

FiniteElementModel Strip(int elements) { return Strip(elements, 0, elements); }

std::string Deflection(int node) { return std::to_string(node) + ".3"; }

// (beta L)^2 sqrt(EI / (m L^4)) with cosh(beta L) cos(beta L) = 1.
std::vector<double> ElasticHz() {
  std::vector<double> hz;
  for (const double root : {4.730040744862704, 7.853204624095838,
                            10.995607838001671, 14.137165491257464}) {
    hz.push_back(root * root / kTwoPi *
                 std::sqrt(kBending / (kMassPerLength * std::pow(kLength, 4))));
  }
  return hz;
}

ReducedModel ReduceStrip(const FiniteElementModel& model,
                         ReductionMethod method, int num_modes) {
  const int nodes = model.num_dofs() / 2;
  ReductionOptions options;
  options.method = method;
  options.kept_dofs = {Deflection(1), Deflection((nodes + 1) / 2),
                       Deflection(nodes)};
  options.num_modes = num_modes;
  // Fewer modes are requested than there are rigid-body modes: all of these are
  // found nevertheless.
  options.num_compared_modes = 1;
  ReducedModel reduced;
  std::string error;
  EXPECT_TRUE(ReduceModel(model, options, &reduced, &error)) << error;
  return reduced;
}

class FreeStripTest : public ::testing::TestWithParam<int> {};

TEST_P(FreeStripTest, ModesOfTheWholeAreThoseOfTheTextbook) {
  const FiniteElementModel model = Strip(GetParam());
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 6, &modes, &error))
      << error;
  EXPECT_EQ(modes.num_rigid_body_modes, 2);
  EXPECT_EQ(modes.frequency_hz[0], 0.0);
  EXPECT_EQ(modes.frequency_hz[1], 0.0);
  const std::vector<double> elastic = ElasticHz();
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(modes.frequency_hz[i + 2] / elastic[static_cast<size_t>(i)],
                1.0, GetParam() == 12 ? 2e-3 : 2e-5);
  }
}

// Any motion a + b x of the kept DOFs is one of the whole strip, with its mass
// and its inertia m L^2 / 12, and without resistance.
TEST_P(FreeStripTest, RigidBodyIsKeptByConstraints) {
  const FiniteElementModel model = Strip(GetParam());
  for (const int num_modes : {0, 6}) {
    const ReducedModel reduced =
        ReduceStrip(model, ReductionMethod::kCraigBampton, num_modes);
    ASSERT_EQ(reduced.rigid_body_motions.cols(), 2);
    Matrix motion = Matrix::Zero(3 + num_modes, 2);
    motion.col(0).head(3).setOnes();
    motion.col(1).head(3) << -0.5 * kLength, 0.0, 0.5 * kLength;
    const Matrix mass = motion.transpose() * reduced.mass * motion;
    EXPECT_NEAR(mass(0, 0), kMass, 1e-10 * kMass);
    EXPECT_NEAR(mass(1, 1), kMass * kLength * kLength / 12.0, 1e-10 * kMass);
    EXPECT_NEAR(mass(0, 1), 0.0, 1e-10 * kMass);
    EXPECT_LT(
        (reduced.stiffness * reduced.rigid_body_motions).norm(),
        1e-14 * reduced.stiffness.norm() * reduced.rigid_body_motions.norm());

    ModalProperties modes;
    std::string error;
    ASSERT_TRUE(ComputeModes(reduced.mass, 1e-4 * reduced.stiffness,
                             reduced.stiffness, &modes, &error))
        << error;
    EXPECT_EQ(modes.frequency_hz[0], 0.0);
    EXPECT_EQ(modes.frequency_hz[1], 0.0);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(modes.damped_frequency_hz[i], 0.0);
      EXPECT_TRUE(std::isnan(modes.damping_ratio[i]));
    }
    const std::vector<double> elastic = ElasticHz();
    const int good = num_modes == 0 ? 1 : 4;
    for (int i = 0; i < good; ++i) {
      EXPECT_NEAR(modes.frequency_hz[i + 2] / elastic[static_cast<size_t>(i)],
                  1.0, num_modes == 0 ? 5e-3 : 1e-2);
    }
  }
}

TEST_P(FreeStripTest, RigidBodyIsKeptByModes) {
  const FiniteElementModel model = Strip(GetParam());
  for (const bool serep : {true, false}) {
    const ReducedModel reduced = ReduceStrip(
        model, serep ? ReductionMethod::kSerep : ReductionMethod::kModal,
        serep ? 0 : 6);
    ModalProperties modes;
    std::string error;
    ASSERT_TRUE(ComputeModes(reduced.mass, 1e-4 * reduced.stiffness,
                             reduced.stiffness, &modes, &error))
        << error;
    EXPECT_EQ(modes.frequency_hz[0], 0.0);
    EXPECT_EQ(modes.frequency_hz[1], 0.0);
    EXPECT_TRUE(std::isnan(modes.damping_ratio[0]));
    const std::vector<double> elastic = ElasticHz();
    for (int i = 0; i < (serep ? 1 : 4); ++i) {
      EXPECT_NEAR(modes.frequency_hz[i + 2] / elastic[static_cast<size_t>(i)],
                  1.0, GetParam() == 12 ? 2e-3 : 2e-5);
    }
  }
}

// Softening half of the strip does not support it; a spring under it does.
TEST_P(FreeStripTest, GroupsHoldItOnlyWhereTheyAreSupports) {
  const int elements = GetParam();
  const FiniteElementModel model = Strip(elements);
  const ReducedModel reduced =
      ReduceStrip(model, ReductionMethod::kCraigBampton, 4);
  const Matrix half = ReduceMatrix(Strip(elements, 0, elements / 2).stiffness,
                                   reduced.basis, reduced.rigid_body_motions);
  EXPECT_GT(half.norm(), 0.1 * reduced.stiffness.norm());
  UndampedModes modes;
  std::string error;
  ASSERT_TRUE(ComputeUndampedModes(reduced.mass, reduced.stiffness - 0.3 * half,
                                   &modes, &error));
  EXPECT_EQ(modes.eigenvalues[0], 0.0);
  EXPECT_EQ(modes.eigenvalues[1], 0.0);
  EXPECT_GT(modes.eigenvalues[2], 0.0);

  SparseMatrix spring(model.num_dofs(), model.num_dofs());
  spring.insert(0, 0) = 1e3;
  const Matrix support =
      ReduceMatrix(spring, reduced.basis, reduced.rigid_body_motions);
  EXPECT_EQ(support(0, 0), 1e3);
  EXPECT_EQ(support.norm(), 1e3);
}

INSTANTIATE_TEST_SUITE_P(Elements, FreeStripTest,
                         ::testing::Values(12, 40, 100, 200));

// A bar of equal elements with consistent masses:
// w^2 = 6 (c / h)^2 (1 - cos a) / (2 + cos a), a = j pi / elements.
TEST(FreeBar, FrequenciesAreThoseOfTheTextbook) {
  constexpr int kElements = 50;
  const double h = kLength / kElements;
  const double speed = std::sqrt(210e9 / 7850.0);
  Matrix mass = Matrix::Zero(kElements + 1, kElements + 1);
  Matrix stiffness = mass;
  const Matrix one = Matrix::Ones(2, 2);
  const Matrix unit = Matrix::Identity(2, 2);
  for (int e = 0; e < kElements; ++e) {
    mass.block(e, e, 2, 2) += 7850.0 * h / 6.0 * (one + unit);
    stiffness.block(e, e, 2, 2) += 210e9 / h * (2.0 * unit - one);
  }
  FiniteElementModel model;
  model.mass = mass.sparseView();
  model.stiffness = stiffness.sparseView();
  model.dof_names = DefaultDofNames(kElements + 1);
  ReductionOptions options;
  options.kept_dofs = {"u1", "u51"};
  options.num_modes = 8;
  options.num_compared_modes = 4;
  ReducedModel reduced;
  std::string error;
  ASSERT_TRUE(ReduceModel(model, options, &reduced, &error)) << error;
  UndampedModes modes;
  ASSERT_TRUE(
      ComputeUndampedModes(reduced.mass, reduced.stiffness, &modes, &error));
  EXPECT_EQ(modes.eigenvalues[0], 0.0);
  for (int j = 1; j < 4; ++j) {
    const double a = j * kPi / kElements;
    const double w2 = 6.0 * speed * speed / (h * h) * (1.0 - std::cos(a)) /
                      (2.0 + std::cos(a));
    EXPECT_NEAR(reduced.whole_modes.eigenvalues[j] / w2, 1.0, 1e-9);
    EXPECT_NEAR(std::sqrt(modes.eigenvalues[j]) / (j * kPi * speed / kLength),
                1.0, 5e-3);
  }
}

TEST(DofsToHold, NamesWhatIsMissing) {
  const FiniteElementModel model = Strip(20);
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 4, &modes, &error));
  const Matrix shapes = RigidBodyShapes(modes);
  const Vector mass = model.mass.diagonal();
  EXPECT_THAT(DofsToHold(shapes, mass, {}), SizeIs(2));
  EXPECT_THAT(DofsToHold(shapes, mass, {20}), SizeIs(1));
  // Deflection and rotation of a node; two deflections; two rotations.
  EXPECT_THAT(DofsToHold(shapes, mass, {20, 21}), IsEmpty());
  EXPECT_THAT(DofsToHold(shapes, mass, {20, 22}), IsEmpty());
  EXPECT_THAT(DofsToHold(shapes, mass, {1, 41}), SizeIs(1));
  // The returned DOFs do prevent all rigid-body modes.
  std::vector<int> held = {1, 41};
  held.push_back(DofsToHold(shapes, mass, held)[0]);
  EXPECT_THAT(DofsToHold(shapes, mass, held), IsEmpty());
  EXPECT_THAT(DofsToHold(Matrix(42, 0), mass, {}), IsEmpty());
}

TEST(ReduceModel, SaysWhatToKeepOfAFreeModel) {
  const FiniteElementModel model = Strip(20);
  const auto error_of = [&model](ReductionMethod method,
                                 const std::vector<std::string>& kept,
                                 int num_modes) {
    ReductionOptions options;
    options.method = method;
    options.kept_dofs = kept;
    options.num_modes = num_modes;
    ReducedModel reduced;
    std::string error;
    EXPECT_FALSE(ReduceModel(model, options, &reduced, &error));
    return error;
  };
  EXPECT_EQ(error_of(ReductionMethod::kCraigBampton, {"11.3"}, 4).find('\n'),
            std::string::npos);
  EXPECT_THAT(error_of(ReductionMethod::kCraigBampton, {"11.3"}, 4),
              HasSubstr("2 rigid-body modes, and the kept DOFs hold 1 of them; "
                        "keep DOFs that hold all, such as "));
  EXPECT_THAT(error_of(ReductionMethod::kGuyan, {"1.5", "21.5"}, 0),
              HasSubstr("the kept DOFs hold 1 of them"));
  EXPECT_THAT(error_of(ReductionMethod::kModal, {}, 1),
              HasSubstr("1 modes are taken of a model with 2 rigid-body "
                        "modes"));
  EXPECT_THAT(error_of(ReductionMethod::kSerep, {"1.3"}, 0),
              HasSubstr("with 2 rigid-body modes"));
}

}  // namespace
}  // namespace pinode
