// Finds samples of measured loads and responses that a working sensor does not
// produce.

#ifndef PINODE_RECORD_SAMPLE_FAULTS_H_
#define PINODE_RECORD_SAMPLE_FAULTS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A column of a record, unprocessed.
struct WatchedSignal {
  enum class Kind { kResponse, kLoad, kCovariate };

  std::string label;  // "channel a3", "ground x"
  std::string unit;   // "1": none is named
  Kind kind = Kind::kResponse;
  Vector values;  // NaN: missing
};

// Samples that differ in kind from the others.
struct Outliers {
  std::vector<Eigen::Index> samples;  // ascending; empty: there are none
  // Smallest distance of an outlier, relative to the largest distance of the
  // other samples.
  double ratio = 0.0;
  // True if all outliers have one value, like a code for missing samples.
  bool alike = false;
};

// Finds a few samples that are four times as far from the median as every other
// sample. A few means at most ten or a thousandth, or any number if all have
// the same value. If there are none, finds single samples that are four times
// as far from their neighbourhood. Neither a load with blows nor a decay has
// such samples: they have neighbours on the way to the peak and back, or only
// noise beside them.
Outliers FindOutliers(const Vector& values);

// Returns the faults in the signals of a forced record, one or two sentences
// each. Faults are outliers, and a response that hangs, is sampled too rarely,
// is clipped at its range, or repeats another one. The rest of the record
// separates blows from bad samples. A load's outlier that responses follow is a
// blow, and so is a response's outlier in the middle of one. Loads may stand
// still or stay at their limits. Sample k is at start_time + k * step, in
// `time_unit`.
std::vector<std::string> FindSampleFaults(
    const std::vector<WatchedSignal>& signals, double start_time, double step,
    const std::string& time_unit);

}  // namespace pinode

#endif  // PINODE_RECORD_SAMPLE_FAULTS_H_
