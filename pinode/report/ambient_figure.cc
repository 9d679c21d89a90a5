#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/gnuplot.h"

namespace pinode {
namespace {

constexpr int kMostChannels = 6;

// In dB.
Vector Level(const Vector& densities) {
  return densities.unaryExpr([](double value) {
    return value > 0.0 ? 10.0 * std::log10(value) : NAN;
  });
}

// One panel.
void DrawChannel(const AmbientScore& score, int channel, double hz,
                 bool is_first, FigureScript* script) {
  const Vector frequencies = hz * score.frequencies;
  const Vector measured = Level(score.measured.row(channel).transpose() / hz);
  const Vector modelled = Level(score.modelled.row(channel).transpose() / hz);
  // The mean of n squares of complex normal numbers fluctuates by 1 / sqrt(n).
  const Vector width =
      score.lines.cwiseMax(1.0).cwiseSqrt().cwiseInverse() * 1.96;
  const Vector factor_up = (1.0 + width.array()).log10() * 10.0;
  const Vector factor_down = (1.0 - width.array()).max(0.05).log10() * 10.0;
  script->Line("set title " +
               GnuplotString(score.channels[static_cast<size_t>(channel)]) +
               " offset 0,-0.6");
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
  script->Line("unset key");
}

}  // namespace

Figure MakeAmbientFigure(const ReportInput& input, int record) {
  Figure figure;
  const AmbientScore& score =
      input.summary->ambient[static_cast<size_t>(record)];
  const int count =
      std::min(static_cast<int>(score.channels.size()), kMostChannels);
  if (count == 0 || score.frequencies.size() < 2) return figure;
  figure.id = "ambient" + std::to_string(record);
  const int columns = std::min(count, 2);
  const int rows = (count + columns - 1) / columns;
  FigureScript script(figure.id, 900, 60 + 230 * rows);
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns));
  script.Line("set key outside top right horizontal");
  script.Line("set xlabel 'frequency, Hz'");
  script.Line("set ylabel 'density, dB'");
  const double hz = input.problem->description.HzPerModelFrequency();
  script.Line(
      Range("x", hz * score.lowest_frequency, hz * score.highest_frequency));
  for (int c = 0; c < count; ++c) {
    DrawChannel(score, c, hz, c == 0, &script);
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Record '" + score.name +
      "': spectral densities, means of neighbouring lines, and those of the "
      "model with the band in which 95 % of the measured ones lie if it is "
      "right.";
  if (count < static_cast<int>(score.channels.size())) {
    figure.caption += " The first channels alone.";
  }
  return figure;
}

}  // namespace pinode
