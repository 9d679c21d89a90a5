#include <algorithm>
#include <cmath>

#include "pinode/discover/equation_values.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"

namespace pinode {
namespace {

constexpr int kMaxPanels = 6;
// Largest number of dots; a dot takes ten times the bytes of a point on a line.
constexpr int kMaxDots = 900;

std::string EquationUnit(const DiscoveredEquation& equation,
                         const UnitSystem& units) {
  return UnitName(equation.acts_as == ActsAs::kForce ? Dimension::kForce
                                                     : Dimension::kAcceleration,
                  units);
}

}  // namespace

std::string SourceOf(const DiscoveredEquation& equation) {
  return equation.source == DiscoveryOptions::Source::kNetwork
             ? "network " + equation.network
             : "the force that smoothed records need beside the model";
}

Figure MakeEquationFigure(const DiscoveredEquation& equation,
                          const UnitSystem& units, int number) {
  Figure figure;
  const Eigen::Index samples = equation.sample_outputs.size();
  EquationValues values;
  std::string error;
  if (!EvaluateAtSamples(equation, &values, &error) ||
      equation.features.size() != values.parts.size()) {
    return figure;
  }
  // Features of the terms.
  std::vector<size_t> features;
  for (size_t f = 0; f < values.parts.size(); ++f) {
    if (values.parts[f].size() > 0) features.push_back(f);
  }
  const int panels = std::min(static_cast<int>(features.size()), kMaxPanels);
  if (samples < 2 || panels == 0 || values.sum.size() != samples) return figure;
  figure.id = "equation_" + std::to_string(number);
  const int columns = std::min(panels, 2);
  const int rows = (panels + 1) / 2;
  figure.half_width = columns == 1;
  FigureScript script(figure.id, columns == 1 ? 440 : 900, 280 * rows);
  script.Line("unset key");
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns) + " margins " +
              (columns == 1 ? "0.19,0.96" : "0.1,0.975") + "," +
              (rows == 1 ? "0.2" : "0.11") + ",0.96 spacing 0.12,0.16");
  script.Line(
      "set ylabel " +
      GnuplotString(AxisLabel(equation.output, EquationUnit(equation, units))));
  // Two dots per sample and panel.
  const int most = kMaxDots / (2 * panels);
  const Eigen::Index stride = (samples + most - 1) / most;
  for (int k = 0; k < panels; ++k) {
    const size_t feature = features[static_cast<size_t>(k)];
    const Vector& part = values.parts[feature];
    const auto at =
        equation.sample_features.col(static_cast<Eigen::Index>(feature));
    // Terms of other features would scatter the dots of a sum.
    std::vector<double> x, regressed, said;
    for (Eigen::Index i = 0; i < samples; i += stride) {
      x.push_back(at[i]);
      said.push_back(part[i]);
      regressed.push_back(equation.sample_outputs[i] -
                          (values.sum[i] - part[i]));
    }
    script.Line("set xlabel " +
                GnuplotString(
                    AxisLabel(equation.feature_names[feature],
                              FeatureUnit(equation.features[feature], units))));
    const std::string below = script.Data({x, regressed});
    const std::string above = script.Data({x, said});
    script.Line(
        "plot " + below +
        " using 1:2 with points pt 7 ps 0.55 lc rgb '#aaaaaa' notitle, " +
        above + " using 1:2 with points pt 7 ps 0.25 lc rgb '#0072B2' notitle");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      equation.output +
      " over each feature, along the training records. Blue: the "
      "equation's terms in that feature. Grey: what they replace, " +
      SourceOf(equation) + " minus the other terms.";
  const int left_out = static_cast<int>(features.size()) - panels;
  if (left_out > 0) {
    figure.caption +=
        " " + std::to_string(left_out) + " more features are not drawn.";
  }
  return figure;
}

Figure MakeParetoFigure(const DiscoveredEquation& equation, int number) {
  Figure figure;
  std::vector<double> terms, residuals, chosen, chosen_residual;
  for (const DiscoveryParetoPoint& point : equation.pareto) {
    // The axis is logarithmic.
    if (!(point.residual > 0.0) || !std::isfinite(point.residual)) continue;
    terms.push_back(point.num_terms);
    residuals.push_back(point.residual);
    if (point.num_terms == equation.num_regressed_terms) {
      chosen.push_back(point.num_terms);
      chosen_residual.push_back(point.residual);
    }
  }
  if (terms.size() < 2) return figure;
  figure.id = "pareto_" + std::to_string(number);
  figure.half_width = true;
  FigureScript script(figure.id, 440, 280);
  script.Line("unset key");
  script.Line("set margins 10,2,3.5,1");
  script.Line("set logscale y");
  script.Line("set format y '%.0e'");
  script.Line("set xlabel 'number of terms'");
  script.Line("set ylabel 'residual, share of the acceleration'");
  const std::string data = script.Data({terms, residuals});
  std::string plot = "plot " + data +
                     " using 1:2 with linespoints pt 7 ps 0.5 " + kUpdatedLine +
                     " notitle";
  if (!chosen.empty()) {
    const std::string mark = script.Data({chosen, chosen_residual});
    plot += ", " + mark + " using 1:2 with points pt 6 ps 1.6 lw 2 " + kMark +
            " notitle";
  }
  script.Line(plot);
  figure.script = script.text();
  figure.caption = equation.output + ": remainder of " + SourceOf(equation) +
                   " for the best set of each size, out of " +
                   std::to_string(equation.num_candidates) + " candidates." +
                   (chosen.empty() ? "" : " Circled: the chosen set.");
  return figure;
}

}  // namespace pinode
