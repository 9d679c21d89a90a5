#include <algorithm>

#include "pinode/report/modes_report.h"
#include "pinode/report/spectra_panels.h"

namespace pinode {
namespace {

// Lines that a curve of this width needs.
constexpr Eigen::Index kMostLines = 600;

// Returns a spectrum; neighbouring lines are drawn as the highest of them.
std::vector<std::vector<double>> SpectrumLine(const Vector& frequency,
                                              const Vector& density) {
  std::vector<std::vector<double>> columns(2);
  const Eigen::Index stride = frequency.size() / kMostLines + 1;
  for (Eigen::Index k = 0; k < frequency.size(); k += stride) {
    const Eigen::Index count = std::min(stride, frequency.size() - k);
    columns[0].push_back(frequency[k + count / 2]);
    columns[1].push_back(Decibels(density.segment(k, count).maxCoeff()));
  }
  return columns;
}

}  // namespace

Figure MakeModalSpectraFigure(const ResponseRecord& record,
                              const ModalSpectra& spectra, int number) {
  if (record.channels.empty() || spectra.frequency_hz.size() < 2) return {};
  std::vector<std::string> names;
  for (const auto& channel : record.channels) names.push_back(channel.name);
  return MakeSpectraPanels(
      "spectra" + std::to_string(number), names, spectra.frequency_hz[0],
      spectra.frequency_hz.tail(1)[0],
      "Spectral densities of the channels, and those of the modes and a noise "
      "as the loads drive them.",
      [&](int c, FigureScript* script) {
        const std::string measured = script->Data(SpectrumLine(
            spectra.frequency_hz, spectra.measured.row(c).transpose()));
        const std::string modelled = script->Data(SpectrumLine(
            spectra.frequency_hz, spectra.modelled.row(c).transpose()));
        script->Line(
            "plot " + Lines(measured, kFaintLine, c == 0 ? "measured" : "") +
            ", " + Lines(modelled, kUpdatedLine, c == 0 ? "modes" : ""));
      });
}

}  // namespace pinode
