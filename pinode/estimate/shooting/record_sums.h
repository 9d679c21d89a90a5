// Sums over the samples of a record in one piece.

#ifndef PINODE_ESTIMATE_SHOOTING_RECORD_SUMS_H_
#define PINODE_ESTIMATE_SHOOTING_RECORD_SUMS_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Sums over samples of histories Z (R x samples) and of the channels' residuals
// r_c.
struct RecordSums {
  Vector costs;                  // 1/2 r_c' r_c of each channel
  std::vector<Matrix> grams;     // of each pattern, lower triangles; R x R
  Matrix products;               // Z r_c, R x channels
  std::vector<Matrix> hessians;  // where the Jacobian's rows are summed
  Vector end;  // the last histories, zero where they are others' to sum
};

// Sums over a share's pieces to twice the digits. A piece's own sum is the same
// for any number of threads, and so is that of all.
class PieceSums {
 public:
  // Sizes are those of `zero`.
  explicit PieceSums(const RecordSums& zero)
      : piece_(zero), sum_(zero), rest_(zero) {}

  RecordSums* piece() { return &piece_; }
  // Adds the piece to the others, and begins the next.
  void Close();
  void Add(PieceSums* other);
  // Hands over the sum of all pieces; nothing is left here.
  RecordSums Take();

 private:
  void Add(RecordSums* term);

  RecordSums piece_, sum_, rest_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_RECORD_SUMS_H_
