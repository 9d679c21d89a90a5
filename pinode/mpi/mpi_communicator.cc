#include "pinode/mpi/mpi_communicator.h"

#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <thread>

namespace pinode {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

// Time of polling without a pause; afterwards polls with a pause.
constexpr microseconds kEager(200000);
constexpr microseconds kPause(100);
// Time for which a process that was told to end still waits for others.
constexpr microseconds kLastWait(300000);

}  // namespace

std::unique_ptr<MpiCommunicator> MpiCommunicator::Begin(const Options& options,
                                                        std::string* error) {
  int provided = MPI_THREAD_SINGLE;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) !=
      MPI_SUCCESS) {
    *error = "MPI does not begin";
    return nullptr;
  }
  std::unique_ptr<MpiCommunicator> result(new MpiCommunicator(options));
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm local = MPI_COMM_NULL;
  if (provided < MPI_THREAD_FUNNELED ||
      MPI_Comm_rank(MPI_COMM_WORLD, &result->rank_) != MPI_SUCCESS ||
      MPI_Comm_size(MPI_COMM_WORLD, &result->size_) != MPI_SUCCESS ||
      MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0,
                          MPI_INFO_NULL, &local) != MPI_SUCCESS ||
      MPI_Comm_size(local, &result->num_local_ranks_) != MPI_SUCCESS) {
    *error = "MPI does not give the rank";
    result->failed_ = true;
    return nullptr;
  }
  MPI_Comm_free(&local);
  return result;
}

MpiCommunicator::~MpiCommunicator() {
  if (!failed_) MPI_Finalize();
}

bool MpiCommunicator::Fail(const std::string& what) {
  const bool is_first = !failed_;
  failed_ = true;
  if (is_first && options_.on_failure) options_.on_failure(what);
  return false;
}

bool MpiCommunicator::Wait(void* request, double timeout_seconds) {
  const auto begin = Clock::now();
  auto told = Clock::time_point::max();
  for (;;) {
    int done = 0;
    if (MPI_Test(static_cast<MPI_Request*>(request), &done,
                 MPI_STATUS_IGNORE) != MPI_SUCCESS) {
      return Fail("a rank cannot be reached");
    }
    if (done != 0) return true;
    const auto now = Clock::now();
    if (now - begin < kEager) {
      sched_yield();
      continue;
    }
    if (std::chrono::duration<double>(now - begin).count() > timeout_seconds) {
      return Fail("a rank has not answered for " +
                  std::to_string(static_cast<int>(timeout_seconds)) + " s");
    }
    if (options_.interrupted && options_.interrupted()) {
      told = std::min(told, now);
      if (now - told > kLastWait) {
        return Fail("interrupted while a rank did not answer");
      }
    }
    std::this_thread::sleep_for(kPause);
  }
}

bool MpiCommunicator::Sum(double* values, int64_t count) {
  for (int64_t at = 0; at < count && !failed_; at += options_.most_at_once) {
    const int now =
        static_cast<int>(std::min(options_.most_at_once, count - at));
    MPI_Request request = MPI_REQUEST_NULL;
    const void* send = rank_ == 0 ? MPI_IN_PLACE : values + at;
    if (MPI_Ireduce(send, rank_ == 0 ? values + at : nullptr, now, MPI_DOUBLE,
                    MPI_SUM, 0, MPI_COMM_WORLD, &request) != MPI_SUCCESS) {
      return Fail("a rank cannot be reached");
    }
    if (!Wait(&request, options_.timeout_seconds)) return false;
  }
  return Broadcast(0, values, count * static_cast<int64_t>(sizeof(double)));
}

bool MpiCommunicator::Gather(const std::vector<int64_t>& sizes, double* all) {
  int64_t total = 0;
  std::vector<int> counts, places;
  for (const int64_t size : sizes) {
    counts.push_back(static_cast<int>(std::min(size, options_.most_at_once)));
    places.push_back(static_cast<int>(std::min(total, options_.most_at_once)));
    total += size;
  }
  if (failed_) return false;
  if (total > options_.most_at_once) {
    // Beyond the addressable size of MPI: one rank after the other.
    int64_t at = 0;
    for (int r = 0; r < size_; ++r) {
      const int64_t size = sizes[static_cast<size_t>(r)];
      if (!Broadcast(r, all + at, size * static_cast<int64_t>(sizeof(double))))
        return false;
      at += size;
    }
    return true;
  }
  MPI_Request request = MPI_REQUEST_NULL;
  if (MPI_Iallgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, all, counts.data(),
                      places.data(), MPI_DOUBLE, MPI_COMM_WORLD,
                      &request) != MPI_SUCCESS) {
    return Fail("a rank cannot be reached");
  }
  return Wait(&request, options_.timeout_seconds);
}

bool MpiCommunicator::Await() {
  if (failed_) return false;
  MPI_Request request = MPI_REQUEST_NULL;
  if (MPI_Ibarrier(MPI_COMM_WORLD, &request) != MPI_SUCCESS) {
    return Fail("a rank cannot be reached");
  }
  return Wait(&request, std::numeric_limits<double>::infinity());
}

bool MpiCommunicator::Broadcast(int root, void* bytes, int64_t count) {
  for (int64_t at = 0; at < count && !failed_; at += options_.most_at_once) {
    const int now =
        static_cast<int>(std::min(options_.most_at_once, count - at));
    MPI_Request request = MPI_REQUEST_NULL;
    if (MPI_Ibcast(static_cast<char*>(bytes) + at, now, MPI_BYTE, root,
                   MPI_COMM_WORLD, &request) != MPI_SUCCESS) {
      return Fail("a rank cannot be reached");
    }
    if (!Wait(&request, options_.timeout_seconds)) return false;
  }
  return !failed_;
}

void MpiCommunicator::Abort(int status) {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::_Exit(status);
}

}  // namespace pinode
