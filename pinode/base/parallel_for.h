// Runs a loop over independent tasks on a few threads.

#ifndef PINODE_BASE_PARALLEL_FOR_H_
#define PINODE_BASE_PARALLEL_FOR_H_

#include <functional>

namespace pinode {

// Calls task(index, thread) for every index in [0, count), with thread in [0,
// num_threads). The thread of an index is fixed (index modulo num_threads), so
// that sums kept per thread are the same in every run. Runs in the calling
// thread if there is only one task or one thread.
void ParallelFor(int count, int num_threads,
                 const std::function<void(int index, int thread)>& task);

// Largest number of threads. Callers must refuse larger numbers: a thread that
// cannot be created ends the process.
inline constexpr int kMostThreads = 1024;

// Returns the number of processors, at least 1.
int DefaultThreads();

}  // namespace pinode

#endif  // PINODE_BASE_PARALLEL_FOR_H_
