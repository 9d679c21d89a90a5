#include <algorithm>
#include <cmath>
#include <optional>

#include "pinode/base/strings.h"
#include "pinode/report/decimate.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Number of points per curve, so that no figure exceeds 150 KiB.
constexpr int kCloseUpBuckets = 200;

// Finds samples [first, first + count) around the largest fluctuation: some six
// periods of the first mode.
void StrongestPart(const ReportInput& input, const Vector& values, double step,
                   Eigen::Index* first, Eigen::Index* count) {
  const Eigen::Index size = values.size();
  double mean = 0.0, present = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    mean += value;
    present += 1.0;
  }
  mean = present > 0.0 ? mean / present : 0.0;
  Eigen::Index peak = 0;
  double largest = -1.0;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (std::abs(values(i) - mean) > largest) {
      largest = std::abs(values(i) - mean);
      peak = i;
    }
  }
  double wanted = static_cast<double>(size) / 8.0;
  const std::vector<ModePair>& modes = input.prior.modes;
  // Frequency and step are both in the model's time.
  const double frequency = modes.empty() ? 0.0 : modes[0].updated_frequency;
  if (frequency > 0.0) wanted = 6.0 / (frequency * step);
  *count = static_cast<Eigen::Index>(
      std::clamp(wanted, std::min(60.0, static_cast<double>(size)),
                 std::max(60.0, static_cast<double>(size) / 3.0)));
  *count = std::min(*count, size);
  // A free decay is seen best after its peak.
  *first = std::clamp<Eigen::Index>(peak - *count / 3, 0, size - *count);
}

// Half-width of the band of measurements about a prediction, in standard
// deviations.
constexpr double kBandDeviations = 1.96;

// Three panels of a simulated channel.
class ChannelPlot {
 public:
  ChannelPlot(const ReportInput& input, int record, int channel,
              const HistoryRef& prior)
      : input_(input),
        record_(input.problem->records.at(static_cast<size_t>(record))),
        score_(input.summary->records.at(static_cast<size_t>(record))),
        measured_(record_.channels.at(static_cast<size_t>(channel))),
        unit_(ChannelUnit(input, record, channel)),
        num_samples_(record_.num_samples()),
        updated_(score_.prediction.row(channel).transpose()),
        script_(
            "channel_" + std::to_string(record) + "_" + std::to_string(channel),
            900, 400) {
    if (prior.size() == num_samples_) prior_.emplace(prior);
    if (channel < static_cast<int>(score_.channels.size())) {
      sigma_ = score_.channels[static_cast<size_t>(channel)].sigma;
    }
    if (score_.deviations.rows() > channel &&
        score_.deviations.cols() == num_samples_ &&
        score_.deviations.row(channel).allFinite()) {
      half_band_ = kBandDeviations * score_.deviations.row(channel);
    }
  }

  std::string Draw() {
    script_.Line("set multiplot");
    DrawWhole();
    DrawStrongestPart();
    DrawResidual();
    script_.Line("unset multiplot");
    return script_.text();
  }

  bool HasBand() const { return half_band_.size() > 0; }
  bool HasSigma() const { return std::isfinite(sigma_) && sigma_ > 0.0; }

 private:
  double Time(Eigen::Index sample) const {
    return record_.excitation->time(sample);
  }

  // Draws the upper panel.
  void DrawWhole() {
    script_.Line("set lmargin at screen 0.085");
    script_.Line("set rmargin at screen 0.985");
    script_.Line("set tmargin at screen 0.925");
    script_.Line("set bmargin at screen 0.575");
    script_.Line("set key at screen 0.985,0.985");
    script_.Line("set ylabel " +
                 GnuplotString(AxisLabel(measured_.observation.name, unit_)));
    std::vector<HistoryRef> predictions = {updated_};
    if (prior_.has_value()) predictions.push_back(*prior_);
    const Interval range = VerticalRange(measured_.values, predictions);
    script_.Line(Range("y", range.low, range.high));
    script_.Line(Range("x", Time(0), Time(num_samples_ - 1)));
    const std::vector<std::string> curves =
        AddCurves(0, num_samples_, kHistoryBuckets, true);
    const Eigen::Index scored = score_.first_scored_sample;
    if (scored > 0 && scored < num_samples_) {
      const std::string at = ScriptNumber(Time(scored));
      script_.Line("set arrow 1 from " + at + ", graph 0 to " + at +
                   ", graph 1 nohead " + kFaintLine);
      script_.Line("set label 1 ' scored from here' at " + at +
                   ", graph 0.04 tc rgb '#555555'");
    }
    Plot(curves);
    script_.Line("unset arrow");
    script_.Line("unset label");
  }

  // Draws the lower left panel.
  void DrawStrongestPart() {
    Eigen::Index first, count;
    StrongestPart(input_, measured_.values, record_.sampling_step(), &first,
                  &count);
    script_.Line("unset key");
    script_.Line("set rmargin at screen 0.49");
    script_.Line("set tmargin at screen 0.49");
    script_.Line("set bmargin at screen 0.145");
    script_.Line("set xlabel " +
                 GnuplotString(AxisLabel(
                     "time", input_.problem->description.units.time)));
    script_.Line(Range("x", Time(first), Time(first + count - 1)));
    std::vector<std::string> curves =
        AddCurves(first, count, kCloseUpBuckets, false);
    if (HasBand()) {
      const Vector prediction = updated_.segment(first, count);
      const Vector half = half_band_.segment(first, count);
      curves.insert(
          curves.begin(),
          Band(Vector::LinSpaced(count, Time(first), Time(first + count - 1)),
               prediction - half, prediction + half, "", &script_));
    }
    Plot(curves);
  }

  // Draws the lower right panel.
  void DrawResidual() {
    const Vector residual = measured_.values - updated_;
    script_.Line("set lmargin at screen 0.6");
    script_.Line("set rmargin at screen 0.985");
    script_.Line("set ylabel " + GnuplotString(AxisLabel("residual", unit_)));
    script_.Line(Range("x", Time(0), Time(num_samples_ - 1)));
    Interval range;
    range.Add(residual);
    range.Add(2.5 * sigma_);
    range.Add(-2.5 * sigma_);
    script_.Line(Range("y", range.low, range.high));
    std::vector<std::string> curves;
    const Polyline line = DecimateHistory(Time(0), record_.sampling_step(),
                                          residual, kHistoryBuckets);
    if (!line.x.empty()) {
      curves.push_back(Lines(script_.Data({line.x, line.y}), kUpdatedLine, ""));
    }
    if (HasSigma()) {
      for (const double side : {-2.0 * sigma_, 2.0 * sigma_}) {
        curves.push_back(ScriptNumber(side) + " with lines " + kMark +
                         " lw 1 dt (3,3) notitle");
      }
    }
    Plot(curves);
  }

  // Adds the initial model first, so that it lies below the more important
  // curves.
  std::vector<std::string> AddCurves(Eigen::Index from, Eigen::Index size,
                                     int buckets, bool titles) {
    std::vector<std::string> curves;
    const auto add = [&](const HistoryRef& values, const char* style,
                         const char* title) {
      const Polyline line =
          DecimateHistory(Time(from), record_.sampling_step(),
                          values.segment(from, size), buckets);
      if (line.x.empty()) return;
      curves.push_back(
          Lines(script_.Data({line.x, line.y}), style, titles ? title : ""));
    };
    if (prior_.has_value()) add(*prior_, kPriorLine, "initial model");
    add(measured_.values, kMeasuredLine, "measured");
    add(updated_, kUpdatedLine, "updated model");
    return curves;
  }

  // Plots the curves; axes are drawn also without finite values.
  void Plot(const std::vector<std::string>& curves) {
    script_.Line(curves.empty() ? "plot NaN notitle"
                                : "plot " + Join(curves, ", "));
  }

  const ReportInput& input_;
  const IdentificationRecord& record_;
  const RecordScore& score_;
  const MeasuredChannel& measured_;
  const std::string unit_;
  const Eigen::Index num_samples_;
  const HistoryRef updated_;
  std::optional<HistoryRef> prior_;
  Vector half_band_;  // empty: not known
  double sigma_ = 0.0;
  FigureScript script_;
};

}  // namespace

Figure MakeChannelFigure(const ReportInput& input, int record, int channel,
                         const HistoryRef& prior) {
  Figure figure;
  const size_t r = static_cast<size_t>(record);
  const IdentificationRecord& data = input.problem->records.at(r);
  const std::string& name =
      data.channels.at(static_cast<size_t>(channel)).observation.name;
  if (r >= input.summary->records.size()) return figure;
  const RecordScore& score = input.summary->records[r];
  if (score.prediction.rows() <= channel ||
      score.prediction.cols() != data.num_samples() || data.num_samples() < 2) {
    return figure;
  }
  figure.id =
      "channel_" + std::to_string(record) + "_" + std::to_string(channel);
  ChannelPlot plot(input, record, channel, prior);
  figure.script = plot.Draw();

  figure.caption = name + " in " + RecordWithRole(input, record);
  if (channel < static_cast<int>(score.channels.size())) {
    const ChannelScore& scored = score.channels[static_cast<size_t>(channel)];
    figure.caption += ", error " + ReadableNumber(100.0 * scored.nrmse, 3) +
                      " %, initial model " +
                      ReadableNumber(100.0 * scored.prior_nrmse, 3) + " %";
  }
  figure.caption +=
      ". Top: whole record. Bottom left: its strongest part. Bottom right: "
      "residual (measured minus updated model).";
  if (plot.HasBand()) {
    figure.caption += " Shaded: 95 % of measurements are expected here.";
  }
  if (plot.HasSigma()) {
    figure.caption += " Dashed: \u00b12\u03c3 of the noise.";
  }
  return figure;
}

}  // namespace pinode
