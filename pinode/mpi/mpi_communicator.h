// Ranks of an MPI job; the only place that knows MPI.

#ifndef PINODE_MPI_MPI_COMMUNICATOR_H_
#define PINODE_MPI_MPI_COMMUNICATOR_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"

namespace pinode {

// All ranks of MPI_COMM_WORLD. Sums go to rank 0 and from there to all, so that
// every rank has the same bits. MPI is called from one thread.
class MpiCommunicator final : public Communicator {
 public:
  struct Options {
    // A rank that does not answer for so long has stalled.
    double timeout_seconds = 300.0;
    // Numbers, or bytes, that are sent at a time: MPI counts in 32 bits. No
    // more than its default.
    int64_t most_at_once = int64_t{1} << 28;
    // Asked while others are waited for: whether this process was told to end.
    // It then waits for a moment and no longer, because the one who told it
    // will not either.
    std::function<bool()> interrupted;
    // Called once, with a sentence, where a rank does not answer. May not
    // return.
    std::function<void(const std::string& what)> on_failure;
  };

  // Begins MPI, once in a process. nullptr, with a sentence in *error, where
  // it does not begin.
  static std::unique_ptr<MpiCommunicator> Begin(const Options& options,
                                                std::string* error);
  // Waits for all ranks and ends MPI; without waiting after a failure.
  ~MpiCommunicator() override;
  MpiCommunicator(const MpiCommunicator&) = delete;
  MpiCommunicator& operator=(const MpiCommunicator&) = delete;

  using Communicator::Broadcast;
  using Communicator::Sum;
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  bool Sum(double* values, int64_t count) override;
  bool Gather(const std::vector<int64_t>& sizes, double* all) override;
  bool Await() override;
  bool Broadcast(int root, void* bytes, int64_t count) override;

  // Ranks on this machine.
  int num_local_ranks() const { return num_local_ranks_; }

  // Ends all ranks, and does not return.
  [[noreturn]] void Abort(int status);

 private:
  explicit MpiCommunicator(const Options& options) : options_(options) {}

  // `request`: an MPI_Request.
  bool Wait(void* request, double timeout_seconds);
  bool Fail(const std::string& what);

  const Options options_;
  int rank_ = 0;
  int size_ = 1;
  int num_local_ranks_ = 1;
  bool failed_ = false;
};

}  // namespace pinode

#endif  // PINODE_MPI_MPI_COMMUNICATOR_H_
