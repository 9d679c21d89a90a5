// A loop over independent tasks on a few threads.

#ifndef PINODE_BASE_PARALLEL_FOR_H_
#define PINODE_BASE_PARALLEL_FOR_H_

#include <functional>

namespace pinode {

// Calls task(index, thread) for every index in [0, count), thread in
// [0, num_threads). Which thread gets which index is fixed (index modulo
// num_threads): sums that are kept per thread come out the same every time.
// Runs in the calling thread where there is only one task or one thread.
void ParallelFor(int count, int num_threads,
                 const std::function<void(int index, int thread)>& task);

// More are refused by whoever asks for them: a thread that cannot be had ends
// the process.
inline constexpr int kMostThreads = 1024;

// Number of processors, at least 1.
int DefaultThreads();

}  // namespace pinode

#endif  // PINODE_BASE_PARALLEL_FOR_H_
