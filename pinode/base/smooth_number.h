// Lengths with a fast Fourier transform.

#ifndef PINODE_BASE_SMOOTH_NUMBER_H_
#define PINODE_BASE_SMOOTH_NUMBER_H_

#include <cstdint>

namespace pinode {

// Returns the largest product of twos, threes and fives that is not above
// `limit`, at least 1.
inline int64_t SmoothNumberBelow(int64_t limit) {
  for (int64_t size = limit; size > 1; --size) {
    int64_t rest = size;
    for (const int factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return size;
  }
  return 1;
}

}  // namespace pinode

#endif  // PINODE_BASE_SMOOTH_NUMBER_H_
