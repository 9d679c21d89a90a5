#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/gnuplot.h"
#include "pinode/report/modes_report.h"

namespace pinode {
namespace {

constexpr int kMostSpectra = 6;
constexpr Eigen::Index kMostLines = 600;

// In dB; the highest of neighbouring lines stands for them.
std::vector<std::vector<double>> SpectrumLine(const Vector& frequency,
                                              const Vector& density) {
  std::vector<std::vector<double>> columns(2);
  const Eigen::Index stride = frequency.size() / kMostLines + 1;
  for (Eigen::Index k = 0; k < frequency.size(); k += stride) {
    const Eigen::Index count = std::min(stride, frequency.size() - k);
    const double largest = density.segment(k, count).maxCoeff();
    columns[0].push_back(frequency[k + count / 2]);
    columns[1].push_back(largest > 0.0 ? 10.0 * std::log10(largest) : NAN);
  }
  return columns;
}

}  // namespace

Figure MakeModalSpectraFigure(const ResponseRecord& record,
                              const ModalSpectra& spectra, int number) {
  Figure figure;
  const int count = std::min(record.num_channels(), kMostSpectra);
  if (count == 0 || spectra.frequency_hz.size() < 2) return figure;
  figure.id = "spectra" + std::to_string(number);
  const int columns = std::min(count, 2);
  const int rows = (count + columns - 1) / columns;
  FigureScript script(figure.id, 900, 60 + 230 * rows);
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns));
  script.Line("set key outside top right horizontal");
  script.Line("set xlabel 'frequency, Hz'");
  script.Line("set ylabel 'density, dB'");
  script.Line(
      Range("x", spectra.frequency_hz[0], spectra.frequency_hz.tail(1)[0]));
  for (int c = 0; c < count; ++c) {
    script.Line("set title " +
                GnuplotString(record.channels[static_cast<size_t>(c)].name) +
                " offset 0,-0.6");
    const std::string measured = script.Data(SpectrumLine(
        spectra.frequency_hz, spectra.measured.row(c).transpose()));
    const std::string modelled = script.Data(SpectrumLine(
        spectra.frequency_hz, spectra.modelled.row(c).transpose()));
    script.Line("plot " +
                Lines(measured, kFaintLine, c == 0 ? "measured" : "") + ", " +
                Lines(modelled, kUpdatedLine, c == 0 ? "modes" : ""));
    script.Line("unset key");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Spectral densities of the channels, and those of the modes and a noise "
      "as the loads drive them.";
  if (count < record.num_channels()) {
    figure.caption += " The first channels alone.";
  }
  return figure;
}

}  // namespace pinode
