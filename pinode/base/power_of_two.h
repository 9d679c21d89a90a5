// Scale factors that cause no rounding.

#ifndef PINODE_BASE_POWER_OF_TWO_H_
#define PINODE_BASE_POWER_OF_TWO_H_

#include <cmath>

namespace pinode {

// Returns the largest power of two that is not above `size`, or 1 if `size` is
// not positive and finite. Dividing by it changes no digits. Results, including
// square roots, are therefore the same in units that differ by a power of two.
inline double PowerOfTwoBelow(double size) {
  return size > 0.0 && std::isfinite(size) ? std::ldexp(1.0, std::ilogb(size))
                                           : 1.0;
}

}  // namespace pinode

#endif  // PINODE_BASE_POWER_OF_TWO_H_
