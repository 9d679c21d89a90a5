// Exchange of the segments' results between ranks.

#ifndef PINODE_ESTIMATE_SHOOTING_SEGMENT_EXCHANGE_H_
#define PINODE_ESTIMATE_SHOOTING_SEGMENT_EXCHANGE_H_

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/estimate/shooting/shooting_record.h"

namespace pinode {

// Gives all ranks the results and ends of all segments, (record, segment), and
// all of `done`. The rank owners[i] has evaluated segment i, with (done) or
// without success; -1: no rank has. num_free: rows of the segments' cross
// products, 0 where the parameters were left out. False where a rank does not
// answer.
[[nodiscard]] bool ExchangeSegments(
    const std::vector<std::unique_ptr<ShootingRecord>>& records,
    const std::vector<std::pair<int, int>>& segments,
    const std::vector<int>& owners, int num_free, Communicator* communicator,
    std::vector<char>* done);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SEGMENT_EXCHANGE_H_
