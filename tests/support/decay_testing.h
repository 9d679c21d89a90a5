// Free decays of chains for the tests of damage.

#ifndef TESTS_SUPPORT_DECAY_TESTING_H_
#define TESTS_SUPPORT_DECAY_TESTING_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/problem/identification_problem.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {

// Returns a chain of `n` masses of 1 on springs of 40, held at its first
// spring, with damping of 1/160 of the stiffness. Free groups are the springs
// ("k" of one mass, "k1", "k2" and so on of several), "c", and with
// `mass_sigma` above zero "m", all masses with this prior deviation.
inline std::shared_ptr<StructuralDynamics> DecayingChain(
    int n, double mass_sigma = 0.0) {
  StructuralModel model;
  model.mass = Matrix::Identity(n, n);
  model.stiffness = Matrix::Zero(n, n);
  model.influence = Matrix::Zero(n, 0);
  model.support_mass_coupling = Matrix::Zero(n, 0);
  std::vector<Matrix> springs;
  for (int i = 0; i < n; ++i) {
    Vector ends = Vector::Unit(n, i);
    if (i > 0) ends[i - 1] = -1.0;
    springs.push_back(40.0 * ends * ends.transpose());
    model.stiffness += springs.back();
    model.dof_names.push_back(n == 1 ? "w" : "w" + std::to_string(i + 1));
  }
  model.damping = model.stiffness / 160.0;
  std::string error;
  const std::shared_ptr<StructuralDynamics> dynamics =
      StructuralDynamics::Create(model, {}, &error);
  if (dynamics == nullptr) {
    ADD_FAILURE() << error;
    return dynamics;
  }
  const auto add = [&](const std::string& name, MatrixGroup::Target target,
                       const Matrix& matrix) {
    GroupTerm term;
    term.group.name = name;
    term.group.target = target;
    term.group.matrix = matrix;
    term.alpha.name = name;
    term.alpha.free = true;
    if (target == MatrixGroup::Target::kMass) {
      term.alpha.prior_sigma = mass_sigma;
    }
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  };
  for (int i = 0; i < n; ++i) {
    add(n == 1 ? "k" : "k" + std::to_string(i + 1),
        MatrixGroup::Target::kStiffness, springs[static_cast<size_t>(i)]);
  }
  add("c", MatrixGroup::Target::kDamping, model.damping);
  if (mass_sigma > 0.0) add("m", MatrixGroup::Target::kMass, model.mass);
  return dynamics;
}

// Returns the fit of a decay whose springs and damping have these factors, over
// that of the masses; 1 % noise.
inline TestFit FitOfDecay(const Vector& springs, double damping, unsigned seed,
                          double mass_sigma = 0.0) {
  const int n = static_cast<int>(springs.size());
  IdentificationProblem problem;
  problem.dynamics = DecayingChain(n, mass_sigma);
  if (problem.dynamics == nullptr) return {};
  IdentificationRecord record;
  record.name = "decay";
  record.excitation.emplace(0.0, 0.02, Matrix(0, 400), Interpolation::kLinear);
  Vector start = Vector::Zero(2 * n);
  for (int i = 0; i < n; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "a" + std::to_string(i + 1), Quantity::kRelativeAcceleration, n, i));
    start[i] = i + 1 == n ? 0.01 : 0.001;
  }
  record.substeps = 8;
  auto truth = std::make_shared<StructuralDynamics>(*problem.dynamics);
  Vector values = truth->Parameters();
  values.head(n) = springs.array() - 1.0;
  values[n] = damping - 1.0;
  truth->SetParameters(values);
  testing::Simulate(*truth, truth->Parameters(), start, 0.01, seed, &record);
  record.substeps = 0;
  record.start = IdentificationRecord::Start::kFree;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return FitOf(std::move(problem));
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_DECAY_TESTING_H_
