// The frame with the negative stiffness device, data/nsd, after section 4 of
// Lai et al. (2021): without the device a linear network corrects stiffness and
// damping, with the device that network is kept and the device is learned.
// Scores are taken against the noise-free response. Each test runs on the
// synthetic ground motions and, where the measured records are at hand, on
// those.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/figure_testing.h"
#include "pinode/case/folded_matrices.h"
#include "pinode/record/table.h"
#include "tests/cases/measure.h"
#include "tests/cases/nsd_twin.h"

namespace pinode {
namespace testing {
namespace {

// Of every response that is scored.
constexpr double kRateHz = 256.0;
// The records that train end here; their responses go on for 10 s.
constexpr double kTrainingSeconds = 20.0;

// `held` is `asked`, or what is reached where that is out of reach;
// data/README.md says why.
void ExpectFigure(const std::string& what, double asked, double held,
                  double measured) {
  ReportFigure(what, AtMost(asked), measured);
  EXPECT_LT(measured, held) << what;
}

void ExpectFigure(const std::string& what, double asked, double measured) {
  ExpectFigure(what, asked, asked, measured);
}

// Folder of the case on the measured ground motions, made once a process and
// removed with it; empty with a reason where it cannot be made.
std::string MeasuredFolder(std::string* reason) {
  struct Folder {
    std::string path;
    ~Folder() {
      std::error_code ignored;
      if (!path.empty()) std::filesystem::remove_all(path, ignored);
    }
  };
  static Folder folder;
  if (!folder.path.empty()) return folder.path;
  const std::string measured = MeasuredData();
  if (measured.empty()) {
    *reason = "measured data not at hand; set PINODE_MEASURED_DATA";
    return "";
  }
  const std::string path =
      ::testing::TempDir() + "/pinode_nsd_" + std::to_string(getpid());
  folder.path = path;
  if (!WriteMeasuredNsd(measured, path, reason)) {
    folder.path.clear();
    ADD_FAILURE() << *reason;
  }
  return folder.path;
}

// The parameters of network `index` within those of the dynamics.
struct Range {
  int offset = 0;
  int size = 0;
};

Range NetworkRange(const StructuralDynamics& dynamics, int index) {
  const int first = static_cast<int>(dynamics.blocks().size()) -
                    static_cast<int>(dynamics.networks().size());
  return {
      dynamics.block_offset(first + index),
      dynamics.networks()[static_cast<size_t>(index)].network->num_weights()};
}

// `values` as the weights of the first network.
void SetFirstNetwork(const Vector& values, Case* c) {
  auto dynamics = std::make_shared<StructuralDynamics>(*c->problem.dynamics);
  const Range range = NetworkRange(*dynamics, 0);
  ASSERT_EQ(values.size(), range.size);
  Vector theta = dynamics->Parameters();
  theta.segment(range.offset, range.size) = values;
  dynamics->SetParameters(theta);
  c->problem.dynamics = dynamics;
}

class Nsd : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (IsMeasured()) {
      std::string reason;
      folder_ = MeasuredFolder(&reason);
      if (folder_.empty()) {
        ReportSkipped(
            std::string("nsd, ") +
            ::testing::UnitTest::GetInstance()->current_test_info()->name());
        GTEST_SKIP() << reason;
      }
    } else {
      folder_ = "data/nsd";
    }
  }

  bool IsMeasured() const { return std::string(GetParam()) == "measured"; }

  std::string What(const std::string& name) const {
    return std::string("nsd, ") + GetParam() + " grounds, " + name + ": ";
  }

  CaseRun Run(const std::string& name) const {
    return RunCase(ReadCaseOrFail(folder_ + "/" + name + ".toml"));
  }

  // A case with the device. The weights file beside it comes from the synthetic
  // records; on the measured ones NN1 is learned first.
  Case ReadPhase2(const std::string& name) const {
    Case c = ReadCaseOrFail(folder_ + "/" + name + ".toml");
    if (IsMeasured()) {
      const CaseRun first = Run("phase1");
      EXPECT_TRUE(first.summary.usable) << first.summary.message;
      const Range range = NetworkRange(*first.c.problem.dynamics, 0);
      SetFirstNetwork(first.model.parameters.segment(range.offset, range.size),
                      &c);
    }
    return c;
  }

  Matrix TrueMatrix(const std::string& name) const {
    Matrix matrix(3, 3);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        matrix(i, j) = Truth(
            folder_ + "/truth.json",
            "/" + name + "/" + std::to_string(i) + "/" + std::to_string(j));
      }
    }
    return matrix;
  }

  double TrueDevice(const std::string& name) const {
    return Truth(folder_ + "/truth.json", "/elements/device/" + name);
  }

  double TrueForce(double drift) const {
    const double gap = TrueDevice("gap");
    return TrueDevice("k") * (drift - std::clamp(drift, -gap, gap));
  }

  FoldedMatrices Folded(const CaseRun& run) const {
    const StructuralDynamics& dynamics = *run.c.problem.dynamics;
    return FoldNetworks(dynamics,
                        run.model.parameters.head(dynamics.num_parameters()));
  }

  // Worst entry, in parts of the largest true one.
  static double WorstEntry(const Matrix& matrix, const Matrix& truth) {
    const Matrix error = matrix - truth;
    return error.allFinite()
               ? error.cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff()
               : std::nan("");
  }

  static Matrix Symmetric(const Matrix& matrix) {
    return 0.5 * (matrix + matrix.transpose());
  }

  // Worst floor's nrmse from `from` seconds on.
  static double WorstFloor(const CaseRun& run, const std::string& record,
                           double from) {
    const auto first = static_cast<Eigen::Index>(std::lround(from * kRateHz));
    double worst = 0.0;
    for (size_t r = 0; r < run.summary.records.size(); ++r) {
      const RecordScore& score = run.summary.records[r];
      if (score.name != record) continue;
      const IdentificationRecord& data = run.c.problem.records[r];
      EXPECT_NEAR(data.sampling_step() * kRateHz, 1.0, 1e-9);
      EXPECT_EQ(score.prediction.rows(), 3);
      for (Eigen::Index i = 0; i < score.prediction.rows(); ++i) {
        const Vector measured = data.channels[static_cast<size_t>(i)].values;
        const Vector predicted = score.prediction.row(i).transpose();
        const Eigen::Index count = measured.size() - first;
        EXPECT_GT(count, 1);
        const Vector tail = measured.tail(count);
        worst = Worse(worst, (tail - predicted.tail(count)).norm() /
                                 (tail.array() - tail.mean()).matrix().norm());
      }
      return worst;
    }
    ADD_FAILURE() << "no record " << record;
    return std::nan("");
  }

  static double WorstContinuation(const CaseRun& run, const char* phase) {
    const std::string name = phase;
    return Worse(WorstFloor(run, name + "_a_next", kTrainingSeconds),
                 WorstFloor(run, name + "_b_next", kTrainingSeconds));
  }

  // The learned force of the device, by the second network or by the element,
  // against the true one at the same drifts: those that the model runs through
  // in the 30 s of both motions it was trained with.
  double DeviceForceNrmse(const CaseRun& run) const {
    const StructuralDynamics& dynamics = *run.c.problem.dynamics;
    std::vector<double> learned;
    std::vector<double> truth;
    for (const char* name : {"phase2_a_next", "phase2_b_next"}) {
      const Matrix& states = run.Record(name).states;
      EXPECT_GT(states.cols(), 1) << name;
      for (Eigen::Index i = 0; i < states.cols(); ++i) {
        truth.push_back(TrueForce(states(0, i)));
        learned.push_back(dynamics.laws().empty()
                              ? NetworkForce(run, states.col(i))
                              : ElementForce(run, states(0, i)));
      }
    }
    const Eigen::Map<const Vector> f(truth.data(),
                                     static_cast<Eigen::Index>(truth.size()));
    const Eigen::Map<const Vector> g(learned.data(), f.size());
    return (g - f).norm() / (f.array() - f.mean()).matrix().norm();
  }

  static double ElementForce(const CaseRun& run, double drift) {
    const double gap = run.Parameter("device.gap").value;
    return run.Parameter("device.k").value *
           (drift - std::clamp(drift, -gap, gap));
  }

  // The second network drives DOF 1 with an acceleration; the device resists.
  static double NetworkForce(const CaseRun& run, const Vector& state) {
    const StructuralDynamics& dynamics = *run.c.problem.dynamics;
    const NetworkTerm& term = dynamics.networks().at(1);
    const int n = dynamics.num_dofs();
    Vector features(term.network->num_inputs());
    for (size_t k = 0; k < term.features.size(); ++k) {
      const Feature& feature = term.features[k];
      features[static_cast<Eigen::Index>(k)] = feature.Selector(n).dot(
          feature.OnVelocity() ? state.segment(n, n) : state.head(n));
    }
    const Range range = NetworkRange(dynamics, 1);
    const Vector weights =
        run.model.parameters.segment(range.offset, range.size);
    NetworkWorkspace workspace(*term.network);
    double acceleration = 0.0;
    term.network->Evaluate(features.data(), weights.data(), &acceleration,
                           &workspace);
    return -dynamics.model().mass(0, 0) * acceleration;
  }

  // What the table asks of a model with the device.
  void ExpectDevice(const CaseRun& run, const std::string& what,
                    double force_limit, double holdout_limit) const {
    EXPECT_TRUE(run.summary.usable) << run.summary.message;
    std::printf("%s%d iterations, %.1f s\n", what.c_str(),
                run.summary.num_iterations, run.summary.seconds);
    ExpectFigure(what + "device force, nrmse", force_limit,
                 DeviceForceNrmse(run));
    ExpectFigure(what + "nrmse, hold-out, worst floor", holdout_limit,
                 WorstFloor(run, "holdout", 0.0));
    const double next = WorstContinuation(run, "phase2");
    ReportFigure(what + "nrmse, next 10 s, worst floor", Nothing(), next);
    EXPECT_LT(next, holdout_limit);
  }

  std::string folder_;
};

struct Phase1Limits {
  double stiffness;
  double damping;
  double damping_held;
};

void ExpectMatrices(const std::string& what, const Phase1Limits& limits,
                    double stiffness, double damping) {
  ExpectFigure(what + "K, worst entry in parts of the largest",
               limits.stiffness, stiffness);
  ExpectFigure(what + "C, worst entry in parts of the largest", limits.damping,
               limits.damping_held, damping);
}

TEST_P(Nsd, LinearNetworkFindsStiffnessAndDamping) {
  const CaseRun run = Run("phase1");
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  const FoldedMatrices folded = Folded(run);
  const Matrix stiffness = TrueMatrix("stiffness");
  const Matrix damping = TrueMatrix("damping");
  const std::string what = What("phase 1");
  // As learned the measured motions tell less of C than is asked.
  ExpectMatrices(what + "as learned, ",
                 {0.01, 0.04, IsMeasured() ? 0.08 : 0.04},
                 WorstEntry(folded.stiffness, stiffness),
                 WorstEntry(folded.damping, damping));
  ExpectMatrices(what + "symmetric, ", {0.01, 0.04, 0.04},
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
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  const FoldedMatrices folded = Folded(run);
  const Matrix stiffness = TrueMatrix("stiffness");
  const Matrix damping = TrueMatrix("damping");
  const std::string what = What("phase 1, accelerations");
  ExpectMatrices(what + "as learned, ", {0.004, 0.012, 0.012},
                 WorstEntry(folded.stiffness, stiffness),
                 WorstEntry(folded.damping, damping));
  ExpectMatrices(what + "symmetric, ", {0.004, 0.012, 0.012},
                 WorstEntry(Symmetric(folded.stiffness), stiffness),
                 WorstEntry(Symmetric(folded.damping), damping));
  ExpectFigure(what + "nrmse, next 10 s, worst floor", 0.005,
               WorstContinuation(run, "phase1"));
}

TEST_P(Nsd, NetworkOnSixInputsFindsTheDevice) {
  ExpectDevice(RunCase(ReadPhase2("phase2_network6")), What("NN2, six inputs"),
               0.03, 0.08);
}

TEST_P(Nsd, NetworkOnDriftAndVelocityFindsTheDevice) {
  ExpectDevice(RunCase(ReadPhase2("phase2_network2")), What("NN2, x1 and v1"),
               0.01, 0.02);
}

TEST_P(Nsd, ElementFindsTheDeviceFromStarts50PercentOff) {
  for (const double k : {0.5, 1.5}) {
    Case c = ReadPhase2("phase2_element");
    auto dynamics = std::make_shared<StructuralDynamics>(*c.problem.dynamics);
    // The element is the first block; its parameters are k and gap.
    ASSERT_EQ(dynamics->blocks()[0].parameters[0].name, "device.k");
    ASSERT_EQ(dynamics->blocks()[0].parameters[1].name, "device.gap");
    Vector theta = dynamics->Parameters();
    theta[0] = k * TrueDevice("k");
    theta[1] = (2.0 - k) * TrueDevice("gap");
    dynamics->SetParameters(theta);
    c.problem.dynamics = dynamics;
    const CaseRun run = RunCase(std::move(c));
    EXPECT_EQ(run.summary.termination, Termination::kConverged);
    ExpectDevice(
        run,
        What(std::string("element, slope ") + (k < 1 ? "half" : "1.5") +
             ", gap " + (k < 1 ? "1.5" : "half")),
        0.004, 0.02);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST_P(Nsd, ElementAndMatricesTogether) {
  const CaseRun run = RunCase(ReadPhase2("phase2_joint"));
  const std::string what = What("element, K and C refitted");
  ExpectDevice(run, what, 0.004, 0.002);
  const FoldedMatrices folded = Folded(run);
  ReportFigure(what + "K, worst entry in parts of the largest", Nothing(),
               WorstEntry(folded.stiffness, TrueMatrix("stiffness")));
  ReportFigure(what + "C, worst entry in parts of the largest", Nothing(),
               WorstEntry(folded.damping, TrueMatrix("damping")));
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

INSTANTIATE_TEST_SUITE_P(
    Grounds, Nsd, ::testing::Values("synthetic", "measured"),
    [](const ::testing::TestParamInfo<const char*>& grounds) {
      return std::string(grounds.param);
    });

}  // namespace
}  // namespace testing
}  // namespace pinode
