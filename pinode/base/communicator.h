// Communication between several processes that do one job together.

#ifndef PINODE_BASE_COMMUNICATOR_H_
#define PINODE_BASE_COMMUNICATOR_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Exchange of data between the ranks (processes) of one job. The ranks run the
// same program on the same input, and each does its part of the work. After an
// exchange, the exchanged data are the same on every rank, bit for bit, so that
// all ranks take the same decisions. Every rank must call the same functions in
// the same order, from one thread.
//
// Every exchange returns true on success. If a rank does not answer, the call
// and all later calls return false, and the data are undefined. Nothing is
// thrown.
class Communicator {
 public:
  virtual ~Communicator() = default;

  // Rank of this process, from 0 to size() - 1.
  virtual int rank() const = 0;
  // Number of ranks, at least 1.
  virtual int size() const = 0;

  // Adds up arrays over the ranks, entry by entry, in place. `values` has
  // `count` entries, the same number on every rank.
  [[nodiscard]] virtual bool Sum(double* values, int64_t count) = 0;
  // Gathers the ranks' numbers in `all`: sizes[0] numbers of rank 0, then
  // sizes[1] numbers of rank 1, and so on. `all` has room for the sum of
  // `sizes`. Before the call each rank fills in its own part. After the call
  // every rank has all parts.
  [[nodiscard]] virtual bool Gather(const std::vector<int64_t>& sizes,
                                    double* all) = 0;
  // Waits until all ranks have called it, without a time limit. Call it after
  // work that each rank does alone.
  [[nodiscard]] virtual bool Await() = 0;
  // Sends `count` bytes from rank `root` to all other ranks, which receive them
  // in `bytes`.
  [[nodiscard]] virtual bool Broadcast(int root, void* bytes,
                                       int64_t count) = 0;

  // Adds up vectors of equal length over the ranks, in place.
  [[nodiscard]] bool Sum(Vector* values);
  // Sends a vector or a text of any length. The other ranks resize theirs.
  [[nodiscard]] bool Broadcast(int root, Vector* values);
  [[nodiscard]] bool Broadcast(int root, std::string* text);
  // Returns true if `value` is true on every rank. Returns false if a rank does
  // not answer.
  [[nodiscard]] bool AllTrue(bool value);
};

// A communicator for one process. It exchanges nothing.
class SingleProcess final : public Communicator {
 public:
  using Communicator::Broadcast;
  using Communicator::Sum;
  int rank() const override { return 0; }
  int size() const override { return 1; }
  bool Sum(double*, int64_t) override { return true; }
  bool Gather(const std::vector<int64_t>&, double*) override { return true; }
  bool Await() override { return true; }
  bool Broadcast(int, void*, int64_t) override { return true; }
};

// Returns *communicator, or a single process for nullptr.
Communicator& CommunicatorOrSingle(Communicator* communicator);

}  // namespace pinode

#endif  // PINODE_BASE_COMMUNICATOR_H_
