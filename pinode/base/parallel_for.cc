#include "pinode/base/parallel_for.h"

#include <algorithm>
#include <system_error>
#include <thread>
#include <vector>

namespace pinode {

void ParallelFor(int count, int num_threads,
                 const std::function<void(int index, int thread)>& task) {
  num_threads = std::max(1, std::min(num_threads, count));
  const auto run = [&](int thread) {
    for (int i = thread; i < count; i += num_threads) task(i, thread);
  };
  std::vector<std::thread> threads;
  int started = 1;
  try {
    for (; started < num_threads; ++started) threads.emplace_back(run, started);
  } catch (const std::system_error&) {
    // The system gives no more threads (ulimit -u): this one does their work.
  }
  run(0);
  for (int t = started; t < num_threads; ++t) run(t);
  for (std::thread& thread : threads) thread.join();
}

int DefaultThreads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace pinode
