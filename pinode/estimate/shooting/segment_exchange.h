// What ranks have found of different segments, made known to all.

#ifndef PINODE_ESTIMATE_SHOOTING_SEGMENT_EXCHANGE_H_
#define PINODE_ESTIMATE_SHOOTING_SEGMENT_EXCHANGE_H_

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/estimate/shooting/shooting_record.h"

namespace pinode {

// The results and ends of segments, (record, segment), each of which its owner,
// a rank, has evaluated, with (done) or without success; -1: nobody has.
// Afterwards all ranks have all of them, and all of `done`. num_free: columns
// of their cross products, 0 where the parameters were left out. False where a
// rank does not answer.
[[nodiscard]] bool ExchangeSegments(
    const std::vector<std::unique_ptr<ShootingRecord>>& records,
    const std::vector<std::pair<int, int>>& segments,
    const std::vector<int>& owners, int num_free, Communicator* communicator,
    std::vector<char>* done);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SEGMENT_EXCHANGE_H_
