#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/modal/frf/frf_modes.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/modes_report.h"

namespace pinode {
namespace {

// Curves that stay legible, and lines that a curve needs.
constexpr Eigen::Index kMostIndicators = 3;
constexpr Eigen::Index kMostIndicatorLines = 900;

// Singular values of the functions at a line in dB, largest first.
Vector IndicatorsAt(const ModesOfFrfs& frfs, Eigen::Index line) {
  const Eigen::Index responses = frfs.num_responses;
  const ComplexMatrix values = frfs.measured.row(line).reshaped(
      responses, frfs.measured.cols() / responses);
  const Vector singular =
      Eigen::JacobiSVD<ComplexMatrix>(values).singularValues().cwiseMax(1e-300);
  return 20.0 * singular.array().log10();
}

// Columns of frequency and `count` indicators. Neighbouring lines are drawn as
// the one with the largest indicator.
std::vector<std::vector<double>> IndicatorCurves(const ModesOfFrfs& frfs,
                                                 Eigen::Index count) {
  std::vector<std::vector<double>> columns(static_cast<size_t>(count) + 1);
  const Eigen::Index lines = frfs.frequencies_hz.size();
  const Eigen::Index stride = lines / kMostIndicatorLines + 1;
  for (Eigen::Index k = 0; k < lines; k += stride) {
    Eigen::Index at = k;
    Vector largest = IndicatorsAt(frfs, k);
    for (Eigen::Index i = k + 1; i < std::min(lines, k + stride); ++i) {
      const Vector values = IndicatorsAt(frfs, i);
      if (values[0] <= largest[0]) continue;
      at = i;
      largest = values;
    }
    columns[0].push_back(frfs.frequencies_hz[at]);
    for (Eigen::Index c = 0; c < count; ++c) {
      columns[static_cast<size_t>(c) + 1].push_back(largest[c]);
    }
  }
  return columns;
}

// Columns of frequency, and of the median and the lowest coherence of all
// pairs. Neighbouring lines are drawn as the lowest of them.
std::vector<std::vector<double>> CoherenceCurves(const ModesOfFrfs& frfs) {
  std::vector<std::vector<double>> columns(3);
  const Eigen::Index lines = frfs.frequencies_hz.size();
  const Eigen::Index stride = lines / kMostIndicatorLines + 1;
  for (Eigen::Index k = 0; k < lines; k += stride) {
    double middle = 1.0;
    double lowest = 1.0;
    for (Eigen::Index i = k; i < std::min(lines, k + stride); ++i) {
      const Vector own = frfs.coherence.row(i).transpose();
      middle = std::min(middle, Median({own.begin(), own.end()}));
      lowest = std::min(lowest, own.minCoeff());
    }
    columns[0].push_back(frfs.frequencies_hz[k]);
    columns[1].push_back(middle);
    columns[2].push_back(lowest);
  }
  return columns;
}

}  // namespace

Figure MakeFrfIndicatorFigure(const ModesOfFrfs& frfs, int number) {
  Figure figure;
  if (frfs.frequencies_hz.size() < 2 || frfs.num_responses == 0) return figure;
  const bool has_coherence = frfs.coherence.rows() > 0;
  const Eigen::Index count =
      std::min({kMostIndicators, frfs.num_responses,
                frfs.measured.cols() / frfs.num_responses});
  figure.id = "indicator" + std::to_string(number);
  FigureScript script(figure.id, 900, has_coherence ? 520 : 300);
  script.Line("set multiplot layout " +
              std::string(has_coherence ? "2,1" : "1,1"));
  script.Line("set key outside top right horizontal");
  script.Line("set xlabel 'frequency, Hz'");
  script.Line(Range("x", frfs.frequencies_hz[0],
                    frfs.frequencies_hz[frfs.frequencies_hz.size() - 1]));
  for (const IdentifiedMode& mode : frfs.record.modes) {
    const std::string at = ScriptNumber(mode.frequency_hz);
    script.Line("set arrow from " + at + ", graph 0 to " + at +
                ", graph 1 nohead " + kFaintLine);
  }
  script.Line("set ylabel 'singular value, dB'");
  const std::string indicators = script.Data(IndicatorCurves(frfs, count));
  std::string plot = "plot ";
  for (Eigen::Index c = 0; c < count; ++c) {
    plot += (c > 0 ? ", " : "") + indicators +
            " using 1:" + std::to_string(c + 2) + " with lines " +
            (c == 0 ? kUpdatedLine : kPriorLine) + " title '" +
            (c == 0 ? "mode indicator" : "next") + "'";
  }
  script.Line(plot);
  if (has_coherence) {
    script.Line("set ylabel 'coherence'");
    script.Line(Range("y", 0.0, 1.02));
    const std::string coherence = script.Data(CoherenceCurves(frfs));
    script.Line("plot " + coherence + " using 1:3 with lines " + kMeasuredLine +
                " title 'lowest', " + coherence + " using 1:2 with lines " +
                kUpdatedLine + " title 'median'");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Complex mode indicator function: singular values of the functions at "
      "each line. The first peaks at a mode. If the second peaks with it, "
      "there "
      "are two modes. Vertical lines are the modes that were found.";
  if (has_coherence) {
    figure.caption +=
        " The coherence falls where noise or other loads act, and at "
        "antiresonances.";
  }
  return figure;
}

}  // namespace pinode
