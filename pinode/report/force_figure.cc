#include <algorithm>

#include "pinode/base/strings.h"
#include "pinode/report/decimate.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"

namespace pinode {
namespace {

// Number of samples of a true force in a panel below which they are drawn as
// dots.
constexpr int kFewSamples = 50;

// Finds the part where a force acts: the middle nine tenths of its energy with
// as much again on both sides. If that is most of the record, an eighth of the
// record around its peak.
void LargestPart(const Vector& force, Eigen::Index* first,
                 Eigen::Index* count) {
  const Eigen::Index size = force.size();
  const double energy = force.squaredNorm();
  Eigen::Index from = 0, to = size - 1, peak = 0;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (std::abs(force[i]) > std::abs(force[peak])) peak = i;
    if (sum < 0.05 * energy) from = i;
    if (sum < 0.95 * energy) to = i;
    sum += force[i] * force[i];
  }
  const Eigen::Index length = to - from + 1;
  const bool short_one = length < size / 3;
  *count = std::min(
      size, std::max<Eigen::Index>(short_one ? 3 * length : size / 8, 40));
  const Eigen::Index middle = short_one ? (from + to) / 2 : peak;
  *first = std::clamp<Eigen::Index>(middle - *count / 2, 0, size - *count);
}

// Returns the true force; nullptr: unknown.
const ForceTruth* TruthOf(const std::string& name,
                          const std::vector<ForceTruth>& truths) {
  const ForceTruth* found = nullptr;
  for (const ForceTruth& truth : truths) {
    if (truth.name == name && truth.times.size() > 0) found = &truth;
  }
  return found;
}

// Draws the whole of a force, and the part where it is largest.
class ForcePlot {
 public:
  ForcePlot(const ForceEstimate& estimate, const ForceTruth* truth,
            const UnitSystem& units, const std::string& id)
      : estimate_(estimate),
        truth_(truth),
        has_band_(estimate.sigma.allFinite()),
        script_(id, 900, 300) {
    script_.Line(
        "set multiplot layout 1,2 margins 0.085,0.985,0.2,0.86 spacing "
        "0.1,0.1");
    script_.Line("set xlabel " + GnuplotString(AxisLabel("time", units.time)));
    script_.Line("set ylabel " +
                 GnuplotString(AxisLabel("force", units.force)));
    std::vector<HistoryRef> others;
    if (has_band_) {
      others.emplace_back(estimate.lower95);
      others.emplace_back(estimate.upper95);
    }
    if (truth != nullptr) others.emplace_back(truth->values);
    const Interval range = VerticalRange(estimate.value, others);
    script_.Line(Range("y", range.low, range.high));
  }

  std::string Draw() {
    Eigen::Index first, part;
    LargestPart(estimate_.value, &first, &part);
    script_.Line("set key at screen 0.985,0.985");
    Plot(0, estimate_.value.size(), true);
    script_.Line("unset key");
    Plot(first, part, false);
    script_.Line("unset multiplot");
    return script_.text();
  }

  // True if the true force is drawn as dots, which the caption has to mention.
  bool has_dots() const { return has_dots_; }

 private:
  void Plot(Eigen::Index from, Eigen::Index size, bool titles) {
    const Vector times = estimate_.times.segment(from, size);
    script_.Line(Range("x", times[0], times[size - 1]));
    std::vector<std::string> curves;
    if (has_band_) {
      curves.push_back(Band(times, estimate_.lower95.segment(from, size),
                            estimate_.upper95.segment(from, size),
                            titles ? "95 % band" : "", &script_));
    }
    if (truth_ != nullptr) AddTruth(times, titles, &curves);
    const Polyline line = DecimateHistory(
        times, estimate_.value.segment(from, size), kHistoryBuckets);
    curves.push_back(Lines(script_.Data({line.x, line.y}), kUpdatedLine,
                           titles ? "identified" : ""));
    script_.Line("plot " + Join(curves, ", "));
  }

  void AddTruth(const Vector& times, bool titles,
                std::vector<std::string>* curves) {
    const Polyline line =
        DecimateHistory(truth_->times, truth_->values, 2 * kHistoryBuckets);
    const double begin = times[0], end = times[times.size() - 1];
    const auto shown = std::count_if(
        truth_->times.begin(), truth_->times.end(),
        [=](double time) { return begin <= time && time <= end; });
    if (!titles && shown < kFewSamples) {
      // Between its samples an impact is not a straight line.
      has_dots_ = true;
      curves->push_back(
          script_.Data({Column(truth_->times), Column(truth_->values)}) +
          " using 1:2 with points pt 7 ps 0.5 lc rgb '#333333' notitle");
    } else if (!line.x.empty()) {
      curves->push_back(Lines(script_.Data({line.x, line.y}), kTrueLine,
                              titles ? "truth" : ""));
    }
  }

  const ForceEstimate& estimate_;
  const ForceTruth* truth_;
  const bool has_band_;
  bool has_dots_ = false;
  FigureScript script_;
};

}  // namespace

Figure MakeForceFigure(const ReportInput& input, int force) {
  Figure figure;
  const ForceEstimate& estimate =
      input.summary->forces.at(static_cast<size_t>(force));
  if (estimate.value.size() < 2 || !estimate.value.allFinite()) return figure;
  const ProblemDescription& description = input.problem->description;
  figure.id = "force_" + std::to_string(force);
  ForcePlot plot(estimate, TruthOf(estimate.name, description.force_truths),
                 description.units, figure.id);
  figure.script = plot.Draw();
  figure.caption =
      estimate.name + ", the force identified in " +
      RecordWithRole(input, estimate.record) + ". Right: its largest part." +
      (plot.has_dots() ? " Dots: the true force at its samples." : "");
  return figure;
}

}  // namespace pinode
