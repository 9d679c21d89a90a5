// Small steps between a file's columns and a record that can be fitted.
// Everything here knows that NaN means a missing sample.

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

// Subtracts the mean, which is returned (0 where nothing is present).
double RemoveOffset(Vector* values);

// A straight line across each gap, the nearest sample before the first and
// after the last. At least one sample is present.
Vector FillMissing(const Vector& values);

// Makes missing in *values what is missing in `pattern`. The way back after
// FillMissing() and a filter.
void CopyMissing(const Vector& pattern, Vector* values);

// Converts a channel to the model's unit of `dimension` and multiplies it by
// `sign` (+1 or -1: a sensor mounted upside down). False, with the channel
// untouched, if its unit is not one of that dimension.
[[nodiscard]] bool ConvertChannel(Dimension dimension, const UnitSystem& system,
                                  int sign, Channel* channel,
                                  std::string* error);

// The samples of `record` with from <= t <= to; a sample that rounding puts
// just outside counts as inside. False if the window is reversed, reaches
// beyond the record by more than one step, or holds fewer than two samples.
[[nodiscard]] bool SelectWindow(const Record& record, double from, double to,
                                Record* window, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_PREPARE_H_
