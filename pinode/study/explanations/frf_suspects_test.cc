#include "pinode/study/explanations/frf_suspects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/estimate/frf/frf_transfer.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/structural_model.h"
#include "tests/support/group_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Four masses with a group for each spring, hit at two of them, without noise.
IdentificationProblem HammerTest() {
  const Vector springs =
      (Vector(4) << 4000.0, 3000.0, 2500.0, 2000.0).finished();
  Matrix stiffness = Matrix::Zero(4, 4);
  for (int i = 0; i < 4; ++i) {
    stiffness += springs[i] * SpringMatrix(4, i - 1, i);
  }
  const Matrix damping = 0.2 * Matrix::Identity(4, 4) + 4e-4 * stiffness;
  const StructuralModel model = MakeStructuralModel(
      Matrix::Identity(4, 4), damping, stiffness, {"u1", "u2", "u3", "u4"});
  auto dynamics =
      std::make_shared<StructuralDynamics>(model, std::vector<InputSpec>{});
  std::string error;
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(dynamics->AddGroup(
        testing::MakeGroupTerm("k" + std::to_string(i + 1),
                               MatrixGroup::Target::kStiffness,
                               springs[i] * SpringMatrix(4, i - 1, i)),
        &error))
        << error;
  }
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  FrfRecord record;
  record.name = "hammer";
  record.frequencies = Vector::LinSpaced(200, 1.0, 25.0);
  for (int o = 0; o < 4; ++o) {
    Observation response;
    response.name = model.dof_names[static_cast<size_t>(o)];
    response.quantity = Quantity::kRelativeAcceleration;
    response.weights = Vector::Unit(4, o);
    record.responses.push_back(response);
  }
  record.references = Matrix::Identity(4, 2);
  record.reference_names = {"u1", "u2"};
  record.values.resize(200, 8);
  for (Eigen::Index k = 0; k < 200; ++k) {
    const double w = kTwoPi * record.frequencies[k];
    ComplexMatrix z(4, 4);
    z.real() = stiffness - w * w * model.mass;
    z.imag() = w * damping;
    const ComplexMatrix motion =
        z.partialPivLu().solve(record.references.cast<std::complex<double>>());
    record.values.row(k) = (-w * w * motion).reshaped().transpose();
  }
  problem.frfs = {record};
  return problem;
}

std::vector<Suspect> Find(const IdentificationProblem& problem) {
  IdentifiedModel model;
  model.parameters = ParameterLayout(problem).InitialValues();
  return MakeFrfSuspects(problem, model, 1);
}

// Places of the discrete suspects.
std::vector<std::string> PlacesOf(const std::vector<Suspect>& suspects) {
  std::vector<std::string> places;
  for (const Suspect& suspect : suspects) {
    if (suspect.IsDiscrete()) places.push_back(suspect.what);
  }
  return places;
}

TEST(FrfSuspects, OfGoodPlacesAreGainsAndClocksAlone) {
  const IdentificationProblem problem = HammerTest();
  const std::vector<Suspect> found = Find(problem);
  EXPECT_THAT(PlacesOf(found), IsEmpty());
  // Gain and clock of all sensors together, and of each.
  EXPECT_EQ(found.size(), 10u);
  for (const Suspect& suspect : found) {
    IdentificationProblem changed = problem;
    std::string error;
    ASSERT_TRUE(AddSuspects({suspect}, &changed, &error)) << error;
    const bool late = suspect.kind == Suspect::Kind::kSensorDelay ||
                      suspect.kind == Suspect::Kind::kExcitationDelay;
    const FrfRecord& record = changed.frfs[0];
    const std::vector<int>& unknowns = late ? record.delays : record.gains;
    EXPECT_TRUE((late ? record.gains : record.delays).empty());
    EXPECT_EQ(std::count(unknowns.begin(), unknowns.end(), 0),
              suspect.place.empty() ? 4 : 1);
    EXPECT_FALSE(AddSuspects({suspect}, &changed, &error));
  }
}

// A sensor that is late by tau has exp(-i w tau) times its functions. With its
// clock at tau the model has them too.
TEST(FrfSuspects, ALateSensorIsDescribedByItsClock) {
  constexpr double kLate = 0.004;
  IdentificationProblem problem = HammerTest();
  FrfRecord& measured = problem.frfs[0];
  for (Eigen::Index k = 0; k < measured.num_lines(); ++k) {
    const double angle = -kTwoPi * measured.frequencies[k] * kLate;
    for (const Eigen::Index pair : {2, 6}) {
      measured.values(k, pair) *= std::polar(1.0, angle);
    }
  }
  const std::vector<Suspect> found = Find(problem);
  const auto named =
      std::find_if(found.begin(), found.end(), [](const Suspect& suspect) {
        return suspect.what == "the clock of sensor 'u3'";
      });
  ASSERT_NE(named, found.end());
  EXPECT_EQ(named->place, "u3");
  std::string error;
  ASSERT_TRUE(AddSuspects({*named}, &problem, &error)) << error;
  Parameter& delay = problem.sensors.parameters.back();
  EXPECT_LT(kLate, delay.upper);
  delay.value = kLate;
  const ParameterLayout layout(problem);
  FrfTransfer transfer(problem.frfs[0], *problem.dynamics, layout);
  ASSERT_TRUE(transfer.SetPoint(layout.Free(layout.InitialValues()), &error))
      << error;
  const FrfRecord& record = problem.frfs[0];
  FrfTransfer::Line line;
  for (Eigen::Index k = 0; k < record.num_lines(); ++k) {
    transfer.Compute(k, /*with_slopes=*/false, &line);
    EXPECT_LT((line.values - record.values.row(k).transpose()).norm(),
              1e-9 * record.values.row(k).norm());
  }
}

// Each fault is named first, and its suspect takes it back.
TEST(FrfSuspects, FaultsOfPlacesAreNamedAndTakenBack) {
  const IdentificationProblem good = HammerTest();
  const struct {
    std::vector<Suspect::FrfChange> fault;
    const char* what;
  } faults[] = {
      {{{0, false, 2, 2}}, "sensor 'u3' mounted upside down"},
      {{{0, false, 1, 3}}, "sensors 'u2' and 'u4' swapped"},
      {{{0, true, 1, 1}}, "the force at 'u2' in the other direction"},
      {{{0, true, 0, 1}}, "the places of the forces 'u1' and 'u2' swapped"},
  };
  for (const auto& fault : faults) {
    IdentificationProblem problem = good;
    problem.frfs[0].variances = Matrix::Ones(200, 8);
    problem.frfs[0].variances.col(3).setConstant(2.0);
    const IdentificationProblem before = problem;
    ChangeFrfs(fault.fault, &problem);
    EXPECT_NE(problem.frfs[0].values, good.frfs[0].values);
    const std::vector<Suspect> found = Find(problem);
    const auto named = std::find_if(
        found.begin(), found.end(),
        [&](const Suspect& suspect) { return suspect.what == fault.what; });
    ASSERT_NE(named, found.end()) << fault.what;
    std::string error;
    ASSERT_TRUE(AddSuspects({*named}, &problem, &error)) << error;
    EXPECT_EQ(problem.frfs[0].values, good.frfs[0].values) << fault.what;
    EXPECT_EQ(problem.frfs[0].variances, before.frfs[0].variances);
  }
}

// Two swapped sensors have only the first mode, of a model that is a little
// off. Lines that they lack must not count for other sensors.
TEST(FrfSuspects, MissingLinesHideNoFault) {
  IdentificationProblem problem = HammerTest();
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  dynamics->SetParameters(Eigen::Vector4d(0.0, 0.0, 0.0, -0.2));
  problem.dynamics = dynamics;
  ChangeFrfs({{0, false, 1, 2}}, &problem);
  FrfRecord& record = problem.frfs[0];
  for (Eigen::Index k = 0; k < record.num_lines(); ++k) {
    if (record.frequencies[k] < 7.0) continue;
    for (const Eigen::Index pair : {1, 2, 5, 6}) record.values(k, pair) = kNaN;
  }
  EXPECT_THAT(PlacesOf(Find(problem)),
              ElementsAre("sensors 'u2' and 'u3' swapped"));
}

TEST(FrfSuspects, TurnsAreFoundAmongManySensors) {
  IdentificationProblem problem = HammerTest();
  FrfRecord& record = problem.frfs[0];
  constexpr Eigen::Index kSensors = 600;
  const FrfRecord few = record;
  record.responses.clear();
  record.values.resize(few.num_lines(), 2 * kSensors);
  for (Eigen::Index o = 0; o < kSensors; ++o) {
    record.responses.push_back(few.responses[static_cast<size_t>(o % 4)]);
    record.responses.back().name = "s" + std::to_string(o);
    for (Eigen::Index j = 0; j < 2; ++j) {
      record.values.col(o + kSensors * j) = few.values.col(o % 4 + 4 * j);
    }
  }
  ChangeFrfs({{0, false, 577, 577}}, &problem);
  EXPECT_THAT(PlacesOf(Find(problem)),
              ElementsAre("sensor 's577' mounted upside down"));
}

TEST(FrfSuspects, OfFreeGainsAreClocksAlone) {
  IdentificationProblem problem = HammerTest();
  Parameter gain;
  gain.name = "gain.u1";
  gain.value = 1.0;
  problem.sensors.parameters.push_back(gain);
  problem.frfs[0].gains = {0, -1, -1, -1};
  for (const Suspect& suspect : Find(problem)) {
    EXPECT_EQ(suspect.what.rfind("the clock of ", 0), 0u) << suspect.what;
  }
  problem.frfs[0].delays = {-1, 0, -1, -1};
  EXPECT_THAT(Find(problem), IsEmpty());
}

}  // namespace
}  // namespace pinode
