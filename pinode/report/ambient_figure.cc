#include "pinode/report/figure.h"
#include "pinode/report/spectra_panels.h"

namespace pinode {
namespace {

// Draws one panel.
void DrawChannel(const AmbientScore& score, int channel, double hz,
                 FigureScript* script) {
  const bool is_first = channel == 0;
  const Vector frequencies = hz * score.frequencies;
  const Vector measured =
      (score.measured.row(channel).transpose() / hz).unaryExpr(&Decibels);
  const Vector modelled =
      (score.modelled.row(channel).transpose() / hz).unaryExpr(&Decibels);
  // The mean of n squares of complex normal numbers fluctuates by 1 / sqrt(n).
  const Vector width =
      score.lines.cwiseMax(1.0).cwiseSqrt().cwiseInverse() * 1.96;
  const Vector factor_up = (1.0 + width.array()).log10() * 10.0;
  const Vector factor_down = (1.0 - width.array()).max(0.05).log10() * 10.0;
  Interval range;
  range.Add(modelled);
  script->Line(Range("y", range.low - 12.0, range.high + 8.0));
  const std::string band =
      Band(frequencies, modelled + factor_down, modelled + factor_up,
           is_first ? "95 %" : "", script);
  const std::string points =
      script->Data({Column(frequencies), Column(measured)});
  const std::string line =
      script->Data({Column(frequencies), Column(modelled)});
  script->Line("plot " + band + ", " +
               Lines(points, kFaintLine, is_first ? "measured" : "") + ", " +
               Lines(line, kUpdatedLine, is_first ? "model" : ""));
}

}  // namespace

Figure MakeAmbientFigure(const ReportInput& input, int record) {
  const AmbientScore& score =
      input.summary->ambient[static_cast<size_t>(record)];
  if (score.channels.empty() || score.frequencies.size() < 2) return {};
  const double hz = input.problem->description.HzPerModelFrequency();
  return MakeSpectraPanels(
      "ambient" + std::to_string(record), score.channels,
      hz * score.lowest_frequency, hz * score.highest_frequency,
      "Record '" + score.name +
          (score.by_measured_loads.size() > 0
               ? "' without the response to the measured loads"
               : "'") +
          ": spectral densities (means of neighbouring lines), measured and of "
          "the model. The band holds 95 % of the measured ones if the model is "
          "right.",
      [&](int c, FigureScript* script) { DrawChannel(score, c, hz, script); });
}

}  // namespace pinode
