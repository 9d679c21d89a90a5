// Fits to frequency responses of the chain of six masses: what they determine,
// and what they refuse.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/estimate/fit/fit_once.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/verdict.h"
#include "pinode/structure/model/structural_model.h"
#include "tests/support/group_testing.h"

namespace pinode {
namespace {

constexpr int kMasses = 6;
constexpr double kRatio = 0.02;

// The chain of unit masses with these frequencies in Hz: a tridiagonal
// stiffness matrix by the method of Lanczos, from equal parts of all modes.
Matrix ChainStiffness() {
  const double hz[] = {1.9293, 5.6169, 8.6806, 14.4909, 15.8430, 17.0080};
  Vector squares(kMasses);
  for (int i = 0; i < kMasses; ++i) squares[i] = std::pow(kTwoPi * hz[i], 2);
  Matrix basis = Matrix::Zero(kMasses, kMasses);
  basis.col(0).setConstant(1.0 / std::sqrt(kMasses));
  for (int i = 1; i < kMasses; ++i) {
    Vector next = squares.cwiseProduct(basis.col(i - 1));
    for (int pass = 0; pass < 2; ++pass) {
      next -= basis.leftCols(i) * (basis.leftCols(i).transpose() * next);
    }
    // Springs between masses make the other entries negative.
    basis.col(i) = -next.normalized();
  }
  return basis.transpose() * squares.asDiagonal() * basis;
}

StructuralModel ChainModel() {
  StructuralModel model;
  for (int i = 1; i <= kMasses; ++i) {
    model.dof_names.push_back("u" + std::to_string(i));
  }
  model.mass = Matrix::Identity(kMasses, kMasses);
  model.stiffness = ChainStiffness();
  const Eigen::SelfAdjointEigenSolver<Matrix> modes(model.stiffness);
  model.damping =
      modes.eigenvectors() *
      (2.0 * kRatio * modes.eigenvalues().cwiseSqrt()).asDiagonal() *
      modes.eigenvectors().transpose();
  model.influence = Matrix::Zero(kMasses, 0);
  model.support_mass_coupling = Matrix::Zero(kMasses, 0);
  return model;
}

// The chain with a factor of each coupling spring, and of all damping. Truth:
// k2 has lost a fifth, and the damping has grown by a tenth.
struct ChainFrfs {
  explicit ChainFrfs(int seed, double noise = 0.01, int heavier = -1,
                     double by = 0.0) {
    const StructuralModel model = ChainModel();
    StructuralModel truth = model;
    auto dynamics =
        std::make_shared<StructuralDynamics>(model, std::vector<InputSpec>{});
    std::string error;
    const auto add = [&](const std::string& name, MatrixGroup::Target target,
                         const Matrix& matrix) {
      GroupTerm term = testing::MakeGroupTerm(name, target, matrix);
      term.alpha.lower = -0.9;
      EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
    };
    for (int i = 0; i + 1 < kMasses; ++i) {
      const Matrix spring =
          -model.stiffness(i, i + 1) * SpringMatrix(kMasses, i, i + 1);
      add("k" + std::to_string(i + 1), MatrixGroup::Target::kStiffness, spring);
      if (i == 1) truth.stiffness -= 0.2 * spring;
    }
    add("c", MatrixGroup::Target::kDamping, model.damping);
    truth.damping *= 1.1;
    if (heavier >= 0) truth.mass(heavier, heavier) += by;
    problem.dynamics = dynamics;

    FrfRecord record;
    record.name = "hammer";
    record.frequencies = Vector::LinSpaced(391, 0.5, 20.0);
    for (int o = 0; o < kMasses; ++o) {
      Observation response;
      response.name = model.dof_names[static_cast<size_t>(o)];
      response.quantity = Quantity::kRelativeAcceleration;
      response.weights = Vector::Unit(kMasses, o);
      record.responses.push_back(std::move(response));
    }
    record.references = Matrix::Identity(kMasses, 1);
    record.reference_names = {"u1"};
    record.values.resize(record.num_lines(), kMasses);
    for (Eigen::Index k = 0; k < record.num_lines(); ++k) {
      const double w = kTwoPi * record.frequencies[k];
      ComplexMatrix z(kMasses, kMasses);
      z.real() = truth.stiffness - w * w * truth.mass;
      z.imag() = w * truth.damping;
      record.values.row(k) =
          (-w * w *
           z.partialPivLu().solve(
               Vector::Unit(kMasses, 0).cast<std::complex<double>>().eval()))
              .transpose();
    }
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    std::normal_distribution<double> normal;
    for (Eigen::Index o = 0; o < kMasses; ++o) {
      const double rms = record.values.col(o).norm() /
                         std::sqrt(static_cast<double>(record.num_lines()));
      for (std::complex<double>& value : record.values.col(o)) {
        value += noise * rms / std::sqrt(2.0) *
                 std::complex<double>(normal(random), normal(random));
      }
    }
    problem.frfs.push_back(std::move(record));
  }

  void Fit() {
    IdentificationOptions options;
    options.num_threads = 1;
    FitOnce(problem, options, nullptr, &fit, &fitted);
    findings = CheckFit(options.tuning.gaps, fit);
    for (Finding& finding : CheckDoubts(fit)) {
      findings.push_back(std::move(finding));
    }
  }

  static double Truth(const std::string& name) {
    return name == "k2" ? -0.2 : name == "c" ? 0.1 : 0.0;
  }

  IdentificationProblem problem;
  FitSummary fit;
  IdentifiedModel fitted;
  std::vector<Finding> findings;
};

TEST(FrfFitTest, IntervalsCoverTheTruth) {
  int covered = 0;
  int count = 0;
  for (int seed = 1; seed <= 8; ++seed) {
    ChainFrfs chain(seed);
    chain.Fit();
    EXPECT_TRUE(chain.findings.empty()) << chain.findings.front().Sentence();
    ASSERT_EQ(chain.fit.termination, Termination::kConverged)
        << chain.fit.message;
    for (const ParameterEstimate& estimate : chain.fit.parameters) {
      const double truth = ChainFrfs::Truth(estimate.name);
      covered += estimate.lower95 <= truth && truth <= estimate.upper95;
      ++count;
      EXPECT_NEAR(estimate.value, truth, 0.01) << estimate.name;
      EXPECT_LT(estimate.sigma, 0.005) << estimate.name;
    }
  }
  // 48 intervals of 95 %: 41 or fewer have a probability of 0.3 %.
  EXPECT_EQ(count, 48);
  EXPECT_GE(covered, 42);
}

TEST(FrfFitTest, UnknownNoiseIsFound) {
  ChainFrfs chain(3);
  chain.Fit();
  const FrfScore& score = chain.fit.frfs.at(0);
  const FrfRecord& record = chain.problem.frfs[0];
  for (Eigen::Index p = 0; p < kMasses; ++p) {
    const double rms =
        record.values.col(p).norm() / std::sqrt(391.0) / std::sqrt(2.0);
    EXPECT_NEAR(score.sigma[p] / rms, 0.01, 0.001);
    EXPECT_NEAR(score.errors[p], 0.01, 0.001);
  }
  EXPECT_GT(score.probability, 1e-4);
}

// With a mass that is not free, no set of the springs is right.
TEST(FrfFitTest, WrongMassIsNotGood) {
  for (int dof = 0; dof < kMasses; ++dof) {
    ChainFrfs chain(1, 0.01, dof, 0.3);
    chain.Fit();
    EXPECT_FALSE(Verdict(chain.findings).usable()) << "u" << dof + 1;
  }
}

// The same data as receptance, with the variances that go with it.
TEST(FrfFitTest, QuantitiesGiveTheSame) {
  ChainFrfs chain(5);
  chain.Fit();
  for (const Quantity quantity :
       {Quantity::kDisplacement, Quantity::kVelocity}) {
    ChainFrfs other(5);
    FrfRecord& record = other.problem.frfs[0];
    record.variances.resize(record.num_lines(), kMasses);
    for (Eigen::Index k = 0; k < record.num_lines(); ++k) {
      const std::complex<double> iw(0.0, kTwoPi * record.frequencies[k]);
      const std::complex<double> factor =
          quantity == Quantity::kVelocity ? 1.0 / iw : 1.0 / (iw * iw);
      record.values.row(k) *= factor;
      record.variances.row(k).setConstant(std::norm(factor));
    }
    for (Observation& response : record.responses) {
      response.quantity = quantity;
    }
    other.Fit();
    for (size_t i = 0; i < chain.fit.parameters.size(); ++i) {
      const ParameterEstimate& a = chain.fit.parameters[i];
      const ParameterEstimate& b = other.fit.parameters[i];
      EXPECT_NEAR(a.value, b.value, 0.02 * a.sigma) << a.name;
      EXPECT_NEAR(a.sigma, b.sigma, 0.02 * a.sigma) << a.name;
    }
  }
}

// Half of the lines have thirty times the noise. Variances from the coherence
// say so: the intervals hold the truth and are those of the other half.
TEST(FrfFitTest, CoherenceWeightsTheLines) {
  constexpr double kLoud = 30.0;
  ChainFrfs even(4);
  ChainFrfs weighted(4);
  FrfRecord& record = weighted.problem.frfs[0];
  const ChainFrfs clean(4, 0.0);
  record.variances = Matrix::Ones(record.num_lines(), kMasses);
  for (Eigen::Index k = 0; k < record.num_lines(); k += 2) {
    const auto exact = clean.problem.frfs[0].values.row(k);
    record.values.row(k) = exact + kLoud * (record.values.row(k) - exact);
    record.variances.row(k).setConstant(kLoud * kLoud);
  }
  ChainFrfs unweighted = weighted;
  unweighted.problem.frfs[0].variances.resize(0, 0);
  even.Fit();
  weighted.Fit();
  unweighted.Fit();
  for (size_t i = 0; i < even.fit.parameters.size(); ++i) {
    const ParameterEstimate& estimate = weighted.fit.parameters[i];
    const double truth = ChainFrfs::Truth(estimate.name);
    EXPECT_NEAR(estimate.value, truth, 3.5 * estimate.sigma) << estimate.name;
    // Half of the lines: sqrt(2) times the deviation.
    EXPECT_NEAR(estimate.sigma / even.fit.parameters[i].sigma, std::sqrt(2.0),
                0.3)
        << estimate.name;
    EXPECT_GT(unweighted.fit.parameters[i].sigma, 5.0 * estimate.sigma)
        << estimate.name;
  }
}

TEST(FrfFitTest, TermsForRecordsAreRefused) {
  ChainFrfs chain(1);
  auto dynamics = std::make_shared<StructuralDynamics>(*chain.problem.dynamics);
  std::string error;
  ASSERT_TRUE(dynamics->AddElement("stop", "cubic", 0, 1, {10.0}, &error))
      << error;
  chain.problem.dynamics = dynamics;
  EXPECT_FALSE(chain.problem.IsValid(&error));
  EXPECT_NE(error.find("an element, a library or a network with memory"),
            std::string::npos)
      << error;
}

}  // namespace
}  // namespace pinode
