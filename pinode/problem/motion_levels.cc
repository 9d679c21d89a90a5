#include "pinode/problem/motion_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/base/types.h"

namespace pinode {
namespace {

// Number of parts of a record, of equal energy each.
constexpr int kParts = 4;
// Fewest samples of a part.
constexpr Eigen::Index kFewestOfPart = 10;
// Ratio of levels from which they are different. Parts of one steady record of
// a frame on a shake table differed by up to 1.27.
constexpr double kLevelRatio = 1.25;

// Mean of the finite ones of `values`; NaN if there are fewer than `fewest`.
double MeanOfFinite(const Eigen::Ref<const Vector>& values,
                    Eigen::Index fewest) {
  double sum = 0.0;
  Eigen::Index count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count < fewest ? kNaN : sum / static_cast<double>(count);
}

// The squares of motions about their means, NaN where they are missing.
// `motions`: samples x sensors.
Matrix SquaresOf(Matrix motions) {
  for (auto motion : motions.colwise()) {
    const double mean = MeanOfFinite(motion, 1);
    motion = (motion.array() - mean).square();
  }
  return motions;
}

// Ends of the parts of a record, each with the same share of `energy`. A part
// ends earlier if the others need the samples that are left.
std::vector<Eigen::Index> EndsOf(const Vector& energy) {
  std::vector<Eigen::Index> ends;
  const double all = energy.sum();
  double sum = 0.0;
  Eigen::Index begin = 0;
  for (Eigen::Index i = 0; i < energy.size(); ++i) {
    sum += energy[i];
    const auto full = static_cast<double>(ends.size() + 1) / kParts;
    // Samples that the other parts need at least, and those that there are.
    const Eigen::Index left =
        (kParts - 1 - static_cast<Eigen::Index>(ends.size())) * kFewestOfPart;
    const Eigen::Index after = energy.size() - (i + 1);
    if (ends.size() + 1 == kParts || i + 1 - begin < kFewestOfPart ||
        (sum < full * all && after > left)) {
      continue;
    }
    ends.push_back(i + 1);
    begin = i + 1;
  }
  ends.push_back(energy.size());
  return ends;
}

// Names a sensor. Its levels are not set.
MotionLevel SensorOf(const IdentificationProblem& problem,
                     const Observation& observation,
                     const std::string& location) {
  MotionLevel sensor;
  sensor.channel = observation.name;
  sensor.dof = location;
  sensor.quantity = QuantityName(observation.quantity);
  sensor.unit =
      UnitName(DimensionOf(observation.quantity), problem.description.units);
  return sensor;
}

// Levels in different units are not compared.
bool IsSameSensor(const MotionLevel& a, const MotionLevel& b) {
  return a.dof == b.dof && a.quantity == b.quantity && a.unit == b.unit;
}

// Joins the levels of each sensor: the whole range and the mean.
std::vector<MotionLevel> JoinBySensor(const std::vector<MotionLevel>& all) {
  std::vector<MotionLevel> joined;
  std::vector<double> counts;
  for (const MotionLevel& own : all) {
    size_t i = 0;
    while (i < joined.size() && !IsSameSensor(joined[i], own)) ++i;
    if (i == joined.size()) {
      joined.push_back(own);
      counts.push_back(1.0);
      continue;
    }
    counts[i] += 1.0;
    joined[i].mean += (own.mean - joined[i].mean) / counts[i];
    joined[i].lowest = std::min(joined[i].lowest, own.lowest);
    joined[i].highest = std::max(joined[i].highest, own.highest);
  }
  return joined;
}

// Returns 1 or -1 if a level is a quarter above or below those that a sensor
// has had, else 0.
int Beyond(double level, const MotionLevel& had) {
  if (level > kLevelRatio * had.highest) return 1;
  return kLevelRatio * level < had.lowest ? -1 : 0;
}

// Adds the levels of one record to `levels`. `motions`: samples x sensors.
void AddLevels(const std::vector<MotionLevel>& sensors, const Matrix& motions,
               std::vector<MotionLevel>* levels) {
  const Eigen::Index n = motions.rows();
  if (sensors.empty() || n < kParts * kFewestOfPart) return;
  const Matrix squares = SquaresOf(motions);
  Vector energy = Vector::Zero(n);
  for (const auto& square : squares.colwise()) {
    const double mean = MeanOfFinite(square, 1);
    if (!(mean > 0.0)) continue;
    energy += square.unaryExpr([mean](double value) {
      return std::isfinite(value) ? value / mean : 0.0;
    });
  }
  if (!(energy.sum() > 0.0) || !std::isfinite(energy.sum())) return;
  const std::vector<Eigen::Index> ends = EndsOf(energy);
  for (size_t c = 0; c < sensors.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    MotionLevel own = sensors[c];
    own.lowest = kInfinity;
    double count = 0.0;
    Eigen::Index begin = 0;
    for (const Eigen::Index end : ends) {
      const double level = std::sqrt(MeanOfFinite(
          squares.col(column).segment(begin, end - begin), kFewestOfPart));
      begin = end;
      if (!std::isfinite(level)) continue;
      count += 1.0;
      own.lowest = std::min(own.lowest, level);
      own.highest = std::max(own.highest, level);
      own.mean += (level - own.mean) / count;
    }
    if (!(own.highest > 0.0)) continue;
    levels->push_back(std::move(own));
  }
}

void AddLevelsOf(const IdentificationProblem& problem,
                 const IdentificationRecord& record,
                 std::vector<MotionLevel>* levels) {
  std::vector<MotionLevel> sensors;
  Matrix motions(record.num_samples(), 0);
  for (const MeasuredChannel& channel : record.channels) {
    if (!channel.fit) continue;
    sensors.push_back(
        SensorOf(problem, channel.observation, problem.LocationOf(channel)));
    motions.conservativeResize(Eigen::NoChange, motions.cols() + 1);
    motions.rightCols(1) = channel.values;
  }
  AddLevels(sensors, motions, levels);
}

void AddLevelsOf(const IdentificationProblem& problem,
                 const AmbientRecord& record,
                 std::vector<MotionLevel>* levels) {
  std::vector<MotionLevel> sensors;
  for (const Observation& channel : record.channels) {
    sensors.push_back(SensorOf(
        problem, channel,
        LocationText(channel.weights, problem.dynamics->model().dof_names)));
  }
  AddLevels(sensors, record.samples.transpose(), levels);
}

}  // namespace

std::vector<MotionLevel> MotionLevels(const IdentificationProblem& problem) {
  std::vector<MotionLevel> levels;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    AddLevelsOf(problem, record, &levels);
  }
  for (const AmbientRecord& record : problem.ambient) {
    AddLevelsOf(problem, record, &levels);
  }
  return JoinBySensor(levels);
}

std::string LevelSentence(const std::vector<MotionLevel>& levels) {
  if (levels.empty()) return "";
  const MotionLevel* largest = &levels[0];
  for (const MotionLevel& level : levels) {
    if (level.quantity == levels[0].quantity &&
        level.highest > largest->highest) {
      largest = &level;
    }
  }
  return "The values hold for the motion of these records, from " +
         FormatNumber(largest->lowest, 2) + " to " +
         FormatNumber(largest->highest, 2) + " " + largest->unit +
         " RMS at sensor '" + largest->channel +
         "'. At another level of motion they may differ by more than the "
         "intervals.";
}

LevelComparison CompareLevels(const std::vector<MotionLevel>& baselines,
                              const std::vector<MotionLevel>& now) {
  int common = 0, other = 0;
  for (const MotionLevel& level : now) {
    std::vector<MotionLevel> had;
    int sides = 0;
    for (const MotionLevel& before : baselines) {
      if (!IsSameSensor(before, level)) continue;
      had.push_back(before);
      sides += Beyond(before.mean, level);
    }
    if (had.empty()) continue;
    ++common;
    // Baselines on both sides enclose the new records.
    const bool on_one_side = static_cast<size_t>(std::abs(sides)) == had.size();
    if (on_one_side || Beyond(level.mean, JoinBySensor(had)[0]) != 0) ++other;
  }
  if (common == 0) return LevelComparison::kUnknown;
  return 2 * other > common ? LevelComparison::kOther : LevelComparison::kSame;
}

}  // namespace pinode
