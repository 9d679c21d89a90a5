// What the tests of data/nsd share: the case on synthetic or on measured ground
// motions, and how its results are scored.

#ifndef PINODE_TESTS_CASES_NSD_TESTING_H_
#define PINODE_TESTS_CASES_NSD_TESTING_H_

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
#include "pinode/study/problem/folded_matrices.h"
#include "tests/cases/measure.h"
#include "tests/cases/nsd_twin.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {

// Folder of the case on the measured ground motions, made once a process and
// removed with it; empty with a reason where it cannot be made.
inline std::string MeasuredFolder(std::string* reason) {
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

inline Range NetworkRange(const StructuralDynamics& dynamics, int index) {
  return {
      dynamics.block_offset(dynamics.network_block(index)),
      dynamics.networks()[static_cast<size_t>(index)].network->num_weights()};
}

// The first network as `run` has learned it, with the scales that go with it.
inline void SetFirstNetwork(const CaseRun& run, Case* c) {
  const StructuralDynamics& learned = *run.c.problem.dynamics;
  const NetworkArchitecture& architecture =
      learned.networks()[0].network->architecture();
  const Range from = NetworkRange(learned, 0);
  const Vector values = run.model.parameters.segment(from.offset, from.size);
  auto dynamics = std::make_shared<StructuralDynamics>(*c->problem.dynamics);
  std::string error;
  ASSERT_TRUE(dynamics->SetNetworkScales(0, architecture.input_scale,
                                         architecture.output_scale, &error))
      << error;
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
      EXPECT_TRUE(first.summary.usable()) << first.summary.message;
      SetFirstNetwork(first, &c);
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
      if (states.rows() == 0 || states.cols() < 2) {
        ADD_FAILURE() << name << " diverges";
        return std::nan("");
      }
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
    const NetworkTerm& term = dynamics.networks()[1];
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
    EXPECT_TRUE(run.summary.usable()) << run.summary.message;
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

class NsdElement : public Nsd {};

inline std::string GroundName(
    const ::testing::TestParamInfo<const char*>& grounds) {
  return grounds.param;
}

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_NSD_TESTING_H_
