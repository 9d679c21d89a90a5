#include "pinode/study/explanations/shape_suspects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ShapeChange = Suspect::ShapeChange;

const Vector& Alpha() {
  static const Vector alpha{{-0.1, 0.05, 0.12, -0.08, 0.1}};
  return alpha;
}

// Four modes at all DOFs of five floors whose stiffness is free, with 0.1 %
// noise in frequencies and 0.01 in shapes.
IdentificationProblem ModesOfFloors(unsigned seed) {
  IdentificationProblem problem;
  const auto chain = testing::MakeGroupedChain(5, 100.0, 0.5);
  problem.dynamics = chain;
  const StructuralModel truth = chain->CorrectedModel(Alpha());
  UndampedModes modes;
  std::string error;
  EXPECT_TRUE(ComputeUndampedModes(truth.mass, truth.stiffness, &modes, &error))
      << error;
  testing::Gaussian noise(seed);
  for (int j = 0; j < 4; ++j) {
    MeasuredMode mode;
    mode.name = std::to_string(j + 1);
    const double hz = std::sqrt(modes.eigenvalues[j]) / kTwoPi;
    mode.frequency = hz * (1.0 + 1e-3 * noise.Next());
    mode.frequency_sigma = 1e-3 * hz;
    mode.dofs = {0, 1, 2, 3, 4};
    mode.shape =
        modes.shapes.col(j) / modes.shapes.col(j).cwiseAbs().maxCoeff();
    for (double& entry : mode.shape) entry += 0.01 * noise.Next();
    mode.shape_sigma = 0.01;
    problem.modal.modes.push_back(std::move(mode));
  }
  return problem;
}

// Identifies `problem` and returns its summary. Checks that the first
// explanation is of this kind and place, has these log odds at least, and finds
// the true stiffness.
IdentificationSummary ExpectNamed(const IdentificationProblem& problem,
                                  const std::string& kind,
                                  const std::string& place,
                                  double least_log_odds = 20.0) {
  IdentificationSummary summary =
      Identify(problem, IdentificationOptions(), {}, nullptr).summary;
  EXPECT_FALSE(summary.explanations.empty()) << kind << " " << place;
  // A place for those who read it.
  if (summary.explanations.empty()) summary.explanations.resize(1);
  const Explanation& first = summary.explanations[0];
  EXPECT_EQ(first.kind, kind) << first.what;
  EXPECT_EQ(first.place, place) << first.what;
  EXPECT_GT(first.log_odds, least_log_odds) << first.what;
  EXPECT_EQ(first.values.size(), 5u);
  for (size_t j = 0; j < first.values.size(); ++j) {
    const double truth = Alpha()[static_cast<Eigen::Index>(j)];
    const ExplainedValue& value = first.values[j];
    EXPECT_NEAR(value.value, truth, value.upper95 - value.lower95) << place;
  }
  return summary;
}

TEST(ShapeSuspects, NameTheTurnedSensor) {
  for (const int dof : {0, 3}) {
    IdentificationProblem problem = ModesOfFloors(1);
    for (MeasuredMode& mode : problem.modal.modes) mode.shape[dof] *= -1.0;
    const IdentificationSummary summary =
        ExpectNamed(problem, "sensor_gain", "u" + std::to_string(dof + 1));
    EXPECT_NE(summary.verdict.grade(), Grade::kGood);
  }
}

TEST(ShapeSuspects, NameTheSwappedSensors) {
  for (const int dof : {0, 2}) {
    IdentificationProblem problem = ModesOfFloors(1);
    for (MeasuredMode& mode : problem.modal.modes) {
      std::swap(mode.shape[dof], mode.shape[3]);
    }
    const IdentificationSummary summary = ExpectNamed(
        problem, "sensors_exchanged", "u" + std::to_string(dof + 1) + ",u4");
    EXPECT_NE(summary.verdict.grade(), Grade::kGood);
  }
}

TEST(ShapeSuspects, NameTheSwappedShapes) {
  IdentificationProblem problem = ModesOfFloors(4);
  std::swap(problem.modal.modes[1].shape, problem.modal.modes[2].shape);
  EXPECT_NE(ExpectNamed(problem, "mode", "2,3").verdict.grade(), Grade::kGood);
}

TEST(ShapeSuspects, NameTheWrongSignOfOneEntry) {
  IdentificationProblem problem = ModesOfFloors(5);
  problem.modal.modes[2].shape[4] *= -1.0;
  // The mode has no partner, and the others are right without it.
  ExpectNamed(problem, "mode", "3", /*least_log_odds=*/3.0);
}

TEST(ShapeSuspects, NameTheGain) {
  for (const double gain : {0.7, 1.25}) {
    IdentificationProblem problem = ModesOfFloors(6);
    for (MeasuredMode& mode : problem.modal.modes) mode.shape[2] *= gain;
    const IdentificationSummary summary =
        ExpectNamed(problem, "sensor_gain", "u3");
    EXPECT_NE(summary.verdict.grade(), Grade::kGood);
    EXPECT_THAT(summary.explanations[0].what, HasSubstr("the gain of"));
  }
}

// Five places and four modes: 5 turns, 20 signs, 10 pairs, 6 pairs of modes.
TEST(ShapeSuspects, KnowHowManyWereCompared) {
  IdentificationProblem problem = ModesOfFloors(8);
  for (MeasuredMode& mode : problem.modal.modes) mode.shape[1] *= -1.0;
  IdentifiedModel model;
  model.parameters = Alpha();
  const std::vector<Suspect> suspects = MakeShapeSuspects(problem, model, 2);
  ASSERT_FALSE(suspects.empty());
  EXPECT_EQ(suspects[0].what, "the sensor at 'u2' mounted upside down");
  for (const Suspect& suspect : suspects) {
    const ShapeChange& change = suspect.shape_changes[0];
    const size_t expected = change.kind == ShapeChange::Kind::kExchangeDofs ? 10
                            : change.kind == ShapeChange::Kind::kExchangeModes
                                ? 6
                            : change.mode < 0 ? 5
                                              : 20;
    EXPECT_EQ(suspect.num_compared, expected) << suspect.what;
  }
}

// A gain by regression on the true modes: 1.25 to the noise of the entries.
TEST(ShapeSuspects, GainIsThatOfTheEntries) {
  IdentificationProblem problem = ModesOfFloors(7);
  EXPECT_FALSE(MakeGainOfShapes(problem, Alpha(), 1).has_value());
  for (MeasuredMode& mode : problem.modal.modes) mode.shape[1] *= 1.25;
  const auto gain = MakeGainOfShapes(problem, Alpha(), 1);
  ASSERT_TRUE(gain.has_value());
  EXPECT_NEAR(1.0 / gain->shape_changes[0].factor, 1.25, 0.03);
}

TEST(ShapeSuspects, ChangesCarryTheCovariances) {
  ModalData data;
  data.modes.resize(1);
  MeasuredMode& mode = data.modes[0];
  mode.dofs = {0, 2, 5};
  mode.shape = Vector{{1.0, 2.0, 3.0}};
  mode.shape_covariance = Matrix{{4, 1, 2}, {1, 5, 3}, {2, 3, 6}};
  mode.frequency_shape_covariance = Vector{{0.1, 0.2, 0.3}};
  ShapeChange scale;
  scale.one = 2;
  scale.factor = -2.0;
  ChangeShapes({scale}, &data);
  EXPECT_EQ(mode.shape, Vector({{1.0, -4.0, 3.0}}));
  EXPECT_EQ(mode.shape_covariance,
            Matrix({{4, -2, 2}, {-2, 20, -6}, {2, -6, 6}}));
  EXPECT_EQ(mode.frequency_shape_covariance, Vector({{0.1, -0.4, 0.3}}));
  ShapeChange swap;
  swap.kind = ShapeChange::Kind::kExchangeDofs;
  swap.one = 0;
  swap.two = 3;
  ChangeShapes({swap}, &data);
  EXPECT_EQ(mode.dofs, std::vector<int>({3, 2, 5}));
  LeaveOutPlace(2, &data);
  EXPECT_EQ(mode.dofs, std::vector<int>({3, 5}));
  EXPECT_EQ(mode.shape_covariance, Matrix({{4, 2}, {2, 6}}));
  // Two entries are the least that a shape has.
  LeaveOutPlace(3, &data);
  EXPECT_EQ(mode.dofs.size(), 2u);
}

// The standard deviation of a scaled entry is scaled, the others' are not.
TEST(ShapeSuspects, AScaledEntryHasItsOwnDeviation) {
  ModalData data;
  data.modes.resize(1);
  MeasuredMode& mode = data.modes[0];
  mode.dofs = {0, 2, 5};
  mode.shape = Vector{{1.0, 2.0, 3.0}};
  mode.shape_sigma = 0.1;
  ShapeChange scale;
  scale.one = 2;
  scale.factor = -1.0;
  ChangeShapes({scale}, &data);
  EXPECT_EQ(mode.shape_sigma, 0.1);
  EXPECT_EQ(mode.shape_covariance.size(), 0);
  scale.factor = 2.0;
  ChangeShapes({scale}, &data);
  EXPECT_EQ(mode.shape_sigma, 0.0);
  const Matrix expected = Vector{{0.01, 0.04, 0.01}}.asDiagonal();
  EXPECT_TRUE(mode.shape_covariance.isApprox(expected, 1e-12));
}

}  // namespace
}  // namespace pinode
