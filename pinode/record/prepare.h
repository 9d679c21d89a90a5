// Small steps that turn a file's columns into a record that can be fitted. In
// all functions NaN means a missing sample.

#ifndef PINODE_RECORD_PREPARE_H_
#define PINODE_RECORD_PREPARE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/record/record.h"

namespace pinode {

// A run of missing samples, first .. first + size - 1.
struct Gap {
  Eigen::Index first = 0;
  Eigen::Index size = 0;
};
std::vector<Gap> FindGaps(const Vector& values);

// Subtracts the mean and returns it (0 if all samples are missing).
double RemoveOffset(Vector* values);

// Returns the values with each gap filled by a straight line. Gaps at the ends
// get the nearest sample. At least one sample must be present.
Vector FillMissing(const Vector& values);

// Sets to missing in *values the samples that are missing in `pattern`. Use it
// after FillMissing() and a filter.
void CopyMissing(const Vector& pattern, Vector* values);

// Converts a channel to the model's unit of `dimension` and multiplies it by
// `sign` (+1 or -1: a sensor mounted upside down). Returns false, with the
// channel unchanged, if its unit is not one of that dimension.
[[nodiscard]] bool ConvertChannel(Dimension dimension, const UnitSystem& system,
                                  int sign, Channel* channel,
                                  std::string* error);

// Selects the samples of `record` with from <= t <= to. A sample just outside
// by rounding counts as inside. Returns false if the window is reversed,
// exceeds the record by more than one step, or holds fewer than two samples.
[[nodiscard]] bool SelectWindow(const Record& record, double from, double to,
                                Record* window, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_PREPARE_H_
