#include "pinode/estimate/shooting/shooting_record.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

// One record of a structure without inputs, where samples take no memory.
IdentificationProblem Decay(Eigen::Index samples) {
  IdentificationProblem problem;
  problem.dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(2, 40.0, 0.1), std::vector<InputSpec>());
  IdentificationRecord record;
  record.substeps = 1;
  record.excitation.emplace(0.0, 0.01, Matrix(0, samples),
                            Interpolation::kLinear);
  problem.records.push_back(record);
  return problem;
}

TEST(ShootingRecord, IsCutIntoSegmentsOfAboutTheLengthAskedFor) {
  const IdentificationProblem problem = Decay(101);
  ShootingRecord record(problem, 0, 1e-4);
  std::vector<Eigen::Index> asked;
  record.Cut(33, [&](Eigen::Index sample) {
    asked.push_back(sample);
    return Vector(Vector::Zero(4));
  });
  EXPECT_EQ(record.boundaries(), (std::vector<Eigen::Index>{0, 33, 66, 100}));
  EXPECT_EQ(asked, (std::vector<Eigen::Index>{0, 33, 66}));
}

TEST(ShootingRecord, CutsRecordsOfMoreSamplesThanAnIntCanCount) {
  const IdentificationProblem problem = Decay(5000000001);
  ShootingRecord record(problem, 0, 1e-4);
  const Matrix starts = record.Cut(1000000000, [](Eigen::Index sample) {
    return Vector(Vector::Constant(4, static_cast<double>(sample)));
  });
  EXPECT_EQ(record.num_segments(), 5);
  EXPECT_EQ(record.first_sample(4), 4000000000);
  EXPECT_EQ(record.last_sample(4), 5000000000);
  EXPECT_EQ(starts(0, 4), 4e9);
  record.Cut(0, [](Eigen::Index) { return Vector(Vector::Zero(4)); });
  EXPECT_EQ(record.boundaries(), (std::vector<Eigen::Index>{0, 5000000000}));
}

}  // namespace
}  // namespace pinode
