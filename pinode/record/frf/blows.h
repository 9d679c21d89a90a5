// Finds the blows of a hammer in records of its force.

#ifndef PINODE_RECORD_FRF_BLOWS_H_
#define PINODE_RECORD_FRF_BLOWS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Forces and responses that were sampled together.
struct ForcedRecord {
  std::string name;
  double sampling_step = 0.0;  // s
  Matrix forces;               // references x samples
  Matrix responses;            // responses x samples
};

// Piece of a record that is transformed as a whole.
struct FrfBlock {
  size_t record = 0;
  Eigen::Index first = 0;
  // Sample after the last one of the blow, from `first` on. 0: no blow.
  Eigen::Index pulse_end = 0;
};

struct BlowSearch {
  std::vector<FrfBlock> blocks;
  Eigen::Index block_samples = 0;
  // Samples from any blow to the next one in `blocks`, the fewest; 0: there is
  // none before.
  Eigen::Index shortest_rest = 0;
  // One sentence for each kind of blow that was left out, and for blocks that
  // are too short for the vibration.
  std::vector<std::string> remarks;
};

// Returns true if forces act in a few short pulses and rest between them.
bool HasBlows(const std::vector<ForcedRecord>& records);

// Finds the blows, and a block for each. `block_samples`: length of the blocks;
// 0: up to the next blow or the end of the record. A blow is left out if the
// hammer hits again within its block (5 % of the peak or more), if its force or
// a response is cut off at the range of the instrument (a plateau, or the same
// largest force as another blow), or if its block is not
// complete or ends before the blow does. `decay_per_sample`: of the exponential
// window, 0 without it; it serves the remark on short blocks. Fails with a
// sentence if no blow is left.
[[nodiscard]] bool FindBlows(const std::vector<ForcedRecord>& records,
                             Eigen::Index block_samples,
                             double decay_per_sample, BlowSearch* search,
                             std::string* error);

// Returns the largest number of samples, at most `samples`, whose prime factors
// are 2, 3 and 5: fast to transform.
Eigen::Index FastLength(Eigen::Index samples);

}  // namespace pinode

#endif  // PINODE_RECORD_FRF_BLOWS_H_
