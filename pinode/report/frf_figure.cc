#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/modal/frf/frf_modes.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/gnuplot.h"
#include "pinode/report/modes_report.h"

namespace pinode {
namespace {

// Panels of a figure that stay legible, and lines that a curve needs.
constexpr int kMostFrfPanels = 6;
constexpr Eigen::Index kMostFrfLines = 900;

// Phase in degrees, from -90 to 270. Responses of lightly damped structures are
// near 0 and 180 degrees between their modes, and noise must not turn 180 into
// -180 from line to line.
double PhaseDegrees(const std::complex<double>& value) {
  const double degrees = std::arg(value) * 180.0 / kPi;
  return degrees < -90.0 ? degrees + 360.0 : degrees;
}

// Returns frequency, magnitude in dB and phase in degrees. Neighbouring lines
// are drawn as the largest of them.
std::vector<std::vector<double>> FrfCurve(const Vector& frequencies,
                                          const ComplexVector& values) {
  std::vector<std::vector<double>> columns(3);
  const Eigen::Index stride = frequencies.size() / kMostFrfLines + 1;
  for (Eigen::Index k = 0; k < frequencies.size(); k += stride) {
    const Eigen::Index count = std::min(stride, frequencies.size() - k);
    Eigen::Index at = 0;
    const double largest = values.segment(k, count).cwiseAbs().maxCoeff(&at);
    columns[0].push_back(frequencies[k + at]);
    columns[1].push_back(20.0 * std::log10(std::max(largest, 1e-30)));
    columns[2].push_back(PhaseDegrees(values[k + at]));
  }
  return columns;
}

// Functions to draw, one column a pair.
struct FrfCurves {
  Vector frequencies_hz;
  ComplexMatrix measured, modelled;
  std::vector<std::string> names;
  std::string title;  // of the modelled ones, in the legend
};

// Draws magnitude and phase of the first functions.
Figure DrawFrfs(const FrfCurves& frfs, const std::string& id,
                const std::string& caption) {
  Figure figure;
  const Eigen::Index pairs = frfs.measured.cols();
  if (pairs == 0 || frfs.frequencies_hz.size() < 2) return figure;
  figure.id = id;
  const int panels =
      static_cast<int>(std::min<Eigen::Index>(pairs, kMostFrfPanels));
  FigureScript script(figure.id, 900, 60 + 210 * panels);
  script.Line("set multiplot layout " + std::to_string(panels) + ",2");
  script.Line("set key outside top right horizontal");
  script.Line("set xlabel 'frequency, Hz'");
  script.Line(Range("x", frfs.frequencies_hz[0],
                    frfs.frequencies_hz[frfs.frequencies_hz.size() - 1]));
  for (int p = 0; p < panels; ++p) {
    const std::string measured =
        script.Data(FrfCurve(frfs.frequencies_hz, frfs.measured.col(p)));
    const std::string synthesised =
        script.Data(FrfCurve(frfs.frequencies_hz, frfs.modelled.col(p)));
    script.Line("set title " +
                GnuplotString(frfs.names[static_cast<size_t>(p)]) +
                " offset 0,-0.6");
    const char* const columns[] = {" using 1:2", " using 1:3"};
    const char* const labels[] = {"set ylabel 'magnitude, dB'",
                                  "set ylabel 'phase, degrees'"};
    for (int side = 0; side < 2; ++side) {
      script.Line(labels[side]);
      script.Line(side == 0 ? "set yrange [*:*]" : "set yrange [-100:280]");
      script.Line(
          "plot " + measured + columns[side] + " with lines " + kMeasuredLine +
          (p == 0 && side == 0 ? " title 'measured'" : " notitle") + ", " +
          synthesised + columns[side] + " with lines " + kUpdatedLine +
          (p == 0 && side == 0 ? " title " + GnuplotString(frfs.title)
                               : std::string(" notitle")));
      script.Line("unset key");
    }
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption = caption;
  if (panels < pairs) {
    figure.caption +=
        " Only " + std::to_string(panels) + " functions are drawn.";
  }
  return figure;
}

}  // namespace

Figure MakeFrfFigure(const ModesOfFrfs& frfs, int number) {
  return DrawFrfs({frfs.frequencies_hz, frfs.measured, frfs.synthesised,
                   frfs.pair_names, "synthesised"},
                  "frfs" + std::to_string(number),
                  "Frequency response functions, measured and synthesised from "
                  "the modes and the residuals of modes outside of the band.");
}

Figure MakeModelFrfFigure(const ReportInput& input, int set) {
  const FrfScore& score = input.summary->frfs[static_cast<size_t>(set)];
  std::vector<Eigen::Index> worst(score.pairs.size());
  std::iota(worst.begin(), worst.end(), Eigen::Index{0});
  std::stable_sort(worst.begin(), worst.end(),
                   [&score](Eigen::Index a, Eigen::Index b) {
                     return score.errors[a] > score.errors[b];
                   });
  const auto complex = [&worst](const Matrix& real, const Matrix& imaginary) {
    ComplexMatrix values(real.cols(), real.rows());
    values.real() = real(worst, Eigen::all).transpose();
    values.imag() = imaginary(worst, Eigen::all).transpose();
    return values;
  };
  FrfCurves curves;
  curves.frequencies_hz =
      input.problem->description.HzPerModelFrequency() * score.frequencies;
  curves.title = "model";
  if (score.measured_real.size() == 0) return {};
  curves.measured = complex(score.measured_real, score.measured_imaginary);
  curves.modelled = complex(score.modelled_real, score.modelled_imaginary);
  for (const Eigen::Index pair : worst) {
    curves.names.push_back(score.pairs[static_cast<size_t>(pair)]);
  }
  return DrawFrfs(curves, "model_frfs" + std::to_string(set),
                  "Frequency response functions '" + score.name +
                      "', measured and of the model, those with the largest "
                      "errors first.");
}

}  // namespace pinode
