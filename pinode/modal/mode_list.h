// Modes of a record as they are found at several sampling rates.

#ifndef PINODE_MODAL_MODE_LIST_H_
#define PINODE_MODAL_MODE_LIST_H_

#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Record at one of its sampling rates.
struct RecordAtRate {
  double step = 0.0;
  Matrix samples;  // channels x samples, mean zero, standard deviation 1
  Vector scales;   // standard deviations that they were divided by
  Matrix inputs;   // measured loads, scaled likewise
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
};

// Subtracts the mean of each channel and divides by its standard deviation,
// which becomes its scale.
void Standardise(Matrix* samples, Vector* scales);

// Returns samples at half their sampling rate.
Matrix Halved(const Matrix& samples, double step);

bool IsInside(const SubspacePole& pole, const AnalysedBand& band);

// Adds the poles inside of the band to it. Returns their places there, -1 for
// those outside.
std::vector<int> AddPoles(const std::vector<SubspacePole>& poles,
                          double window_seconds, AnalysedBand* band);

// List of modes in the making. `result` must outlive it.
class ModeList {
 public:
  struct Entry {
    IdentifiedMode mode;
    int band = 0;
    std::vector<std::pair<int, int>> members;  // bands, and poles there
    double sigma = 0.0;  // of the frequency, before it respects a bound
  };

  explicit ModeList(ModesOfRecord* result) : result_(*result) {}

  bool empty() const { return found_.empty(); }
  // Marks a mode whose damping may be zero and whose amplitude is constant as a
  // harmonic, with a remark.
  void MarkHarmonic(const RecordAtRate& level, const SubspacePole& pole,
                    IdentifiedMode* mode);
  void Add(Entry entry) { found_.push_back(std::move(entry)); }
  // Moves the modes into the result, by frequency. Where two rates found the
  // same mode the more certain estimate is kept.
  void Finish();

 private:
  ModesOfRecord& result_;
  std::vector<Entry> found_;
};

}  // namespace pinode

#endif  // PINODE_MODAL_MODE_LIST_H_
