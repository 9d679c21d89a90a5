// Passes over the histories of modes, several stretches of a run side by side.

#ifndef PINODE_INTEGRATE_HISTORY_PASS_H_
#define PINODE_INTEGRATE_HISTORY_PASS_H_

#include <functional>

#include "pinode/base/types.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/modal_response.h"

namespace pinode {

// Where share `index` of `count` begins in pieces begin ... end, so that all
// are done at the same time although each first passes what lies before its
// own, at `skip_share` of the price of a piece that is its own; above 0, below
// 1.
int FairBound(int begin, int end, int index, int count, double skip_share);

// The samples of a run in pieces that are never parted.
class HistoryPass {
 public:
  // Samples first ... first + count - 1 of `grid`; the run is at rest, or at a
  // start of 1, at the first one. `operations`: of matrix products that a
  // visitor takes for a sample, by which shares are measured. All must outlive
  // the object.
  HistoryPass(const ModalResponse& response,
              const ModalResponse::Contents& contents,
              const IntegrationGrid& grid, Eigen::Index first,
              Eigen::Index count, double operations);

  static int NumPieces(Eigen::Index samples);
  // Of a sample, counted from that of the run.
  static int PieceOf(Eigen::Index sample);
  int num_pieces() const { return NumPieces(count_); }
  int Bound(int begin, int end, int index, int count) const {
    return FairBound(begin, end, index, count, skip_share_);
  }

  // R x a few consecutive samples, which begin `first` samples behind that of
  // the run, as ModalResponse::Advance has them. Of a share in their order.
  using Visitor = std::function<void(int share, Eigen::Index first,
                                     const Matrix& histories)>;
  // Of pieces begin ... end - 1, shared by threads, each of which finds for
  // itself where its own begin. Their histories are the same bits, whoever has
  // them. Calls come from several threads at a time.
  void Visit(int begin, int end, int num_shares, const Visitor& visitor) const;
  void Visit(int num_threads, const Visitor& visitor) const {
    Visit(0, num_pieces(), NumShares(0, num_pieces(), num_threads), visitor);
  }
  static int NumShares(int begin, int end, int num_threads);

 private:
  const ModalResponse& response_;
  const ModalResponse::Contents& contents_;
  const IntegrationGrid& grid_;
  const Eigen::Index first_;
  const Eigen::Index count_;
  double skip_share_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_HISTORY_PASS_H_
