#include "pinode/base/parallel_for.h"

#include <algorithm>
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
  for (int t = 1; t < num_threads; ++t) threads.emplace_back(run, t);
  run(0);
  for (std::thread& thread : threads) thread.join();
}

int DefaultThreads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace pinode
