#ifndef PINODE_BASE_CONSTANTS_H_
#define PINODE_BASE_CONSTANTS_H_

#include <limits>

namespace pinode {

// Numbers that all layers share.
constexpr double kPi = 3.14159265358979323846;
constexpr double kTwoPi = 2.0 * kPi;
constexpr double kRootTwo = 1.41421356237309504880;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace pinode

#endif  // PINODE_BASE_CONSTANTS_H_
