// Samples of measured loads and responses that no sensor in order gives.

#ifndef PINODE_RECORD_SAMPLE_FAULTS_H_
#define PINODE_RECORD_SAMPLE_FAULTS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A column of a record, as it came.
struct WatchedSignal {
  enum class Kind { kResponse, kLoad, kCovariate };

  std::string label;  // "channel a3", "ground x"
  std::string unit;   // "1": none is named
  Kind kind = Kind::kResponse;
  Vector values;  // NaN: missing
};

// Samples that are not of the others' kind.
struct Outliers {
  std::vector<Eigen::Index> samples;  // ascending; empty: there are none
  // By how much the least of them is further out than all others.
  double ratio = 0.0;
  // All have one value, as what stands for missing samples has.
  bool alike = false;
};

// A few samples (ten, or a thousandth, at most; in any number those that have
// all the same value) that are four times as far from the median as every
// other sample; else single ones that are four times as far from what is around
// them. Neither a load with blows nor a decay has such: on the way to its peak
// and back there are others, or there is nothing but noise beside it.
Outliers FindOutliers(const Vector& values);

// What is wrong with the signals of a forced record, one sentence or two each:
// outliers, a response that hangs, is read too rarely, is cut off at its range,
// or is another one once more. Blows are told from bad samples by what the rest
// of the record does then: a load's outlier that responses follow is a blow,
// and so is a response's in the middle of one. Loads may stand still or at
// their limits. Sample k is at start_time + k * step, in `time_unit`.
std::vector<std::string> FindSampleFaults(
    const std::vector<WatchedSignal>& signals, double start_time, double step,
    const std::string& time_unit);

}  // namespace pinode

#endif  // PINODE_RECORD_SAMPLE_FAULTS_H_
