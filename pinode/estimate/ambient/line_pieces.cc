#include "pinode/estimate/ambient/line_pieces.h"

#include "pinode/base/parallel_for.h"

namespace pinode {

LinePieces::LinePieces(Eigen::Index num_lines, int num_threads,
                       Communicator* communicator)
    : num_lines_(num_lines),
      num_threads_(num_threads),
      communicator_(CommunicatorOrSingle(communicator)) {}

void LinePieces::ForOwn(const std::function<void(int piece)>& task) const {
  ParallelFor(kCount, num_threads_, [&](int piece, int) {
    if (RankOf(piece) == communicator_.rank()) task(piece);
  });
}

void LinePieces::ForAll(const std::function<void(int piece)>& task) const {
  ParallelFor(kCount, num_threads_, [&](int piece, int) { task(piece); });
}

}  // namespace pinode
