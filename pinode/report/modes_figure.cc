#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/spectra.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/gnuplot.h"
#include "pinode/report/modes_report.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Curves of singular values, and poles of a diagram that keep the page small.
constexpr int kSingularValues = 3;
constexpr size_t kMostPoles = 2500;

// Returns the poles of modes, or all others.
std::vector<std::vector<double>> Poles(const ModesOfRecord& modes,
                                       bool of_modes) {
  std::vector<std::vector<double>> columns(2);
  for (const AnalysedBand& band : modes.bands) {
    for (const DiagramPole& pole : band.poles) {
      if ((pole.mode >= 0) != of_modes) continue;
      columns[0].push_back(pole.frequency_hz);
      columns[1].push_back(pole.order);
    }
  }
  const size_t stride = columns[0].size() / kMostPoles + 1;
  std::vector<std::vector<double>> kept(2);
  for (size_t i = 0; i < columns[0].size(); i += stride) {
    kept[0].push_back(columns[0][i]);
    kept[1].push_back(columns[1][i]);
  }
  return kept;
}

Interval FrequencyRange(const ModesOfRecord& modes) {
  Interval range;
  for (const IdentifiedMode& mode : modes.modes) range.Add(mode.frequency_hz);
  Interval bands;
  for (const AnalysedBand& band : modes.bands) {
    bands.Add(band.lowest_hz);
    bands.Add(band.highest_hz);
  }
  if (range.empty()) return bands;
  range.high = std::min(bands.high, 1.25 * range.high);
  range.low = std::max(0.0, std::min(0.5 * range.low, range.low - 1.0));
  return range;
}

// Returns values in dB; neighbouring lines are drawn as the highest of them.
std::vector<std::vector<double>> SingularLine(const Spectra& spectra, int which,
                                              const Interval& range) {
  std::vector<std::vector<double>> columns(2);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index f = 0; f < spectra.frequency_hz.size(); ++f) {
    if (spectra.frequency_hz[f] >= range.low &&
        spectra.frequency_hz[f] <= range.high) {
      inside.push_back(f);
    }
  }
  const size_t stride = inside.size() / (2 * kHistoryBuckets) + 1;
  for (size_t i = 0; i < inside.size(); i += stride) {
    double largest = 0.0;
    for (size_t k = i; k < std::min(i + stride, inside.size()); ++k) {
      largest = std::max(largest, spectra.singular_values(which, inside[k]));
    }
    columns[0].push_back(spectra.frequency_hz[inside[i]]);
    columns[1].push_back(10.0 * std::log10(std::max(largest, 1e-30)));
  }
  return columns;
}

}  // namespace

Figure MakeStabilisationFigure(const ResponseRecord& record,
                               const ModesOfRecord& modes, int number) {
  Figure figure;
  figure.id = "stabilisation" + std::to_string(number);
  FigureScript script(figure.id, 900, 460);
  const Interval range = FrequencyRange(modes);
  // A record of frequency response functions has no samples.
  const Spectra spectra = record.samples.size() > 0
                              ? EstimateSpectra(record, 0, kSingularValues)
                              : Spectra();
  script.Line("set xlabel 'frequency, Hz'");
  script.Line("set ylabel 'model order'");
  const bool has_spectra = spectra.singular_values.rows() > 0;
  if (has_spectra) {
    script.Line("set y2label 'singular values of the spectra, dB'");
    script.Line("set y2tics nomirror");
    script.Line("set border 11");
  }
  script.Line("set key outside bottom center horizontal");
  script.Line(Range("x", range.low, range.high));
  script.Line("set yrange [0:*]");
  std::vector<std::string> parts;
  const char* const shades[] = {"#888888", "#bbbbbb", "#dddddd"};
  for (int i = 0; i < spectra.singular_values.rows(); ++i) {
    const std::string data = script.Data(SingularLine(spectra, i, range));
    parts.push_back(data + " using 1:2 axes x1y2 with lines lc rgb '" +
                    shades[i] + "' lw 1 " +
                    (i == 0 ? "title 'singular values'" : "notitle"));
  }
  const auto others = Poles(modes, false);
  const auto members = Poles(modes, true);
  if (!others[0].empty()) {
    parts.push_back(script.Data(others) +
                    " using 1:2 with points pt 2 ps 0.35 lc rgb '#E69F00' "
                    "title 'other poles'");
  }
  if (!members[0].empty()) {
    parts.push_back(script.Data(members) +
                    " using 1:2 with points pt 7 ps 0.4 lc rgb '#0072B2' title "
                    "'poles of a mode'");
  }
  script.Line("plot " + Join(parts, ", "));
  figure.script = script.text();
  figure.caption =
      "Stabilisation diagram: each point is a pole of the model of that order, "
      "those in blue are the modes of the table.";
  if (has_spectra) {
    figure.caption +=
        " Behind it the singular values of the spectra of all channels.";
  }
  return figure;
}

Figure MakeIdentifiedShapesFigure(const MergedModes& merged, int most) {
  Figure figure;
  const int places = static_cast<int>(merged.places.size());
  const int count = std::min(static_cast<int>(merged.modes.size()), most);
  if (places < 2 || count == 0) return figure;
  figure.id = "shapes";
  const int columns = std::min(count, 4);
  const int rows = (count + columns - 1) / columns;
  const int width = 225 * columns;
  const int height = 40 + rows * std::clamp(90 + 14 * places, 150, 330);
  FigureScript script(figure.id, width, height);
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns));
  std::vector<std::string> ticks;
  const int every = (places + 19) / 20;
  for (int i = 0; i < places; i += every) {
    ticks.push_back(GnuplotString(merged.places[static_cast<size_t>(i)]) + " " +
                    std::to_string(i + 1));
  }
  script.Line("set ytics (" + Join(ticks, ", ") + ")");
  script.Line(Range("y", 0.5, places + 0.5));
  script.Line("set xrange [-1.25:1.25]");
  script.Line("set xtics -1, 1, 1");
  script.Line("set xzeroaxis");
  script.Line(
      "set arrow from 0, graph 0 to 0, graph 1 nohead lc rgb '#999999'");
  script.Line("unset key");
  for (int m = 0; m < count; ++m) {
    const IdentifiedMode& mode = merged.modes[static_cast<size_t>(m)].mode;
    const double t = StudentQuantile(mode.degrees_of_freedom);
    std::vector<std::vector<double>> data(3);
    for (int i = 0; i < places; ++i) {
      data[0].push_back(mode.shape[i].real());
      data[1].push_back(i + 1);
      data[2].push_back(t * mode.shape_sigma_real[i]);
    }
    script.Line("set title " +
                GnuplotString(std::to_string(m + 1) + ":  " +
                              ReadableNumber(mode.frequency_hz, 4) + " Hz") +
                " offset 0,-0.6");
    script.Line("plot " + script.Data(data) +
                " using 1:2:3 with xerrorbars pt 7 ps 0.5 " + kUpdatedLine);
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  const size_t all = merged.modes.size();
  figure.caption =
      (static_cast<size_t>(count) < all
           ? "The first " + std::to_string(count) + " of " +
                 std::to_string(all) + " mode"
           : std::string("Mode")) +
      " shapes in displacements, real parts, largest entry one, with 95 % "
      "intervals; places in the order of the sensors.";
  return figure;
}

}  // namespace pinode
