#include "pinode/report/spectra_panels.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/report/gnuplot.h"

namespace pinode {
namespace {

// Panels that stay legible.
constexpr int kMostPanels = 6;

}  // namespace

double Decibels(double density) {
  return density > 0.0 ? 10.0 * std::log10(density) : kNaN;
}

Figure MakeSpectraPanels(
    const std::string& id, const std::vector<std::string>& channels,
    double lowest_hz, double highest_hz, const std::string& caption,
    const std::function<void(int channel, FigureScript* script)>& draw) {
  Figure figure;
  figure.id = id;
  const int num_channels = static_cast<int>(channels.size());
  const int count = std::min(num_channels, kMostPanels);
  const int columns = std::min(count, 2);
  const int rows = (count + columns - 1) / columns;
  FigureScript script(id, 900, 60 + 230 * rows);
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns));
  script.Line("set key outside top right horizontal");
  script.Line("set xlabel 'frequency, Hz'");
  script.Line("set ylabel 'density, dB'");
  script.Line(Range("x", lowest_hz, highest_hz));
  for (int c = 0; c < count; ++c) {
    script.Line("set title " + GnuplotString(channels[static_cast<size_t>(c)]) +
                " offset 0,-0.6");
    draw(c, &script);
    script.Line("unset key");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption = caption;
  if (count < num_channels) figure.caption += " The first channels alone.";
  return figure;
}

}  // namespace pinode
