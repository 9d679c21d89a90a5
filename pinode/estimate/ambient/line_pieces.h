// The division of a record's lines among ranks and threads.

#ifndef PINODE_ESTIMATE_AMBIENT_LINE_PIECES_H_
#define PINODE_ESTIMATE_AMBIENT_LINE_PIECES_H_

#include <Eigen/Core>
#include <functional>

#include "pinode/base/communicator.h"

namespace pinode {

// Pieces of the band, each a range of lines. The ranks share the pieces, and so
// do the threads of a rank. The number of pieces is fixed: sums over the pieces
// in their order are the same bits for any number of ranks and threads.
class LinePieces {
 public:
  static constexpr int kCount = 16;

  // `communicator` may be nullptr: a single process. It must outlive this
  // object.
  LinePieces(Eigen::Index num_lines, int num_threads,
             Communicator* communicator);

  // Lines First(piece) ... First(piece + 1) - 1 belong to the piece.
  Eigen::Index First(int piece) const {
    return num_lines_ * Eigen::Index{piece} / kCount;
  }
  // The rank that sums the piece. A later piece has the same or a higher rank.
  int RankOf(int piece) const { return piece * communicator_.size() / kCount; }
  Communicator& communicator() const { return communicator_; }

  // Calls task(piece), on several threads, for the pieces of this rank.
  void ForOwn(const std::function<void(int piece)>& task) const;
  // Calls task(piece), on several threads, for all pieces.
  void ForAll(const std::function<void(int piece)>& task) const;

 private:
  const Eigen::Index num_lines_;
  const int num_threads_;
  Communicator& communicator_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_LINE_PIECES_H_
