// Finds faults in the channels of any record.

#ifndef PINODE_RECORD_CHANNEL_FAULTS_H_
#define PINODE_RECORD_CHANNEL_FAULTS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Returns the correlation of two series about their means, over the samples
// that both have (NaN: missing). Returns 0 if one of them is constant there.
double CorrelationOfPresent(const Vector& a, const Vector& b);

// Returns the reason why a channel cannot be used: an infinite sample, or
// samples that are all alike or missing. The phrase follows the channel's name.
// Empty: usable.
std::string WhyChannelIsUseless(const Vector& values);

// Returns the faults of sensors, one sentence each: a channel that repeats its
// values, one that is clipped at its range, several equal samples far from all
// others (see FindOutliers()), or two equal channels. `samples`: channels x
// samples.
std::vector<std::string> FindChannelFaults(
    const std::vector<std::string>& channels, const Matrix& samples);

}  // namespace pinode

#endif  // PINODE_RECORD_CHANNEL_FAULTS_H_
