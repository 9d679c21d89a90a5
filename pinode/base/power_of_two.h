// Scales that round nothing.

#ifndef PINODE_BASE_POWER_OF_TWO_H_
#define PINODE_BASE_POWER_OF_TWO_H_

#include <cmath>

namespace pinode {

// The largest power of two that is not above `size`; 1 where that is not
// positive and finite. What is divided by it has the same digits, and comes out
// the same in units that are a power of two apart: roots, too.
inline double PowerOfTwoBelow(double size) {
  return size > 0.0 && std::isfinite(size) ? std::ldexp(1.0, std::ilogb(size))
                                           : 1.0;
}

}  // namespace pinode

#endif  // PINODE_BASE_POWER_OF_TWO_H_
