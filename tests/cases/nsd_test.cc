// The frame with the negative stiffness device, data/nsd, after section 4 of
// Lai et al. (2021): without the device a linear network corrects stiffness and
// damping, with the device that network is kept and the device is learned.
// Scores are taken against the noise-free response. Tests run on the synthetic
// ground motions and, where the measured records are at hand, on those.

#include <string>

#include "gtest/gtest.h"
#include "pinode/record/table.h"
#include "tests/cases/nsd_testing.h"

namespace pinode {
namespace testing {
namespace {

struct Phase1Limits {
  double stiffness;
  double damping;
};

void ExpectMatrices(const std::string& what, const Phase1Limits& limits,
                    double stiffness, double damping) {
  ExpectFigure(what + "K, worst entry in parts of the largest",
               limits.stiffness, stiffness);
  ExpectFigure(what + "C, worst entry in parts of the largest", limits.damping,
               damping);
}

TEST_P(Nsd, LinearNetworkFindsStiffnessAndDamping) {
  const CaseRun run = Run("phase1");
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  const FoldedMatrices folded = Folded(run);
  const Matrix stiffness = TrueMatrix("stiffness");
  const Matrix damping = TrueMatrix("damping");
  const std::string what = What("phase 1");
  ExpectMatrices(what + "as learned, ", {0.01, 0.04},
                 WorstEntry(folded.stiffness, stiffness),
                 WorstEntry(folded.damping, damping));
  ExpectMatrices(what + "symmetric, ", {0.01, 0.04},
                 WorstEntry(Symmetric(folded.stiffness), stiffness),
                 WorstEntry(Symmetric(folded.damping), damping));
  ExpectFigure(what + "nrmse, next 10 s, worst floor", 0.005,
               WorstContinuation(run, "phase1"));

  if (IsMeasured()) return;
  // The cases of phase 2 begin with what comes out here.
  const Case c = ReadCaseOrFail(folder_ + "/phase2_element.toml");
  const FoldedMatrices kept =
      FoldNetworks(*c.problem.dynamics, c.problem.dynamics->Parameters());
  EXPECT_LT(WorstEntry(kept.stiffness, folded.stiffness), 1e-4);
  EXPECT_LT(WorstEntry(kept.damping, folded.damping), 1e-3);
}

TEST_P(Nsd, LinearNetworkNeedsAccelerationsOnly) {
  const CaseRun run = Run("phase1_acceleration");
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  const FoldedMatrices folded = Folded(run);
  const Matrix stiffness = TrueMatrix("stiffness");
  const Matrix damping = TrueMatrix("damping");
  const std::string what = What("phase 1, accelerations");
  ExpectMatrices(what + "as learned, ", {0.004, 0.012},
                 WorstEntry(folded.stiffness, stiffness),
                 WorstEntry(folded.damping, damping));
  ExpectMatrices(what + "symmetric, ", {0.004, 0.012},
                 WorstEntry(Symmetric(folded.stiffness), stiffness),
                 WorstEntry(Symmetric(folded.damping), damping));
  ExpectFigure(what + "nrmse, next 10 s, worst floor", 0.005,
               WorstContinuation(run, "phase1"));
}

TEST_P(Nsd, NetworkOnDriftAndVelocityFindsTheDevice) {
  ExpectDevice(RunCase(ReadPhase2("phase2_network2")), What("NN2, x1 and v1"),
               0.01, 0.02);
}

// The committed records, made with SciPy, against what makes the records on
// measured ground motions.
TEST(NsdTwin, RespondsAsTheCommittedRecords) {
  const std::string folder = PINODE_SOURCE_DIR "/data/nsd/";
  const NsdTwin twin(folder + "truth.json");
  for (const char* name : {"phase1_b", "phase2_a", "phase2_b", "holdout"}) {
    const std::string record = name;
    const bool holdout = record == "holdout";
    Table ground, expected;
    std::string error;
    ASSERT_TRUE(ReadCsvTable(folder + "ground.csv", {record}, &ground, &error))
        << error;
    ASSERT_TRUE(ReadCsvTable(folder + record + (holdout ? ".csv" : "_next.csv"),
                             {"x1", "x2", "x3"}, &expected, &error))
        << error;
    const Matrix states =
        twin.Respond(ground.values.col(0), record != "phase1_b");
    ASSERT_EQ(states.rows(), expected.values.rows());
    // The files have six decimals.
    EXPECT_LT((states.leftCols(3) - expected.values).cwiseAbs().maxCoeff(),
              1e-6)
        << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Grounds, Nsd,
                         ::testing::Values("synthetic", "measured"),
                         GroundName);
// On measured motions: in nsd_study_test.cc.
INSTANTIATE_TEST_SUITE_P(Grounds, NsdElement, ::testing::Values("synthetic"),
                         GroundName);

}  // namespace
}  // namespace testing
}  // namespace pinode
