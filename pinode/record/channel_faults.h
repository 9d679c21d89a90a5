// What is wrong with the channels of a record, whoever looks at them.

#ifndef PINODE_RECORD_CHANNEL_FAULTS_H_
#define PINODE_RECORD_CHANNEL_FAULTS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Correlation of two series about their means, over the samples that both have
// (NaN: missing); 0 where one of them is constant there.
double CorrelationOfPresent(const Vector& a, const Vector& b);

// What a channel is that nothing can be done with: one with an infinite sample,
// or whose samples are all alike or missing. A phrase that follows its name;
// empty: none of this.
std::string WhyChannelIsUseless(const Vector& values);

// What is wrong with sensors, a sentence each: a channel that says the same
// over and over, one that is cut off at its range, two that are one. `samples`:
// channels x samples.
std::vector<std::string> FindChannelFaults(
    const std::vector<std::string>& channels, const Matrix& samples);

}  // namespace pinode

#endif  // PINODE_RECORD_CHANNEL_FAULTS_H_
