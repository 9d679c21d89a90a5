// Durations for progress and summaries.

#ifndef PINODE_BASE_STOPWATCH_H_
#define PINODE_BASE_STOPWATCH_H_

#include <chrono>

namespace pinode {

// Returns the seconds since `begin`.
inline double SecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
      .count();
}

}  // namespace pinode

#endif  // PINODE_BASE_STOPWATCH_H_
