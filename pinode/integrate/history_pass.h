// Passes over the histories of modes, with several stretches of a run in
// parallel.

#ifndef PINODE_INTEGRATE_HISTORY_PASS_H_
#define PINODE_INTEGRATE_HISTORY_PASS_H_

#include <functional>

#include "pinode/base/types.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/modal_response.h"

namespace pinode {

// Returns the first piece of share `index` of `count` in the pieces begin ...
// end. The shares finish at the same time, although each must first pass over
// the pieces before its own. Passing over a piece costs `skip_share` (above 0,
// below 1) of the cost of one of its own pieces.
int FairBound(int begin, int end, int index, int count, double skip_share);

// The samples of a run, divided into fixed pieces.
class HistoryPass {
 public:
  // Handles samples first ... first + count - 1 of `grid`. At the first sample
  // the run is at rest, or has a start of 1. `operations` are the operations of
  // a visitor's matrix products per sample; they determine the shares. All
  // arguments must outlive the object.
  HistoryPass(const ModalResponse& response,
              const ModalResponse::Contents& contents,
              const IntegrationGrid& grid, Eigen::Index first,
              Eigen::Index count, double operations);

  static int NumPieces(Eigen::Index samples);
  // Returns the piece of a sample, counted from the first sample of the run.
  static int PieceOf(Eigen::Index sample);
  int num_pieces() const { return NumPieces(count_); }
  int Bound(int begin, int end, int index, int count) const {
    return FairBound(begin, end, index, count, skip_share_);
  }

  // Receives the histories of a few consecutive samples, R x samples, which
  // begin `first` samples after that of the run, as from
  // ModalResponse::Advance. A share's calls come in order.
  using Visitor = std::function<void(int share, Eigen::Index first,
                                     const Matrix& histories)>;
  // Visits pieces begin ... end - 1, shared by threads. Each thread computes
  // the state at the beginning of its own pieces. The histories are the same
  // bits for any number of threads. Calls come from several threads at a time.
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
