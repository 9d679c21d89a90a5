// Several processes that do one job together.

#ifndef PINODE_BASE_COMMUNICATOR_H_
#define PINODE_BASE_COMMUNICATOR_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// The ranks run the same program on the same input: each does its part of the
// work, and what is exchanged is the same, bit for bit, on every rank
// afterwards, so that all take the same decisions. Every rank must call the
// same functions in the same order, from one thread.
//
// Where a rank does not answer, calls return false, and so do all that follow.
class Communicator {
 public:
  virtual ~Communicator() = default;

  // This process, from 0, and how many there are.
  virtual int rank() const = 0;
  virtual int size() const = 0;

  // Adds up `count` numbers over the ranks, in place.
  [[nodiscard]] virtual bool Sum(double* values, int64_t count) = 0;
  // `all` holds the ranks' numbers one after the other, sizes[r] of rank r, of
  // which each has filled in its own; afterwards all of them.
  [[nodiscard]] virtual bool Gather(const std::vector<int64_t>& sizes,
                                    double* all) = 0;
  // Until all ranks have come so far, however long that takes: after work that
  // each does alone.
  [[nodiscard]] virtual bool Await() = 0;
  // All ranks receive `count` bytes of rank `root`.
  [[nodiscard]] virtual bool Broadcast(int root, void* bytes,
                                       int64_t count) = 0;

  [[nodiscard]] bool Sum(Vector* values);
  [[nodiscard]] bool Broadcast(int root, Vector* values);  // of any length
  [[nodiscard]] bool Broadcast(int root, std::string* text);
  // Whether it is true on every rank; false where one does not answer.
  [[nodiscard]] bool AllTrue(bool value);
};

// One process, which has nobody to ask.
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

// The one that `options` name, or a single process for nullptr.
Communicator& CommunicatorOrSingle(Communicator* communicator);

}  // namespace pinode

#endif  // PINODE_BASE_COMMUNICATOR_H_
