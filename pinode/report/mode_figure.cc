#include <algorithm>

#include "pinode/base/strings.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Panels that stay legible.
constexpr int kMaxModes = 6;

// Returns the shape with a largest entry of one, with the sign that agrees with
// `like`.
Vector NormalisedShape(const Vector& shape, const Vector& like) {
  const double largest = shape.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return shape;
  const double sign = shape.dot(like) < 0.0 ? -1.0 : 1.0;
  return shape * (sign / largest);
}

// Returns modes that have initial and updated shapes, at most kMaxModes.
std::vector<int> ModesToDraw(const std::vector<ModePair>& pairs, int num_dofs) {
  std::vector<int> modes;
  for (size_t m = 0; m < pairs.size(); ++m) {
    const ModePair& mode = pairs[m];
    if (mode.initial_shape.size() == num_dofs &&
        mode.updated_shape.size() == num_dofs &&
        mode.initial_shape.allFinite() && mode.updated_shape.allFinite()) {
      modes.push_back(static_cast<int>(m));
    }
    if (static_cast<int>(modes.size()) == kMaxModes) break;
  }
  return modes;
}

// Draws one panel; the first has the legend of all.
void DrawMode(const ModePair& mode, const std::string& title, bool is_first,
              FigureScript* script) {
  std::vector<double> places;
  for (Eigen::Index i = 0; i < mode.updated_shape.size(); ++i) {
    places.push_back(static_cast<double>(i + 1));
  }
  script->Line("set title " + GnuplotString(title) + " offset 0,-0.5");
  const std::string initial = script->Data(
      {Column(NormalisedShape(mode.initial_shape, mode.updated_shape)),
       places});
  const std::string updated = script->Data(
      {Column(NormalisedShape(mode.updated_shape, mode.updated_shape)),
       places});
  script->Line("plot " + initial + " using 1:2 with linespoints pt 6 ps 0.7 " +
               kPriorLine + (is_first ? " title 'initial'" : " notitle") +
               ", " + updated + " using 1:2 with linespoints pt 7 ps 0.5 " +
               kUpdatedLine + (is_first ? " title 'updated'" : " notitle"));
  script->Line("unset key");
}

}  // namespace

Figure MakeModeShapeFigure(const ReportInput& input) {
  Figure figure;
  const std::vector<std::string>& dofs =
      input.problem->dynamics->model().dof_names;
  const int num_dofs = static_cast<int>(dofs.size());
  const std::vector<int> modes = ModesToDraw(input.prior.modes, num_dofs);
  if (num_dofs < 2 || modes.empty()) return figure;

  const int count = static_cast<int>(modes.size());
  const int columns = std::min(count, 3);
  const int rows = (count + columns - 1) / columns;
  figure.id = "modes";
  const int width = 300 * columns;
  const int height = 80 + 230 * rows;
  FigureScript script(figure.id, width, height);
  const auto fraction = [](double pixels, int size) {
    return FormatNumber(pixels / size, 5);
  };
  script.Line("set key at screen " + fraction(width - 12.0, width) +
              ", screen " + fraction(height - 8.0, height));
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns) + " margins " + fraction(70, width) +
              "," + fraction(width - 15.0, width) + "," + fraction(35, height) +
              "," + fraction(height - 75.0, height) + " spacing " +
              fraction(75, width) + "," + fraction(60, height));
  std::vector<std::string> ticks;
  const int every = (num_dofs + 11) / 12;
  for (int i = 0; i < num_dofs; ++i) {
    if (i % every == 0) {
      ticks.push_back(GnuplotString(dofs[static_cast<size_t>(i)]) + " " +
                      std::to_string(i + 1));
    }
  }
  script.Line("set ytics (" + Join(ticks, ", ") + ")");
  script.Line(Range("y", 0.5, num_dofs + 0.5));
  script.Line("set xrange [-1.15:1.15]");
  script.Line("set xtics -1, 0.5, 1");
  script.Line("set xzeroaxis");
  const double hz = input.problem->description.HzPerModelFrequency();
  for (size_t i = 0; i < modes.size(); ++i) {
    const ModePair& mode = input.prior.modes[static_cast<size_t>(modes[i])];
    DrawMode(mode,
             "mode " + std::to_string(modes[i] + 1) + ":  " +
                 ReadableNumber(hz * mode.initial_frequency, 4) + " \u2192 " +
                 ReadableNumber(hz * mode.updated_frequency, 4) + " Hz",
             i == 0, &script);
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Mode shapes of the linear part, largest entry one, DOFs in the model's "
      "order.";
  return figure;
}

}  // namespace pinode
