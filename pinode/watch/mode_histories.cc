#include "pinode/watch/mode_histories.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/watch/assignment.h"
#include "pinode/watch/channel_shape.h"

namespace pinode {
namespace {

// Cost above which a mode begins a history rather than joins one. A mode at the
// limit of both frequency and shape would cost 2.
constexpr double kCostOfBirth = 1.5;
// The recent mean of a history follows its last ten modes.
constexpr double kLeastWeight = 0.1;
// Histories of few modes end when they were not seen for some time: poles of
// noise begin many.
constexpr int kFewModes = 10;
constexpr int kLongAbsence = 100;  // records

// History while it is made.
struct Recent {
  double log_frequency = 0.0;
  double sigma = 0.0;  // of log_frequency, of a typical mode
  ChannelShape shape;
  int count = 0;
  int last_record = 0;
};

class Joiner {
 public:
  explicit Joiner(const TrackingOptions& options) : options_(options) {}

  void Add(int number, const StoredRecord& record) {
    std::vector<int> alive;
    for (size_t h = 0; h < recent_.size(); ++h) {
      if (recent_[h].count >= kFewModes ||
          number - recent_[h].last_record <= kLongAbsence) {
        alive.push_back(static_cast<int>(h));
      }
    }
    const Eigen::Index num_modes =
        static_cast<Eigen::Index>(record.modes.size());
    const Eigen::Index num_alive = static_cast<Eigen::Index>(alive.size());
    std::vector<ChannelShape> shapes;
    for (const StoredMode& mode : record.modes) {
      shapes.push_back(ShapeOf(record, mode));
    }
    // One more column for each mode: the birth of a history.
    Matrix costs =
        Matrix::Constant(num_modes, num_alive + num_modes, kCostOfBirth);
    for (Eigen::Index m = 0; m < num_modes; ++m) {
      for (Eigen::Index h = 0; h < num_alive; ++h) {
        costs(m, h) =
            Cost(record.modes[static_cast<size_t>(m)],
                 shapes[static_cast<size_t>(m)],
                 recent_[static_cast<size_t>(alive[static_cast<size_t>(h)])]);
      }
    }
    const std::vector<int> columns = AssignRows(costs);
    for (size_t m = 0; m < record.modes.size(); ++m) {
      int history = static_cast<int>(recent_.size());
      if (columns[m] < num_alive) {
        history = alive[static_cast<size_t>(columns[m])];
      } else {
        recent_.emplace_back();
        histories_.emplace_back();
      }
      histories_[static_cast<size_t>(history)].points.push_back(
          {number, static_cast<int>(m)});
      Update(record.modes[m], shapes[m], number,
             &recent_[static_cast<size_t>(history)]);
    }
  }

  std::vector<ModeHistory> Take() { return std::move(histories_); }

 private:
  // Cost of joining; beyond that of a birth if it is not allowed.
  double Cost(const StoredMode& mode, const ChannelShape& shape,
              const Recent& recent) const {
    constexpr double kForbidden = 1e6;
    const double sigma = mode.frequency_sigma / mode.frequency_hz;
    const double scale =
        std::sqrt(options_.largest_step * options_.largest_step +
                  9.0 * (sigma * sigma + recent.sigma * recent.sigma));
    const double step =
        (std::log(mode.frequency_hz) - recent.log_frequency) / scale;
    if (std::abs(step) > 1.0) return kForbidden;
    const double mac = ShapeProducts(recent.shape, shape).Mac();
    if (mac < options_.least_mac) return kForbidden;
    return step * step + (1.0 - mac) / (1.0 - options_.least_mac);
  }

  static void Update(const StoredMode& mode, const ChannelShape& shape,
                     int number, Recent* recent) {
    ++recent->count;
    recent->last_record = number;
    const double weight = std::max(kLeastWeight, 1.0 / recent->count);
    recent->log_frequency +=
        weight * (std::log(mode.frequency_hz) - recent->log_frequency);
    recent->sigma +=
        weight * (mode.frequency_sigma / mode.frequency_hz - recent->sigma);
    // Shapes have no scale and no phase: take those of the history.
    const ShapeProducts products(recent->shape, shape);
    std::complex<double> factor = 1.0;
    if (std::abs(products.ab) > 0.0) {
      factor = std::sqrt(products.aa / products.bb) * std::conj(products.ab) /
               std::abs(products.ab);
    }
    for (const auto& [name, value] : shape) {
      auto [place, is_new] = recent->shape.emplace(name, factor * value);
      if (!is_new) place->second += weight * (factor * value - place->second);
    }
  }

  const TrackingOptions& options_;
  std::vector<Recent> recent_;
  std::vector<ModeHistory> histories_;
};

}  // namespace

std::vector<ModeHistory> JoinModes(const std::vector<StoredRecord>& records,
                                   const TrackingOptions& options) {
  Joiner joiner(options);
  for (size_t r = 0; r < records.size(); ++r) {
    joiner.Add(static_cast<int>(r), records[r]);
  }
  return joiner.Take();
}

}  // namespace pinode
