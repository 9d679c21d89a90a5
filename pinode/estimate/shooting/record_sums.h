// Sums over the samples of a record in one piece.

#ifndef PINODE_ESTIMATE_SHOOTING_RECORD_SUMS_H_
#define PINODE_ESTIMATE_SHOOTING_RECORD_SUMS_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Of histories Z (R x samples) and the channels' residuals r_c over them.
struct RecordSums {
  Vector costs;                  // of each channel, 1/2 r_c' r_c
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
  // Of all; there is nothing left here.
  RecordSums Take();

 private:
  void Add(RecordSums* term);

  RecordSums piece_, sum_, rest_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_RECORD_SUMS_H_
