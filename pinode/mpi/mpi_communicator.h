// Ranks of an MPI job. No other header of pinode uses MPI.

#ifndef PINODE_MPI_MPI_COMMUNICATOR_H_
#define PINODE_MPI_MPI_COMMUNICATOR_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"

namespace pinode {

// Communicator of all ranks of MPI_COMM_WORLD. Rank 0 computes sums and sends
// them to all ranks, so that every rank has the same bits. Call it from one
// thread.
class MpiCommunicator final : public Communicator {
 public:
  struct Options {
    // Time after which a rank that does not answer counts as failed.
    double timeout_seconds = 300.0;
    // Largest number of values or bytes in one message. It may not be above its
    // default, because MPI counts in 32 bits.
    int64_t most_at_once = int64_t{1} << 28;
    // Function that is called while this process waits for other ranks. It
    // returns true if this process was told to end. The wait then ends after a
    // short time, because whoever told it to end will not wait long.
    std::function<bool()> interrupted;
    // Function that is called once, with a sentence, if a rank does not answer.
    // It need not return.
    std::function<void(const std::string& what)> on_failure;
  };

  // Starts MPI. Call it once per process. Returns nullptr, with a sentence in
  // *error, if it fails.
  static std::unique_ptr<MpiCommunicator> Begin(const Options& options,
                                                std::string* error);
  // Waits for all ranks, then ends MPI. Does not wait if a rank has failed.
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

  // Ends all ranks with this exit status, and does not return.
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
