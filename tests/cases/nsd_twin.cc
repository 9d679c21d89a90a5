#include "tests/cases/nsd_twin.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/record/filter.h"
#include "pinode/record/table.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {
namespace {

constexpr double kSeconds = 30.0;
constexpr double kGravity = 386.0;  // in/s^2
constexpr double kDisplacementNoise = 0.002;
constexpr double kAccelerationNoise = 0.01;  // of the standard deviation
constexpr double kVelocityCornerHz = 15.0;
// Short, so that no visit of the device is overlooked.
constexpr int kPieces = 4;

struct Motion {
  const char* record;
  const char* file;
  bool device;
  double scale;
};

constexpr Motion kMotions[] = {
    {"phase1_a", "kobe_1995_takatori_000.csv", false, 0.17},
    {"phase1_b", "pacoima_dam_1971_pul164.csv", false, 0.35},
    {"phase2_a", "kobe_1995_takatori_000.csv", true, 0.132},
    {"phase2_b", "pacoima_dam_1971_pul164.csv", true, 0.246},
    {"holdout", "northridge_1994_rinaldi_228.csv", true, 0.08},
};

// Ground acceleration in in/s^2, as the file that the case reads will have it;
// zero after the record's end.
bool ReadMotion(const std::string& path, double scale, Vector* ground,
                std::string* error) {
  Table table;
  if (!ReadCsvTable(path, {"t_s", "acc_g"}, &table, error)) return false;
  const Eigen::Index rows = table.num_rows();
  ground->setZero(std::lround(kSeconds * kRateHz) + 1);
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < ground->size(); ++i) {
    const double t = static_cast<double>(i) / kRateHz;
    while (row + 1 < rows && table.values(row + 1, 0) <= t) ++row;
    if (row + 1 >= rows) break;
    const double part = (t - table.values(row, 0)) /
                        (table.values(row + 1, 0) - table.values(row, 0));
    const double g =
        (1.0 - part) * table.values(row, 1) + part * table.values(row + 1, 1);
    (*ground)[i] = 1e-4 * std::round(1e4 * scale * kGravity * g);
  }
  return true;
}

// Displacements, low-passed, then differentiated by the quartic through five
// samples.
Matrix MeasuredVelocity(Matrix x) {
  FilterOptions options;
  options.corner_frequencies = {kVelocityCornerHz};
  ZeroPhaseFilter(options, 1.0 / kRateHz).Apply(&x);
  const Eigen::Index n = x.rows();
  Matrix v = Matrix::Zero(n, x.cols());
  v.middleRows(2, n - 4) = x.topRows(n - 4) - 8.0 * x.middleRows(1, n - 4) +
                           8.0 * x.middleRows(3, n - 4) - x.bottomRows(n - 4);
  v.row(0) = -25.0 * x.row(0) + 48.0 * x.row(1) - 36.0 * x.row(2) +
             16.0 * x.row(3) - 3.0 * x.row(4);
  v.row(1) = -3.0 * x.row(0) - 10.0 * x.row(1) + 18.0 * x.row(2) -
             6.0 * x.row(3) + x.row(4);
  // The last two lie after the part that is used.
  return v * (kRateHz / 12.0);
}

bool WriteCsv(const std::string& path, const std::string& header,
              const Matrix& values, int decimals, std::string* error) {
  std::string text = header + "\n";
  char cell[32];
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      std::snprintf(cell, sizeof(cell), "%s%.*f", j > 0 ? "," : "", decimals,
                    values(i, j));
      text += cell;
    }
    text += "\n";
  }
  return WriteFileAtomically(path, text, error);
}

}  // namespace

NsdTwin::NsdTwin(const std::string& truth_path)
    : mass_(3),
      stiffness_(3, 3),
      damping_(3, 3),
      k_(Truth(truth_path, "/elements/device/k")),
      gap_(Truth(truth_path, "/elements/device/gap")) {
  for (int i = 0; i < 3; ++i) {
    const std::string row = "/" + std::to_string(i);
    mass_[i] = Truth(truth_path, "/mass" + row);
    for (int j = 0; j < 3; ++j) {
      const std::string entry = row + "/" + std::to_string(j);
      stiffness_(i, j) = Truth(truth_path, "/stiffness" + entry);
      damping_(i, j) = Truth(truth_path, "/damping" + entry);
    }
  }
}

double NsdTwin::DeviceForce(double drift) const {
  return k_ * (drift - std::clamp(drift, -gap_, gap_));
}

Matrix NsdTwin::Respond(const Vector& ground, bool device) const {
  // z = [x; v; ground acceleration; its slope; 1], z' = generator z. Below the
  // gap, inside, above.
  const double edges[] = {-gap_, gap_};
  const double step = 1.0 / (kPieces * kRateHz);
  Matrix generators[3], forward[3];
  for (int side = -1; side <= 1; ++side) {
    Matrix k = stiffness_;
    if (side != 0) k(0, 0) += k_;
    Matrix g = Matrix::Zero(9, 9);
    g.block(0, 3, 3, 3).setIdentity();
    g.block(3, 0, 3, 3) = mass_.cwiseInverse().asDiagonal() * (-k);
    g.block(3, 3, 3, 3) = mass_.cwiseInverse().asDiagonal() * (-damping_);
    g.block(3, 6, 3, 1).setConstant(-1.0);
    g(6, 7) = 1.0;
    g(3, 8) = side * k_ * gap_ / mass_[0];
    generators[side + 1] = g;
    forward[side + 1] = (g * step).exp();
  }
  const auto side_of = [&](double drift) {
    return drift < -gap_ ? -1 : (drift > gap_ ? 1 : 0);
  };

  Matrix states = Matrix::Zero(ground.size(), 6);
  Vector z = Vector::Zero(9);
  z[8] = 1.0;
  int side = 0;
  for (Eigen::Index i = 0; i + 1 < ground.size(); ++i) {
    z[6] = ground[i];
    z[7] = (ground[i + 1] - ground[i]) * kRateHz;
    for (int piece = 0; piece < kPieces; ++piece) {
      Vector next = forward[side + 1] * z;
      double left = step;
      while (device && side_of(next[0]) != side) {
        // The instant at which x1 meets the gap, by bisection.
        const int target = side_of(next[0]);
        const double edge = edges[side + target > 0 ? 1 : 0];
        double before = 0.0, after = left;
        for (int k = 0; k < 50; ++k) {
          const double middle = 0.5 * (before + after);
          const Vector there = (generators[side + 1] * middle).exp() * z;
          const bool crossed = (there[0] > edge) == (next[0] > edge);
          (crossed ? after : before) = middle;
        }
        z = (generators[side + 1] * after).exp() * z;
        left -= after;
        side += target > side ? 1 : -1;
        next = (generators[side + 1] * left).exp() * z;
        // Turned back within rounding of the edge.
        if (left <= 0.0) break;
      }
      z = next;
    }
    states.row(i + 1) = z.head(6).transpose();
  }
  return states;
}

Matrix NsdTwin::AbsoluteAccelerations(const Matrix& states, bool device) const {
  Matrix force =
      states.leftCols(3) * stiffness_ + states.rightCols(3) * damping_;
  if (device) {
    for (Eigen::Index i = 0; i < force.rows(); ++i) {
      force(i, 0) += DeviceForce(states(i, 0));
    }
  }
  return -force * mass_.cwiseInverse().asDiagonal();
}

bool WriteMeasuredNsd(const std::string& measured, const std::string& folder,
                      std::string* error) {
  const std::string source = PINODE_SOURCE_DIR "/data/nsd";
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  for (const auto& entry : std::filesystem::directory_iterator(source)) {
    const std::string extension = entry.path().extension();
    const std::string name = entry.path().filename();
    if (extension != ".toml" && extension != ".json" && name != "M.csv" &&
        name != "K.csv" && name != "C.csv" && name != "device.csv") {
      continue;
    }
    std::filesystem::copy_file(
        entry.path(), folder + "/" + name,
        std::filesystem::copy_options::overwrite_existing, failed);
    if (failed) {
      *error = folder + "/" + name + ": " + failed.message();
      return false;
    }
  }

  const NsdTwin twin(source + "/truth.json");
  const Eigen::Index all = std::lround(kSeconds * kRateHz) + 1;
  const Eigen::Index trained = std::lround(kTrainingSeconds * kRateHz) + 1;
  Matrix grounds(all, static_cast<Eigen::Index>(std::size(kMotions)));
  std::string header;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  const auto noise = [&] { return normal(generator); };
  for (size_t m = 0; m < std::size(kMotions); ++m) {
    const Motion& motion = kMotions[m];
    const std::string base = folder + "/" + motion.record;
    header += std::string(m > 0 ? "," : "") + motion.record;
    Vector ground;
    if (!ReadMotion(measured + "/ground_motions/" + motion.file, motion.scale,
                    &ground, error)) {
      return false;
    }
    grounds.col(static_cast<Eigen::Index>(m)) = ground;
    const Matrix states = twin.Respond(ground, motion.device);
    const Matrix x = states.leftCols(3);
    const bool holdout = std::string(motion.record) == "holdout";
    if (!WriteCsv(base + (holdout ? ".csv" : "_next.csv"), "x1,x2,x3", x, 6,
                  error)) {
      return false;
    }
    if (holdout) continue;
    Matrix noisy = x;
    for (double& value : noisy.reshaped())
      value += kDisplacementNoise * noise();
    Matrix both(trained, 6);
    both << noisy.topRows(trained), MeasuredVelocity(noisy).topRows(trained);
    if (!WriteCsv(base + ".csv", "x1,x2,x3,v1,v2,v3", both, 5, error)) {
      return false;
    }
    if (motion.device) continue;
    Matrix a = twin.AbsoluteAccelerations(states.topRows(trained), false);
    for (auto column : a.colwise()) {
      const double sigma =
          kAccelerationNoise *
          std::sqrt((column.array() - column.mean()).square().mean());
      for (double& value : column) value += sigma * noise();
    }
    if (!WriteCsv(base + "_acc.csv", "a1,a2,a3", a, 4, error)) return false;
  }
  return WriteCsv(folder + "/ground.csv", header, grounds, 4, error);
}

}  // namespace testing
}  // namespace pinode
