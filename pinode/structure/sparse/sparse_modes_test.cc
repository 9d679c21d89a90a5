#include "pinode/structure/sparse/sparse_modes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/sparse/modes_from_factors.h"
#include "pinode/structure/sparse/shifted_factors.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix FromTriplets(int n, const Triplets& triplets) {
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

void AddSpring(int a, int b, double k, Triplets* triplets) {
  triplets->emplace_back(a, a, k);
  if (b < 0) return;
  triplets->emplace_back(b, b, k);
  triplets->emplace_back(a, b, -k);
  triplets->emplace_back(b, a, -k);
}

SparseMatrix DiagonalMatrix(const Vector& diagonal) {
  Triplets triplets;
  for (int i = 0; i < diagonal.size(); ++i) {
    if (diagonal[i] != 0.0) triplets.emplace_back(i, i, diagonal[i]);
  }
  return FromTriplets(static_cast<int>(diagonal.size()), triplets);
}

// `copies` separate chains of n unit masses and unit springs, each held at its
// first mass or free.
SparseMatrix Chains(int n, int copies, bool held) {
  Triplets triplets;
  for (int c = 0; c < copies; ++c) {
    if (held) AddSpring(c * n, -1, 1.0, &triplets);
    for (int i = 1; i < n; ++i) {
      AddSpring(c * n + i - 1, c * n + i, 1.0, &triplets);
    }
  }
  return FromTriplets(n * copies, triplets);
}

double HeldChainEigenvalue(int n, int mode) {
  const double s = std::sin((2 * mode + 1) * kPi / (2.0 * (2 * n + 1)));
  return 4.0 * s * s;
}

double FreeChainEigenvalue(int n, int mode) {
  const double s = std::sin(mode * kPi / (2.0 * n));
  return 4.0 * s * s;
}

SparseModes ComputeOrFail(const SparseMatrix& mass,
                          const SparseMatrix& stiffness, int count) {
  SparseModes modes;
  std::string error;
  EXPECT_TRUE(ComputeLowestModes(mass, stiffness, count, &modes, &error))
      << error;
  return modes;
}

void ExpectEigenvalues(const SparseModes& modes,
                       const std::vector<double>& expected, double tolerance) {
  ASSERT_EQ(modes.eigenvalues.size(),
            static_cast<Eigen::Index>(expected.size()));
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(modes.eigenvalues[static_cast<Eigen::Index>(i)], expected[i],
                tolerance * std::abs(expected[i]))
        << "mode " << i + 1;
  }
}

// Phi' M Phi = I and K Phi = M Phi W^2, to the rounding in K Phi.
void ExpectModesSolveTheProblem(const SparseMatrix& mass,
                                const SparseMatrix& stiffness,
                                const SparseModes& modes) {
  const Matrix& shapes = modes.mode_shapes;
  ASSERT_EQ(shapes.rows(), mass.rows());
  const Eigen::Index count = modes.eigenvalues.size();
  const Matrix gram = shapes.transpose() * (mass * shapes);
  EXPECT_LT((gram - Matrix::Identity(count, count)).cwiseAbs().maxCoeff(),
            1e-9);
  const Matrix forces = stiffness * shapes;
  const Matrix inertia = mass * shapes * modes.eigenvalues.asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i) {
    const double parts =
        (stiffness.cwiseAbs() * shapes.col(i).cwiseAbs()).norm();
    EXPECT_LT((forces.col(i) - inertia.col(i)).norm(),
              1e-8 * inertia.col(i).norm() + 1e-12 * parts)
        << "mode " << i + 1;
    EXPECT_LE(modes.error_bounds[i], 1e-8);
    Eigen::Index largest = 0;
    shapes.col(i).cwiseAbs().maxCoeff(&largest);
    EXPECT_GT(shapes(largest, i), 0.0);
  }
}

TEST(ComputeLowestModes, HeldChain) {
  for (const int n : {1, 2, 40, 299, 300, 2000}) {
    SCOPED_TRACE(n);
    const SparseMatrix mass = DiagonalMatrix(Vector::Ones(n));
    const SparseMatrix stiffness = Chains(n, 1, true);
    const int count = std::min(n, 20);
    const SparseModes modes = ComputeOrFail(mass, stiffness, count);
    std::vector<double> expected;
    for (int i = 0; i < count; ++i) {
      expected.push_back(HeldChainEigenvalue(n, i));
    }
    ExpectEigenvalues(modes, expected, 1e-9);
    ExpectModesSolveTheProblem(mass, stiffness, modes);
    EXPECT_EQ(modes.shift, 0.0);
    EXPECT_EQ(modes.num_rigid_body_modes, 0);
    EXPECT_THAT(modes.notes, ElementsAre());
    EXPECT_NEAR(modes.frequency_hz[0], std::sqrt(expected[0]) / (2.0 * kPi),
                1e-9);
  }
}

// Nothing is coupled, so any order of elimination will do.
TEST(ComputeLowestModes, DiagonalModel) {
  constexpr int kSize = 2500;
  SparseMatrix mass(kSize, kSize);
  SparseMatrix stiffness(kSize, kSize);
  mass.setIdentity();
  stiffness.setIdentity();
  for (int i = 0; i < kSize; ++i) stiffness.coeffRef(i, i) = kSize - i;
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(ComputeLowestModes(mass, stiffness, 3, &modes, &error)) << error;
  ASSERT_EQ(modes.eigenvalues.size(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(modes.eigenvalues[i], i + 1.0, 1e-9);
    EXPECT_NEAR(modes.mode_shapes(kSize - 1 - i, i), 1.0, 1e-9);
  }
}

TEST(ComputeLowestModes, FreeChainsHaveRigidBodyModes) {
  for (const int n : {10, 700}) {
    for (const int copies : {1, 6}) {
      SCOPED_TRACE(n * copies);
      const SparseMatrix mass = DiagonalMatrix(Vector::Ones(n * copies));
      const SparseMatrix stiffness = Chains(n, copies, false);
      const int count = std::min(n * copies, 4 * copies);
      const SparseModes modes = ComputeOrFail(mass, stiffness, count);
      std::vector<double> expected;
      for (int i = 0; i < count; ++i) {
        expected.push_back(FreeChainEigenvalue(n, i / copies));
      }
      ExpectEigenvalues(modes, expected, 1e-7);
      ExpectModesSolveTheProblem(mass, stiffness, modes);
      EXPECT_LT(modes.shift, 0.0);
      EXPECT_EQ(modes.num_rigid_body_modes, copies);
      ASSERT_FALSE(modes.notes.empty());
      EXPECT_THAT(modes.notes[0], HasSubstr("rigid-body"));
    }
  }
}

// Seven equal chains: Lanczos from one vector finds each eigenvalue only once,
// except for rounding.
TEST(ComputeLowestModes, MissesNoneOfAClusterThatIsCutByTheCount) {
  const int n = 150;
  const int copies = 7;
  const SparseMatrix mass = DiagonalMatrix(Vector::Ones(n * copies));
  const SparseMatrix stiffness = Chains(n, copies, true);
  for (const int count : {1, 6, 7, 8, 10, 20}) {
    SCOPED_TRACE(count);
    const SparseModes modes = ComputeOrFail(mass, stiffness, count);
    std::vector<double> expected;
    for (int i = 0; i < count; ++i) {
      expected.push_back(HeldChainEigenvalue(n, i / copies));
    }
    ExpectEigenvalues(modes, expected, 1e-9);
    ExpectModesSolveTheProblem(mass, stiffness, modes);
  }
}

// A chain that is held within is two: one held at both ends, the other at its
// first mass. 500 masses are counted by inertia, 40 go to the dense solver.
TEST(ModesFromFactors, HoldsDofsByTheFactorsOfTheWhole) {
  for (const int n : {40, 500}) {
    SCOPED_TRACE(n);
    const int at = n / 3;
    const SparseMatrix mass = DiagonalMatrix(Vector::Ones(n));
    const SparseMatrix stiffness = Chains(n, 1, true);
    std::vector<double> expected;
    for (int i = 0; i < 9; ++i) {
      const double s = std::sin((i + 1) * kPi / (2.0 * (at + 1)));
      expected.push_back(4.0 * s * s);
      expected.push_back(HeldChainEigenvalue(n - at - 1, i));
    }
    std::sort(expected.begin(), expected.end());
    expected.resize(9);
    auto factors = std::make_unique<ShiftedFactors>();
    ASSERT_TRUE(factors->FactoriseDefinite(mass, stiffness, 0.0));
    SparseModes modes;
    std::string error;
    ASSERT_TRUE(
        ModesFromFactors(mass, stiffness, {at}, 9, &factors, &modes, &error))
        << error;
    ExpectEigenvalues(modes, expected, 1e-9);
    EXPECT_EQ(modes.mode_shapes.row(at).norm(), 0.0);
    EXPECT_LT((modes.mode_shapes.transpose() * modes.mode_shapes -
               Matrix::Identity(9, 9))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-9);
    // The factors can be asked again.
    ASSERT_NE(factors, nullptr);
    ASSERT_TRUE(
        ModesFromFactors(mass, stiffness, {}, 1, &factors, &modes, &error))
        << error;
    ExpectEigenvalues(modes, {HeldChainEigenvalue(n, 0)}, 1e-9);
  }
}

TEST(ModesFromFactors, RefusesToHoldAllMasses) {
  const SparseMatrix mass = DiagonalMatrix(Vector::Unit(5, 2));
  const SparseMatrix stiffness = Chains(5, 1, true);
  auto factors = std::make_unique<ShiftedFactors>();
  ASSERT_TRUE(factors->FactoriseDefinite(mass, stiffness, 0.0));
  SparseModes modes;
  std::string error;
  EXPECT_FALSE(
      ModesFromFactors(mass, stiffness, {2}, 1, &factors, &modes, &error));
  EXPECT_THAT(error, HasSubstr("no DOF with mass is left to move"));
}

TEST(ComputeLowestModes, SquareMembraneHasPairs) {
  const int p = 40;
  Triplets triplets;
  for (int i = 0; i < p; ++i) {
    for (int j = 0; j < p; ++j) {
      const int dof = i * p + j;
      triplets.emplace_back(dof, dof, 4.0);
      for (const int other : {dof - p, dof + p}) {
        if (other >= 0 && other < p * p) {
          triplets.emplace_back(dof, other, -1.0);
        }
      }
      if (j > 0) triplets.emplace_back(dof, dof - 1, -1.0);
      if (j + 1 < p) triplets.emplace_back(dof, dof + 1, -1.0);
    }
  }
  const SparseMatrix stiffness = FromTriplets(p * p, triplets);
  const SparseMatrix mass = DiagonalMatrix(Vector::Ones(p * p));
  std::vector<double> expected;
  for (int i = 1; i <= p; ++i) {
    for (int j = 1; j <= p; ++j) {
      const double a = std::sin(i * kPi / (2.0 * (p + 1)));
      const double b = std::sin(j * kPi / (2.0 * (p + 1)));
      expected.push_back(4.0 * (a * a + b * b));
    }
  }
  std::sort(expected.begin(), expected.end());
  expected.resize(30);
  const SparseModes modes = ComputeOrFail(mass, stiffness, 30);
  ExpectEigenvalues(modes, expected, 1e-9);
  ExpectModesSolveTheProblem(mass, stiffness, modes);
}

// Every other mass of a chain is missing: two springs in series.
TEST(ComputeLowestModes, MasslessDofsAddNoModes) {
  for (const int n : {5, 400}) {
    SCOPED_TRACE(n);
    Vector masses(2 * n);
    for (int i = 0; i < 2 * n; ++i) masses[i] = i % 2 == 0 ? 0.0 : 1.0;
    const SparseMatrix mass = DiagonalMatrix(masses);
    const SparseMatrix stiffness = Chains(2 * n, 1, true);
    const int asked = std::min(10, 2 * n);
    const SparseModes modes = ComputeOrFail(mass, stiffness, asked);
    std::vector<double> expected;
    for (int i = 0; i < std::min(asked, n); ++i) {
      expected.push_back(0.5 * HeldChainEigenvalue(n, i));
    }
    ExpectEigenvalues(modes, expected, 1e-9);
    ExpectModesSolveTheProblem(mass, stiffness, modes);
    if (n == 5) {
      EXPECT_THAT(modes.notes, ElementsAre(HasSubstr("5 modes, 10 were")));
    }
  }
}

TEST(ComputeLowestModes, FreeAndMasslessTogether) {
  const int n = 401;
  Vector masses(n);
  for (int i = 0; i < n; ++i) masses[i] = i % 2 == 0 ? 1.0 : 0.0;
  const SparseMatrix mass = DiagonalMatrix(masses);
  const SparseMatrix stiffness = Chains(n, 1, false);
  const SparseModes modes = ComputeOrFail(mass, stiffness, 8);
  // 201 masses, springs of 1/2.
  std::vector<double> expected;
  for (int i = 0; i < 8; ++i) {
    expected.push_back(0.5 * FreeChainEigenvalue(201, i));
  }
  ExpectEigenvalues(modes, expected, 1e-8);
  EXPECT_EQ(modes.num_rigid_body_modes, 1);
}

TEST(ComputeLowestModes, RefusesMotionsWithoutMassAndStiffness) {
  // The massless DOFs 2 and 3 are connected only to each other.
  Triplets triplets;
  AddSpring(0, 1, 1.0, &triplets);
  AddSpring(0, -1, 1.0, &triplets);
  AddSpring(2, 3, 1.0, &triplets);
  const SparseMatrix stiffness = FromTriplets(4, triplets);
  const SparseMatrix mass =
      DiagonalMatrix((Vector(4) << 1.0, 1.0, 0.0, 0.0).finished());
  SparseModes modes;
  std::string error;
  EXPECT_FALSE(ComputeLowestModes(mass, stiffness, 2, &modes, &error));
  EXPECT_THAT(error, HasSubstr("without mass"));
  EXPECT_EQ(modes.eigenvalues.size(), 0);

  EXPECT_FALSE(
      ComputeLowestModes(SparseMatrix(4, 4), stiffness, 2, &modes, &error));
  EXPECT_THAT(error, HasSubstr("mass matrix is zero"));
}

TEST(ComputeLowestModes, NegativeStiffnessComesFirst) {
  for (const int n : {20, 500}) {
    SCOPED_TRACE(n);
    const SparseMatrix mass = DiagonalMatrix(Vector::Constant(n, 2.0));
    SparseMatrix stiffness = Chains(n, 1, true);
    for (int i = 0; i < n; ++i) stiffness.coeffRef(i, i) -= 0.02;
    const SparseModes modes = ComputeOrFail(mass, stiffness, 6);
    std::vector<double> expected;
    for (int i = 0; i < 6; ++i) {
      expected.push_back(0.5 * (HeldChainEigenvalue(n, i) - 0.02));
    }
    ExpectEigenvalues(modes, expected, 1e-8);
    EXPECT_TRUE(std::isnan(modes.frequency_hz[0]));
  }
}

// Programs write supports as a huge number on the diagonal.
TEST(ComputeLowestModes, PenaltiesDoNoHarm) {
  for (const int n : {20, 500}) {
    SCOPED_TRACE(n);
    SparseMatrix stiffness = Chains(n + 1, 1, false);
    stiffness.coeffRef(0, 0) += 1e36;
    const SparseMatrix mass = DiagonalMatrix(Vector::Ones(n + 1));
    const SparseModes modes = ComputeOrFail(mass, stiffness, 5);
    std::vector<double> expected;
    for (int i = 0; i < 5; ++i) expected.push_back(HeldChainEigenvalue(n, i));
    ExpectEigenvalues(modes, expected, 1e-9);
    EXPECT_EQ(modes.num_rigid_body_modes, 0);
  }
}

// A cantilever of Bernoulli beam elements, translations in m and rotations,
// consistent mass: against the dense solver, and against beam theory
// (1.8751^2 and so on). Its K spans 1e10.
TEST(ComputeLowestModes, SlenderBeam) {
  const int elements = 200;
  const double l = 1.0 / elements;
  Matrix k(4, 4);
  k << 12, 6 * l, -12, 6 * l, 6 * l, 4 * l * l, -6 * l, 2 * l * l, -12, -6 * l,
      12, -6 * l, 6 * l, 2 * l * l, -6 * l, 4 * l * l;
  k /= l * l * l;
  Matrix m(4, 4);
  m << 156, 22 * l, 54, -13 * l, 22 * l, 4 * l * l, 13 * l, -3 * l * l, 54,
      13 * l, 156, -22 * l, -13 * l, -3 * l * l, -22 * l, 4 * l * l;
  m *= l / 420.0;
  Triplets stiffness_entries, mass_entries;
  for (int e = 0; e < elements; ++e) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const int row = 2 * e - 2 + i;
        const int column = 2 * e - 2 + j;
        if (row < 0 || column < 0) continue;
        stiffness_entries.emplace_back(row, column, k(i, j));
        mass_entries.emplace_back(row, column, m(i, j));
      }
    }
  }
  const int n = 2 * elements;
  const SparseMatrix stiffness = FromTriplets(n, stiffness_entries);
  const SparseMatrix mass = FromTriplets(n, mass_entries);
  const SparseModes modes = ComputeOrFail(mass, stiffness, 4);
  const double roots[] = {1.8751040687119611, 4.6940911329741745,
                          7.8547574382376126, 10.995540734875467};
  for (int i = 0; i < 4; ++i) {
    const double expected = roots[i] * roots[i];
    EXPECT_NEAR(std::sqrt(modes.eigenvalues[i]) / expected, 1.0, 1e-6);
  }
  ModalProperties dense;
  std::string error;
  ASSERT_TRUE(ComputeModes(Matrix(mass), Matrix::Zero(n, n), Matrix(stiffness),
                           &dense, &error))
      << error;
  for (int i = 1; i < 4; ++i) {
    EXPECT_GT(Mac(dense.mode_shapes.col(i), modes.mode_shapes.col(i)),
              1.0 - 1e-6);
  }
}

TEST(ComputeLowestModes, AgreesWithTheDenseSolverOnEverythingAskedFor) {
  // Random symmetric positive definite pair, all modes.
  const int n = 30;
  srand(3);
  const Matrix a = Matrix::Random(n, n);
  const Matrix b = Matrix::Random(n, n);
  const Matrix stiffness = a * a.transpose() + Matrix::Identity(n, n);
  const Matrix mass = b * b.transpose() + Matrix::Identity(n, n);
  ModalProperties dense;
  std::string error;
  ASSERT_TRUE(
      ComputeModes(mass, Matrix::Zero(n, n), stiffness, &dense, &error));
  const SparseMatrix sparse_mass = mass.sparseView();
  const SparseMatrix sparse_stiffness = stiffness.sparseView();
  for (const int count : {1, 15, 29, 30}) {
    const SparseModes modes =
        ComputeOrFail(sparse_mass, sparse_stiffness, count);
    ASSERT_EQ(modes.frequency_hz.size(), count);
    for (int i = 0; i < count; ++i) {
      EXPECT_NEAR(modes.frequency_hz[i], dense.frequency_hz[i],
                  1e-10 * dense.frequency_hz[i]);
      EXPECT_GT(Mac(modes.mode_shapes.col(i), dense.mode_shapes.col(i)),
                1.0 - 1e-10);
    }
  }
}

// A chain whose springs are powers of two from 1 to 2^40 and whose masses are
// powers of two from 2^-13 to 2^13, two DOFs without mass.
void WideChain(bool held, SparseMatrix* mass, SparseMatrix* stiffness) {
  const int springs[] = {0, 40, 3, 27, 10, 33, 0, 38, 20, 1, 30, 14};
  const int masses[] = {0, 13, -7, 5, 99, -13, 2, 9, -3, 99, 11, 1};
  Triplets triplets;
  Vector diagonal(12);
  for (int i = 0; i < 12; ++i) {
    if (i > 0) AddSpring(i - 1, i, std::ldexp(1.0, springs[i]), &triplets);
    diagonal[i] = masses[i] == 99 ? 0.0 : std::ldexp(1.0, masses[i]);
  }
  if (held) AddSpring(0, -1, 1.0, &triplets);
  *mass = DiagonalMatrix(diagonal);
  *stiffness = FromTriplets(12, triplets);
}

// Frequencies over eight decades, all from one model. The eigenvalues are those
// of mpmath with 60 digits (eigsy of the statically condensed matrix).
TEST(ComputeLowestModes, FindsAllModesOfAWideSpectrum) {
  const std::vector<double> expected[] = {
      {8.365274042136099e-5, 3.855342053837848e-4, 6.328921326798046e-3,
       2.822364328585997e-1, 8.200000000952743e+3, 8.390656118232143e+6,
       8.39683096097356e+6, 1.718406451175788e+10, 6.925634766412595e+10,
       1.099645845505e+12},
      {0.0, 3.480553829407785e-4, 6.328372733644286e-3, 2.822360576014604e-1,
       8.200000000952743e+3, 8.390656118232143e+6, 8.39683096097356e+6,
       1.718406451175788e+10, 6.925634766412595e+10, 1.099645845504e+12}};
  for (const bool held : {true, false}) {
    SparseMatrix mass, stiffness;
    WideChain(held, &mass, &stiffness);
    for (const int count : {1, 4, 12}) {
      SCOPED_TRACE(count);
      const SparseModes modes = ComputeOrFail(mass, stiffness, count);
      std::vector<double> lowest = expected[held ? 0 : 1];
      lowest.resize(std::min<size_t>(10, static_cast<size_t>(count)));
      ExpectEigenvalues(modes, lowest, 1e-11);
      EXPECT_EQ(modes.num_rigid_body_modes, held ? 0 : 1);
      const Matrix gram =
          modes.mode_shapes.transpose() * (mass * modes.mode_shapes);
      EXPECT_LT((gram - Matrix::Identity(gram.rows(), gram.cols()))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-9);
    }
  }
}

// Two masses of a held pair differ by 1e-12 of the link's stiffness, which the
// factors of 16 digits had wrong by 1e-5. The closed form is that of two DOFs.
TEST(ComputeLowestModes, SoftSpringBesideAStiffLink) {
  const double link = std::ldexp(1.0, 38);
  Triplets triplets;
  AddSpring(0, -1, 1.0, &triplets);
  AddSpring(0, 1, link, &triplets);
  const SparseModes modes = ComputeOrFail(DiagonalMatrix(Vector::Ones(2)),
                                          FromTriplets(2, triplets), 2);
  const double sum = 1.0 + 2.0 * link;
  const double high = 0.5 * (sum + std::sqrt(sum * sum - 4.0 * link));
  ExpectEigenvalues(modes, {link / high, high}, 1e-14);
  EXPECT_EQ(modes.num_rigid_body_modes, 0);
}

// A model that nothing holds, with a mode that is softer than the digits of a
// file: it is not called a rigid body without a word.
TEST(ComputeLowestModes, NotesASoftModeThatMayBeRounding) {
  const double link = std::ldexp(1.0, 42);
  Triplets triplets;
  AddSpring(0, 1, link, &triplets);
  AddSpring(1, 2, 1.0, &triplets);
  AddSpring(2, 3, link, &triplets);
  const SparseModes modes = ComputeOrFail(DiagonalMatrix(Vector::Ones(4)),
                                          FromTriplets(4, triplets), 4);
  EXPECT_EQ(modes.num_rigid_body_modes, 2);
  EXPECT_THAT(modes.notes, Contains(HasSubstr("1 of the modes at 0 Hz")));
}

TEST(ComputeLowestModes, RefusesAQuarterOfAllModesOfALargeModel) {
  const int n = 4100;
  SparseModes modes;
  std::string error;
  EXPECT_FALSE(ComputeLowestModes(DiagonalMatrix(Vector::Ones(n)),
                                  Chains(n, 1, true), 1100, &modes, &error));
  EXPECT_THAT(error, HasSubstr("at most a quarter"));
}

TEST(CheckExpectedFrequencies, SkipsRigidBodyModesAndNamesTheFirstThatDiffers) {
  const int n = 30;
  const SparseModes modes =
      ComputeOrFail(DiagonalMatrix(Vector::Ones(n)), Chains(n, 1, false), 4);
  std::vector<double> expected;
  for (int i = 1; i < 4; ++i) {
    expected.push_back(std::sqrt(FreeChainEigenvalue(n, i)) / (2.0 * kPi));
  }
  std::string error;
  EXPECT_TRUE(CheckExpectedFrequencies(modes, expected, 1e-6, &error)) << error;
  expected[1] *= 1.002;
  EXPECT_TRUE(CheckExpectedFrequencies(modes, expected, 0.01, &error)) << error;
  EXPECT_FALSE(CheckExpectedFrequencies(modes, expected, 1e-3, &error));
  EXPECT_THAT(error, HasSubstr("mode 2"));
  expected.push_back(1.0);
  EXPECT_FALSE(CheckExpectedFrequencies(modes, expected, 0.01, &error));
  EXPECT_THAT(error, HasSubstr("3 modes above 0 Hz"));
}

}  // namespace
}  // namespace pinode
