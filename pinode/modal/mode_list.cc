#include "pinode/modal/mode_list.h"

#include <algorithm>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/harmonics.h"
#include "pinode/modal/mode_estimate.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/record/resample.h"

namespace pinode {

void Standardise(Matrix* samples, Vector* scales) {
  scales->resize(samples->rows());
  for (Eigen::Index c = 0; c < samples->rows(); ++c) {
    const Vector values = samples->row(c);
    const double sigma = StandardDeviationOfPresent(values);
    (*scales)[c] = sigma > 0.0 ? sigma : 1.0;
    samples->row(c) = (values.array() - MeanOfPresent(values)) / (*scales)[c];
  }
}

Matrix Halved(const Matrix& samples, double step) {
  Matrix result;
  for (Eigen::Index c = 0; c < samples.rows(); ++c) {
    const Vector values = Resample(samples.row(c), step, 2.0 * step);
    if (c == 0) result.resize(samples.rows(), values.size());
    result.row(c) = values.transpose();
  }
  return result;
}

bool IsInside(const SubspacePole& pole, const AnalysedBand& band) {
  return pole.frequency() >= band.lowest_hz &&
         pole.frequency() <= band.highest_hz;
}

std::vector<int> AddPoles(const std::vector<SubspacePole>& poles,
                          double window_seconds, AnalysedBand* band) {
  std::vector<int> places;
  for (const SubspacePole& pole : poles) {
    if (!IsInside(pole, *band)) {
      places.push_back(-1);
      continue;
    }
    places.push_back(static_cast<int>(band->poles.size()));
    band->poles.push_back({pole.order, pole.frequency(),
                           FindPoleSigmas(pole, window_seconds).frequency,
                           pole.damping_ratio(), -1});
  }
  return places;
}

void ModeList::MarkHarmonic(const RecordAtRate& level, const SubspacePole& pole,
                            IdentifiedMode* mode) {
  if (mode->damping_lower95 > 0.0) return;
  const NarrowBand narrow =
      FindNarrowBand(level.samples, level.step, pole.shape, pole.frequency());
  mode->is_harmonic = IsSine(narrow);
  if (!mode->is_harmonic) return;
  result_.remarks.push_back(
      "The vibration at " + FormatNumber(mode->frequency_hz, 5) +
      " Hz is a harmonic, not a mode. Its amplitude is constant (kurtosis " +
      FormatNumber(narrow.kurtosis, 3) +
      "; a sine has 1.5, random vibration 3) and its damping may be zero. To "
      "keep it, set harmonics = true in [modes].");
}

void ModeList::Finish() {
  std::sort(found_.begin(), found_.end(), [](const Entry& a, const Entry& b) {
    return a.mode.frequency_hz < b.mode.frequency_hz;
  });
  std::vector<Entry> kept;
  for (Entry& next : found_) {
    bool is_new = true;
    for (Entry& other : kept) {
      if (other.band == next.band || !IsSameMode(other.mode, next.mode)) {
        continue;
      }
      is_new = false;
      if (next.sigma < other.sigma) {
        other = next;
      }
      break;
    }
    if (is_new) kept.push_back(std::move(next));
  }
  for (size_t i = 0; i < kept.size(); ++i) {
    for (const auto& [band, member] : kept[i].members) {
      result_.bands[static_cast<size_t>(band)]
          .poles[static_cast<size_t>(member)]
          .mode = static_cast<int>(i);
    }
    result_.modes.push_back(std::move(kept[i].mode));
  }
}

}  // namespace pinode
