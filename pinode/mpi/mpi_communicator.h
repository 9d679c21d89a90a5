// Ranks of an MPI job; the only file that uses MPI.

#ifndef PINODE_MPI_MPI_COMMUNICATOR_H_
#define PINODE_MPI_MPI_COMMUNICATOR_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"

namespace pinode {

// Communicator of all ranks of MPI_COMM_WORLD. Sums go to rank 0 and from there
// to all, so that every rank has the same bits. MPI is called from one thread.
class MpiCommunicator final : public Communicator {
 public:
  struct Options {
    // Time after which a rank that does not answer has stalled.
    double timeout_seconds = 300.0;
    // Largest count of numbers, or bytes, that are sent at a time: MPI counts
    // in 32 bits. At most its default.
    int64_t most_at_once = int64_t{1} << 28;
    // Called while waiting for other ranks; true if this process was told to
    // end. It then waits only a moment longer, because the sender of the signal
    // will not wait either.
    std::function<bool()> interrupted;
    // Called once, with a sentence, if a rank does not answer. May not return.
    std::function<void(const std::string& what)> on_failure;
  };

  // Begins MPI, once in a process. Returns nullptr, with a sentence in *error,
  // if it fails.
  static std::unique_ptr<MpiCommunicator> Begin(const Options& options,
                                                std::string* error);
  // Waits for all ranks and ends MPI; does not wait after a failure.
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

  // Number of ranks on this machine.
  int num_local_ranks() const { return num_local_ranks_; }

  // Ends all ranks, and does not return.
  [[noreturn]] void Abort(int status);

 private:
  explicit MpiCommunicator(const Options& options) : options_(options) {}

  // Waits for `request`, an MPI_Request.
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
