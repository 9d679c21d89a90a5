// Levels of motion that records cover.

#ifndef PINODE_PROBLEM_MOTION_LEVELS_H_
#define PINODE_PROBLEM_MOTION_LEVELS_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Returns the level of motion at each fitted sensor over the training records
// and the ambient ones. Each record is cut into four parts of equal energy, or
// nearly so. A part's level is the RMS of the measured motion about its mean
// over the whole record. Missing samples do not count, nor do parts with fewer
// than 10 others. Records without motion, and those of fewer than 40 samples,
// have no levels.
std::vector<MotionLevel> MotionLevels(const IdentificationProblem& problem);

// Returns a sentence with the range at the sensor of the largest motion, among
// those that measure the first one's quantity. Empty without levels.
std::string LevelSentence(const std::vector<MotionLevel>& levels);

// Result of CompareLevels.
enum class LevelComparison { kSame, kOther, kUnknown };

// Compares the levels of new records with those of the baselines. The level is
// another one if this holds at more than half of the common sensors: the mean
// level of one side lies a quarter above or below all levels of the other side.
// Baselines on both sides of the new records enclose them. Sensors are common
// if place, quantity and unit are the same. Without common ones the answer is
// unknown.
LevelComparison CompareLevels(const std::vector<MotionLevel>& baselines,
                              const std::vector<MotionLevel>& now);

}  // namespace pinode

#endif  // PINODE_PROBLEM_MOTION_LEVELS_H_
