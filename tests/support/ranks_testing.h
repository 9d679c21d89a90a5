// Ranks of a job, as threads of one process.

#ifndef TESTS_SUPPORT_RANKS_TESTING_H_
#define TESTS_SUPPORT_RANKS_TESTING_H_

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "pinode/base/communicator.h"

namespace pinode::testing {

// Data shared by the ranks of one job.
class ThreadRanks {
 public:
  explicit ThreadRanks(int size) : size_(size) {}

  // Calls work(communicator) on as many threads as there are ranks.
  void Run(const std::function<void(Communicator*)>& work) {
    std::vector<std::thread> threads;
    for (int r = 0; r < size_; ++r) {
      threads.emplace_back([this, r, &work]() {
        Rank rank(this, r);
        work(&rank);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

 private:
  class Rank final : public Communicator {
   public:
    using Communicator::Broadcast;
    using Communicator::Sum;
    Rank(ThreadRanks* all, int rank) : all_(all), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return all_->size_; }
    bool Sum(double* values, int64_t count) override {
      const auto bytes = static_cast<size_t>(count) * sizeof(double);
      for (int r = 0; r < size(); ++r) {
        if (r == rank_) {
          if (r == 0) all_->sum_.assign(static_cast<size_t>(count), 0.0);
          for (int64_t i = 0; i < count; ++i) {
            all_->sum_[static_cast<size_t>(i)] += values[i];
          }
        }
        all_->Meet();
      }
      if (count > 0) std::memcpy(values, all_->sum_.data(), bytes);
      all_->Meet();
      return true;
    }
    bool Gather(const std::vector<int64_t>& sizes, double* all) override {
      int64_t total = 0;
      int64_t own = 0;
      for (int r = 0; r < size(); ++r) {
        if (r == rank_) own = total;
        total += sizes[static_cast<size_t>(r)];
      }
      // Parts of other ranks may contain anything.
      std::vector<double> numbers(static_cast<size_t>(total), 0.0);
      std::copy_n(all + own, sizes[static_cast<size_t>(rank_)],
                  numbers.begin() + own);
      if (!Sum(numbers.data(), total)) return false;
      std::copy(numbers.begin(), numbers.end(), all);
      return true;
    }
    bool Await() override {
      all_->Meet();
      return true;
    }
    bool Broadcast(int root, void* bytes, int64_t count) override {
      if (rank_ == root) all_->bytes_ = bytes;
      all_->Meet();
      if (rank_ != root) {
        std::memcpy(bytes, all_->bytes_, static_cast<size_t>(count));
      }
      all_->Meet();
      return true;
    }

   private:
    ThreadRanks* all_;
    int rank_;
  };

  // Waits until all threads have called it.
  void Meet() {
    std::unique_lock<std::mutex> lock(mutex_);
    const int round = round_;
    if (++arrived_ == size_) {
      arrived_ = 0;
      ++round_;
      all_here_.notify_all();
      return;
    }
    all_here_.wait(lock, [&]() { return round_ != round; });
  }

  const int size_;
  std::mutex mutex_;
  std::condition_variable all_here_;
  int arrived_ = 0;
  int round_ = 0;
  std::vector<double> sum_;
  void* bytes_ = nullptr;
};

}  // namespace pinode::testing

#endif  // TESTS_SUPPORT_RANKS_TESTING_H_
